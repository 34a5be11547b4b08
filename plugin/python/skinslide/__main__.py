"""`python -m skinslide` is the command `skinslide`."""

from __future__ import annotations

from skinslide.command.start import run

run()
