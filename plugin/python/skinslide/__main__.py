"""`python -m skinslide` is the command `skinslide`."""

from __future__ import annotations

import sys

from skinslide.command.start import main

sys.exit(main())
