"""Sleeve: the arm flexes by 60° over 24 frames, and the patch is the whole ring of skin round the elbow.

The ring is a disk with one hole: its longer rim is embedded on the circle; the other is the hole, pinned. In the result
the skin slides along the arm all the way round, and is less stretched over the point of the elbow and less crowded in
its crook. The rest pose is `primvars:__Pref`; the patch is a float primvar painted on the points.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, regions, skinning, stage
from makers.arm import Arm, farthest, left_arm, unit
from makers.command import main

REACH = 8.0  # cm, of the ring from the elbow along either bone
BEND = np.radians(60)


def distance_along(body: np.ndarray, arm: Arm) -> np.ndarray:
    """How far each point (V,) lies from the elbow along the bone on its side of the joint, cm."""
    from_elbow = body - arm.elbow
    upper, fore = from_elbow @ unit(arm.shoulder - arm.elbow), from_elbow @ unit(arm.wrist - arm.elbow)
    return np.where(from_elbow @ arm.along < 0, upper, fore)


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body, arm = points[: mesh.body_size], left_arm(points)
    frames = (skinning.skin(body, arm.flexed(angle)) for angle in np.linspace(0, BEND, stage.FRAME_COUNT))
    cache = stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces, rest_source="__Pref")

    tip = farthest(body, arm.elbow, arm.outward, within=8.0)
    along = distance_along(body, arm)
    ring = regions.below(along, mesh.faces, REACH)
    ring &= regions.below(np.linalg.norm(body - arm.elbow, axis=1), mesh.faces, 2 * REACH)
    # The rest of the body and the forearm end are what the ring's two boundaries are open to.
    beyond = ~regions.below(along, mesh.faces, 1.3 * REACH)
    region = regions.tidy(mesh.faces, ring, regions.face_at(mesh.faces, tip), outside=beyond)
    return stage.write(folder, cache, stage.Patch("sleeve_L", region, store="float"))


if __name__ == "__main__":
    main(make, __doc__)
