"""Character: the elbow's arm as it comes from a rig: skinned by UsdSkel, split at its UV seams, with authored normals.

Nothing is cached or painted: `skinslide setup --joint` makes the shot's patch. The two copies of a point on a seam
slide together, and keep the same normal. The rest pose is that in which the body was bound.
"""

import sys
from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, rigged, stage
from makers.arm import left_arm
from makers.command import main

BEND = np.radians(110)
JOINT = "lowerarm01.L"
FROM_BEHIND = np.array([-5.0, -42.0, -28.0])  # cm


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    points = makehuman.read_mesh().points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    hinge = left_arm(points).hinge
    bend = [(hinge, angle) for angle in np.linspace(0, BEND, stage.FRAME_COUNT)]
    character = rigged.Character(points, {JOINT: bend})
    shot = stage.write_skinned(folder, lambda published: rigged.define(published, character))
    look_at_seam(shot, left_arm(points).elbow)
    return shot


def look_at_seam(shot: Path, elbow: np.ndarray) -> None:
    """Adds a camera that sees the seam at the back of the elbow."""
    opened = Usd.Stage.Open(str(shot))
    eye = Gf.Vec3d(*(elbow + FROM_BEHIND).tolist())
    seen_from = Gf.Matrix4d().SetLookAt(eye, Gf.Vec3d(*elbow.tolist()), Gf.Vec3d(0, 0, 1))
    UsdGeom.Camera.Define(opened, "/World/seam_CAM").AddTransformOp().Set(seen_from.GetInverse())
    opened.Save()


if __name__ == "__main__":
    main(make, __doc__)
