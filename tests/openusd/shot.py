"""Writes a set-up and its bake for the host: a patch of each rule, with normals and velocities, over some frames.

python shot.py FOLDER
"""

import sys
from pathlib import Path

import numpy as np

import stages
from skinslide import bake_to_file

FRAMES = range(1001, 1009)
RULES = {"unit": range(1, 10), "fast": range(11, 19), "relaxed": range(20, 28), "even": range(29, 37)}

folder = Path(sys.argv[1])
sheet = stages.grid(38, 12)
stage, mesh = stages.patched_stage(sheet, stages.block(38, range(0), range(0)))
stage.SetEndTimeCode(FRAMES[-1])
mesh.GetPrim().RemoveAPI("SkinSlideAPI", stages.PATCH)
for rule, columns in RULES.items():
    stages.add_patch(mesh, stages.block(38, columns, range(1, 11)), rule)
    stages.set_property(mesh, "forceDensityRule", rule, patch=rule)
mesh.SetNormalsInterpolation("vertex")
for frame in FRAMES:
    mesh.GetPointsAttr().Set(stages.vectors(sheet.moved(frame)), frame)
    mesh.CreateNormalsAttr().Set(stages.vectors(np.tile([0, 0, 1], (len(sheet.points), 1))), frame)
    mesh.CreateVelocitiesAttr().Set(stages.vectors(np.zeros_like(sheet.points)), frame)
bake_to_file(stages.save(stage, folder / "shot.usda"), folder / "baked.usda")
(folder / "live.skinslide").write_text("#usda 1.0\n(timeCodesPerSecond = 24; subLayers = [@./shot.usda@])\n")
