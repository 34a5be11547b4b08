"""Elbow: the arm flexes by 110° over 24 frames, with an oval patch over its point.

The cached skin is pulled tight over the point of the elbow, where linear blend skinning stretches it most. In the
result the skin around slides towards the point: the texture there keeps closer to its spacing at rest, and the
silhouette of the arm stays. The rest pose is the default value of `points`; the patch is a bool primvar by face.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, regions, skinning, stage
from makers.arm import farthest, left_arm
from makers.command import main

HALF_WIDTH, SLIMNESS = 6.0, 2.5  # of the patch: cm round the arm, and how many times that along it
BEND = np.radians(110)


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body, arm = points[: mesh.body_size], left_arm(points)
    frames = (skinning.skin(body, arm.flexed(angle)) for angle in np.linspace(0, BEND, stage.FRAME_COUNT))
    cache = stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces)

    tip = farthest(body, arm.elbow, arm.outward, within=8.0)
    region = regions.oval(body, mesh.faces, tip, arm.along, HALF_WIDTH, SLIMNESS)
    return stage.write(folder, cache, stage.Patch("elbow_L", region))


if __name__ == "__main__":
    main(make, __doc__)
