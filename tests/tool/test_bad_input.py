"""Stages and arguments that the command refuses, and what it says; what readers say of a mesh is in tests/stage."""

import json
import subprocess
import sys

import numpy as np
import pytest
from pxr import Sdf, Usd

import skinslide
import stages
from skinslide import StageError
from skinslide.command.cli import main
from stages import FRAMES, MESH, PATCH


@pytest.mark.parametrize("name", [PATCH, "n" * 300, "\u00e9l\u00e8ve_" * 40])
def test_a_bad_piece_names_its_patch(name, tmp_path, capfd):
    stage, mesh = stages.patched_stage()
    pinched = np.array([1, 2, 6, 8, 12, 13, 14])
    stages.add_patch(mesh, np.append(pinched, stages.block(6, range(4, 6), range(4, 6))), name)
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda")), "--json"]) == 3
    (problem,) = [each for each in json.loads(capfd.readouterr().out)["problems"] if each["severity"] == "error"]
    assert problem["patch"] == name and problem["message"].startswith("piece 1 of 2: ")


def test_a_value_that_usd_cannot_read(tmp_path, capfd):
    """The numbers of a sample in a crate file are overwritten."""
    stage, mesh = stages.patched_stage(stages.grid(16, 16))
    path = stages.save(stage, tmp_path / "shot.usdc")
    sample = np.array(mesh.GetPointsAttr().Get(FRAMES[1])).tobytes()
    damaged = bytearray(path.read_bytes())
    at = damaged.index(sample)
    damaged[at - 8 : at] = b"\xff" * 8  # the count of points before them
    path.write_bytes(damaged)
    for command in (["check", str(path)], ["bake", str(path), "-o", str(tmp_path / "out.usda")]):
        assert main(command) == (3 if command[0] == "check" else 1)
        said = "".join(capfd.readouterr())
        assert f"error: {MESH}: frame 1002: points cannot be read: " in said and "Traceback" not in said


def test_every_bad_patch_is_named(tmp_path, capfd):
    stage, mesh = stages.patched_stage(stages.grid(3, 3), stages.pinched())
    stages.add_patch(mesh, None, "wrist_L")
    stages.add_patch(mesh, np.arange(9), "knee_L")
    stages.set_property(mesh, "corners", [0, 3, 15, 5], patch="knee_L")
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    said = capfd.readouterr().out
    for patch in (PATCH, "wrist_L", "knee_L"):
        assert f"error: {MESH}: patch {patch}: " in said


def test_nothing_to_slide_says_how_to_start(tmp_path, capfd):
    stage = stages.new_stage()
    stages.add_mesh(stage, stages.grid())
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    assert "skinslide setup" in capfd.readouterr().out


@pytest.mark.parametrize(("name", "text"), [("gone.usda", None), ("text.usda", "words"), ("text.skinslide", "words")])
def test_stage_that_does_not_open(name, text, tmp_path, capfd):
    path = tmp_path / name
    if text:
        path.write_text(text)
    for command in (["check", str(path)], ["bake", str(path), "-o", str(tmp_path / "out.usda")]):
        assert main(command) == 1
        assert f"error: cannot open {path}: " in capfd.readouterr().err


def test_a_stage_that_is_a_link_in_a_circle(tmp_path, capfd):
    (tmp_path / "circle.usda").symlink_to("circle.usda")
    assert main(["check", str(tmp_path / "circle.usda")]) == 1
    assert "circle.usda: Too many levels of symbolic links" in capfd.readouterr().err


@pytest.mark.parametrize("rate", ["0", "inf", "nan"])
@pytest.mark.parametrize("arc", ["root", "sublayer", "reference"])
def test_a_clock_that_stands_still(arc, rate, tmp_path):
    """USD would count the samples of a cache for ever, so another process looks."""
    stages.save(stages.patched_stage()[0], tmp_path / "cache.usda")
    still = f"#usda 1.0\n(\n    timeCodesPerSecond = {rate}\n    subLayers = [@./cache.usda@]\n)\n"
    (tmp_path / "still.usda").write_text(still)
    clock = "#usda 1.0\n(\n    timeCodesPerSecond = 24\n"
    (tmp_path / "sublayer.usda").write_text(f"{clock}    subLayers = [@./still.usda@]\n)\n")
    reference = 'def "World" (\n    references = @./still.usda@</World>\n)\n{\n}\n'
    (tmp_path / "reference.usda").write_text(f"{clock})\n{reference}")
    top = tmp_path / ("still.usda" if arc == "root" else f"{arc}.usda")
    command = [sys.executable, "-m", "skinslide", "bake", str(top), "-o", str(tmp_path / "out.usda")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert done.stderr.startswith("error: cannot read ")
    assert done.stderr.endswith(f"still.usda: timeCodesPerSecond is {rate}, and another layer's is not\n")


def test_an_open_stage_whose_clock_stands_still(tmp_path):
    cache = stages.save(stages.patched_stage()[0], tmp_path / "cache.usda")
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().subLayerPaths.append(str(cache))
    stage.SetTimeCodesPerSecond(0)
    for function in (skinslide.check, skinslide.bake):
        with pytest.raises(StageError, match="timeCodesPerSecond is 0, and another layer's is not"):
            function(stage)


def test_no_name_of_a_prim(tmp_path, capfd):
    path = stages.save(stages.patched_stage()[0], tmp_path / "shot.usda")
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda"), "--prim", ""]) == 3
    said = capfd.readouterr().err
    assert said == "error: an empty name is not the path of a prim, such as /World/char/geo\n"


@pytest.mark.parametrize("at", [b"def Xform", b'"World"', b"skin_GEO", b'"none"', b"elbow_L", b"uniform"])
@pytest.mark.parametrize("name", ["shot.usda", "shot.skinslide", "shot.usdc"])
def test_a_byte_that_is_not_utf_8(at, name, tmp_path, capfd):
    """Wherever it is: one line, and one document. A crate file may hold it where nobody looks."""
    stages.save(stages.patched_stage()[0], tmp_path / f"good.{'usdc' if name.endswith('c') else 'usda'}").rename(
        tmp_path / name
    )
    good = (tmp_path / name).read_bytes()
    bad = at.strip(b'"')
    (tmp_path / name).write_bytes(good.replace(bad, b"\xff" + bad[1:]))
    code = main(["check", str(tmp_path / name), "--json"])
    printed, said = capfd.readouterr()
    json.loads(printed)
    assert "Traceback" not in said
    if not name.endswith("usdc"):
        assert code == 1 and len(said.splitlines()) == 1 and said.startswith("error: cannot open")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("words", "it is not USDA text: the first line must be #usda 1.0"),
        ("#usda 1.0\n\0", "it is not USDA text: it holds a zero byte"),
        ("#usda 1.0\n" + 'over "a" {\n' * 20000, "it nests brackets more than 500 deep, in line 502"),
    ],
)
def test_text_that_usd_cannot_be_given(text, message, tmp_path):
    """In a process of its own, which USD's parser would end."""
    path = tmp_path / "x.skinslide"
    path.write_text(text)
    done = subprocess.run([sys.executable, "-m", "skinslide", "check", str(path)], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr == f"error: cannot open {path}: {message}\n"


def test_weight_out_of_range_is_clamped_and_told(tmp_path, capfd):
    stage, mesh = stages.patched_stage()
    weight = [1.0] * 12 + [1.5] + [1.0] * 36
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", Sdf.ValueTypeNames.FloatArray, "vertex", weight)
    path = stages.save(stage, tmp_path / "shot.usda")
    assert main(["check", str(path)]) == 0
    assert f"warning: {MESH}: patch {PATCH}: weight of vertex 12 is 1.5" in capfd.readouterr().out
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda")]) == 0
    assert "outside 0..1" in capfd.readouterr().out


USAGE = {
    "frames: empty": ["--frames", ""],
    "frames: words": ["--frames", "all"],
    "frames: zero step": ["--frames", "1:9x0"],
    "lookup: no such device": ["--lookup", "egl", "--egl-device", "999"],
    "lookup: device of no number": ["--egl-device", "first"],
    "lookup: resolution above any device's": ["--lookup", "egl", "--egl-resolution", "1000000"],
    "lookup: unknown": ["--lookup", "guess"],
    "jobs: none": ["--jobs", "0"],
    "limit: negative": ["--max-folded", "-1"],
    "output: missing folder": ["-o", "gone/out.usda"],
    "output: extension": ["-o", "out.abc"],
    "output: input": ["-o", "shot.usda"],
    "output: folder": ["-o", "folder.usda"],
}


@pytest.mark.parametrize("arguments", USAGE.values(), ids=USAGE.keys())
def test_bad_usage(arguments, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    stage, _mesh = stages.patched_stage()
    path = stages.save(stage, tmp_path / "shot.usda")
    before = path.read_bytes()
    (tmp_path / "folder.usda").mkdir()
    output = [] if "-o" in arguments else ["-o", "out.usda"]
    assert main(["bake", "shot.usda", *output, *arguments]) == 2
    assert "error: " in capfd.readouterr().err
    assert path.read_bytes() == before
    assert sorted(each.name for each in tmp_path.iterdir()) == ["folder.usda", "shot.usda"]


def test_input_is_a_sublayer_of_the_stage(tmp_path, capfd):
    stage, _mesh = stages.patched_stage()
    cache = stages.save(stage, tmp_path / "cache.usda")
    (tmp_path / "shot.usda").write_text("#usda 1.0\n(\n    subLayers = [@./cache.usda@]\n)\n")
    before = cache.read_bytes()
    assert main(["bake", str(tmp_path / "shot.usda"), "-o", str(cache)]) == 2
    assert str(cache) in capfd.readouterr().err
    assert cache.read_bytes() == before


def test_read_only_folder(public_folder, capfd):
    stage, _mesh = stages.patched_stage()
    path = stages.save(stage, public_folder / "shot.usda")
    folder = public_folder / "locked"
    folder.mkdir(mode=0o555)
    with stages.as_nobody():
        assert main(["bake", str(path), "-o", str(folder / "out.usda")]) == 2
    assert "not writable" in capfd.readouterr().err
