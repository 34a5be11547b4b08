"""Meshes that UsdSkel skins: what is slid is what USD's own bake of skinning gives, and a bake ends the skinning."""

import json

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

import rigs
import skinslide
import stages
from skinslide.command.cli import main
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH

POINTS = f"{MESH}.points"


def points_of(stage, frame, path=MESH):
    return np.array(UsdGeom.Mesh(stage.GetPrimAtPath(path)).GetPointsAttr().Get(frame))


def normals_of(stage, frame, name="normals"):
    return np.array(stage.GetPrimAtPath(MESH).GetAttribute(name).Get(frame))


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def skinned_prims(stage):
    """The prims that UsdSkel says it skins."""
    found = []
    for root in stage.Traverse():
        if root.IsA(UsdSkel.Root):
            cache, predicate = UsdSkel.Cache(), Usd.TraverseInstanceProxies()
            cache.Populate(UsdSkel.Root(root), predicate)
            for binding in cache.ComputeSkelBindings(UsdSkel.Root(root), predicate):
                found += [str(target.GetPrim().GetPath()) for target in binding.GetSkinningTargets()]
    return found


def dual_quaternion(_stage, mesh):
    UsdSkel.BindingAPI(mesh.GetPrim()).CreateSkinningMethodAttr(UsdSkel.Tokens.dualQuaternion)


def blend_shapes(_stage, mesh):
    rigs.blend_shape(mesh)


def blend_shapes_alone(stage, mesh):
    rigs.blend_shape(mesh)
    for name in ("jointIndices", "jointWeights"):
        mesh.GetPrim().RemoveProperty(f"primvars:skel:{name}")


def other_spaces(stage, mesh):
    """The mesh in centimetres off to the side, bound to a skeleton in metres, both below what moves."""
    UsdGeom.Xformable(stage.GetPrimAtPath("/World/char")).AddTranslateOp().Set((1e6, 0, 0))
    mesh.AddScaleOp().Set((0.01, 0.01, 0.01))
    placed = Gf.Matrix4d().SetScale(0.01)
    UsdSkel.BindingAPI(mesh.GetPrim()).CreateGeomBindTransformAttr(placed)
    points = np.array(mesh.GetPointsAttr().Get())
    mesh.GetPointsAttr().Set(stages.vectors(100 * points))


def moving_mesh(_stage, mesh):
    turn = mesh.AddRotateZOp()
    for frame in (1001.0, 1002.5):
        turn.Set(30 * (frame - 1001), frame)


def sparse_keys(stage, _mesh):
    """Skinned points turn between these samples, and do not go straight."""
    UsdSkel.Animation(stage.GetPrimAtPath(rigs.ANIMATION)).GetRotationsAttr().ClearAtTime(FRAMES[1])


def joints_of_its_own(_stage, mesh):
    binding = UsdSkel.BindingAPI(mesh.GetPrim())
    binding.CreateJointsAttr(rigs.JOINTS[::-1])
    indices = np.array(binding.GetJointIndicesPrimvar().Get())
    binding.GetJointIndicesPrimvar().Set(Vt.IntArray.FromNumpy(2 - indices))


def rigid(_stage, mesh):
    """One joint moves all of the mesh, as authored above it."""
    for name in ("jointIndices", "jointWeights"):
        mesh.GetPrim().RemoveProperty(f"primvars:skel:{name}")
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim().GetParent())
    binding.CreateJointIndicesPrimvar(True, 1).Set([2])
    binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])


def bound_above(_stage, mesh):
    mesh.GetPrim().RemoveProperty("skel:skeleton")
    UsdSkel.BindingAPI.Apply(mesh.GetPrim().GetParent()).CreateSkeletonRel().SetTargets([rigs.SKELETON])


RIGS = [
    lambda *_: None,
    dual_quaternion,
    blend_shapes,
    blend_shapes_alone,
    other_spaces,
    moving_mesh,
    sparse_keys,
    joints_of_its_own,
    bound_above,
]


@pytest.fixture(params=RIGS, ids=lambda each: each.__name__.strip("<>"))
def rig(request):
    stage, mesh = rigs.skinned_stage()
    request.param(stage, mesh)
    return stage, mesh


def only_mesh(stage):
    (mesh,), problems = read_meshes(stage)
    assert not problems
    return mesh


def test_points_are_those_that_usd_bakes(rig):
    stage, _ = rig
    mesh, usd = only_mesh(stage), rigs.skinned_by_usd(stage)
    samples = UsdGeom.Mesh(usd.GetPrimAtPath(MESH)).GetPointsAttr().GetTimeSamples()
    assert mesh.frame_times() == sorted({*FRAMES, *samples})
    for time in samples:
        # Through the world, as USD goes, a million units from the origin leave 1e-10 of a double.
        np.testing.assert_allclose(mesh.points_at(Usd.TimeCode(time)), points_of(usd, time), rtol=1e-6, atol=1e-6)
    assert np.abs(points_of(usd, FRAMES[-1]) - points_of(usd, FRAMES[0])).max() > 0.1


def test_rest_is_the_pose_in_which_it_was_bound(rig):
    """With joints where they were bound, and no shapes, that is what is skinned, but for rounding."""
    stage, _ = rig
    rest = only_mesh(stage).rest_points
    stage.RemovePrim(rigs.ANIMATION)
    UsdGeom.Xformable(stage.GetPrimAtPath(MESH)).GetPrim().RemoveProperty("xformOp:rotateZ")
    np.testing.assert_allclose(only_mesh(stage).points_at(Usd.TimeCode.Default()), rest, rtol=1e-6, atol=1e-6)


def test_a_rigid_mesh_moves_with_its_joint():
    stage, mesh = rigs.skinned_stage()
    rigid(stage, mesh)
    read = only_mesh(stage)
    lengths = [np.linalg.norm(np.diff(read.points_at(Usd.TimeCode(frame)), axis=0), axis=1) for frame in FRAMES]
    np.testing.assert_allclose(lengths[2], lengths[0], rtol=1e-5)


@pytest.mark.parametrize("interpolation", ["vertex", "faceVarying"])
@pytest.mark.parametrize("method", ["classicLinear", "dualQuaternion"])
def test_normals_are_those_that_usd_bakes(interpolation, method):
    stage, mesh = rigs.skinned_stage()
    UsdSkel.BindingAPI(mesh.GetPrim()).CreateSkinningMethodAttr(method)
    add_normals(mesh, interpolation)
    usd, (normals, *_) = rigs.skinned_by_usd(stage), only_mesh(stage).skinned_vectors()[1:]
    for frame in FRAMES:
        np.testing.assert_allclose(normals.skinned(Usd.TimeCode(frame)), normals_of(usd, frame), atol=1e-6)
    assert np.abs(normals_of(usd, FRAMES[-1]) - normals_of(usd, FRAMES[0])).max() > 0.1


def add_normals(mesh, interpolation):
    """Gives the sheet normals that are tilted at random, so that no rule can have made them again."""
    count = 49 if interpolation == "vertex" else 144
    vectors = np.random.default_rng(7).normal((0, 0, 1), 0.2, (count, 3))
    mesh.CreateNormalsAttr(stages.vectors(unit(vectors)))
    mesh.SetNormalsInterpolation(interpolation)


def add_tangents(mesh, interpolation, type_name=Sdf.ValueTypeNames.Vector3fArray):
    """From each point to that in the next row, as long as that is far; by corner those of its point."""
    points = np.array(mesh.GetPointsAttr().Get(), np.float64)
    ways = np.roll(points, -7, axis=0) - points
    values = ways if interpolation == "vertex" else ways[np.array(mesh.GetFaceVertexIndicesAttr().Get())]
    double = type_name == Sdf.ValueTypeNames.Vector3dArray
    value = Vt.Vec3dArray.FromNumpy(values) if double else stages.vectors(values)
    stages.set_primvar(mesh, "tangents", type_name, interpolation, value)


@pytest.mark.parametrize("interpolation", ["vertex", "faceVarying"])
@pytest.mark.parametrize("type_name", [Sdf.ValueTypeNames.Vector3fArray, Sdf.ValueTypeNames.Vector3dArray])
def test_tangents_turn_as_the_joints_do(interpolation, type_name, tmp_path):
    """Where one joint moves all points, tangents lead from point to point; where two do, they keep their lengths."""
    stage, mesh = rigs.skinned_stage()
    add_tangents(mesh, interpolation, type_name)
    stages.set_property(mesh, "envelope", 0.0)
    report = skinslide.bake_to_file(stage, tmp_path / "slid.usda")
    assert not [problem for problem in report.problems if "tangents" in problem.message]
    slid = Usd.Stage.Open(str(tmp_path / "slid.usda"))
    tangents = slid.GetPrimAtPath(MESH).GetAttribute("primvars:tangents")
    assert tangents.GetTypeName() == type_name and tangents.GetTimeSamples() == list(FRAMES)
    corners = np.arange(49) if interpolation == "vertex" else np.array(mesh.GetFaceVertexIndicesAttr().Get())
    rigid = np.isin(corners % 7, [0, 6])  # all of the root, or of the hand
    for frame in FRAMES:
        points, found = points_of(slid, frame), np.array(tangents.Get(frame))
        ways = (np.roll(points, -7, axis=0) - points)[corners]
        np.testing.assert_allclose(found[rigid], ways[rigid], atol=1e-6)
        rest = np.linalg.norm(np.array(mesh.GetPrim().GetAttribute("primvars:tangents").Get()), axis=1)
        np.testing.assert_allclose(np.linalg.norm(found, axis=1), rest, rtol=1e-5)
    assert np.abs(found - np.array(tangents.Get(FRAMES[0]))).max() > 0.1


def test_a_cache_has_tangents_too(tmp_path):
    stage, mesh = rigs.skinned_stage()
    add_tangents(mesh, "vertex")
    character = stages.save(stage, tmp_path / "character.usda")
    report = skinslide.cache(character, tmp_path / "cache.usdc")
    assert report.meshes[0].normals == ["primvars:tangents"]
    stages.set_property(mesh, "envelope", 0.0)
    skinslide.bake_to_file(stage, tmp_path / "slid.usda")
    layers = [Sdf.Layer.FindOrOpen(str(tmp_path / name)) for name in ("cache.usdc", "slid.usda")]
    path = f"{MESH}.primvars:tangents"
    for frame in FRAMES:
        cached, slid = (np.array(layer.QueryTimeSample(path, frame)) for layer in layers)
        np.testing.assert_array_equal(cached, slid)


def test_rates_of_a_skinned_mesh_are_named(tmp_path):
    stage, mesh = rigs.skinned_stage()
    mesh.CreateVelocitiesAttr(stages.vectors(np.zeros((49, 3))))
    said = [problem.message for problem in skinslide.bake_to_file(stage, tmp_path / "slid.usda").problems]
    assert any(message.startswith("velocities cannot be recomputed, so the bake blocks them: ") for message in said)


# ---- A bake above the character ----


@pytest.fixture
def files(tmp_path, rig):
    """The character of a rig with normals, in a file."""
    stage, mesh = rig
    add_normals(mesh, "vertex")
    return stages.save(stage, tmp_path / "character.usda"), tmp_path


def above(*layers):
    root = Sdf.Layer.CreateAnonymous(".usda")
    root.subLayerPaths = list(map(str, layers))
    root.timeCodesPerSecond = 24
    return Usd.Stage.Open(root)


def test_composed_points_are_the_slid_ones_once(files):
    character, folder = files
    skinslide.bake_to_file(character, folder / "slid.usda")
    slid, composed = Usd.Stage.Open(str(folder / "slid.usda")), above(folder / "slid.usda", character)
    assert skinned_prims(Usd.Stage.Open(str(character))) == [MESH] and skinned_prims(composed) == []
    usd = rigs.skinned_by_usd(composed)
    for frame in FRAMES:
        np.testing.assert_array_equal(points_of(usd, frame), points_of(slid, frame))
        np.testing.assert_array_equal(normals_of(usd, frame), normals_of(slid, frame))


def test_a_neighbour_is_skinned_as_before(tmp_path):
    stage, mesh = stages.patched_stage()
    other = stages.add_mesh(stage, stages.grid(), "/World/char/geo/other_GEO")
    rigs.skeleton(stage)
    rigs.bind(mesh), rigs.bind(other)
    character = stages.save(stage, tmp_path / "character.usda")
    skinslide.bake_to_file(character, tmp_path / "slid.usda")
    composed = above(tmp_path / "slid.usda", character)
    assert skinned_prims(composed) == ["/World/char/geo/other_GEO"]


def test_a_bake_is_that_of_the_cache(files):
    character, folder = files
    report = skinslide.cache(character, folder / "cache.usdc")
    assert [mesh.skeleton for mesh in report.meshes] == [rigs.SKELETON] and not report.problems
    (folder / "cached.usda").write_text(
        "#usda 1.0\n(subLayers = [@cache.usdc@, @character.usda@]; timeCodesPerSecond = 24)\n"
    )
    skinslide.bake_to_file(character, folder / "one.usda")
    skinslide.bake_to_file(folder / "cached.usda", folder / "other.usda")
    one, other = (Usd.Stage.Open(str(folder / name)) for name in ("one.usda", "other.usda"))
    times = UsdGeom.Mesh(one.GetPrimAtPath(MESH)).GetPointsAttr().GetTimeSamples()
    assert times == UsdGeom.Mesh(other.GetPrimAtPath(MESH)).GetPointsAttr().GetTimeSamples()
    for time in times:
        assert points_of(one, time).tobytes() == points_of(other, time).tobytes()
        assert normals_of(one, time).tobytes() == normals_of(other, time).tobytes()


def test_a_cache_says_what_usd_bakes(files):
    character, folder = files
    skinslide.cache(character, folder / "cache.usdc")
    composed, usd = above(folder / "cache.usdc", character), rigs.skinned_by_usd(Usd.Stage.Open(str(character)))
    assert skinned_prims(composed) == [] and not skinslide.check(composed).failed
    for frame in FRAMES:
        np.testing.assert_allclose(points_of(composed, frame), points_of(usd, frame), rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(normals_of(composed, frame), unit(normals_of(usd, frame)), atol=1e-6)


@pytest.mark.parametrize("count", [1, 3])
def test_a_cache_warns_of_points_that_are_not_finite(count, tmp_path, capfd):
    """As they are authored at the last two frames: they are written so, and a bake fails on them."""
    stage, mesh = rigs.skinned_stage()
    points = np.array(mesh.GetPointsAttr().Get())
    mesh.GetPointsAttr().Set(stages.vectors(points), FRAMES[0])
    points[8 : 8 + count] = np.nan
    for frame in FRAMES[1:]:
        mesh.GetPointsAttr().Set(stages.vectors(points), frame)
    report = skinslide.cache(stages.save(stage, tmp_path / "character.usda"), tmp_path / "cache.usda")
    twice, warning = report.problems
    assert (warning.severity, warning.prim, warning.frame) == ("warning", MESH, FRAMES[1])
    more = ", and 2 more are not" if count == 3 else ""
    same = " (and something like it at 1 more frame)"
    assert warning.message == f"points: vertex 8 is not finite: (nan, nan, nan){more}{same}"
    composed = above(tmp_path / "cache.usda", tmp_path / "character.usda")
    (error,) = [each for each in skinslide.check(composed).problems if each.severity == "error"]
    assert str(error) == f"error: {MESH}: frame 1002: points: vertex 8 is not finite: (nan, nan, nan){same}"
    assert main(["cache", str(tmp_path / "character.usda"), "-o", str(tmp_path / "cache.usda"), "--quiet"]) == 0
    assert capfd.readouterr().err == f"{twice}\n{warning}\n"


def test_a_cache_has_rest_in_the_pose_in_which_it_was_bound(tmp_path):
    stage, mesh = rigs.skinned_stage()
    UsdSkel.BindingAPI(mesh.GetPrim()).CreateGeomBindTransformAttr(Gf.Matrix4d().SetTranslate((0.5, 0, 0)))
    bound = np.array(mesh.GetPointsAttr().Get()) + np.float32((0.5, 0, 0))
    skinslide.cache(stages.save(stage, tmp_path / "character.usda"), tmp_path / "cache.usda")
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "cache.usda"))
    np.testing.assert_allclose(np.array(layer.GetAttributeAtPath(POINTS).default), bound, atol=1e-6)


def test_a_live_layer_slides_the_cache(files):
    character, folder = files
    live = folder / "x.skinslide"
    live.write_text("#usda 1.0\n(subLayers = [@cache.usdc@, @character.usda@]; timeCodesPerSecond = 24)\n")
    skinslide.cache(character, folder / "cache.usdc")
    skinslide.bake_to_file(character, folder / "slid.usda")
    opened, slid = Usd.Stage.Open(str(live)), Usd.Stage.Open(str(folder / "slid.usda"))
    for frame in FRAMES:
        assert points_of(opened, frame).tobytes() == points_of(slid, frame).tobytes()


def test_a_bake_into_the_stage_of_the_character_is_done_again_to_the_same_values(rig):
    stage, _ = rig
    skinslide.bake(stage)
    first = [points_of(stage, frame) for frame in FRAMES]
    assert skinned_prims(stage) == []
    skinslide.bake(stage)
    np.testing.assert_array_equal(first, [points_of(stage, frame) for frame in FRAMES])


# ---- What still skins, as USD has it ----

AGAIN = "points have samples, but UsdSkel skins them again; remove the skinning where they are baked"


def test_samples_that_are_skinned_again_are_warned_of_everywhere(tmp_path, capsys):
    stage, mesh = rigs.skinned_stage()
    mesh.GetPointsAttr().Set(stages.vectors(stages.grid().moved(1002)), 1002)
    character = stages.save(stage, tmp_path / "character.usda")
    assert AGAIN in skinslide.check(character).text()
    assert AGAIN in skinslide.bake_to_file(character, tmp_path / "slid.usda").text()
    assert main(["bake", str(character), "-o", str(tmp_path / "again.usda"), "--json", "--quiet"]) == 0
    assert [each["message"] for each in json.loads(capsys.readouterr().out)["problems"]] == [AGAIN]


def test_what_usd_has_baked_is_not_skinned_again():
    stage, _ = rigs.skinned_stage()
    assert not skinslide.check(rigs.skinned_by_usd(stage)).problems


def test_check_names_the_skeleton():
    stage, _ = rigs.skinned_stage()
    report = skinslide.check(stage)
    assert report.meshes[0].skeleton == rigs.SKELETON and f"skinned by {rigs.SKELETON}" in report.text()


def test_nothing_to_cache():
    stage, _ = stages.patched_stage()
    with pytest.raises(skinslide.StageProblems, match="UsdSkel skins no mesh on the stage"):
        skinslide.cache(stage, "never.usda")
