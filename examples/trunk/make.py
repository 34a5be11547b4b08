"""Trunk: a tapered tube, closed at both ends, curls up over 24 frames; nothing is painted.

It is the paper's elephant. In the cache, skin is stretched on the outer side of the curl and crowded on the inner side.
The patch is all of it, which cannot be laid out in a plane. In the result skin slides round to the outer side.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import closed, stage
from makers.command import main

SIDE, ALONG = 6, 60  # faces along a side of the block that is blown up
RADII, LENGTH = (9.0, 3.0), 90.0
CURL = np.radians(300)  # at the tip; the curve tightens towards it


def curled(rest: np.ndarray, share: float) -> np.ndarray:
    """The trunk (V, 3) at `share`, 0..1, of its curl: bent about Z along its middle line, lengths of which stay."""
    steps = np.linspace(0, 1, 2001)
    heading = share * CURL * steps**2
    line = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    way = np.concatenate([[[0, 0]], np.cumsum((line[1:] + line[:-1]) / 2, axis=0)]) * LENGTH / (len(steps) - 1)
    at = np.clip(rest[:, 0] / LENGTH, 0, 1)
    forward = np.stack([np.interp(at, steps, line[:, k]) for k in range(2)], axis=1)
    middle = np.stack([np.interp(at, steps, way[:, k]) for k in range(2)], axis=1)
    beyond = (rest[:, 0] - LENGTH * at)[:, None]  # of the domes at the ends
    bent = middle + beyond * forward + rest[:, 1:2] * np.stack([-forward[:, 1], forward[:, 0]], axis=1)
    return np.column_stack([bent, rest[:, 2]])


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    rest, faces = closed.tube(SIDE, ALONG, RADII, LENGTH)
    st = np.stack([rest[:, 0] / LENGTH, np.arctan2(rest[:, 2], rest[:, 1]) / (2 * np.pi) + 0.5], axis=1)
    frames = (curled(rest, share) for share in np.linspace(0, 1, stage.FRAME_COUNT))
    return stage.write(folder, stage.Cache(rest, frames, faces, st, faces))


if __name__ == "__main__":
    main(make, __doc__)
