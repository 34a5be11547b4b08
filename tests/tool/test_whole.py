"""`setup --whole` makes one patch of every mesh that stretches, where it does and so far around that it can give."""

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

import skinslide
import stages
from skinslide.author.setup import setup_to_file
from skinslide.command.cli import main
from skinslide.problems import StageProblems, UsageError
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from stages import FRAMES

SIDE = 24
SKIN, ROD, HIDDEN, STILL = (f"/World/char/geo/{name}_GEO" for name in ("skin", "rod", "hidden", "still"))


def bulging(shape: stages.Shape) -> dict[float, np.ndarray]:
    """Points of a flat sheet at each frame: a cone on the six squares around its middle grows in the last two."""
    away = np.linalg.norm(shape.points[:, :2] - SIDE / 2, axis=1)
    cone = np.maximum(3 - away, 0)[:, None] * (0, 0, 1)
    return {frame: shape.points + amount * cone for frame, amount in zip(FRAMES, (0, 0.1, 0.5), strict=True)}


def add(stage: Usd.Stage, path: str, poses: dict[float, np.ndarray]) -> UsdGeom.Mesh:
    shape = stages.squares(SIDE)
    mesh = stages.add_mesh(stage, shape, path, frames=())
    for frame, points in poses.items():
        mesh.GetPointsAttr().Set(stages.vectors(points.astype(np.float32)), frame)
    return mesh


@pytest.fixture
def shot(tmp_path):
    """A sheet that bulges, one that only moves, one that is a guide, and one that stays."""
    stage, shape = stages.new_stage(), stages.squares(SIDE)
    skin = add(stage, SKIN, bulging(shape))
    stages.set_primvar(skin, "lips", Sdf.ValueTypeNames.FloatArray, "vertex", [0.0] * 312 + [1.0] + [0.0] * 312)
    add(stage, ROD, {frame: shape.points + frame for frame in FRAMES})
    add(stage, HIDDEN, bulging(shape)).CreatePurposeAttr(UsdGeom.Tokens.guide)
    add(stage, STILL, {})
    return stages.save(stage, tmp_path / "cache.usda")


def whole(path) -> dict[str, dict[str, np.ndarray]]:
    """The faces of each patch, by the path of its mesh."""
    return {mesh.path: {patch.name: patch.faces for patch in mesh.patches} for mesh in read_meshes(open_stage(path))[0]}


def expected(reach: int) -> list[int]:
    """The faces of a square around the middle."""
    low, high = SIDE // 2 - reach, SIDE // 2 + reach
    return stages.block(SIDE, range(low, high), range(low, high)).tolist()


def test_where_skin_stretches_and_around(shot, tmp_path):
    report = setup_to_file(shot, tmp_path / "x.skinslide", whole=True)
    found = whole(tmp_path / "x.skinslide")
    assert list(found) == [SKIN] and list(found[SKIN]) == ["skin"]
    faces = found[SKIN]["skin"].tolist()
    # The cone's own squares, three around them at least, and no more than half as far again as it is wide.
    assert set(expected(5)) <= set(faces) <= set(expected(8))
    notes = [problem for problem in report.problems if problem.severity == "note"]
    assert [note.prim for note in notes] == [ROD] and "no edge ever stretches by over 2%" in notes[0].message


def test_it_slides_and_is_even(shot, tmp_path):
    stage = open_stage(shot)
    skinslide.setup(stage, whole=True)
    report = skinslide.bake(stage)
    assert stage.GetPrimAtPath(SKIN).GetAttribute("skinSlide:skin:forceDensityRule").Get() == "even"
    ((patch,),) = (mesh.patches for mesh in report.meshes)
    before, after = patch.column("stretch_before"), patch.column("stretch_after")
    assert before[0] == after[0] == 0 and after[-1] < 0.8 * before[-1]


@pytest.mark.parametrize(("frames", "stretches"), [("1001", False), ("1001-1002", False), ([1003], True)])
def test_only_frames_that_are_asked_for(frames, stretches, shot, tmp_path):
    """In the second a side of the cone is log(1 + 0.1^2) / 2 longer, half a hundredth."""
    output = tmp_path / "x.usda"
    if stretches:
        setup_to_file(shot, output, whole=True, frames=frames)
        assert list(whole(output)) == [SKIN]
        return
    with pytest.raises(StageProblems, match="no edge of any mesh ever stretches by over 2%"):
        setup_to_file(shot, output, whole=True, frames=frames)
    assert not output.exists()


def test_of_a_prim_and_below(shot, tmp_path):
    setup_to_file(shot, tmp_path / "a.usda", SKIN, "own", whole=True, rule="relaxed")
    setup_to_file(shot, tmp_path / "b.usda", "/World/char", "own", whole=True)
    a, b = whole(tmp_path / "a.usda"), whole(tmp_path / "b.usda")
    assert list(a) == list(b) == [SKIN] and a[SKIN]["own"].tolist() == b[SKIN]["own"].tolist()
    with pytest.raises(StageProblems, match="no mesh is rendered and has points that move"):
        setup_to_file(shot, tmp_path / "c.usda", STILL, whole=True)


@pytest.mark.parametrize("rest", ["points", "rest"])
def test_one_pose_is_compared_with_rest(rest, shot, tmp_path, monkeypatch):
    """It is a sample beside default points, or default points beside a primvar. One that is rest moves nothing."""
    read, read_moving = list[str](), skinslide.author.whole.read_moving
    monkeypatch.setattr(
        "skinslide.author.whole.read_moving", lambda prim: read.append(str(prim.GetPath())) or read_moving(prim)
    )
    stage, shape, still = stages.new_stage(), stages.squares(SIDE), STILL.replace("still", "at_rest")
    for path, points in ((SKIN, bulging(shape)[FRAMES[-1]]), (still, shape.points)):
        mesh = stages.add_mesh(stage, shape, path, frames=(), rest=rest)
        time = FRAMES[0] if rest == "points" else Usd.TimeCode.Default()
        mesh.GetPointsAttr().Set(stages.vectors(points.astype(np.float32)), time)
    report = setup_to_file(stages.save(stage, tmp_path / "pose.usda"), tmp_path / "one.usda", whole=True)
    assert not [problem for problem in report.problems if problem.prim == still]
    assert sorted(read) == sorted([SKIN, still])
    setup_to_file(shot, tmp_path / "many.usda", SKIN, whole=True)
    one, many = whole(tmp_path / "one.usda"), whole(tmp_path / "many.usda")
    assert list(one) == [SKIN] and one[SKIN]["skin"].tolist() == many[SKIN]["skin"].tolist()
    assert main(["bake", str(tmp_path / "one.usda"), "-o", str(tmp_path / "slid.usda")]) == 0


def test_pins(shot, tmp_path):
    setup_to_file(shot, tmp_path / "x.usda", whole=True, pin="lips")
    skinslide.bake(stage := open_stage(tmp_path / "x.usda"))
    points = UsdGeom.Mesh(stage.GetPrimAtPath(SKIN)).GetPointsAttr().Get(FRAMES[-1])
    assert points[312] == Gf.Vec3f(*map(float, bulging(stages.squares(SIDE))[FRAMES[-1]][312]))
    with pytest.raises(StageProblems, match="no mesh that moves has a GeomSubset or a primvar nails"):
        setup_to_file(shot, tmp_path / "x.usda", whole=True, pin=["lips", "nails"])


def referenced(shot, folder, **instanceable: str):
    """The character, referenced once under each name."""
    prims = (
        f'def "{name}" (references = @{shot.name}@; instanceable = {value}) {{\n}}'
        for name, value in instanceable.items()
    )
    path = folder / "shot.usda"
    path.write_text('#usda 1.0\n(defaultPrim = "Shot")\ndef Xform "Shot" {\n' + "\n".join(prims) + "\n}\n")
    return path


def test_what_instances_share_is_told_of(shot, tmp_path):
    path = referenced(shot, tmp_path, own="false", shared="true")
    report = setup_to_file(path, tmp_path / "x.usda", whole=True)
    assert list(whole(tmp_path / "x.usda")) == [SKIN.replace("/World", "/Shot/own")]
    warnings = [problem for problem in report.problems if problem.severity == "warning"]
    said = "is inside an instance, whose points are shared; author instanceable = false on /Shot/shared"
    assert [warning.prim for warning in warnings] == [path.replace("/World", "/Shot/shared") for path in (SKIN, ROD)]
    assert {warning.message for warning in warnings} == {f"has no patch: {said}"}
    with pytest.raises(StageProblems, match=f"error: /Shot/shared/char/geo/skin_GEO: {said}"):
        setup_to_file(referenced(shot, tmp_path, shared="true"), tmp_path / "y.usda", whole=True)


def test_a_prototype_of_an_instancer_does_not_stop_the_others(shot, tmp_path):
    stage = Usd.Stage.Open(str(shot))
    add(stage, "/World/crowd/double", bulging(stages.squares(SIDE)))
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/crowd")
    instancer.CreatePrototypesRel().AddTarget("/World/crowd/double")
    report = skinslide.setup(stage, whole=True)
    assert [mesh.path for mesh in report.meshes] == [SKIN]
    (warning,) = [problem for problem in report.problems if problem.severity == "warning"]
    assert warning.prim == "/World/crowd/double" and "has no patch: is a prototype of" in warning.message


def test_what_is_slid_live_already_is_told_of(shot, tmp_path):
    setup_to_file(shot, tmp_path / "x.skinslide", SKIN, whole=True)
    path = tmp_path / "shot.usda"
    path.write_text("#usda 1.0\n(subLayers = [@x.skinslide@])\n")
    with pytest.raises(StageProblems, match=f"error: {SKIN}: is slid already, by"):
        setup_to_file(path, tmp_path / "y.usda", SKIN, whole=True)


def test_a_mesh_without_faces_is_none(shot, tmp_path):
    stage = Usd.Stage.Open(str(shot))
    rod = UsdGeom.Mesh(stage.GetPrimAtPath(ROD))
    rod.GetFaceVertexCountsAttr().Set([])
    rod.GetFaceVertexIndicesAttr().Set([])
    assert [mesh.path for mesh in skinslide.setup(stage, whole=True).meshes] == [SKIN]


def test_after_a_bake_into_the_same_layer(shot, tmp_path):
    """It looks at the cache, as it did before, and not at what was slid."""
    stage = open_stage(shot)
    skinslide.setup(stage, whole=True)
    before = stage.GetPrimAtPath(SKIN).GetAttribute("primvars:skinSlide:skin:patch").Get()
    skinslide.bake(stage)
    points = UsdGeom.Mesh(stage.GetPrimAtPath(SKIN)).GetPointsAttr()
    slid = np.array(points.Get(FRAMES[-1]))
    skinslide.setup(stage, whole=True)
    assert stage.GetPrimAtPath(SKIN).GetAttribute("primvars:skinSlide:skin:patch").Get() == before
    assert np.array(points.Get(FRAMES[-1])).tobytes() == slid.tobytes()


def test_frames_beyond_the_samples_are_told_of(shot, tmp_path):
    report = setup_to_file(shot, tmp_path / "x.usda", SKIN, whole=True, frames="1003-1005")
    (warning,) = [problem for problem in report.problems if problem.severity == "warning"]
    assert warning.frame == 1004 and "2 frames are beyond the samples, which go from 1001 to 1003" in warning.message


def three_at_an_edge(mesh):
    counts, indices = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    counts.Set([*counts.Get(), 3])
    indices.Set([*indices.Get(), 312, 313, 0])


def hole_of_no_face(mesh):
    mesh.CreateHoleIndicesAttr([10_000])
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.catmullClark)


def without_rest(mesh):
    points = mesh.GetPointsAttr()
    samples = {frame: points.Get(frame) for frame in points.GetTimeSamples()}
    points.Clear()
    for frame, values in samples.items():
        points.Set(values, frame)


def not_finite(mesh):
    values = np.array(mesh.GetPointsAttr().Get(FRAMES[1]))
    values[7] = np.nan
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(values), FRAMES[1])


def other_count(mesh):
    mesh.GetPointsAttr().Set([(0, 0, 0)] * 5, FRAMES[1])


def no_such_point(mesh):
    indices = np.array(mesh.GetFaceVertexIndicesAttr().Get())
    indices[3] = 10_000
    mesh.GetFaceVertexIndicesAttr().Set(indices.tolist())


def pin_of_another_count(mesh):
    stages.set_primvar(mesh, "lips", Sdf.ValueTypeNames.FloatArray, "vertex", [1.0] * 40)


def holed(stage, scheme=UsdGeom.Tokens.catmullClark, holes=(300, 301)) -> Usd.Stage:
    """The skin as a subdivision surface with holes where it stretches."""
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(SKIN))
    mesh.CreateSubdivisionSchemeAttr(scheme)
    mesh.CreateHoleIndicesAttr(list(holes))
    return stage


@pytest.mark.parametrize("interpolation", [None, "auto", "limit"])
def test_faces_without_a_limit_surface_are_left_out(interpolation, shot, tmp_path):
    """Not in place of the mesh: the others are as they are without holes, and what is made can be baked."""
    setup_to_file(shot, tmp_path / "without.usda", SKIN, whole=True)
    character = stages.save(holed(Usd.Stage.Open(str(shot))), tmp_path / "holed.usda")
    report = setup_to_file(character, tmp_path / "x.usda", SKIN, whole=True, interpolation=interpolation)
    (note,) = [each for each in report.problems if "limit surface" in each.message]
    says = "2 faces without limit surface are left out, face 300 the first; with --interpolation linear none is"
    assert (note.severity, note.prim, note.message) == ("note", SKIN, says)
    faces, without = (whole(tmp_path / name)[SKIN]["skin"].tolist() for name in ("x.usda", "without.usda"))
    assert faces == [face for face in without if face not in (300, 301)] != without
    record = skinslide.bake_to_file(tmp_path / "x.usda", tmp_path / "slid.usda")
    ((patch,),) = (mesh.patches for mesh in record.meshes)
    assert (
        max(patch.column("folded_faces")) == 0
        and patch.column("stretch_after")[-1] < patch.column("stretch_before")[-1]
    )
    assert main(["check", str(tmp_path / "x.usda")]) == 0


def test_a_mesh_on_which_no_face_that_stretches_has_a_limit_surface(shot, tmp_path):
    setup_to_file(shot, tmp_path / "without.usda", SKIN, whole=True)
    stretched = whole(tmp_path / "without.usda")[SKIN]["skin"].tolist()
    character = stages.save(holed(Usd.Stage.Open(str(shot)), holes=stretched), tmp_path / "holed.usda")
    with pytest.raises(StageProblems) as bad:
        setup_to_file(character, tmp_path / "x.usda", SKIN, whole=True)
    (problem,) = bad.value.problems
    assert (problem.severity, problem.prim) == ("error", SKIN)
    assert problem.message.startswith(f"{len(stretched)} faces without limit surface are left out, ")


def test_one_face_without_a_limit_surface_is_no_several(shot, tmp_path):
    character = stages.save(holed(Usd.Stage.Open(str(shot)), holes=[300]), tmp_path / "holed.usda")
    report = setup_to_file(character, tmp_path / "x.usda", SKIN, whole=True)
    assert sum(each.message.startswith("1 face without limit surface is left out, ") for each in report.problems) == 1


@pytest.mark.parametrize(
    ("scheme", "interpolation"), [(UsdGeom.Tokens.catmullClark, "linear"), (UsdGeom.Tokens.none, None)]
)
def test_holes_are_faces_without_a_limit_surface_only(scheme, interpolation, shot, tmp_path):
    setup_to_file(shot, tmp_path / "without.usda", SKIN, whole=True)
    character = stages.save(holed(Usd.Stage.Open(str(shot)), scheme), tmp_path / "holed.usda")
    report = setup_to_file(character, tmp_path / "x.usda", SKIN, whole=True, interpolation=interpolation)
    assert not [each for each in report.problems if "limit surface" in each.message]
    faces, without = (whole(tmp_path / name)[SKIN]["skin"].tolist() for name in ("x.usda", "without.usda"))
    assert faces == without and 300 in faces


BAD = {
    "an edge of three faces": (three_at_an_edge, None, "faces"),
    "a hole that is no face": (hole_of_no_face, None, "10000"),
    "no rest": (without_rest, None, "rest"),
    "a sample that is not finite": (not_finite, FRAMES[1], "points: vertex 7 is not finite"),
    "a sample of another count": (other_count, FRAMES[1], "points has 5 values"),
    "no such point": (no_such_point, None, "10000"),
    "a pin that cannot be read": (pin_of_another_count, None, "lips"),
}


@pytest.mark.parametrize(("spoil", "frame", "said"), BAD.values(), ids=BAD.keys())
def test_a_mesh_that_cannot_be_slid_does_not_stop_the_others(spoil, frame, said, shot, tmp_path):
    """It is left as it was, with one warning; the others come out as they do without it."""
    setup_to_file(shot, tmp_path / "alone.usda", SKIN, whole=True, pin="lips")
    stage, twin = Usd.Stage.Open(str(shot)), "/World/char/geo/twin_GEO"
    mesh = add(stage, twin, bulging(stages.squares(SIDE)))
    stages.set_primvar(mesh, "lips", Sdf.ValueTypeNames.FloatArray, "vertex", [0.0] * 625)
    spoil(mesh)
    shot = stages.save(stage, tmp_path / "both.usda")
    report = setup_to_file(shot, tmp_path / "both_set_up.usda", whole=True, pin="lips")
    assert [mesh.path for mesh in report.meshes] == [SKIN] and not report.failed
    (warning,) = [problem for problem in report.problems if problem.severity == "warning"]
    assert (warning.prim, warning.patch, warning.frame) == (twin, None, frame)
    assert warning.message.startswith("has no patch: ") and said in warning.message
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "both_set_up.usda"))
    assert not layer.GetPrimAtPath(twin)
    one, other = (whole(tmp_path / name) for name in ("alone.usda", "both_set_up.usda"))
    assert list(one) == list(other) and one[SKIN]["skin"].tolist() == other[SKIN]["skin"].tolist()
    with pytest.raises(StageProblems) as alone:
        setup_to_file(shot, tmp_path / "never.usda", twin, whole=True, pin="lips")
    assert alone.value.problems[0].message in warning.message


def test_nothing_is_authored_where_none_can_be_slid(shot):
    stage = Usd.Stage.Open(str(shot))
    not_finite(UsdGeom.Mesh(stage.GetPrimAtPath(SKIN)))
    before = stage.GetRootLayer().ExportToString()
    with pytest.raises(StageProblems, match=rf"error: {SKIN}: frame 1002: points: vertex 7 is not finite"):
        skinslide.setup(stage, whole=True)
    assert stage.GetRootLayer().ExportToString() == before


def test_usage(shot, tmp_path):
    stage = open_stage(shot)
    bad = (dict(whole=True, patch=""), dict(whole=True, faces="0"), dict())
    for given in (*bad, dict(patch="elbow", faces="0"), dict(prim=SKIN, faces="0")):
        with pytest.raises(UsageError):
            skinslide.setup(stage, **given)


def test_the_command(shot, tmp_path, capfd):
    output = tmp_path / "x.skinslide"
    assert main(["setup", str(shot), "-o", str(output), "--whole", "--pin", "lips", "--weight", "0.5"]) == 0
    assert f"{output}: written" in capfd.readouterr().out
    assert list(whole(output)) == [SKIN]
