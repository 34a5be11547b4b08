"""Chequer: a bump travels under a chequered square of 64 by 64 faces over 24 frames.

In the cache each point only rises and falls, so the chequers on the bump's flanks are stretched lengthwise. In the
result the squares all around draw in towards the bump and those on it become nearly square again; the bump itself and
the edge of the sheet stay where they were. The patch is the whole sheet, with its four corners; the rest pose is flat.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import sheet, stage
from makers.command import main

COUNT = 64  # faces along a side
CHEQUER = 4  # faces along a chequer


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    cache = sheet.cache(COUNT, CHEQUER, "none")
    region = np.ones(len(cache.faces), dtype=bool)
    return stage.write(folder, cache, stage.Patch("sheet", region, corners=sheet.corners(COUNT)))


if __name__ == "__main__":
    main(make, __doc__)
