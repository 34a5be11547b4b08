"""Fine elbow: the elbow example on a cage of film density, the body subdivided once before it is posed.

The renderer subdivides it further. In the result the limit surface of the arm is where the cache has it, and only the
texture on it slides: examples/measure/limit_distance.py measures by how much.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, refine, regions, skinning, stage
from makers.arm import farthest, left_arm
from makers.command import main

HALF_WIDTH, SLIMNESS = 6.0, 2.5  # of the patch: cm round the arm, and how many times that along it
BEND = np.radians(110)


def refined_weights(faces: np.ndarray) -> dict[str, np.ndarray]:
    """The skin weights on the refined points; their shares of a point still sum to one."""
    weights = makehuman.read_weights()
    values = refine.refined(np.stack(list(weights.values()), axis=1), faces)
    return dict(zip(weights, values.T, strict=True))


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    arm = left_arm(points)
    body, faces = refine.refined(points[: mesh.body_size], mesh.faces), refine.refined_faces(mesh.faces)
    st, st_faces = refine.refined(mesh.st, mesh.st_faces, smooth=False), refine.refined_faces(mesh.st_faces)
    weights = refined_weights(mesh.faces)
    frames = (skinning.skin(body, arm.flexed(angle), weights) for angle in np.linspace(0, BEND, stage.FRAME_COUNT))
    cache = stage.Cache(body, frames, faces, st, st_faces)

    tip = farthest(body, arm.elbow, arm.outward, within=8.0)
    region = regions.oval(body, faces, tip, arm.along, HALF_WIDTH, SLIMNESS)
    return stage.write(folder, cache, stage.Patch("elbow_L", region))


if __name__ == "__main__":
    main(make, __doc__)
