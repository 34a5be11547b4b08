"""Lengths in the world: a mesh that is scaled unevenly slides there as one that is modelled so."""

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

import skinslide
import stages
from stages import FRAMES, MESH

SCALE = np.float32([3, 1, 1])


def scaled_stage(in_world: bool) -> Usd.Stage:
    """A sheet that rests drawn together along x by a third, below what draws it out again."""
    grid = stages.grid()
    stage, mesh = stages.patched_stage(stages.Shape(grid.points / SCALE, grid.counts, grid.indices))
    for frame in FRAMES:
        mesh.GetPointsAttr().Set(stages.vectors(grid.moved(frame) / SCALE), frame)
    stages.set_property(mesh, "forceDensityRule", "even")
    UsdGeom.Xformable(mesh.GetPrim().GetParent()).AddScaleOp().Set(Gf.Vec3f(*SCALE.tolist()))
    if in_world:
        skinslide.SkinSlideMeshAPI.Apply(mesh).CreateWorldSpaceAttr(True)
    return stage


def slid(stage: Usd.Stage, tmp_path) -> tuple[np.ndarray, skinslide.PatchReport]:
    report = skinslide.bake_to_file(stage, tmp_path / "out.usdc")
    baked = Usd.Stage.Open(str(tmp_path / "out.usdc"))
    points = np.array(UsdGeom.Mesh(baked.GetPrimAtPath(MESH)).GetPointsAttr().Get(FRAMES[-1]))
    return points, report.meshes[0].patches[0]


def test_a_scaled_mesh_slides_as_it_is_seen(tmp_path):
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "forceDensityRule", "even")
    expected, plain = slid(stage, tmp_path)
    found, scaled = slid(scaled_stage(in_world=True), tmp_path)
    np.testing.assert_allclose(found * SCALE, expected, atol=2e-6)
    assert scaled.results[-1].stretch_after == pytest.approx(plain.results[-1].stretch_after, rel=1e-4)
    own, _ = slid(scaled_stage(in_world=False), tmp_path)
    assert np.abs(own * SCALE - expected).max() > 0.01


def test_check_and_bake_warn_of_the_scale_unless_it_is_taken(tmp_path):
    said = "the transforms above scale it 3 times as much one way as another"
    for in_world in (False, True):
        stage = scaled_stage(in_world)
        for report in (skinslide.check(stage), skinslide.bake_to_file(stage, tmp_path / "out.usdc")):
            assert any(said in problem.message for problem in report.problems) != in_world
