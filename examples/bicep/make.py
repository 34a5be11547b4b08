"""Bicep: the arm flexes by 100° over 24 frames while the biceps swells, under one oval patch.

In the cache, skin moves outwards with the muscle and is stretched over it. In the result the skin around slides in, so
the texture over the muscle keeps closer to its spacing at rest, and the swell keeps its shape. The rest pose is
`primvars:rest`; the patch is an int primvar by face, and a painted slide weight fades the sliding out towards its edge.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, regions, skinning, stage
from makers.arm import Arm, left_arm, nearest, unit
from makers.command import main

HALF_WIDTH, SLIMNESS = 7.0, 1.25  # of the patch: cm round the arm, and how many times that along it
ARM_RADIUS = 4.5  # cm
FEATHER = 2.0  # cm over which the slide weight rises from the boundary
BEND = np.radians(100)
SWELL = {**makehuman.MORE_MUSCLE, "arms/l-upperarm-muscle-incr": 1.0}


def muscle(mesh: makehuman.Mesh) -> np.ndarray:
    """How far each body point moves when the muscle is full, (V, 3) cm: the upper arm's share of the targets."""
    weights = makehuman.read_weights()
    share = weights["upperarm01.L"] + weights["upperarm02.L"]
    return makehuman.read_offsets(SWELL)[: mesh.body_size] * share[:, None]


def belly(body: np.ndarray, arm: Arm) -> int:
    """The point in the middle of the front of the upper arm, the side that the forearm closes on."""
    upper, fore = unit(arm.elbow - arm.shoulder), arm.wrist - arm.elbow
    middle = arm.shoulder + 0.45 * (arm.elbow - arm.shoulder)
    return nearest(body, middle + ARM_RADIUS * unit(fore - (fore @ upper) * upper))


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body, arm, swell = points[: mesh.body_size], left_arm(points), muscle(mesh)
    shares = np.linspace(0, 1, stage.FRAME_COUNT)
    frames = (skinning.skin(body + share**2 * swell, arm.flexed(share * BEND)) for share in shares)
    cache = stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces, rest_source="rest")

    axis = unit(arm.elbow - arm.shoulder)
    region = regions.oval(body, mesh.faces, belly(body, arm), axis, HALF_WIDTH, SLIMNESS)
    weight = regions.feather(body, mesh.faces, region, FEATHER)
    return stage.write(folder, cache, stage.Patch("bicep_L", region, store="int", weight=weight))


if __name__ == "__main__":
    main(make, __doc__)
