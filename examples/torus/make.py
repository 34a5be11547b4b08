"""Torus: a bump runs once round inside a ring over 24 frames; nothing is painted.

A ring has a handle and no boundary, so it cannot be laid out in a plane, and no point of it is pinned. In the result
the skin around draws in to the bump, and does not travel round with it.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import closed, stage
from makers.command import main

AROUND, ACROSS = 72, 32
RADIUS, THICKNESS = 40.0, 15.0
HEIGHT, WIDTH = 10.0, 9.0  # of the bump: its top, and its radius at 61 % of that


def bumped(rest: np.ndarray, share: float) -> np.ndarray:
    """The ring (V, 3) with the bump after `share`, 0..1, of its way."""
    angle = 2 * np.pi * share
    middle = RADIUS * rest * [1, 0, 1] / np.hypot(rest[:, 0], rest[:, 2])[:, None]
    out = (rest - middle) / THICKNESS
    top = np.array([RADIUS * np.cos(angle), THICKNESS, RADIUS * np.sin(angle)])
    rise = np.sin(np.pi * share) * HEIGHT * np.exp(-0.5 * (np.linalg.norm(rest - top, axis=1) / WIDTH) ** 2)
    return rest + rise[:, None] * out


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    rest, faces = closed.torus(AROUND, ACROSS, RADIUS, THICKNESS)
    place = np.arange(len(rest))
    st = np.stack([place % AROUND / AROUND, place // AROUND / ACROSS], axis=1)
    frames = (bumped(rest, share) for share in np.linspace(0, 1, stage.FRAME_COUNT))
    return stage.write(folder, stage.Cache(rest, frames, faces, st, faces))


if __name__ == "__main__":
    main(make, __doc__)
