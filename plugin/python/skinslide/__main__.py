"""`python -m skinslide` is the command `skinslide`."""

import sys

from skinslide.cli import main

sys.exit(main())
