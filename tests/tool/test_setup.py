"""`setup` writes a layer that sits on a stage and carries a patch."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom

import stages
from skinslide import setup_to_file
from skinslide.author.options import parse_faces
from skinslide.command.cli import main
from skinslide.problems import StageProblems, UsageError
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH


@pytest.fixture
def cache(tmp_path):
    """A published stage with a mesh, a subset and a painted primvar on it, in a folder of its own."""
    stage = stages.new_stage()
    stage.SetTimeCodesPerSecond(30)
    mesh = stages.add_mesh(stage, stages.grid())
    subset = UsdGeom.Subset.Define(stage, f"{MESH}/elbow")
    subset.CreateElementTypeAttr("face")
    subset.CreateIndicesAttr([7, 8, 13, 14])
    stages.set_primvar(mesh, "mask", Sdf.ValueTypeNames.FloatArray, "vertex", [1.0] * 14 + [0.0] * 35)
    stages.set_primvar(mesh, "blocked", Sdf.ValueTypeNames.FloatArray, "vertex", Sdf.ValueBlock())
    (tmp_path / "publish").mkdir()
    return stages.save(stage, tmp_path / "publish" / "cache.usda")


def patches(path) -> dict[str, list[int]]:
    (mesh,) = read_meshes(open_stage(path))[0]
    return {patch.name: patch.faces.tolist() for patch in mesh.patches}


@pytest.mark.parametrize("extension", ["skinslide", "usda", "usdc", "usd"])
def test_writes_a_layer_on_the_stage(extension, cache, tmp_path):
    output = tmp_path / f"shot.{extension}"
    report = setup_to_file(cache, output, MESH, "elbow_L", faces="0-2,6-8")
    assert not report.failed
    assert patches(output) == {"elbow_L": [0, 1, 2, 6, 7, 8]}
    stage = open_stage(output)
    assert stage.GetRootLayer().subLayerPaths[0].endswith("/publish/cache.usda")
    assert stage.GetTimeCodesPerSecond() == 30 and stage.GetFramesPerSecond() == 24
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (FRAMES[0], FRAMES[-1])
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 0.01
    assert stage.GetDefaultPrim().GetPath() == "/World"
    assert [each.name for each in tmp_path.iterdir() if each.name.startswith(".")] == []


def test_the_path_to_the_stage_is_relative(cache, tmp_path):
    setup_to_file(cache, tmp_path / "shot.skinslide", MESH, "elbow_L", faces="0-2")
    text = (tmp_path / "shot.skinslide").read_text()
    assert text.startswith("#usda 1.0") and "@./publish/cache.usda@" in text
    (tmp_path / "moved").mkdir()
    (tmp_path / "shot.skinslide").rename(tmp_path / "moved" / "shot.skinslide")
    (tmp_path / "publish").rename(tmp_path / "moved" / "publish")
    assert patches(tmp_path / "moved" / "shot.skinslide") == {"elbow_L": [0, 1, 2]}


def test_faces_of_a_subset(cache, tmp_path):
    setup_to_file(cache, tmp_path / "shot.usda", MESH, "elbow_L", subset="elbow")
    assert patches(tmp_path / "shot.usda") == {"elbow_L": [7, 8, 13, 14]}


def test_a_subset_of_the_patch_s_name_stays_the_source(cache, tmp_path):
    setup_to_file(cache, tmp_path / "shot.usda", MESH, "elbow", subset="elbow")
    assert patches(tmp_path / "shot.usda") == {"elbow": [7, 8, 13, 14]}
    assert "primvars" not in (tmp_path / "shot.usda").read_text()


def test_faces_of_a_primvar(cache, tmp_path):
    setup_to_file(cache, tmp_path / "shot.usda", MESH, "elbow_L", primvar="mask")
    assert patches(tmp_path / "shot.usda") == {"elbow_L": [0, 1, 2, 3, 4, 5]}


def test_a_new_patch_is_even(cache, tmp_path):
    output = tmp_path / "shot.usda"
    for patch, choice in {"one": {}, "two": dict(rule="fast")}.items():
        setup_to_file(cache, output, MESH, patch, faces="0-2", **choice)
    setup_to_file(cache, output, MESH, "two", faces="3")
    (mesh,) = read_meshes(open_stage(output))[0]
    assert {patch.name: patch.rule for patch in mesh.patches} == {"one": "even", "two": "fast"}


def test_settings(cache, tmp_path):
    output = tmp_path / "shot.usda"
    given = dict(holes="freeAll", interpolation="meanValue", grow=0.2, weight=0.25)
    setup_to_file(cache, output, MESH, "elbow_L", faces="14", **given)
    ((patch,),) = (mesh.patches for mesh in read_meshes(open_stage(output))[0])
    assert (patch.holes, patch.interpolation) == ("freeAll", "meanValue")
    assert patch.faces.tolist() == [8, 13, 14, 15, 20]
    assert patch.controls.weight.tolist() == [0.25] * 49


WEIGHTS = {
    "of the points of a subset of faces": (dict(pin="elbow"), {8, 9, 10, 15, 16, 17, 22, 23, 24}),
    "of points by a primvar": (dict(pin=["mask"]), set(range(14))),
    "of both": (dict(pin=["mask", "elbow"]), {*range(14), 15, 16, 17, 22, 23, 24}),
}


@pytest.mark.parametrize(("choice", "pinned"), WEIGHTS.values(), ids=WEIGHTS.keys())
@pytest.mark.parametrize("weight", [None, 0.5, "mask"])
def test_pins(choice, pinned, weight, cache, tmp_path):
    setup_to_file(cache, tmp_path / "shot.usda", MESH, "skin", faces="0-35", weight=weight, **choice)
    ((patch,),) = (mesh.patches for mesh in read_meshes(open_stage(tmp_path / "shot.usda"))[0])
    before = {None: [1.0] * 49, 0.5: [0.5] * 49, "mask": [1.0] * 14 + [0.0] * 35}[weight]
    assert patch.controls.weight.tolist() == [0.0 if v in pinned else before[v] for v in range(49)]


def test_again_adds_and_replaces(cache, tmp_path):
    output = tmp_path / "shot.skinslide"
    setup_to_file(cache, output, MESH, "elbow_L", faces="0-2")
    text = output.read_text().replace('over "World"', 'over "World" (\n    kind = "assembly"\n)', 1)
    output.write_text(text)
    setup_to_file(cache, output, MESH, "wrist_L", faces="30-32")
    setup_to_file(cache, output, MESH, "elbow_L", faces="1")
    assert patches(output) == {"elbow_L": [1], "wrist_L": [30, 31, 32]}
    assert open_stage(output).GetPrimAtPath("/World").GetMetadata("kind") == "assembly"


def test_another_file_is_replaced_only_by_force(cache, tmp_path):
    for output, text in ((tmp_path / "notes.usda", "#usda 1.0\n"), (tmp_path / "words.usda", "words")):
        output.write_text(text)
        with pytest.raises(UsageError, match="--force"):
            setup_to_file(cache, output, MESH, "elbow_L", faces="0-2")
        assert output.read_text() == text
        setup_to_file(cache, output, MESH, "elbow_L", faces="0-2", force=True)
        assert patches(output) == {"elbow_L": [0, 1, 2]}


def test_bakes(cache, tmp_path):
    output = tmp_path / "shot.skinslide"
    setup_to_file(cache, output, MESH, "elbow_L", faces="0-35")
    assert main(["bake", str(output), "-o", str(tmp_path / "slid.usda"), "--quiet"]) == 0
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "slid.usda"))
    assert layer.timeCodesPerSecond == 30
    assert layer.ListTimeSamplesForPath(f"{MESH}.points") == list(FRAMES)


FAULTS = {
    "no such face": (dict(faces="30-36"), "there is no face 36: the mesh has 36 faces"),
    "no such subset": (dict(subset="gone"), "there is no GeomSubset gone"),
    "no such primvar": (dict(primvar="gone"), "there is no primvar gone"),
    "no such pin": (
        dict(faces="0-2", pin="gone"),
        "there is neither a GeomSubset gone under the mesh nor a primvar gone on it",
    ),
    "pin by corner": (dict(faces="0-2", pin="st"), "is texCoord2f[]"),
    "no such weight": (dict(faces="0-2", weight="gone"), "there is no primvar gone"),
    "all free by a rule in the plane": (dict(faces="0-2", rule="unit", holes="freeAll"), "needs rule relaxed or even"),
    "pin without a value": (dict(faces="0-2", pin="blocked"), "primvars:blocked has no value"),
    "weight without a value": (dict(faces="0-2", weight="blocked"), "primvars:blocked has no value"),
    "primvar without a value": (dict(primvar="blocked"), "primvars:blocked has no value"),
    "primvar of another kind": (dict(primvar="st"), "is texCoord2f[]"),
    "pinched": (dict(faces="0,7,1,2,8"), None),
}


@pytest.mark.parametrize(("choice", "message"), FAULTS.values(), ids=FAULTS.keys())
def test_a_patch_that_could_not_be_slid_is_not_written(choice, message, cache, tmp_path):
    stage = Usd.Stage.Open(str(cache))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH))
    stages.set_primvar(mesh, "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", [(0, 0)] * 49)
    stage.GetRootLayer().Save()
    output = tmp_path / "shot.usda"
    if message is None:
        choice, message = dict(faces=",".join(map(str, pinched_faces())), rule="unit"), "touches itself"
    with pytest.raises(StageProblems, match=message.replace("[", r"\[")) as raised:
        setup_to_file(cache, output, MESH, "elbow_L", **choice)
    assert all(problem.prim == MESH and problem.patch == "elbow_L" for problem in raised.value.problems)
    assert not output.exists()


def pinched_faces() -> np.ndarray:
    """Faces 1, 2, 6, 8, 12, 13, 14 of a 6 x 6 grid: the pinched block of 3 x 3 at its corner."""
    columns, rows = stages.pinched() % 3, stages.pinched() // 3
    return rows * 6 + columns


@pytest.mark.parametrize(
    ("prim", "message"),
    [("/World/gone", "there is no such prim"), ("/World/char", "is a Xform, not a Mesh"), ("/World", "is a Xform")],
)
def test_prim_that_is_no_mesh(prim, message, cache, tmp_path):
    with pytest.raises(StageProblems, match=f"{prim}: patch elbow_L: {message}"):
        setup_to_file(cache, tmp_path / "shot.usda", prim, "elbow_L", faces="0")


@pytest.mark.parametrize("whole", [False, True])
def test_a_fault_of_an_older_patch_is_a_warning(whole, tmp_path, capfd):
    """The new one is written, and nothing is called an error where the command has done what it was asked for."""
    stage = stages.new_stage()
    mesh = stages.add_mesh(stage, stages.grid())
    mesh.GetPointsAttr().Set(stages.vectors(2 * stages.grid().points), FRAMES[-1])
    stages.add_patch(mesh, np.arange(20, 30), "old")
    mesh.GetPrim().CreateAttribute("skinSlide:old:holes", Sdf.ValueTypeNames.Token, False).Set("open")
    cache, output = stages.save(stage, tmp_path / "cache.usda"), tmp_path / "shot.usda"
    words = ["--whole"] if whole else ["--patch", "elbow_L", "--faces", "0-2"]
    assert main(["setup", str(cache), "-o", str(output), "--prim", MESH, *words]) == 0
    said = capfd.readouterr().out
    assert f"warning: {MESH}: patch old: stops every bake of the mesh: skinSlide:old:holes is 'open'" in said
    assert "error" not in said
    assert main(["bake", str(output), "-o", str(tmp_path / "slid.usda")]) == 3


USAGE = {
    "input is output": dict(output="publish/cache.usda"),
    "extension": dict(output="shot.txt"),
    "missing folder": dict(output="gone/shot.usda"),
    "patch name": dict(patch="elbow L"),
    "reserved patch name": dict(patch="live"),
    "prim path": dict(prim="World/char"),
    "faces: words": dict(faces="all"),
    "faces: backwards": dict(faces="9-3"),
    "faces: empty": dict(faces=""),
    "pin: empty": dict(pin=""),
    "weight: empty": dict(weight=""),
    "rule": dict(rule="stiff"),
    "holes": dict(holes="open"),
    "interpolation": dict(interpolation="cubic"),
    "frames without whole": dict(frames="1001"),
    "grow": dict(grow="-1"),
}


@pytest.mark.parametrize("change", USAGE.values(), ids=USAGE.keys())
def test_bad_usage(change, cache, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    before = cache.read_bytes()
    arguments = {"output": "shot.usda", "prim": MESH, "patch": "elbow_L", "faces": "0-2", **change}
    options = [word for name, value in arguments.items() for word in (f"--{name}", value)]
    assert main(["setup", "publish/cache.usda", *options]) == 2
    assert capfd.readouterr().err.splitlines()[-1].startswith("error: ")
    assert cache.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["publish"]


@pytest.mark.parametrize(
    ("choice", "what"),
    [
        (dict(faces="0-2", pin=["mask", ""]), "a pin"),
        (dict(whole=True, pin=""), "a pin"),
        (dict(faces="0-2", weight=""), "a primvar"),
        (dict(primvar=""), "a primvar"),
        (dict(subset=""), "a GeomSubset"),
        (dict(joint=["arm", ""]), "a joint"),
    ],
)
def test_an_empty_name(choice, what, cache, tmp_path):
    with pytest.raises(UsageError, match=f"^the name of {what} is empty$"):
        setup_to_file(cache, tmp_path / "shot.usda", MESH, "elbow_L", **choice)
    assert not (tmp_path / "shot.usda").exists()


def test_a_set_up_cannot_sit_on_a_set_up(cache, tmp_path, capfd):
    setup_to_file(cache, tmp_path / "shot.skinslide", MESH, "elbow_L", faces="0-2")
    options = ["--prim", MESH, "--patch", "two", "--faces", "3"]
    assert main(["setup", str(tmp_path / "shot.skinslide"), "-o", str(tmp_path / "more.skinslide"), *options]) == 2
    assert "give the stage that it sits on" in capfd.readouterr().err


def test_parse_faces():
    assert parse_faces("0-120, 140,7:9") == [(0, 120), (140, 140), (7, 9)]


# ---- Several at once ----


@pytest.mark.parametrize("extension", ["skinslide", "usdc"])
def test_no_patch_is_lost_by_set_ups_at_once(extension, cache, tmp_path):
    """Processes wait for each other before each writes its patch into one file, which none has made yet."""
    output, count = tmp_path / f"patches.{extension}", 3
    code = """
        import sys, skinslide
        from skinslide.author import layer
        write, first = layer._write, [True]
        def when_all_have_read(*arguments):
            if first:
                first.clear()
                print("read", flush=True)
                sys.stdin.readline()
            write(*arguments)
        layer._write = when_all_have_read
        cache, output, mesh, patch, faces = sys.argv[1:]
        skinslide.setup_to_file(cache, output, mesh, patch, faces=faces)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(cache), str(output), MESH]
    chosen = {f"patch{i}": list(range(6 * i, 6 * i + 3)) for i in range(count)}
    started = [
        subprocess.Popen(
            [*command, patch, ",".join(map(str, faces))], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        for patch, faces in chosen.items()
    ]
    for process in started:
        assert process.stdout.readline() == "read\n"
    for process in started:
        process.stdin.write("go\n")
        process.stdin.flush()
    for process in started:
        process.communicate(timeout=60)
        assert process.returncode == 0
    assert patches(output) == chosen
    assert [path for path in tmp_path.iterdir() if path.name.startswith(".")] == []
