"""Paint as tools leave it: what `check` says of it, and a set-up beside a cache that is exported again."""

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, Vt

import skinslide
import stages
from stages import FRAMES, MESH, PATCH

PLACE = f"skinSlide:{PATCH}"
Types = Sdf.ValueTypeNames


def notes(stage: Usd.Stage) -> list[str]:
    return [problem.message for problem in skinslide.check(stage).problems if problem.severity == "note"]


def test_check_says_what_it_took():
    stage, mesh = stages.patched_stage()
    assert notes(stage) == []
    colours = Types.Color3fArray.type.pythonClass([(0.5, 1, 0)] * 144)
    stages.set_primvar(mesh, f"{PLACE}_weight".replace(":", "_"), Types.Color3fArray, "faceVarying", colours)
    stages.set_primvar(mesh, f"{PLACE}:forceDensity", Types.DoubleArray, "vertex", Vt.DoubleArray([2.0] * 49))
    stages.set_property(mesh, "paintChannel", "g")
    assert notes(stage) == [
        "weight comes from primvars:skinSlide_elbow_L_weight, color3f[], channel g, "
        "the mean over the face corners at each point",
        "forceDensity comes from primvars:skinSlide:elbow_L:forceDensity, double[]",
    ]


@pytest.mark.parametrize("fold", [False, True])
def test_check_says_what_it_did_not_take(fold):
    stage, mesh = stages.patched_stage()
    for name in (f"{PLACE}_wieght", f"{PLACE}_weight".lower(), f"{PLACE}:MaxDistance"):
        stages.set_primvar(mesh, name.replace(f"{PLACE}_", f"skinSlide_{PATCH}_"), Types.FloatArray, "constant", [1.0])
    if fold:
        mesh.GetPrim().CreateAttribute("skinSlide:foldCase", Types.Bool).Set(True)
    told = [problem.message for problem in skinslide.check(stage).problems if problem.severity == "warning"]
    case = "is paint in another case, and has no effect unless skinSlide:foldCase is on"
    assert told == [
        f"primvars:{name} {case}" for name in (f"{PLACE}:MaxDistance", f"{PLACE}_weight".lower()) if not fold
    ] + [f"primvars:skinSlide_{PATCH}_wieght is not paint of an applied patch, and has no effect"]


def exported(path, amount: float) -> None:
    """A cache as a tool exports it, overwriting what was there; amount: of the animation."""
    stage, mesh = stages.patched_stage()
    for name in [each.GetName() for each in mesh.GetPrim().GetAuthoredPropertiesInNamespace("primvars")]:
        mesh.GetPrim().RemoveProperty(name)
    mesh.GetPrim().SetMetadata("apiSchemas", Sdf.TokenListOp())
    rest = np.array(mesh.GetPointsAttr().Get(FRAMES[0]))
    for frame in FRAMES:
        moved = np.array(mesh.GetPointsAttr().Get(frame))
        mesh.GetPointsAttr().Set(stages.vectors(rest + amount * (moved - rest)), frame)
    stage.Export(str(path))


def test_a_setup_outlives_an_export(tmp_path):
    """All paint is in the layer beside the cache, so a cache of the same topology can take the place of the first."""
    cache, setup = tmp_path / "cache.usdc", tmp_path / "x.skinslide"
    exported(cache, 1.0)
    skinslide.setup_to_file(cache, setup, MESH, PATCH, faces=np.arange(36), weight=np.linspace(0, 1, 49))
    skinslide.paint_to_file(cache, setup, MESH, PATCH, edges=[(16, 17)], value=4.0)
    text = setup.read_text()
    baked = {}
    for amount in (1.0, 0.5):
        exported(cache, amount)
        assert not skinslide.check(setup).failed
        skinslide.bake_to_file(setup, tmp_path / "slid.usda")
        slid = Usd.Stage.Open(str(setup))
        layer = Sdf.Layer.OpenAsAnonymous(str(tmp_path / "slid.usda"))
        baked[amount] = np.array(layer.GetAttributeAtPath(f"{MESH}.points").QueryTimeSample(FRAMES[-1]))
        live = UsdGeom.Mesh.Get(slid, MESH).GetPointsAttr().Get(FRAMES[-1])
        assert baked[amount].tobytes() == np.array(live).tobytes()
        original = Usd.Stage.Open(str(cache))
        assert not np.array_equal(baked[amount], UsdGeom.Mesh.Get(original, MESH).GetPointsAttr().Get(FRAMES[-1]))
        del slid, original
    assert setup.read_text() == text
    assert not np.array_equal(baked[1.0], baked[0.5])
