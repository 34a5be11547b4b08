"""Rigs that UsdSkel cannot skin by: one named error, from check, bake and cache alike, and nothing is written."""

import math
import re
from collections.abc import Callable

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

import rigs
import skinslide
import stages
from rigs import ANIMATION, SKELETON
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH

SHAPE = f"{MESH}/bulge"
FLAT = Gf.Matrix4d().SetScale(Gf.Vec3d(1, 0, 1))
Rig = Callable[[Usd.Stage, UsdGeom.Mesh], object]


def skeleton_of(stage: Usd.Stage) -> UsdSkel.Skeleton:
    return UsdSkel.Skeleton(stage.GetPrimAtPath(SKELETON))


def binding_of(mesh: UsdGeom.Mesh) -> UsdSkel.BindingAPI:
    return UsdSkel.BindingAPI(mesh.GetPrim())


def influences(name: str, change: Callable[[list], object]) -> Rig:
    def edit(_stage, mesh):
        attribute = mesh.GetPrim().GetAttribute(f"primvars:skel:{name}")
        values = list(attribute.Get())
        change(values)
        attribute.Set(values)

    return edit


def shapes(change: Callable[[UsdSkel.BlendShape], object]) -> Rig:
    return lambda _stage, mesh: change(rigs.blend_shape(mesh))


def two_skeletons(_stage, mesh):
    binding_of(mesh).GetSkeletonRel().AddTarget(ANIMATION)


def another_animation_of(joints: list[str]) -> Rig:
    def edit(stage, _mesh):
        animation = UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION))
        animation.GetJointsAttr().Set(joints)

    return edit


def one_rotation_less(stage, _mesh):
    UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION)).GetRotationsAttr().Set([Gf.Quatf(1)], FRAMES[1])


def without_api(_stage, mesh):
    mesh.GetPrim().RemoveAPI(UsdSkel.BindingAPI)


BAD = {
    "no bind transforms": (
        lambda stage, _: skeleton_of(stage).GetBindTransformsAttr().Clear(),
        f"the skeleton {SKELETON} has no bindTransforms, of which there must be one for each of its joints",
    ),
    "fewer bind transforms": (
        lambda stage, _: skeleton_of(stage).GetBindTransformsAttr().Set([Gf.Matrix4d(1)] * 2),
        f"the skeleton {SKELETON} has no bindTransforms, of which there must be one for each of its joints",
    ),
    "a joint before its parent": (
        lambda stage, _: skeleton_of(stage).GetJointsAttr().Set(rigs.JOINTS[::-1]),
        f"UsdSkel cannot use the joints of {SKELETON}; is each there once, and after its parent?",
    ),
    "joints that it has not": (
        lambda _, mesh: binding_of(mesh).CreateJointsAttr(["root", "root/leg", "root/tail"]),
        f"skel:joints names root/leg and 1 more, which the skeleton {SKELETON} does not have",
    ),
    "a joint beyond the last": (
        influences("jointIndices", lambda values: values.__setitem__(5, 3)),
        "primvars:skel:jointIndices[5] is 3, but there are 3 joints",
    ),
    "a joint before the first": (
        influences("jointIndices", lambda values: values.__setitem__(5, -1)),
        "primvars:skel:jointIndices[5] is -1, but there are 3 joints",
    ),
    "weights that do not sum to 1": (
        influences("jointWeights", lambda values: values.__setitem__(slice(24, 26), [0.5, 0.25])),
        "primvars:skel:jointWeights of point 12 add up to 0.75, not to 1",
    ),
    "a weight that is no number": (
        influences("jointWeights", lambda values: values.__setitem__(0, float("nan"))),
        "primvars:skel:jointWeights of point 0 add up to nan, not to 1",
    ),
    "fewer influences than points": (
        lambda _, mesh: [
            influences(name, lambda values: values.__delitem__(slice(90, None)))(_, mesh)
            for name in ("jointIndices", "jointWeights")
        ],
        "primvars:skel:jointIndices has 90 values, where 98 are needed",
    ),
    "fewer weights than joints": (
        influences("jointWeights", lambda values: values.__delitem__(slice(4, None))),
        "primvars:skel:jointWeights has 4 values, where 98 are needed",
    ),
    "more joints than weights": (
        influences("jointIndices", lambda values: values.extend([0, 0])),
        "primvars:skel:jointIndices has 100 values, where 98 are needed",
    ),
    "another number of weights": (
        lambda _, mesh: binding_of(mesh).GetJointWeightsPrimvar().SetElementSize(1),
        "UsdSkel cannot use its joints or blend shapes; is SkelBindingAPI applied to it, and are there as many joint "
        "indices as weights?",
    ),
    "no schema": (
        without_api,
        "UsdSkel cannot use its joints or blend shapes; is SkelBindingAPI applied to it, and are there as many joint "
        "indices as weights?",
    ),
    "blend shapes: fewer offsets": (
        shapes(lambda shape: shape.GetOffsetsAttr().Set([(0, 0, 1)] * 3)),
        f"offsets of {SHAPE} has 3 values for 4 point indices",
    ),
    "blend shapes: offsets of other points": (
        shapes(lambda shape: shape.GetPointIndicesAttr().Clear()),
        f"offsets of {SHAPE} has 4 values for 49 points of the mesh",
    ),
    "blend shapes: an in-between of another length": (
        shapes(lambda shape: shape.GetInbetween("half").SetOffsets([(0, 0, 1)] * 5)),
        f"inbetweens:half of {SHAPE} has 5 values for 4 point indices",
    ),
    "blend shapes: normals of another length": (
        shapes(lambda shape: shape.CreateNormalOffsetsAttr([(0, 0, 1)])),
        f"normalOffsets of {SHAPE} has 1 values for 4 point indices",
    ),
    "blend shapes: a point beyond the last": (
        shapes(lambda shape: shape.GetPointIndicesAttr().Set([1, 2, 49, 3])),
        f"pointIndices[2] of {SHAPE} is 49, but the mesh has 49 points",
    ),
    "blend shapes: more names than targets": (
        lambda _, mesh: rigs.blend_shape(mesh) and binding_of(mesh).GetBlendShapesAttr().Set(["bulge", "smile"]),
        "skel:blendShapes has 2 names, but skel:blendShapeTargets 1 targets",
    ),
    "blend shapes: a target that is none": (
        lambda _, mesh: rigs.blend_shape(mesh) and binding_of(mesh).GetBlendShapeTargetsRel().SetTargets([SKELETON]),
        f"skel:blendShapeTargets names {SKELETON}, which is not a BlendShape",
    ),
    "animation of joints that it has not": (
        another_animation_of(["root/arm", "root/leg"]),
        f"the animation {ANIMATION} moves root/leg, which the skeleton {SKELETON} does not have",
    ),
    "two skeletons": (
        two_skeletons,
        f"skel:skeleton of {MESH} names {SKELETON} and {ANIMATION}; it must name one skeleton",
    ),
    "a bind transform that is flat": (
        lambda stage, _: skeleton_of(stage).GetBindTransformsAttr().Set([Gf.Matrix4d(1), FLAT, Gf.Matrix4d(1)]),
        f"bindTransforms of {SKELETON} has no inverse for the joint root/arm",
    ),
    "bind transforms that are nothing": (
        lambda stage, _: skeleton_of(stage).GetBindTransformsAttr().Set([Gf.Matrix4d(0)] * 3),
        f"bindTransforms of {SKELETON} has no inverse for the joint root",
    ),
    "a bind transform that is no number": (
        lambda stage, _: skeleton_of(stage).GetBindTransformsAttr().Set([Gf.Matrix4d(1), Gf.Matrix4d(math.nan), FLAT]),
        f"bindTransforms of {SKELETON} has no inverse for the joint root/arm",
    ),
    "a geomBindTransform that is flat": (
        lambda _, mesh: binding_of(mesh).CreateGeomBindTransformAttr(FLAT),
        "primvars:skel:geomBindTransform has no inverse",
    ),
    "in an instance": (
        lambda stage, _: stage.GetPrimAtPath("/World/char").SetInstanceable(True),
        "is inside an instance, whose points are shared; author instanceable = false on /World/char",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_rig_is_named_and_nothing_is_written(name, tmp_path):
    edit, says = BAD[name]
    stage, mesh = rigs.skinned_stage()
    edit(stage, mesh)
    character = stages.save(stage, tmp_path / "character.usda")
    if stage.GetPrimAtPath("/World/char").IsInstanceable():
        character = instanced(character)
    found = [problem.message for problem in skinslide.check(character).problems if problem.severity == "error"]
    assert found == [says]
    before, output = set(tmp_path.iterdir()), tmp_path / "out.usda"
    output.write_text("what was there before")
    for write in (skinslide.bake_to_file, skinslide.cache):
        with pytest.raises(skinslide.StageProblems) as raised:
            write(character, output)
        assert [problem.message for problem in raised.value.problems if problem.severity == "error"] == [says]
        assert output.read_text() == "what was there before" and set(tmp_path.iterdir()) == {*before, output}


def instanced(character):
    """Prims below an instance are there only where they come by a reference."""
    path = character.with_name("instanced.usda")
    path.write_text(
        '#usda 1.0\n(defaultPrim = "World")\ndef Xform "World" {\n'
        'def "char" (references = @character.usda@</World/char>; instanceable = true) {\n}\n}\n'
    )
    return path


def test_transforms_that_cannot_be_at_a_frame_are_named_with_it(tmp_path):
    stage, mesh = rigs.skinned_stage()
    one_rotation_less(stage, mesh)
    for write in (skinslide.bake_to_file, skinslide.cache):
        with pytest.raises(
            skinslide.FrameProblem, match=f"{MESH}: frame 1002: rotations of {ANIMATION} has 1 values for 2 joints"
        ):
            write(stage, tmp_path / "out.usda")
    assert not list(tmp_path.iterdir())


def nan_rotations(stage, _mesh):
    rotations = UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION)).GetRotationsAttr()
    rotations.Set(Vt.QuatfArray([Gf.Quatf(1), Gf.Quatf(0, math.nan, 0, 0)]), FRAMES[1])


def endless_scales(stage, _mesh):
    scales = UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION)).GetScalesAttr()
    for frame in FRAMES:
        scales.Set([Gf.Vec3h(math.inf if frame == FRAMES[1] else 1), Gf.Vec3h(1)], frame)


def nan_shape(stage, mesh):
    rigs.blend_shape(mesh)
    UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION)).GetBlendShapeWeightsAttr().Set([0, math.nan], FRAMES[1])


def nan_weight(_stage, mesh):
    weights = mesh.GetPrim().GetAttribute("primvars:skel:jointWeights")
    values = np.array(weights.Get())
    weights.Set(Vt.FloatArray.FromNumpy(values), FRAMES[0])
    values[12] = math.nan
    weights.Set(Vt.FloatArray.FromNumpy(values), FRAMES[1])


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (nan_rotations, f"rotations of {ANIMATION} is not finite for root/arm"),
        (endless_scales, f"scales of {ANIMATION} is not finite for root/arm/hand"),
        (nan_shape, f"blendShapeWeights of {ANIMATION} is not finite for bulge"),
        (nan_weight, "primvars:skel:jointWeights[12] is nan"),
    ],
)
def test_what_sends_points_nowhere_is_named_with_its_frame(edit, says, tmp_path):
    """Where it is of joints or weights, and not of points: off the patch, too."""
    stage, mesh = rigs.skinned_stage(faces=np.array([35]))
    edit(stage, mesh)
    found = [str(each) for each in skinslide.check(stage).problems if each.severity == "error"]
    assert len(found) == 1 and found[0].startswith(f"error: {MESH}: frame 1002: {says}")
    for write in (skinslide.bake_to_file, skinslide.cache):
        with pytest.raises(skinslide.FrameProblem, match=re.escape(f"{MESH}: frame 1002: {says}")):
            write(stage, tmp_path / "out.usda")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("frame", FRAMES)
def test_a_mesh_that_is_flattened_cannot_be_skinned(frame, tmp_path):
    """Its points came to be of 1e38."""
    stage, mesh = rigs.skinned_stage()
    scale = UsdGeom.Xformable(mesh).AddScaleOp()
    for each in FRAMES:
        scale.Set((1, 0 if each == frame else 1, 1), each)
    says = f"frame {frame:g}: its transform has no inverse, by which UsdSkel brings points back from {SKELETON}"
    found = [str(each) for each in skinslide.check(stage).problems if each.severity == "error"]
    assert len(found) == 1 and found[0].startswith(f"error: {MESH}: {says}")
    for write in (skinslide.bake_to_file, skinslide.cache):
        with pytest.raises(skinslide.FrameProblem, match=f"{MESH}: {says}"):
            write(stage, tmp_path / "out.usda")
    assert not list(tmp_path.iterdir())


def test_joints_that_move_no_point_may_be_anything():
    stage, mesh = rigs.skinned_stage()
    influences("jointIndices", lambda values: values.__setitem__(slice(None), [0, 2] * 49))(stage, mesh)
    influences("jointWeights", lambda values: values.__setitem__(slice(None), [1, 0] * 49))(stage, mesh)
    skeleton_of(stage).GetBindTransformsAttr().Set([Gf.Matrix4d(1), FLAT, Gf.Matrix4d(0)])
    nan_rotations(stage, mesh)
    assert not skinslide.check(stage).failed


@pytest.mark.parametrize("size", [1e-6, 1e6])
def test_a_bind_pose_may_have_any_size(size):
    """Also along a single axis."""
    stage, mesh = rigs.skinned_stage()
    binds = [Gf.Matrix4d().SetScale(Gf.Vec3d(size, 1, size)) for _ in range(3)]
    skeleton_of(stage).GetBindTransformsAttr().Set(binds)
    binding_of(mesh).CreateGeomBindTransformAttr(Gf.Matrix4d().SetScale(Gf.Vec3d(1, size, 1)))
    assert not [each for each in skinslide.check(stage).problems if "inverse" in each.message]


def test_weights_that_cannot_be_at_a_frame_are_named_with_it(tmp_path):
    """The error is of points, and not of the normals that are skinned with them."""
    stage, mesh = rigs.skinned_stage()
    mesh.CreateNormalsAttr([(0, 0, 1)] * 49)
    weights = mesh.GetPrim().GetAttribute("primvars:skel:jointWeights")
    weights.Set(weights.Get(), FRAMES[0])
    weights.Set([1.0] * 4, FRAMES[1])
    said = f"frame 1002: UsdSkel cannot skin points with the skeleton {SKELETON}"
    (found,) = skinslide.check(stage).problems
    assert str(found).startswith(f"error: {MESH}: {said}")
    for write in (skinslide.bake_to_file, skinslide.cache):
        for frames in (None, "1002"):
            with pytest.raises(skinslide.FrameProblem, match=f"{MESH}: {said}"):
                write(stage, tmp_path / "out.usda", frames=frames)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("value", [Sdf.ValueBlock(), [(0, 0, 1)] * 5, []])
def test_normals_that_cannot_be_at_a_frame(value, tmp_path):
    """A bake blocks them, as those of a mesh that is not skinned; a cache has no frame without them."""
    stage, mesh = rigs.skinned_stage()
    normals = mesh.CreateNormalsAttr()
    normals.Set([(0, 0, 1)] * 49, FRAMES[0])
    normals.Set(value, FRAMES[1])
    assert not [problem for problem in skinslide.check(stage).problems if problem.severity == "error"]
    report = skinslide.bake_to_file(stage, tmp_path / "out.usda")
    assert "frame 1002: normals cannot be recomputed, so the bake blocks them" in report.text()
    with pytest.raises(skinslide.FrameProblem, match=f"{MESH}: frame 1002: normals cannot be skinned"):
        skinslide.cache(stage, tmp_path / "cache.usda")
    assert [path.name for path in tmp_path.iterdir()] == ["out.usda"]


@pytest.mark.parametrize("weights", [0.996, 1.004])
def test_weights_of_eight_bits_are_no_error(weights):
    stage, mesh = rigs.skinned_stage()
    attribute = mesh.GetPrim().GetAttribute("primvars:skel:jointWeights")
    attribute.Set(attribute.GetTypeName().type.pythonClass.FromNumpy(np.float32(weights) * np.array(attribute.Get())))
    assert not skinslide.check(stage).problems


def test_shapes_that_are_not_animated_stay():
    stage, mesh = rigs.skinned_stage()
    (without,), _ = read_meshes(stage)
    rigs.blend_shape(mesh)
    animation = UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION))
    animation.GetBlendShapesAttr().Set(["other", "another"])
    (read,), problems = read_meshes(stage)
    assert not problems
    for frame in map(Usd.TimeCode, FRAMES):
        np.testing.assert_array_equal(read.points_at(frame), without.points_at(frame))
