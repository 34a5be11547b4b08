"""Finger: the left index finger curls at its three joints over 24 frames, under a patch along its back.

In the cache, skin is stretched over the knuckles and not between them. In the result the stretch is spread along the
back of the finger, as in loose skin. The rest pose is `primvars:pref`; the patch is a GeomSubset.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import hand, makehuman, regions, skinning, stage
from makers.arm import farthest, unit
from makers.command import main

HALF_WIDTH, SLIMNESS = 1.1, 6.0  # of the patch: cm round the finger, and how many times that along it
INDEX = 2
CURL = np.radians([55, 80, 45])  # at the knuckle, the middle joint and the last


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body = points[: mesh.body_size]
    joints = hand.finger(points, INDEX)
    shares = np.linspace(0, 1, stage.FRAME_COUNT)
    frames = (skinning.skin(body, hand.curled(points, INDEX, share * CURL)) for share in shares)
    cache = stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces, rest_source="pref")

    along = unit(joints[2] - joints[0])
    knuckle = farthest(body, joints[0], np.cross(along, hand.hinge(joints)), within=1.3)
    region = regions.oval(body, mesh.faces, knuckle, along, HALF_WIDTH, SLIMNESS)
    return stage.write(folder, cache, stage.Patch("index_L", region, store="subset"))


if __name__ == "__main__":
    main(make, __doc__)
