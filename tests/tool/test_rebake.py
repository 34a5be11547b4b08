"""A bake over a bake: never slides twice, and in a session takes the place of the one before."""

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom

import skinslide
import stages
from skinslide import FrameProblem, StageProblems, bake, bake_to_file
from stages import FRAMES, MESH, PATCH

OTHER = "/World/prop/rope_GEO"


def values(stage: Usd.Stage, name: str = "points", path: str = MESH) -> dict[float, bytes]:
    attribute = stage.GetPrimAtPath(path).GetAttribute(name)
    return {time: np.array(attribute.Get(time)).tobytes() for time in attribute.GetTimeSamples()}


def cached_stage() -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A stage with velocities and normals beside its points, all in its root layer."""
    stage, mesh = stages.patched_stage()
    zeros = stages.vectors(np.zeros((49, 3)))
    for frame in FRAMES:
        mesh.CreateVelocitiesAttr().Set(zeros, frame)
        mesh.CreateNormalsAttr().Set(stages.vectors(np.tile([0, 0, 1], (49, 1))), frame)
    mesh.SetNormalsInterpolation("vertex")
    return stage, mesh


def edited(stage: Usd.Stage, where: str) -> Usd.Stage:
    """The stage with its edit target on the layer of the cache, on the session's, or on one with another clock."""
    if where == "session":
        stage.SetEditTarget(stage.GetSessionLayer())
    elif where == "sublayer":
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.timeCodesPerSecond = 48
        stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
        stage.SetEditTarget(stage.GetEditTargetForLocalLayer(layer))
    return stage


PLACES = ["root", "session", "sublayer"]


@pytest.mark.parametrize("where", PLACES)
def test_a_second_bake_gives_the_same(where):
    stage = edited(cached_stage()[0], where)
    bake(stage)
    once = {name: values(stage, name) for name in ("points", "velocities", "normals", "extent")}
    layer = stage.GetEditTarget().GetLayer().ExportToString()
    report = bake(stage)
    assert {name: values(stage, name) for name in once} == once
    assert stage.GetEditTarget().GetLayer().ExportToString() == layer
    assert not report.problems


@pytest.mark.parametrize("where", PLACES)
def test_paint_and_bake_again(where):
    stage = edited(cached_stage()[0], where)
    bake(stage)
    target = stage.GetEditTarget()
    stage.SetEditTarget(stage.GetRootLayer())
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH))
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", Sdf.ValueTypeNames.Float, "constant", 0.5)
    stage.SetEditTarget(target)
    bake(stage)
    fresh, mesh = cached_stage()
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", Sdf.ValueTypeNames.Float, "constant", 0.5)
    bake(fresh)
    for name in ("points", "velocities", "normals"):
        assert values(stage, name) == values(fresh, name)


@pytest.mark.parametrize("where", PLACES)
def test_samples_of_the_earlier_bake_go(where):
    stage = edited(cached_stage()[0], where)
    bake(stage, frames=[1001.5, 1003])
    bake(stage, frames=[1002])
    expected = stage.GetEditTarget().MapToSpecPath(Sdf.Path(MESH)).AppendProperty("points")
    layer = stage.GetEditTarget().GetLayer()
    assert len(layer.ListTimeSamplesForPath(expected)) == 1


@pytest.mark.parametrize("where", PLACES)
def test_a_failed_bake_brings_the_earlier_one_back(where):
    stage = edited(cached_stage()[0], where)
    bake(stage)
    before = [layer.ExportToString() for layer in stage.GetLayerStack()]

    def stop(done: int, _total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bake(stage, progress=stop)
    assert [layer.ExportToString() for layer in stage.GetLayerStack()] == before


@pytest.mark.parametrize("where", PLACES)
@pytest.mark.parametrize("baked", [False, True])
def test_a_bake_that_fails_while_it_is_authored_leaves_nothing(where, baked, monkeypatch):
    stage = edited(cached_stage()[0], where)
    if baked:
        bake(stage)
    before = [layer.ExportToString() for layer in stage.GetLayerStack()]
    authored = Usd.Attribute.Set

    def fail(self, *arguments):
        if self.GetName() == "velocities":
            raise MemoryError
        return authored(self, *arguments)

    monkeypatch.setattr(Usd.Attribute, "Set", fail)
    with pytest.raises(MemoryError):
        bake(stage)
    assert [layer.ExportToString() for layer in stage.GetLayerStack()] == before


def test_the_cache_in_the_edit_target_is_kept_beside_the_bake():
    stage, mesh = cached_stage()
    cached = values(stage)
    bake(stage)
    assert values(stage) != cached
    assert values(stage, "skinSlide:cached:points") == cached
    assert np.array_equal(mesh.GetPointsAttr().Get(), stages.grid().points), "the rest pose stays"
    assert not skinslide.check(stage, [OTHER]).meshes
    assert not any("not applied" in str(problem) for problem in skinslide.check(stage).problems)


def test_the_bake_of_other_prims_stays():
    stage, _mesh = stages.patched_stage()
    other = stages.add_mesh(stage, stages.grid(), OTHER)
    stages.add_patch(other, stages.annulus(), "rope")
    edited(stage, "session")
    bake(stage)
    both = values(stage), values(stage, path=OTHER)
    bake(stage, prims=[MESH], frames=[1002])
    assert list(values(stage)) == [1002.0]
    assert values(stage, path=OTHER) == both[1]


def test_a_patch_that_is_gone_is_slid_no_more():
    stage, _mesh = stages.patched_stage()
    other = stages.add_mesh(stage, stages.grid(), OTHER)
    stages.add_patch(other, stages.annulus(), "rope")
    cached = values(stage, path=OTHER)
    edited(stage, "session")
    bake(stage)
    stage.SetEditTarget(stage.GetRootLayer())
    other.GetPrim().ClearMetadata("apiSchemas")
    stage.SetEditTarget(stage.GetSessionLayer())
    bake(stage)
    assert values(stage, path=OTHER) == cached
    assert not stage.GetSessionLayer().GetAttributeAtPath(f"{OTHER}.points")


def test_a_bad_frame_after_a_bake():
    stage, mesh = stages.patched_stage()
    edited(stage, "session")
    bake(stage)
    before = stage.GetSessionLayer().ExportToString()
    stage.SetEditTarget(stage.GetRootLayer())
    mesh.GetPointsAttr().Set(stages.vectors(np.full((49, 3), np.nan)), FRAMES[2])
    stage.SetEditTarget(stage.GetSessionLayer())
    with pytest.raises(FrameProblem, match="1003"):
        bake(stage)
    assert stage.GetSessionLayer().ExportToString() == before


@pytest.fixture
def baked_shot(tmp_path):
    """A stage that sublayers its own bake."""
    stage, _mesh = cached_stage()
    cache = stages.save(stage, tmp_path / "cache.usda")
    bake_to_file(cache, tmp_path / "slid.usdc")
    (tmp_path / "shot.usda").write_text("#usda 1.0\n(\n    subLayers = [@./slid.usdc@, @./cache.usda@]\n)\n")
    return tmp_path / "shot.usda"


def test_a_bake_in_another_layer_is_an_error_that_names_it(baked_shot, tmp_path):
    with pytest.raises(StageProblems, match=f"{MESH}: points are slid already, by the bake in {tmp_path}/slid.usdc"):
        bake_to_file(baked_shot, tmp_path / "again.usda")
    assert not (tmp_path / "again.usda").exists()
    assert skinslide.check(baked_shot).failed
    with pytest.raises(StageProblems, match="slid already"):
        bake(Usd.Stage.Open(str(baked_shot)))


def test_a_flattened_bake_is_one_too(baked_shot, tmp_path):
    Usd.Stage.Open(str(baked_shot)).Export(str(tmp_path / "flat.usdc"))
    with pytest.raises(StageProblems, match="slid already"):
        bake_to_file(tmp_path / "flat.usdc", tmp_path / "again.usda")


def test_a_cache_above_a_bake_is_slid(baked_shot, tmp_path):
    """A bake that is hidden does not make anything slide twice."""
    text = "#usda 1.0\n(\n    subLayers = [@./cache.usda@, @./slid.usdc@]\n)\n"
    (tmp_path / "hidden.usda").write_text(text)
    bake_to_file(tmp_path / "hidden.usda", tmp_path / "again.usdc")
    slid = [Usd.Stage.Open(str(tmp_path / name)) for name in ("slid.usdc", "again.usdc")]
    assert values(slid[0]) == values(slid[1])


def test_a_bake_into_the_layer_of_the_earlier_one(baked_shot, tmp_path):
    stage = Usd.Stage.Open(str(baked_shot))
    slid = Sdf.Layer.FindOrOpen(str(tmp_path / "slid.usdc"))
    stage.SetEditTarget(stage.GetEditTargetForLocalLayer(slid))
    before = values(stage)
    bake(stage)
    assert values(stage) == before


# ---- Variants ----

LODS = {"high": 1.0, "low": 0.5}


def lods() -> tuple[Usd.Stage, Usd.VariantSet]:
    """A mesh whose points are in one variant or the other, all in the root layer; the last is selected."""
    stage, mesh = stages.patched_stage()
    shape, prim = stages.grid(), mesh.GetPrim()
    prim.RemoveProperty("points")
    variants = stage.GetPrimAtPath("/World/char").GetVariantSets().AddVariantSet("lod")
    for name, size in LODS.items():
        variants.AddVariant(name)
        variants.SetVariantSelection(name)
        with variants.GetVariantEditContext():
            mesh.CreatePointsAttr(stages.vectors(shape.points))
            for frame in FRAMES:
                mesh.GetPointsAttr().Set(stages.vectors(size * shape.moved(frame)), frame)
    return stage, variants


def selected(stage: Usd.Stage, variants: Usd.VariantSet, name: str) -> None:
    """Selects a variant, and edits in it."""
    with Usd.EditContext(stage, stage.GetRootLayer()):
        variants.SetVariantSelection(name)
        target = variants.GetVariantEditTarget()
    stage.SetEditTarget(target)


def test_a_bake_into_one_variant_leaves_the_others():
    alone = {}
    for name in LODS:
        stage, variants = lods()
        selected(stage, variants, name)
        bake(stage)
        alone[name] = values(stage)
    stage, variants = lods()
    for name in (*LODS, "high"):
        selected(stage, variants, name)
        assert not bake(stage, prims=["/World"] if name == "low" else None).problems
    for name in LODS:
        selected(stage, variants, name)
        assert values(stage) == alone[name]
    assert alone["high"] != alone["low"]


def test_a_bake_beside_variants_leaves_what_is_in_them():
    stage, variants = lods()
    selected(stage, variants, "low")
    bake(stage)
    low = values(stage)
    stage.SetEditTarget(stage.GetRootLayer())
    variants.SetVariantSelection("high")
    bake(stage)
    stage.GetPrimAtPath(MESH).RemoveProperty("points")
    variants.SetVariantSelection("low")
    assert values(stage) == low


def test_a_bake_below_a_reference_leaves_what_is_beside_it(tmp_path):
    stage, _mesh = cached_stage()
    other = stages.add_mesh(stage, stages.grid(), OTHER)
    stages.add_patch(other, stages.annulus(), "rope")
    stages.save(stage, tmp_path / "cache.usda")
    cache = Usd.Stage.Open(str(tmp_path / "cache.usda"))
    bake(cache)
    rope = values(cache, path=OTHER)
    shot = Usd.Stage.CreateInMemory()
    prim = shot.DefinePrim("/shot/char")
    prim.GetReferences().AddReference(cache.GetRootLayer().identifier, "/World/char")
    shot.SetEditTarget(Usd.EditTarget(cache.GetRootLayer(), prim.GetPrimIndex().rootNode.children[0]))
    bake(shot, prims=["/shot"], frames=[1002])
    assert list(values(shot, path="/shot/char/geo/skin_GEO")) == [1002]
    assert values(cache, path=OTHER) == rope
