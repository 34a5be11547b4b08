"""Fingers: the left hand closes over 24 frames, every finger at its three joints; nothing is painted.

The stage that this writes has no patch. `skinslide setup --whole` finds where its edges ever stretch, which is at all
knuckles and round all fingers, and makes one patch of the hand. Fingers are tubes, closed at their tips, which do not
lie flat in a plane. In the result skin slides over the knuckles from the back of the hand and from between them.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import hand, makehuman, skinning, stage
from makers.command import main

FINGERS = np.radians([60, 75, 45])  # at the knuckle, the middle joint and the last
THUMB = np.radians([15, 30, 40])


def pose(points: np.ndarray, share: float) -> dict[str, np.ndarray]:
    """The bone turns at `share`, 0..1, of the whole closing."""
    turns = hand.curled(points, 1, share * THUMB)
    for number in range(2, 6):
        turns.update(hand.curled(points, number, share * FINGERS))
    return turns


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body = points[: mesh.body_size]
    frames = (skinning.skin(body, pose(points, share)) for share in np.linspace(0, 1, stage.FRAME_COUNT))
    return stage.write(folder, stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces))


if __name__ == "__main__":
    main(make, __doc__)
