"""Body: an elbow and both knees bend while the jaw opens in a smile, over 24 frames; nothing is painted.

The stage that this writes has no patch. `skinslide setup --whole` finds where its edges ever stretch, and makes one
patch of these and the skin around them. In the result skin slides in at elbow, knees, mouth and cheeks at once, from as
far away as is needed; hands, feet and all else outside the patch are those of the cache, to the bit.

Two masks of the left elbow are on the mesh for commands that take some, elbowMask and tendon; --whole reads neither.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, regions, skinning, stage
from makers.arm import Arm, farthest, left_arm
from makers.command import main

ELBOW, KNEES = np.radians([110, 100])
MOUTH = {"faceunits/jawOpen": 0.7, "faceunits/mouthSmileLeft": 0.6, "faceunits/mouthSmileRight": 0.6}
MASK = 6.0, 2.5  # its half width round the arm in cm, and how many times that it is along it
TENDON = 2.0, 12.0  # its half width and half length, in cm
BACKWARD = np.array([1.0, 0.0, 0.0])  # a positive turn about it takes a foot behind its knee; the character faces +Z


def pose(points: np.ndarray, share: float) -> dict[str, np.ndarray]:
    """The bone turns at `share`, 0..1, of the whole bend."""
    knees = {
        f"lowerleg01.{side.upper()}": skinning.turn(skinning.joint(points, f"{side}-knee"), BACKWARD, share * KNEES)
        for side in "lr"
    }
    return {**left_arm(points).flexed(share * ELBOW), **knees}


def masks(body: np.ndarray, faces: np.ndarray, arm: Arm) -> dict[str, np.ndarray]:
    """The faces over the point of the elbow, bool (F,), and the points of the tendon behind it, (V,)."""
    tip = farthest(body, arm.elbow, arm.outward, within=8.0)
    way = body - body[tip]
    along = way @ arm.along
    beside = np.linalg.norm(way - along[:, None] * arm.along, axis=1)
    tendon = (beside < TENDON[0]) & (np.abs(along) < TENDON[1])
    return {"elbowMask": regions.oval(body, faces, tip, arm.along, *MASK), "tendon": tendon.astype(float)}


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body, mouth = points[: mesh.body_size], makehuman.read_offsets(MOUTH)[: mesh.body_size]
    shares = np.linspace(0, 1, stage.FRAME_COUNT)
    frames = (skinning.skin(body + share * mouth, pose(points, share)) for share in shares)
    painted = masks(body, mesh.faces, left_arm(points))
    return stage.write(folder, stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces, masks=painted))


if __name__ == "__main__":
    main(make, __doc__)
