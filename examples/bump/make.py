"""Bump: the bump of the chequer example under a sheet that renders as a subdivision surface.

The sheet has 32 by 32 faces, too few to have the shape of the bump. In the result the limit surface keeps the bump's
shape, and the squares become nearly square again all the same. The patch is the whole sheet, with its four corners.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import sheet, stage
from makers.command import main

COUNT = 32  # faces along a side
CHEQUER = 2  # faces along a chequer


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    cache = sheet.cache(COUNT, CHEQUER, "catmullClark")
    region = np.ones(len(cache.faces), dtype=bool)
    return stage.write(folder, cache, stage.Patch("sheet", region, corners=sheet.corners(COUNT)))


if __name__ == "__main__":
    main(make, __doc__)
