"""`python -m skinslide` is the command `skinslide`."""

import sys

from skinslide.command.start import main

sys.exit(main())
