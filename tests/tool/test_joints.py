"""Patches by the joints of a rig: faces that mix a joint with those beside it, on one side or both."""

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt

import rigs
import skinslide
import stages
from skinslide.command.cli import main
from skinslide.stage.reading import read_meshes
from stages import MESH


@pytest.fixture
def character():
    """A narrow sheet that three joints in a row move, with nothing set up. Keep the stage."""
    stage, shape = stages.new_stage(), stages.grid(20, 4)
    shape.points[:, 1] *= 0.1
    mesh = stages.add_mesh(stage, shape)
    rigs.skeleton(stage)
    rigs.bind(mesh)
    return stage, mesh


def faces_of(stage, patch):
    ((mesh,), problems) = read_meshes(stage)
    assert not problems
    return {each.name: each.faces for each in mesh.patches}[patch]


def middles(mesh, faces):
    """The middles of faces along x, in which direction the joints lie."""
    points = np.array(mesh.GetPointsAttr().Get())
    return points[np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 4)[faces], 0].mean(axis=1)


def test_faces_are_those_that_mix_the_joint_near_it(character):
    """The arm is 0.4 long; it fades in from -0.25 on, and out to 0.5, where the hand is at 0.4."""
    stage, mesh = character
    skinslide.setup(stage, MESH, "elbow", joint="arm", reach=1.5)
    x = middles(mesh, faces_of(stage, "elbow"))
    assert -0.3 <= x.min() <= -0.2 and x.max() >= 0.4
    skinslide.setup(stage, MESH, "elbow", joint="arm", reach=0.5)  # 0.2 from the joint
    near = middles(mesh, faces_of(stage, "elbow"))
    assert near.min() > -0.2 and near.max() < 0.2 and 0 < len(near) < len(x)


def test_several_joints_are_one_patch(character):
    stage, _ = character
    both = {}
    for name in ("arm", "hand"):
        skinslide.setup(stage, MESH, name, joint=name)
        both[name] = set(faces_of(stage, name))
    skinslide.setup(stage, MESH, "all", joint=["root/arm", "hand"])
    assert set(faces_of(stage, "all")) == both["arm"] | both["hand"]


def two_arms(stage, mesh, left, right):
    """The sheet's middle stays with the root, and an arm on either side takes over along x."""
    joints = ["root", f"root/{left}", f"root/{right}"]
    skeleton = UsdSkel.Skeleton(stage.GetPrimAtPath(rigs.SKELETON))
    skeleton.GetJointsAttr().Set(joints)
    binds = [Gf.Matrix4d().SetTranslate(Gf.Vec3d(x, 0, 0)) for x in (0, -0.3, 0.3)]
    skeleton.GetBindTransformsAttr().Set(binds)
    skeleton.GetRestTransformsAttr().Set(binds)
    UsdSkel.Animation(stage.GetPrimAtPath(rigs.ANIMATION)).GetJointsAttr().Set(joints[1:])
    x = np.array(mesh.GetPointsAttr().Get())[:, 0]
    outer = np.clip((np.abs(x) - 0.1) / 0.4, 0, 1)
    binding = UsdSkel.BindingAPI(mesh.GetPrim())
    indices, weights = np.stack([0 * x, np.where(x < 0, 1, 2)], axis=1), np.stack([1 - outer, outer], axis=1)
    binding.GetJointIndicesPrimvar().Set(Vt.IntArray.FromNumpy(indices.astype(np.int32).ravel()))
    binding.GetJointWeightsPrimvar().Set(Vt.FloatArray.FromNumpy(weights.astype(np.float32).ravel()))


@pytest.mark.parametrize(
    ("left", "right"), [("arm_L", "arm_R"), ("LeftArm", "RightArm"), ("l_arm", "r_arm"), ("leftArm", "rightArm")]
)
def test_both_sides_at_once(character, left, right):
    stage, mesh = character
    two_arms(stage, mesh, left, right)
    skinslide.setup(stage, MESH, "arm_L", joint=left, mirror=True)
    near, far = (middles(mesh, faces_of(stage, patch)) for patch in ("arm_L", "arm_R"))
    assert near.max() < 0 < far.min()
    np.testing.assert_allclose(np.sort(-near), np.sort(far), atol=1e-6)


BAD = {
    "a joint that is none": ({"joint": "leg"}, "leg is not a joint; there are root, arm and hand"),
    "no counterpart": (
        {"joint": "arm", "mirror": True},
        "the joint arm has no counterpart, which would be root/arm",
    ),
    "nothing so near": (
        {"joint": "arm", "reach": 1e-3},
        "no face whose points are within 0.001 lengths of the joint mixes root/arm with its parent or children",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_is_named_and_nothing_is_authored(name, character):
    options, says = BAD[name]
    stage, _ = character
    before = stage.GetRootLayer().ExportToString()
    with pytest.raises(skinslide.StageProblems) as raised:
        skinslide.setup(stage, MESH, "arm_L", **options)
    assert [problem.message for problem in raised.value.problems] == [says]
    assert stage.GetRootLayer().ExportToString() == before


def test_a_mesh_that_is_not_skinned_has_no_joints():
    stage = stages.new_stage()
    stages.add_mesh(stage, stages.grid())
    with pytest.raises(skinslide.StageProblems, match="UsdSkel does not skin it, so it has no joints"):
        skinslide.setup(stage, MESH, "arm", joint="arm")


@pytest.mark.parametrize(
    "options", [{"faces": [0], "reach": 1}, {"faces": [0], "mirror": True}, {"joint": "arm", "reach": -1}]
)
def test_arguments_that_cannot_be(options, character):
    with pytest.raises(skinslide.UsageError):
        skinslide.setup(character[0], MESH, "arm_L", **options)


def test_the_command(character, tmp_path, capsys):
    stage, _ = character
    path, output = stages.save(stage, tmp_path / "character.usda"), tmp_path / "x.skinslide"
    words = ["setup", path, "-o", output, "--prim", MESH, "--patch", "arm", "--joint", "arm,hand", "--reach", "1"]
    assert main([*map(str, words)]) == 0
    assert f"skinned by {rigs.SKELETON}" in capsys.readouterr().out
    assert main(["bake", str(output), "-o", str(tmp_path / "slid.usda"), "--quiet"]) == 0


# ---- What there is to set up ----


def test_check_lists_what_setup_takes(character):
    stage, mesh = character
    subset = UsdGeom.Subset.Define(stage, f"{MESH}/sleeve")
    subset.CreateElementTypeAttr("face")
    UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("mask", stages.Sdf.ValueTypeNames.FloatArray, "vertex").Set([0.0] * 105)
    report = skinslide.check(stage)
    (found,) = report.candidates
    assert (found.path, found.points, found.faces, found.skeleton) == (MESH, 105, 80, rigs.SKELETON)
    assert (found.joints, found.subsets, found.primvars) == (["root", "arm", "hand"], ["sleeve"], ["mask"])
    for words in ("--joint root, arm, hand", "--subset sleeve", "--primvar mask", "--faces 0-79"):
        assert words in report.text()


def test_check_lists_nothing_once_a_patch_is_there(character):
    stage, _ = character
    assert not skinslide.setup(stage, MESH, "arm", joint="arm").candidates


def test_meshes_that_cannot_be_set_up_are_not_listed(character):
    stage, mesh = character
    mesh.GetPrim().SetSpecifier(stages.Sdf.SpecifierOver)
    assert not skinslide.check(stage).candidates and isinstance(stage, Usd.Stage)


def test_a_whole_set_up_of_a_skinned_mesh_is_that_of_its_cache(character, tmp_path):
    stage, _ = character
    path = stages.save(stage, tmp_path / "character.usda")
    skinslide.cache(path, tmp_path / "cache.usda")
    cached = Usd.Stage.Open(str(tmp_path / "cache.usda"))
    cached.GetRootLayer().subLayerPaths.append("character.usda")
    for each in (stage, cached):
        skinslide.setup(each, whole=True)
    faces = faces_of(stage, "skin")
    assert faces.size
    np.testing.assert_array_equal(faces, faces_of(cached, "skin"))
