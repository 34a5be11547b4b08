"""Bakes into a stage."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

import stages
from shots import MESH, OFFSET, REST, baked_mesh, direct, pose
from skinslide import FrameProblem, StageError, UsageError, bake, bake_to_file
from stages import vectors


def test_bake_authors_into_the_edit_target(shot, out):
    shot.save()
    stage = Usd.Stage.Open(str(shot.path))
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.timeCodesPerSecond = 50  # samples lie at twice the stage's times
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    stage.SetEditTarget(stage.GetEditTargetForLocalLayer(layer))
    bake(stage)
    bake_to_file(shot.path, out)
    assert layer.ListTimeSamplesForPath(f"{MESH}.points")[0] == 2 * (OFFSET + 1)
    _stage, written = baked_mesh(out)
    attribute = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    assert attribute.GetTimeSamples() == written.GetPointsAttr().GetTimeSamples()
    for sample in attribute.GetTimeSamples():
        values = [np.array(source.Get(sample)).tobytes() for source in (attribute, written.GetPointsAttr())]
        assert values[0] == values[1]
    assert not stage.GetRootLayer().dirty


def test_bake_maps_times_through_the_edit_target(shot):
    """Authored into the cache, below the payload, samples lie at the cache's own times."""
    shot.save()
    stage = Usd.Stage.Open(str(shot.path))
    cache = Sdf.Layer.FindOrOpen(str(shot.cache_path))
    node = stage.GetPrimAtPath("/World/char").GetPrimIndex().rootNode.children[0]
    stage.SetEditTarget(Usd.EditTarget(cache, node))
    bake(stage)
    assert cache.ListTimeSamplesForPath("/char/geo/body_GEO.points") == [1, 2, 3, 4, 5]
    slid = np.array(cache.QueryTimeSample("/char/geo/body_GEO.points", 2))
    assert slid.tobytes() == direct(pose(2)).tobytes()


def test_a_stage_may_be_open_before_the_import(shot):
    """The schema registry is then without SkinSlideAPI."""
    code = """
        import sys
        from pxr import Usd
        stage = Usd.Stage.Open(sys.argv[1])
        assert not Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("SkinSlideAPI")
        import skinslide
        assert skinslide.bake(stage).frame_count == 5
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code), str(shot.save().path)], check=True)


def test_a_failed_bake_leaves_the_stage(shot):
    bad = pose(5)
    bad[0, 0] = np.inf
    shot.mesh.GetPointsAttr().Set(vectors(bad), 5)
    stage = Usd.Stage.Open(str(shot.save().path))
    before = stage.GetRootLayer().ExportToString()
    with pytest.raises(FrameProblem):
        bake(stage)
    assert stage.GetRootLayer().ExportToString() == before


ANOTHER = "choose another by stage.SetEditTarget, such as stage.GetSessionLayer()"


def refused(stage: Usd.Stage) -> str:
    """What is said of the edit target of a stage; the target stays as it is."""
    before = stage.ExportToString()
    with pytest.raises(UsageError) as error:
        bake(stage)
    assert stage.ExportToString() == before
    return str(error.value)


def sublayered(stage: Usd.Stage) -> Sdf.Layer:
    """Makes a new layer below the session layer the edit target."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    stage.SetEditTarget(layer)
    return layer


def test_a_target_that_cannot_be_edited_says_what_to_do(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    stage.GetRootLayer().SetPermissionToEdit(False)
    assert refused(stage) == f"the edit target {shot.path} is not editable; {ANOTHER}"
    stage = Usd.Stage.Open(str(shot.path))
    layer = sublayered(stage)
    stage.MuteLayer(layer.identifier)
    assert (
        refused(stage) == f"the edit target {layer.identifier} is muted; unmute it by stage.UnmuteLayer, or {ANOTHER}"
    )
    stage.UnmuteLayer(layer.identifier)
    assert bake(stage).frame_count == 5


def test_a_target_that_has_left_the_stage(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    layer = sublayered(stage)
    stage.GetSessionLayer().subLayerPaths.clear()
    assert refused(stage) == f"the edit target {layer.identifier} is not a layer of the stage; {ANOTHER}"


def test_a_target_that_nobody_holds(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    sublayered(stage)
    stage.GetSessionLayer().subLayerPaths.clear()
    assert refused(stage) == f"the edit target is gone; {ANOTHER}"


def test_a_target_that_is_computed(shot, tmp_path):
    path = tmp_path / "x.skinslide"
    path.write_text(f"#usda 1.0\n(\n    subLayers = [@{shot.save().path}@]\n)\n")
    stage = Usd.Stage.Open(str(path))
    assert refused(stage).startswith(f"the edit target {path} is computed; give its path to functions that write files")


def test_a_target_in_a_variant_that_is_not_selected(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    variants = stage.GetPrimAtPath("/World/char").GetVariantSets().AddVariantSet("lod")
    variants.AddVariant("high")
    variants.AddVariant("low")
    variants.SetVariantSelection("high")
    high = variants.GetVariantEditTarget()
    stage.SetEditTarget(high)
    assert not bake(stage).problems
    with Usd.EditContext(stage, stage.GetRootLayer()):
        variants.SetVariantSelection("low")
    fault = f"the variant high of lod in {shot.path}, but low is selected on /World/char"
    assert refused(stage) == f"the edit target is {fault}; select high, or {ANOTHER}"


def test_a_target_that_covers_only_some_of_the_meshes(shot):
    other = stages.add_mesh(shot.shot, stages.grid(), "/World/other_GEO")
    stages.add_patch(other, stages.annulus())
    stage = Usd.Stage.Open(str(shot.save().path))
    cache = Sdf.Layer.FindOrOpen(str(shot.cache_path))
    node = stage.GetPrimAtPath("/World/char").GetPrimIndex().rootNode.children[0]
    stage.SetEditTarget(Usd.EditTarget(cache, node))
    before = cache.ExportToString()
    with pytest.raises(UsageError, match="cannot hold opinions on /World/other_GEO"):
        bake(stage)
    assert cache.ExportToString() == before
    assert bake(stage, prims=MESH).frame_count == 5


def test_points_that_stay_hidden_are_named(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    stage.SetEditTarget(stage.GetSessionLayer())
    points.Set(vectors(pose(1)), OFFSET + 1)
    stage.SetEditTarget(stage.GetRootLayer())
    report = bake(stage)
    assert any("hidden" in problem.message for problem in report.problems)


def test_points_that_stay_hidden_in_one_layer_are_named():
    stage, mesh = stages.patched_stage()
    variants = mesh.GetPrim().GetVariantSets().AddVariantSet("lod")
    variants.AddVariant("high")
    variants.SetVariantSelection("high")
    stage.SetEditTarget(variants.GetVariantEditTarget())
    (problem,) = bake(stage).problems
    hidden = f"{stage.GetRootLayer().identifier}<{stages.MESH}>"
    assert problem.message == f"the slid points are hidden by those in {hidden}, which is stronger"


def test_prims_choose_meshes(shot, out):
    other = MESH.replace("body", "other")
    Sdf.CopySpec(shot.cache.GetRootLayer(), "/char/geo/body_GEO", shot.cache.GetRootLayer(), "/char/geo/other_GEO")
    Sdf.CopySpec(shot.shot.GetRootLayer(), MESH, shot.shot.GetRootLayer(), other)
    report = bake_to_file(shot.save().path, out, prims=[other])
    assert [mesh.path for mesh in report.meshes] == [other]
    report = bake_to_file(shot.path, out)
    assert [mesh.path for mesh in report.meshes] == [MESH, other]
    assert report.frame_count == 10


def test_a_file_that_is_no_stage(tmp_path, out):
    (tmp_path / "bad.usda").write_text("nothing")
    with pytest.raises(StageError):
        bake_to_file(tmp_path / "bad.usda", out)
    assert not out.exists()


def test_points_moved_by_clips(shot, tmp_path, out):
    """Value clips are USD's business: a bake reads what composes."""
    shot.save()
    clip = Sdf.Layer.CreateNew(str(tmp_path / "clip.usda"))
    over = Sdf.CreatePrimInLayer(clip, "/char/geo/body_GEO")
    spec = Sdf.AttributeSpec(over, "points", Sdf.ValueTypeNames.Point3fArray)
    for frame in (1, 2):
        clip.SetTimeSample(spec.path, frame, vectors(pose(frame + 4)))
    clip.Save()
    shot.mesh.GetPrim().RemoveProperty("points")
    pref = UsdGeom.PrimvarsAPI(shot.mesh).CreatePrimvar("pref", Sdf.ValueTypeNames.Point3fArray, "vertex")
    pref.Set(vectors(REST))
    model = Usd.ClipsAPI(shot.cache.GetDefaultPrim())
    model.SetClipAssetPaths([Sdf.AssetPath(str(tmp_path / "clip.usda"))])
    model.SetClipPrimPath("/char")
    model.SetClipActive([Gf.Vec2d(1, 0)])
    model.SetClipTimes([Gf.Vec2d(1, 1), Gf.Vec2d(2, 2)])
    manifest = Usd.ClipsAPI.GenerateClipManifestFromLayers([clip], "/char")
    manifest.Export(str(tmp_path / "manifest.usda"))
    model.SetClipManifestAssetPath(Sdf.AssetPath(str(tmp_path / "manifest.usda")))
    bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == [1001, 1002]
    assert np.array(mesh.GetPointsAttr().Get(1002)).tobytes() == direct(pose(6)).tobytes()
