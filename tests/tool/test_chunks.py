"""Parts of a shot that were baked apart: which fit together, which are whole, and which need not be baked again."""

import json
import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, Vt

import stages
from skinslide import StageError, StageProblems, UsageError, bake_to_file, stitch
from skinslide.command.cli import main
from skinslide.shot.frames import Chunk, parse_frames, spec_of
from skinslide.write.record import Record
from stages import MESH, PATCH

FRAMES = [float(frame) for frame in range(1001, 1009)]
SHORT = "/World/prop/short_GEO"
STILL = "/World/prop/still_GEO"


def saved_shot(path, edit=lambda stage: None):
    """A mesh that moves for eight frames, one that moves for the first three, and one that does not."""
    stage, mesh = stages.patched_stage()
    short = stages.add_mesh(stage, stages.grid(), SHORT, rest="Pref")
    still = stages.add_mesh(stage, stages.grid(), STILL, frames=[], rest="Pref")
    for frame in FRAMES:
        mesh.GetPointsAttr().Set(stages.vectors(stages.grid().moved(frame)), frame)
        mesh.CreateVelocitiesAttr().Set(stages.vectors(np.zeros((49, 3))), frame)
    still.GetPointsAttr().Set(stages.vectors(stages.grid().moved(FRAMES[2])))
    for other in (short, still):
        stages.add_patch(other, stages.annulus())
    edit(stage)
    return stages.save(stage, path)


@pytest.fixture
def shot(tmp_path):
    return saved_shot(tmp_path / "shot.usda")


def parts(shot, folder, count=4, **options):
    """The chunks of a shot."""
    paths = [folder / f"part{number}.usdc" for number in range(1, count + 1)]
    for number, path in enumerate(paths, 1):
        bake_to_file(shot, path, chunk=f"{number}/{count}", **options)
    return paths


def text(path) -> str:
    return Sdf.Layer.OpenAsAnonymous(str(path)).ExportToString()


def record(path) -> Record:
    return Record.read(Sdf.Layer.OpenAsAnonymous(str(path)))


# ---- Parts of the frames ----


@pytest.mark.parametrize("count", [1, 3, 8])
def test_parts_are_the_whole(count, shot, tmp_path):
    bake_to_file(shot, tmp_path / "whole.usda")
    paths = parts(shot, tmp_path, count)
    random.Random(count).shuffle(paths)
    stitch(paths, tmp_path / "out.usda")
    assert (tmp_path / "out.usda").read_text() == (tmp_path / "whole.usda").read_text()


def test_parts_of_named_frames(shot, tmp_path):
    bake_to_file(shot, tmp_path / "whole.usda", frames="1001-1008x2")
    stitch(parts(shot, tmp_path, 2, frames="1001-1008x2"), tmp_path / "out.usda")
    assert (tmp_path / "out.usda").read_text() == (tmp_path / "whole.usda").read_text()


@pytest.mark.parametrize("count", [1, 2, 5, 8])
def test_parts_are_all_frames_once(count):
    found = [Chunk(number, count).of(FRAMES) for number in range(1, count + 1)]
    assert [frame for part in found for frame in part] == FRAMES
    assert max(map(len, found)) - min(map(len, found)) <= 1


@pytest.mark.parametrize(
    ("chunk", "says"),
    [
        ("3", "must be a part and how many there are"),
        ("", "must be a part and how many there are"),
        (3, "must be a part and how many there are"),
        ("0/4", "the part must be from 1 to 4"),
        ("5/4", "the part must be from 1 to 4"),
        ("1/9", "there are 8 frames to divide"),
    ],
)
def test_parts_that_cannot_be(chunk, says, shot, tmp_path):
    with pytest.raises(UsageError, match=says):
        bake_to_file(shot, tmp_path / "out.usdc", chunk=chunk)
    assert not (tmp_path / "out.usdc").exists()


@pytest.mark.parametrize("seed", range(20))
def test_a_spec_gives_the_frames_that_it_is_of(seed):
    chance = random.Random(seed)
    step = chance.choice([1, 2, 0.25, 0.1, 1 / 3])
    frames = sorted({chance.choice([1001, -5, 0.5]) + chance.randrange(40) * step for _ in range(30)})
    assert parse_frames(spec_of(frames)) == frames


def test_a_spec_is_short():
    assert spec_of(FRAMES) == "1001:1008" and spec_of([0.5, 1.0, 1.5, 2.0]) == "0.5:2x0.5"
    assert spec_of([-2.0, -1.0, 0.0, 5.0]) == "-2:0,5" and spec_of([1.0, 2.0]) == "1,2"
    assert all(Fraction(part) for part in spec_of([1.0, 1e22]).split(","))


# ---- Which fit together ----


def refused(chunks, folder, says, error=StageProblems, **options) -> str:
    """What stitch says; its output stays as it was."""
    (folder / "out.usdc").write_bytes(b"older")
    with pytest.raises(error, match=says) as raised:
        stitch(chunks, folder / "out.usdc", **options)
    assert (folder / "out.usdc").read_bytes() == b"older"
    return str(raised.value)


def ranges(shot, folder, *specs):
    paths = [folder / f"{spec}.usdc" for spec in specs]
    for path, spec in zip(paths, specs, strict=True):
        bake_to_file(shot, path, frames=spec)
    return paths


def test_a_gap(shot, tmp_path):
    chunks = ranges(shot, tmp_path, "1001-1003", "1006-1008")
    said = refused(chunks, tmp_path, "no chunk has frames 1004 to 1005 of the shot")
    assert all(str(chunk) in said for chunk in chunks)
    refused(chunks, tmp_path, "frame 1004: 2 frames are in none of .*: 1004,1005", frames="1001-1008")
    report = stitch(chunks, tmp_path / "out.usdc", frames="1001-1003,1006-1008")
    assert len(report.frames) == 6
    refused(chunks, tmp_path, "frame 1001: 3 frames are not asked for, but in .*: 1001:1003", frames="1006-1008")


def test_steps_are_a_gap_unless_they_are_wanted(shot, tmp_path):
    chunks = ranges(shot, tmp_path, "1001-1003x2", "1005-1007x2")
    refused(chunks, tmp_path, "no chunk has frame 1004 of the shot")
    bake_to_file(shot, tmp_path / "whole.usda", frames="1001-1007x2")
    stitch(chunks, tmp_path / "out.usda", frames="1001-1007x2")
    assert (tmp_path / "out.usda").read_text() == (tmp_path / "whole.usda").read_text()


def test_a_part_that_is_missing(shot, tmp_path):
    paths = parts(shot, tmp_path)
    for left in range(4):
        first = FRAMES[2 * left]
        refused(paths[:left] + paths[left + 1 :], tmp_path, f"frame {first:g}: 2 frames are in none")


def test_overlaps_that_are_equal(shot, tmp_path):
    chunks = ranges(shot, tmp_path, "1001-1005", "1003-1008", "1004")
    bake_to_file(shot, tmp_path / "whole.usda", frames="1001-1008")
    stitch(chunks, tmp_path / "out.usda")
    assert (tmp_path / "out.usda").read_text() == (tmp_path / "whole.usda").read_text()


def paint(stage):
    prim = stage.GetPrimAtPath(MESH)
    primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(
        f"skinSlide:{PATCH}:weight", Sdf.ValueTypeNames.FloatArray, "constant"
    )
    primvar.Set([0.5])


def animate(stage):
    envelope = stage.GetPrimAtPath(MESH).CreateAttribute(f"skinSlide:{PATCH}:envelope", Sdf.ValueTypeNames.Float)
    for frame in FRAMES:
        envelope.Set(0.25 if frame == FRAMES[4] else 1.0, frame)


def move_rest(stage):
    points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    points.Set(stages.vectors(np.array(points.Get()) + np.float32(0.01)))


def move_cache(stage):
    points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    points.Set(stages.vectors(np.array(points.Get(FRAMES[4])) + np.float32(0.01)), FRAMES[4])


def turn_faces(stage):
    UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).CreateOrientationAttr("leftHanded")


@pytest.mark.parametrize(
    ("edit", "what"),
    [
        (paint, "set-ups or paint"),
        (animate, "set-ups or paint"),
        (move_rest, "rest points"),
        (move_cache, "caches"),
        (turn_faces, "topology"),
    ],
)
def test_chunks_of_something_else(edit, what, shot, tmp_path):
    (first,) = ranges(shot, tmp_path, "1001-1004")
    saved_shot(shot, edit)
    (second,) = ranges(shot, tmp_path, "1005-1008")
    said = refused([first, second], tmp_path, f"{MESH}: {first} and {second} were baked from other {what}")
    assert len(said.splitlines()) == 1


def facing(count: int, frame: float) -> np.ndarray:
    return stages.vectors(np.tile([0.0, np.sin(frame), np.cos(frame)], (count, 1)))


def add_normals(stage):
    """Gives normals at frames to the mesh that moves, and to the one that does not."""
    for path in (MESH, STILL):
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath(path))
        for frame in FRAMES:
            mesh.CreateNormalsAttr().Set(facing(49, frame), frame)
        mesh.SetNormalsInterpolation("vertex")


def add_tangents(stage):
    primvar = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(MESH)).CreatePrimvar(
        "tangents", Sdf.ValueTypeNames.Vector3fArray, "vertex"
    )
    for frame in FRAMES:
        primvar.Set(facing(49, frame), frame)


def add_st(stage):
    primvars = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(MESH))
    primvars.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex").Set(
        Vt.Vec2fArray.FromNumpy(stages.grid().points[:, :2].astype(np.float32))
    )


def turn(name, frame, path=MESH):
    """An edit that changes vectors at one frame."""

    def edit(stage):
        attribute = stage.GetPrimAtPath(path).GetAttribute(name)
        attribute.Set(stages.vectors(np.array(attribute.Get(frame))[:, ::-1] + 1), frame)

    return edit


def both(*edits):
    def edit(stage):
        for each in edits:
            each(stage)

    return edit


def move_st(stage):
    st = stage.GetPrimAtPath(MESH).GetAttribute("primvars:st")
    st.Set(Vt.Vec2fArray.FromNumpy(np.array(st.Get())[:, ::-1].copy()))


def of_the_whole(stage):
    UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).SetNormalsInterpolation("uniform")


VECTORS = [
    ("normals", add_normals, turn("normals", FRAMES[4]), MESH),
    ("normals that stand no more for vertices", add_normals, of_the_whole, MESH),
    ("normals over points that stay", add_normals, turn("normals", FRAMES[1], STILL), STILL),
    ("tangents", add_tangents, turn("primvars:tangents", FRAMES[4]), MESH),
    ("velocities", lambda stage: None, turn("velocities", FRAMES[4]), MESH),
]


def test_chunks_of_another_stage(shot, tmp_path):
    """It has as many frames, and no mesh is in both."""
    stage, other = stages.new_stage(), "/World/prop/other_GEO"
    stages.add_patch(stages.add_mesh(stage, stages.grid(), other, frames=FRAMES, rest="Pref"), stages.annulus())
    first, second = tmp_path / "1.usdc", tmp_path / "2.usdc"
    bake_to_file(shot, first, chunk="1/2")
    bake_to_file(stages.save(stage, tmp_path / "other.usda"), second, chunk="2/2")
    said = refused([first, second], tmp_path, f"{MESH}: {first} and {second} were baked from stages of other meshes")
    assert len(said.splitlines()) == 1


@pytest.mark.parametrize(("begin", "edit", "where"), [row[1:] for row in VECTORS], ids=[row[0] for row in VECTORS])
def test_chunks_of_other_vectors(begin, edit, where, tmp_path):
    shot = saved_shot(tmp_path / "shot.usda", begin)
    (first,) = ranges(shot, tmp_path, "1001-1004")
    saved_shot(shot, both(begin, edit))
    (second,) = ranges(shot, tmp_path, "1005-1008")
    what = "were baked from other normals, velocities or other vectors"
    refused([first, second], tmp_path, f"{where}: {first} and {second} {what}")


@pytest.mark.parametrize("diagnostics", [True, False])
def test_chunks_of_other_texture_coordinates(diagnostics, tmp_path):
    """They are read only for diagnostics."""
    shot, first, second = saved_shot(tmp_path / "shot.usda", add_st), tmp_path / "1.usdc", tmp_path / "2.usdc"
    bake_to_file(shot, first, chunk="1/2", diagnostics=diagnostics)
    saved_shot(shot, both(add_st, move_st))
    bake_to_file(shot, second, chunk="2/2", diagnostics=diagnostics)
    if diagnostics:
        what = "were baked from other texture coordinates"
        refused([first, second], tmp_path, f"{MESH}: {first} and {second} {what}")
    else:
        stitch([first, second], tmp_path / "out.usdc")
    assert bake_to_file(shot, first, chunk="1/2", diagnostics=diagnostics, resume=True).resumed != diagnostics


def test_chunks_of_other_options(shot, tmp_path):
    bake_to_file(shot, tmp_path / "a.usdc", frames="1001-1004", diagnostics=True)
    bake_to_file(shot, tmp_path / "b.usdc", frames="1005-1008")
    refused([tmp_path / "a.usdc", tmp_path / "b.usdc"], tmp_path, "were baked with another option diagnostics")
    bake_to_file(shot, tmp_path / "a.usdc", frames="1001-1004", max_folded=0)
    stitch([tmp_path / "a.usdc", tmp_path / "b.usdc"], tmp_path / "out.usdc")


def test_parts_of_other_frames(shot, tmp_path):
    bake_to_file(shot, tmp_path / "a.usdc", chunk="1/2")
    bake_to_file(shot, tmp_path / "b.usdc", chunk="2/2", frames="1001-1006")
    refused([tmp_path / "a.usdc", tmp_path / "b.usdc"], tmp_path, "are parts of other frames")


def rewrite(path, edit):
    layer = Sdf.Layer.FindOrOpen(str(path))
    edit(layer)
    layer.Save()


def test_chunks_of_another_version(shot, tmp_path):
    chunks = ranges(shot, tmp_path, "1001-1004", "1005-1008")
    rewrite(chunks[1], lambda layer: replace(Record.read(layer), version="9.9").write(layer))
    refused(chunks, tmp_path, r"were baked by skinslide \S+ and 9\.9")


# ---- Which are whole ----


def test_a_chunk_that_is_not_finished(shot, tmp_path):
    """A bake that was killed leaves one beside its output, under another name."""
    chunks = ranges(shot, tmp_path, "1001-1004", "1005-1008")

    def forget(layer):
        layer.customLayerData = {}

    rewrite(chunks[1], forget)
    refused(chunks, tmp_path, f"{chunks[1]} does not say what it was baked from: it is not finished")


@pytest.mark.parametrize(
    ("member", "value"),
    [
        ("meshes", None),
        ("meshes", "words"),
        ("meshes", {"no prim": {"frames": Vt.DoubleArray(), "poses": Vt.Int64Array()}}),
        ("meshes", {MESH: "words"}),
        ("meshes", {MESH: {}}),
        ("meshes", {MESH: {"frames": Vt.StringArray(["words"]), "poses": Vt.Int64Array([1])}}),
        ("meshes", {MESH: {"frames": Vt.DoubleArray([1.0]), "poses": Vt.Int64Array()}}),
        ("options", None),
        ("options", 3),
        ("version", None),
        ("asked", None),
        ("wanted", "words"),
        ("before", "words"),
    ],
)
def test_a_record_that_is_damaged(member, value, shot, tmp_path):
    """It does not end in a traceback, and such a chunk is baked again."""
    chunks = ranges(shot, tmp_path, "1001-1004", "1005-1008")

    def damage(layer):
        data = dict(layer.customLayerData)
        told = {name: each for name, each in data["skinslide"].items() if name != member}
        layer.customLayerData = {"skinslide": told if value is None else {**told, member: value}}

    rewrite(chunks[1], damage)
    refused(chunks, tmp_path, f"{chunks[1]} says what it was baked from in a way that cannot be read")
    assert not bake_to_file(shot, chunks[1], frames="1005-1008", resume=True).resumed
    assert bake_to_file(shot, chunks[1], frames="1005-1008", resume=True).resumed


def test_a_chunk_of_a_record_to_come(shot, tmp_path):
    chunks = ranges(shot, tmp_path, "1001-1004", "1005-1008")

    def edit(layer):
        layer.customLayerData = {"skinslide": {**layer.customLayerData["skinslide"], "form": 2, "version": "9.9"}}

    rewrite(chunks[0], edit)
    refused(chunks, tmp_path, "baked by skinslide 9.9, whose record this one cannot read")


def test_a_chunk_without_some_of_its_frames(shot, tmp_path):
    chunks = ranges(shot, tmp_path, "1001-1004", "1005-1008")
    rewrite(chunks[1], lambda layer: layer.EraseTimeSample(f"{MESH}.points", 1006))
    refused(chunks, tmp_path, f"{MESH}: frame 1006: {chunks[1]} is not whole: it lacks frames 1006")


@pytest.mark.parametrize("extension", ["usda", "usdc"])
def test_a_truncated_chunk(extension, shot, tmp_path):
    whole, cut = tmp_path / f"a.{extension}", tmp_path / f"b.{extension}"
    bake_to_file(shot, whole, chunk="1/2")
    bake_to_file(shot, cut, chunk="2/2")
    content = cut.read_bytes()
    for length in [0, 1, 8, 100, *(len(content) * part // 8 for part in range(1, 8)), len(content) - 3]:
        cut.write_bytes(content[:length])
        refused([whole, cut], tmp_path, str(cut), (StageError, StageProblems, UsageError))
        bake_to_file(shot, cut, chunk="2/2", resume=True)
        assert text(cut) == text_of(content, cut)


def text_of(content: bytes, like) -> str:
    path = like.with_name(f"content{like.suffix}")
    path.write_bytes(content)
    return text(path)


# ---- Which need not be baked again ----


@pytest.fixture
def chunk(shot, tmp_path):
    path = tmp_path / "chunk.usdc"
    bake_to_file(shot, path, chunk="2/3", max_folded=4)
    return path


def resumed(shot, path, **options) -> bool:
    """Whether the chunk was left as it was."""
    before = path.stat().st_ino
    report = bake_to_file(shot, path, resume=True, **{"chunk": "2/3", "max_folded": 4, **options})
    assert report.resumed == (path.stat().st_ino == before) == (not report.meshes)
    return report.resumed


def test_a_whole_chunk_is_not_baked_again(shot, chunk):
    assert resumed(shot, chunk) and resumed(Usd.Stage.Open(str(shot)), chunk, jobs=2)


@pytest.mark.parametrize(
    "options",
    [
        {"chunk": "1/3"},
        {"max_folded": 3},
        {"max_stretch": 9.0},
        {"diagnostics": True},
        {"prims": MESH},
        {"frames": "1001-1003"},
    ],
)
def test_a_chunk_of_other_options_is_baked_again(options, shot, chunk):
    assert not resumed(shot, chunk, **options)


@pytest.mark.parametrize("edit", [paint, animate, move_rest, move_cache, turn_faces])
def test_a_chunk_of_something_else_is_baked_again(edit, shot, chunk):
    saved_shot(shot, edit)
    assert not resumed(shot, chunk)


@pytest.mark.parametrize("frame", FRAMES)
def test_a_chunk_of_another_pose_is_baked_again(frame, shot, chunk):
    """The pose of any frame of its own, or of one beside it, which velocities are made of."""

    def move(stage):
        points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
        points.Set(stages.vectors(np.array(points.Get(frame)) * 1.01), frame)

    held = record(chunk).frames
    saved_shot(shot, move)
    near = held[0] - 1 <= frame <= held[-1] + 1
    assert resumed(shot, chunk) == (not near and frame not in (FRAMES[0], FRAMES[4], FRAMES[-1]))


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize(("begin", "name"), [(add_normals, "normals"), (add_tangents, "primvars:tangents")])
def test_a_chunk_of_other_vectors_is_baked_again(begin, name, frame, tmp_path):
    shot, path = saved_shot(tmp_path / "shot.usda", begin), tmp_path / "chunk.usdc"
    bake_to_file(shot, path, chunk="2/3", max_folded=4)
    held = record(path).frames
    saved_shot(shot, both(begin, turn(name, frame)))
    assert resumed(shot, path) == (frame not in {*held, FRAMES[0], FRAMES[4], FRAMES[-1]})


def test_a_chunk_of_other_vectors_over_points_that_stay_is_baked_again(tmp_path):
    shot, path = saved_shot(tmp_path / "shot.usda", add_normals), tmp_path / "chunk.usdc"
    bake_to_file(shot, path, chunk="2/3", max_folded=4)
    assert resumed(shot, path)
    saved_shot(shot, both(add_normals, turn("normals", FRAMES[1], STILL)))
    assert not resumed(shot, path)


def test_a_chunk_of_vectors_that_cannot_be_recomputed_is_whole(tmp_path):
    """There are too few of them at a frame."""

    def shorten(stage):
        stage.GetPrimAtPath(MESH).GetAttribute("velocities").Set(stages.vectors(np.zeros((5, 3))), FRAMES[4])

    shot, path = saved_shot(tmp_path / "shot.usda", shorten), tmp_path / "chunk.usdc"
    bake_to_file(shot, path, chunk="2/3", max_folded=4)
    assert record(path).frames and resumed(shot, path)


def test_a_chunk_of_another_spline_is_baked_again(tmp_path):
    """The spline has its knots where they were, with other values."""

    def animate(*values):
        def edit(stage):
            spline = stages.linear_spline(dict(zip((FRAMES[0], FRAMES[3], FRAMES[-1]), values, strict=True)))
            name = f"skinSlide:{PATCH}:envelope"
            stage.GetPrimAtPath(MESH).CreateAttribute(name, Sdf.ValueTypeNames.Float).SetSpline(spline)

        return edit

    shot, path = saved_shot(tmp_path / "shot.usda", animate(1.0, 0.5, 1.0)), tmp_path / "chunk.usdc"
    bake_to_file(shot, path, chunk="2/3", max_folded=4)
    assert resumed(shot, path)
    saved_shot(shot, animate(1.0, 0.25, 1.0))
    assert not resumed(shot, path)


@pytest.mark.parametrize(
    "edit",
    [
        lambda stage: stage.SetTimeCodesPerSecond(30),
        lambda stage: stage.SetStartTimeCode(1000),
        lambda stage: UsdGeom.SetStageMetersPerUnit(stage, 1.0),
    ],
)
def test_a_chunk_of_another_clock_is_baked_again(edit, shot, chunk):
    assert resumed(shot, chunk)
    saved_shot(shot, edit)
    assert not resumed(shot, chunk)


def test_a_chunk_of_another_version_is_baked_again(shot, chunk):
    rewrite(chunk, lambda layer: replace(Record.read(layer), version="9.9").write(layer))
    assert not resumed(shot, chunk)


def test_pictures_are_not_resumed(shot, tmp_path):
    from skinslide import Pictures

    with pytest.raises(UsageError, match="without pictures"):
        bake_to_file(shot, tmp_path / "out.usdc", resume=True, also=[Pictures(tmp_path / "pictures")])


# ---- The command ----


def test_commands(shot, tmp_path, capfd):
    names = [str(tmp_path / f"{number}.usdc") for number in (1, 2)]
    for number, name in enumerate(names, 1):
        bake = ["bake", str(shot), "-o", name, "--chunk", f"{number}/2", "--resume"]
        assert main([*bake, "--quiet"]) == 0 and capfd.readouterr() == ("", "")
        assert main(bake) == 0
        said = capfd.readouterr().out.splitlines()
        assert said == [f"{name}: is whole already, and was not baked again"]
    assert main(["bake", str(shot), "-o", names[0], "--chunk", "3/2"]) == 2
    assert "must be from 1 to 2" in capfd.readouterr().err
    out = str(tmp_path / "out.usdc")
    assert main(["stitch", *names, "-o", out, "--json", "--frames", "1001:1008"]) == 0
    told = json.loads(capfd.readouterr().out)
    assert (told["output"], told["frames"], told["problems"]) == (out, FRAMES, [])
    assert main(["stitch", names[0], "-o", out, "--json"]) == 3
    (problem,) = json.loads(capfd.readouterr().out)["problems"]
    assert problem["frame"] == 1005 and names[0] in problem["message"]


def test_quiet_hides_no_warning(tmp_path, capfd):
    """A warning of what one chunk blocks."""

    def edit(stage):
        velocities = stage.GetPrimAtPath(MESH).GetAttribute("velocities")
        velocities.Set(stages.vectors(np.zeros((5, 3))), FRAMES[-1])

    shot = saved_shot(tmp_path / "shot.usda", edit)
    chunks = ranges(shot, tmp_path, "1001-1004", "1005-1008")
    capfd.readouterr()
    assert main(["stitch", *map(str, chunks), "-o", str(tmp_path / "out.usdc"), "--quiet"]) == 0
    printed = capfd.readouterr()
    assert printed.out == "" and printed.err.startswith(f"warning: {MESH}: velocities is blocked")
