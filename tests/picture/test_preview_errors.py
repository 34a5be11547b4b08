"""Previews that cannot be, and what is left of those that were ended."""

import io
import json
import math
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import UsdGeom

import skinslide
import stages
from sheets import NAME, SIZE, add_st, draw, picture, sheet
from skinslide.command.cli import main
from stages import PATCH


def test_the_command_reports(shot, tmp_path, capfd):
    out = str(tmp_path / "out")
    assert main(["preview", str(shot), "-o", out, "--frames", "1003", "--size", "64x32", "--json", "--quiet"]) == 0
    told = json.loads(capfd.readouterr().out)
    assert sorted(os.listdir(out)) == sorted(os.path.basename(file) for file in told["files"])
    assert told["device"] and told["meshes"][0]["patches"][0]["frames"][0]["frame"] == 1003


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--camera", "/World/char", "--follow"], "does not follow"),
        (["--size", "0x10"], "width is 0"),
        (["--size", "20000x20000"], "20000 by 20000 pixels"),
        (["--size", "ten"], "not a size such as 1920x1080"),
        (["--squares", "-1"], "squares is -1"),
        (["--squares", "1e39"], "squares is 1e+39"),
        (["--stretch-scale", "nan"], "--stretch-scale is nan"),
        (["--stretch-scale", "1e-38"], "--stretch-scale is 1e-38"),
        (["--view", "wire"], "invalid choice"),
        (["--st", ""], "st: the name of the primvar with texture coordinates is empty"),
    ],
)
def test_usage(words, message, shot, tmp_path, capfd):
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), *words]) == 2
    assert message in capfd.readouterr().err
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


@pytest.mark.parametrize("rate", [0.0, -24.0, math.nan])
def test_a_stage_that_cannot_be_played_has_no_page(rate, tmp_path, capfd):
    stage, _mesh = sheet()
    stage.SetTimeCodesPerSecond(rate)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    words = ["--size", "64x32", "--frames", "1002", "-o", str(tmp_path / "out")]
    assert main(["preview", path, *words, "--html", str(tmp_path / "page.html")]) == 3
    assert f"error: the stage has {rate:g} time codes per second" in capfd.readouterr().err
    assert not (tmp_path / "out").exists() and not (tmp_path / "page.html").exists()
    assert main(["preview", path, *words]) == 0


@pytest.mark.parametrize("size", [0, 64, (64, 32, 3), "64x32"])
def test_what_is_no_size(size, shot, tmp_path):
    with pytest.raises(skinslide.UsageError, match=r"size is .*; it must be a width and a height"):
        draw(shot, tmp_path / "out", size=size)


def test_no_views(shot, tmp_path):
    with pytest.raises(skinslide.UsageError, match="views: there are none"):
        draw(shot, tmp_path / "out", views=[])


def test_neither_folder_nor_page(shot, capfd):
    assert main(["preview", str(shot)]) == 2
    assert "no folder for pictures (-o) and no page (--html)" in capfd.readouterr().err


def test_a_page_that_cannot_be(shot, tmp_path, capfd):
    for page in (tmp_path / "page.txt", tmp_path / "none" / "page.html", shot.with_suffix(".html") / "page.html"):
        assert main(["preview", str(shot), "--html", str(page), "--size", "64x32"]) == 2
        assert f"output {page}: " in capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--camera", "/World/none"], f"{stages.MESH}: patch {PATCH}: camera /World/none: there is no such prim"),
        (["--camera", "World"], f"patch {PATCH}: camera World: there is no such prim"),
        (["--camera", "/World/char"], f"patch {PATCH}: camera /World/char: is a Xform, not a Camera"),
        (["--patch", "knee"], f"patch knee: no mesh has it; there is {PATCH}"),
    ],
)
def test_what_the_stage_lacks(words, message, shot, tmp_path, capfd):
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), *words]) == 3
    assert message in capfd.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be(shot, tmp_path, capfd):
    (tmp_path / "file").write_text("")
    for folder, code in ((tmp_path / "file", 2), (tmp_path / "file" / "below", 2), ("/proc/none", 1)):
        assert main(["preview", str(shot), "-o", str(folder)]) == code
        assert f"output {folder}: " in capfd.readouterr().err


def test_a_folder_without_a_name(shot, tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for words in (["preview", "--size", "64x32"], ["maps", "--size", "8"]):
        assert main([*words, str(shot), "-o", ""]) == 2
        assert capfd.readouterr().err == "error: folder is an empty name\n"
    assert os.listdir(tmp_path) == [shot.name]


def test_a_link_to_a_folder_that_is_not_there_yet(shot, tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "pictures")
    draw(shot, tmp_path / "link", frames="1003")
    assert picture(tmp_path / "disk" / "pictures").shape == (SIZE[1], SIZE[0], 3)


def test_a_page_in_the_folder_of_the_pictures(shot, tmp_path):
    """The folder is made for both."""
    draw(shot, tmp_path / "out", frames="1003", html=tmp_path / "out" / "page.html")
    assert sorted(os.listdir(tmp_path / "out")) == ["contact_sheet.1003.png", "page.html", f"{NAME}.chequer.1003.png"]


def test_a_name_that_is_too_long(tmp_path, capfd):
    """For a file of a folder that is not there yet."""
    stage, _mesh = sheet()
    path = f"{stages.MESH}{'x' * 250}"
    other = stages.add_mesh(stage, stages.grid(), path)
    stages.add_patch(other, stages.grid().all_faces)
    add_st(other, stages.grid())
    shot, out = str(stages.save(stage, tmp_path / "shot.usda")), tmp_path / "out"
    for words in (["preview", "--size", "64x32"], ["maps", "--size", "8"]):
        assert main([*words, shot, "-o", str(out)]) == 2
        said = capfd.readouterr().err
        assert said.startswith(f"error: output {out / Path(path).name}.") and said.endswith("the name is too long\n")
    assert not out.exists()


def test_an_unwritable_folder(public_folder, capfd):
    path = str(stages.save(sheet()[0], public_folder / "shot.usda"))
    closed = public_folder / "closed"
    closed.mkdir(mode=0o555)
    with stages.as_nobody():
        assert main(["preview", path, "-o", str(closed)]) == 2
    assert f"output {closed}: is not writable" in capfd.readouterr().err


def test_a_patch_that_cannot_be_followed(tmp_path, capfd):
    """All of it is in one place at a frame."""
    stage, mesh = sheet()
    scale = UsdGeom.Xformable(mesh).AddScaleOp()
    scale.Set((1, 1, 1), 1002)
    scale.Set((0, 0, 0), 1003)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x32", "--follow"]) == 1
    assert f"error: {stages.MESH}: patch {PATCH}: frame 1003: no camera can have" in capfd.readouterr().err
    assert (tmp_path / "out" / f"{NAME}.chequer.1002.png").exists()


@pytest.mark.parametrize("name", [f"{NAME}.stretch.1003.png", "contact_sheet.png"])
def test_a_folder_in_the_way_of_a_picture(name, shot, tmp_path, capfd):
    """That is reported before a frame is slid."""
    (tmp_path / "out" / name).mkdir(parents=True)
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), "--size", "64x32"]) == 2
    assert f"output {tmp_path / 'out' / name}: is a folder" in capfd.readouterr().err
    assert os.listdir(tmp_path / "out") == [name]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "out"], "; every file in out is whole"),
        (["-o", "out", "--html", "page.html"], "; every file in out is whole"),
        (["--html", "page.html"], "; nothing was written"),
    ],
)
def test_an_interrupted_command_says_what_it_left(words, said, shot, tmp_path, capfd, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("skinslide.shot.loop.work_ahead", interrupt)
    assert main(["preview", str(shot), "--size", "64x32", *words]) == 130
    assert capfd.readouterr().err == f"error: interrupted{said}\n"
    assert not list(tmp_path.glob("**/.*")) and not (tmp_path / "page.html").exists()


def test_a_bad_frame_leaves_the_others_whole(tmp_path, capfd):
    stage, mesh = sheet()
    points = np.array(mesh.GetPointsAttr().Get(1003.0))
    points[312] = np.nan  # in the middle of the patch
    mesh.GetPointsAttr().Set(stages.vectors(points), 1003.0)
    out = tmp_path / "out"
    camera = UsdGeom.Camera.Define(stage, "/World/cam")
    camera.AddTranslateOp().Set((0, 0, 2))
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(out), "--size", "64x32", "--camera", "/World/cam"]) == 1
    assert f"{stages.MESH}: frame 1003: " in capfd.readouterr().err
    for file in out.iterdir():
        Image.open(io.BytesIO(file.read_bytes())).load()


@pytest.mark.parametrize(
    ("option", "place", "said"),
    [("-o", "out", "; every file in {} is whole"), ("--html", "page.html", "; nothing was written")],
)
def test_an_ended_command_says_what_there_is(option, place, said, tmp_path, shot):
    program = """
        import os, signal, sys
        from skinslide.command import cli, progress
        progress._lines = lambda: lambda done, total: os.kill(os.getpid(), signal.SIGTERM)
        sys.exit(cli.main(["preview", sys.argv[1], sys.argv[2], sys.argv[3], "--size", "64x32"]))
    """
    output = tmp_path / place
    command = [sys.executable, "-c", textwrap.dedent(program), str(shot), option, str(output)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 143
    assert done.stderr.endswith(f"ended by a signal{said.format(output)}\n")
    assert not output.is_file()


def test_a_fault_of_the_mesh_is_said_once(tmp_path):
    """And at which frame, though it is a camera of the whole shot that meets it, of either patch."""
    stage, mesh = sheet()
    stages.add_patch(mesh, stages.block(24, range(3, 6), range(3, 6)), "other")
    points = np.array(mesh.GetPointsAttr().Get(1003.0))
    points[104] = np.nan  # in the other patch alone
    mesh.GetPointsAttr().Set(stages.vectors(points), 1003.0)
    with pytest.raises(skinslide.StageProblems) as raised:
        draw(stage, tmp_path / "out")
    assert str(raised.value) == f"error: {stages.MESH}: frame 1003: points: vertex 104 is not finite: (nan, nan, nan)"


def test_no_egl(shot, tmp_path):
    """On a machine on which EGL has no vendor at all."""
    empty = tmp_path / "vendors"
    empty.mkdir()
    environment = {**os.environ, "__EGL_VENDOR_LIBRARY_DIRS": str(empty)}
    command = [sys.executable, "-m", "skinslide", "preview", str(shot), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "no EGL device with OpenGL ES 3" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_chequer_that_is_on_no_st_says_so_and_what_there_is(tmp_path):
    stage, mesh = sheet(st=False)
    add_st(mesh, stages.grid(24, 24), "map1")
    (note,) = draw(stage, tmp_path / "out").problems
    assert note.severity == "note" and note.message == (
        "there is no primvars:st, so the chequer is on positions at rest; for texture coordinates there are "
        "primvars:map1"
    )
    assert not draw(stage, tmp_path / "there", st="map1").problems
    assert not draw(stage, tmp_path / "stretch", views="stretch").problems
    with pytest.raises(skinslide.StageProblems, match=r"no primvars:uv to draw a chequer on; there are primvars:map1"):
        draw(stage, tmp_path / "none", st="uv")
    with pytest.raises(skinslide.StageProblems, match=r"in which its maps would be drawn; there are primvars:map1"):
        skinslide.maps(stage, tmp_path / "maps", size=8)
