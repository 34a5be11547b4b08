"""The command as a whole: help, versions, exit codes, one JSON document, interruptions."""

import json
import subprocess
import sys

import pytest
from pxr import Sdf

import skinslide
import stages
from skinslide import cli
from stages import FRAMES, MESH, PATCH


@pytest.fixture
def shot(tmp_path):
    stage, _mesh = stages.patched_stage()
    return stages.save(stage, tmp_path / "shot.usda")


def test_version(capsys):
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out == f"skinslide {skinslide.__version__}\n"


@pytest.mark.parametrize("command", ["bake", "check", "setup"])
def test_help_names_every_option_and_exit_code(command, capsys):
    assert cli.main([command, "--help"]) == 0
    said = capsys.readouterr().out
    assert "STAGE" in said and "exit codes: 0 done, 1 failed, 2" in said


@pytest.mark.parametrize("arguments", ["", "slide", "bake", "bake shot.usda", "check shot.usda --fast"])
def test_usage(arguments, capsys):
    assert cli.main(arguments.split()) == 2
    assert "usage: skinslide" in capsys.readouterr().err


def test_bake_writes_and_reports(shot, tmp_path, capsys):
    output = tmp_path / "out.usda"
    assert cli.main(["bake", str(shot), "-o", str(output), "--frames", "1001,1002:1003x0.5"]) == 0
    assert Sdf.Layer.FindOrOpen(str(output)).ListTimeSamplesForPath(f"{MESH}.points") == [1001, 1002, 1002.5, 1003]
    said = capsys.readouterr().out
    assert PATCH in said and f"{output}: written" in said


def test_bake_json_is_one_document(shot, tmp_path, capsys):
    assert cli.main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["meshes"][0]["frames"] == list(FRAMES)


def test_quiet_prints_nothing(shot, tmp_path, capfd):
    assert cli.main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("raised", "code", "message"),
    [(KeyboardInterrupt(), 130, "interrupted"), (SystemExit(143), 143, "signal"), (MemoryError(), 1, "out of memory")],
)
def test_what_ends_a_command_early(raised, code, message, shot, tmp_path, monkeypatch, capsys):
    def end(*_arguments, **_options):
        raise raised

    monkeypatch.setattr("skinslide.meshes.SlidMesh.points_at", end)
    output = tmp_path / "out.usda"
    assert cli.main(["bake", str(shot), "-o", str(output), "--quiet"]) == code
    assert message in capsys.readouterr().err
    assert sorted(each.name for each in tmp_path.iterdir()) == ["shot.usda"]


def test_runs_as_a_module(shot):
    run = subprocess.run([sys.executable, "-m", "skinslide", "check", str(shot)], capture_output=True, text=True)
    assert run.returncode == 0 and MESH in run.stdout


def test_a_closed_pipe_is_no_traceback(shot):
    command = f"'{sys.executable}' -m skinslide check '{shot}' | true"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert "Traceback" not in run.stderr
