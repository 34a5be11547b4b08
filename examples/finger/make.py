"""Finger: the left index finger curls at its three joints over 24 frames, under a patch along its back.

The cached skin is drawn out over the knuckles and not between them. In the result it is shared out along the back of
the finger, as the loose skin there does. The rest pose is `primvars:pref`; the patch is a GeomSubset.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, regions, skinning, stage
from makers.arm import farthest, unit
from makers.command import main

HALF_WIDTH, SLIMNESS = 1.1, 6.0  # of the patch: cm round the finger, and how many times that along it
CURL = np.radians([55, 80, 45])  # at the knuckle, the middle joint and the last


def hinge(joints: np.ndarray) -> np.ndarray:
    """The axis (3,) of a finger's joints (4, 3): it is a little curled at rest, and curls further in that plane."""
    return unit(np.cross(joints[1] - joints[0], joints[3] - joints[2]))


def curled(joints: np.ndarray, share: float) -> dict[str, np.ndarray]:
    """The bone turns of the finger at `share`, 0..1, of its full curl."""
    axis = hinge(joints)
    return {
        f"finger2-{number}.L": skinning.turn(pivot, axis, share * angle)
        for number, (pivot, angle) in enumerate(zip(joints[:3], CURL, strict=True), start=1)
    }


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body = points[: mesh.body_size]
    joints = np.array([skinning.joint(points, f"l-finger-2-{number}") for number in range(1, 5)])
    frames = (skinning.skin(body, curled(joints, share)) for share in np.linspace(0, 1, stage.FRAME_COUNT))
    cache = stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces, rest_source="pref")

    along = unit(joints[2] - joints[0])
    knuckle = farthest(body, joints[0], np.cross(along, hinge(joints)), within=1.3)
    region = regions.oval(body, mesh.faces, knuckle, along, HALF_WIDTH, SLIMNESS)
    return stage.write(folder, cache, stage.Patch("index_L", region, store="subset"))


if __name__ == "__main__":
    main(make, __doc__)
