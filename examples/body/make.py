"""Body: an elbow and both knees bend while the jaw opens in a smile, over 24 frames; nothing is painted.

The stage that this writes has no patch. `skinslide setup --whole` finds where its edges ever stretch, and makes one
patch of these and the skin around them. In the result skin slides in at elbow, knees, mouth and cheeks at once, from as
far away as is needed; hands, feet and all else outside the patch are those of the cache, to the bit.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, skinning, stage
from makers.arm import left_arm
from makers.command import main

ELBOW, KNEES = np.radians([110, 100])
MOUTH = {"faceunits/jawOpen": 0.7, "faceunits/mouthSmileLeft": 0.6, "faceunits/mouthSmileRight": 0.6}
BACKWARD = np.array([1.0, 0.0, 0.0])  # a positive turn about it takes a foot behind its knee; the character faces +Z


def pose(points: np.ndarray, share: float) -> dict[str, np.ndarray]:
    """The bone turns at `share`, 0..1, of the whole bend."""
    knees = {
        f"lowerleg01.{side.upper()}": skinning.turn(skinning.joint(points, f"{side}-knee"), BACKWARD, share * KNEES)
        for side in "lr"
    }
    return {**left_arm(points).flexed(share * ELBOW), **knees}


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body, mouth = points[: mesh.body_size], makehuman.read_offsets(MOUTH)[: mesh.body_size]
    shares = np.linspace(0, 1, stage.FRAME_COUNT)
    frames = (skinning.skin(body + share * mouth, pose(points, share)) for share in shares)
    return stage.write(folder, stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces))


if __name__ == "__main__":
    main(make, __doc__)
