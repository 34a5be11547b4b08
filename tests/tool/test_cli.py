"""The command as a whole: help, versions, exit codes, one JSON document, interruptions."""

import inspect
import json
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest
from pxr import Sdf

import skinslide
import stages
from skinslide import StageError, parse_frames
from skinslide.command import cli, outcome
from skinslide.shot.options import LayerOptions, MapOptions, PictureOptions, SlideOptions
from skinslide.shot.report import PatchReport
from stages import FRAMES, MESH, PATCH


@pytest.fixture
def shot(tmp_path):
    stage, _mesh = stages.patched_stage()
    return stages.save(stage, tmp_path / "shot.usda")


def test_version(capsys):
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out == f"skinslide {skinslide.__version__}\n"


@pytest.mark.parametrize("command", ["bake", "check", "setup", "paint", "mirror", "stitch"])
def test_help_names_every_option_and_exit_code(command, capsys):
    assert cli.main([command, "--help"]) == 0
    said = capsys.readouterr().out
    assert ("CHUNK" if command == "stitch" else "STAGE") in said and "exit codes: 0 done, 1 failed, 2" in said
    assert "130 interrupted" in said and "143 terminated" in said


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


def test_json_is_json_whatever_the_numbers(capsys):
    numbers = {"stretch": float("nan"), "frames": [1.5, float("inf"), (float("-inf"), 2)], "name": "nan"}
    outcome.print_result(outcome.as_json(numbers), 0)

    def refuse(constant: str) -> None:
        raise ValueError(constant)

    read = json.loads(capsys.readouterr().out, parse_constant=refuse)
    assert read == {"stretch": None, "frames": [1.5, None, [None, 2]], "name": "nan"}


@pytest.mark.parametrize("error", [MemoryError(), KeyboardInterrupt(), StageError("lost")])
def test_a_document_that_breaks_off_is_the_only_one(error, shot, tmp_path, capfd, monkeypatch):
    """It is printed as it is made, and what is printed cannot be taken back."""

    def fail(_report: PatchReport) -> None:
        raise error

    monkeypatch.setattr(PatchReport, "document", fail)
    output = tmp_path / "out.usda"
    assert cli.main(["bake", str(shot), "-o", str(output), "--json"]) == (
        outcome.INTERRUPTED if isinstance(error, KeyboardInterrupt) else outcome.FAILED
    )
    said = capfd.readouterr()
    assert said.out.startswith("{") and '"patches": ' in said.out and "problems" not in said.out
    with pytest.raises(json.JSONDecodeError):
        json.JSONDecoder().raw_decode(said.out)
    assert said.err.splitlines()[-1].startswith("error: ") and Sdf.Layer.FindOrOpen(str(output))


@pytest.mark.parametrize("word", ["--json", "--jso", "--js", "--json=1"])
def test_arguments_that_cannot_be_used_are_told_in_json_where_it_is_asked_for(word, capfd):
    assert cli.main(["bake", "shot.usda", word, "--frobnicate"]) == 2
    (problem,) = json.loads(capfd.readouterr().out)["problems"]
    assert problem["severity"] == "error"


FORGED = "\x1b[2J\nerror: forged\r\x9b1m\u202e\u2028"


@pytest.mark.parametrize("command", ["check", "setup", "stitch", "bake", FORGED])
def test_names_cannot_forge_lines(command, tmp_path, monkeypatch, capfd):
    """Names of files, patches, prims and commands may hold control characters."""
    monkeypatch.chdir(tmp_path)
    stage, mesh = stages.patched_stage()
    mesh.GetPrim().AddAppliedSchema(f"SkinSlideAPI:{FORGED}")
    shot = "shot.usda" if command == "setup" else f"shot{FORGED}.usda"  # no layer can name such a file
    stage.GetRootLayer().Export(shot)
    words = {
        "setup": ["-o", f"{FORGED}.usda", "--prim", MESH + FORGED, "--patch", FORGED, "--faces", FORGED],
        "bake": ["-o", f"{FORGED}/out.usda"],
        "stitch": ["-o", "out.usda"],
    }
    assert cli.main([command, shot, *words.get(command, [])]) != 0
    printed = "".join(capfd.readouterr())
    assert "\\x1b[2J\\nerror: forged\\r\\x9b1m\\u202e\\u2028" in printed
    assert all(c == "\n" or c.isprintable() for c in printed)
    assert not any(line.startswith("error: forged") for line in printed.splitlines())


def test_what_was_written_is_one_line(shot, tmp_path, capfd):
    output = tmp_path / f"{FORGED}.usda"
    assert cli.main(["setup", str(shot), "-o", str(output), "--prim", MESH, "--patch", "more", "--faces", "0-3"]) == 0
    assert cli.main(["bake", str(shot), "-o", str(output.with_name(f"out{output.name}"))]) == 0
    said = capfd.readouterr().out
    assert "\x1b" not in said and "\nerror: forged" not in said and said.count("\\nerror: forged") == 3


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

    monkeypatch.setattr("skinslide.stage.mesh.PatchedMesh.points_at", end)
    output = tmp_path / "out.usda"
    assert cli.main(["bake", str(shot), "-o", str(output), "--quiet"]) == code
    said = capsys.readouterr().err
    assert message in said and (code == 1 or "nothing was written" in said)
    assert sorted(each.name for each in tmp_path.iterdir()) == ["shot.usda"]


@pytest.mark.parametrize("raised", [KeyboardInterrupt(), SystemExit(143)])
def test_an_interruption_after_the_output_is_in_place(raised, shot, tmp_path, monkeypatch, capsys):
    def end(_report):
        raise raised

    monkeypatch.setattr("skinslide.shot.report.BakeReport.text", end)
    output = tmp_path / "out.usda"
    for _ in range(2):  # also where there was one before
        assert cli.main(["bake", str(shot), "-o", str(output)]) in (130, 143)
        assert f"after {output} was written" in capsys.readouterr().err


def test_runs_as_a_module(shot):
    run = subprocess.run([sys.executable, "-m", "skinslide", "check", str(shot)], capture_output=True, text=True)
    assert run.returncode == 0 and MESH in run.stdout


def test_a_closed_pipe_is_no_traceback(shot):
    command = f"'{sys.executable}' -m skinslide check '{shot}' | true"
    run = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert "Traceback" not in run.stderr


# ---- Arguments ----


@pytest.mark.parametrize("function", [skinslide.bake, skinslide.bake_to_file, skinslide.preview, skinslide.maps])
def test_functions_have_the_defaults_of_the_options(function):
    tables = [SlideOptions, *([LayerOptions] if function.__name__.startswith("bake") else [])]
    parameters = inspect.signature(function).parameters
    for option in (option for table in tables for option in fields(table)):
        assert parameters[option.name].default == option.default, option.name


@pytest.mark.parametrize(("product", "table"), [(skinslide.Pictures, PictureOptions), (skinslide.Maps, MapOptions)])
def test_products_tell_their_options(product, table):
    for option in fields(table):
        assert f"    {option.name}: " in product.__doc__ and "%(" not in product.__doc__


@pytest.mark.parametrize("spec", ["-5:5x5", "-5--4", "-.5,3"])
def test_negative_frames(spec, shot, tmp_path):
    output = tmp_path / "out.usda"
    assert cli.main(["bake", str(shot), "-o", str(output), "--quiet", "--frames", spec]) == 0
    assert Sdf.Layer.FindOrOpen(str(output)).ListTimeSamplesForPath(f"{MESH}.points") == parse_frames(spec)


@pytest.mark.parametrize(
    "words", [["bake", "--json"], ["check", "--json", "a", "b"], ["bake", "a", "-o", "b", "--jobs", "0", "--json"]]
)
def test_bad_arguments_are_a_document_too(words, capsys):
    assert cli.main(words) == 2
    said = capsys.readouterr()
    (problem,) = json.loads(said.out)["problems"]
    assert problem["message"] in said.err and "usage: skinslide" in said.err


def test_arguments_that_are_no_text(shot, capsys):
    assert cli.main(["check", "shot\udcff.usda"]) == 2
    assert "is not UTF-8" in capsys.readouterr().err
    options = ["--prim", MESH, "--patch", "more", "--faces", "9" * 5000]
    assert cli.main(["setup", str(shot), "-o", "out.usda", *options]) == 2
    assert len(capsys.readouterr().err) < 500


def test_nothing_is_no_stage(tmp_path, capsys):
    assert cli.main(["check", ""]) == 1
    assert "error: cannot open : the name is empty" in capsys.readouterr().err


# ---- Streams ----


def shell(command: str, shot: Path) -> subprocess.CompletedProcess:
    """Runs `skinslide` in a folder with a stage; nothing may end in a traceback."""
    command = command.replace("skinslide", f"'{sys.executable}' -m skinslide")
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, cwd=shot.parent)
    assert "Traceback" not in done.stderr and "Exception ignored" not in done.stderr
    return done


@pytest.mark.parametrize("end", ["2>&-", "2>/dev/full", "<&-", "--quiet >&-", ">&-", "--quiet >/dev/full"])
def test_streams_that_a_bake_can_do_without(end, shot):
    assert shell(f"skinslide bake shot.usda -o out.usda {end}", shot).returncode == 0
    assert (shot.parent / "out.usda").read_text().startswith("#usda")


REPORTS = ["bake shot.usda -o out.usda", "check shot.usda", "check shot.usda --json", "--version", "bake --help"]


@pytest.mark.parametrize("buffered", ["", "PYTHONUNBUFFERED=1 "])
@pytest.mark.parametrize("command", REPORTS)
def test_a_report_that_cannot_be_printed(buffered, command, shot):
    done = shell(f"{buffered}skinslide {command} >/dev/full", shot)
    assert done.returncode == 1 and "error: the report cannot be printed: No space left" in done.stderr
    assert (shot.parent / "out.usda").exists() == ("-o out.usda" in command)


def test_names_that_the_terminal_cannot_show(tmp_path):
    stage, _mesh = stages.patched_stage()
    stages.add_patch(stages.add_mesh(stage, stages.grid(), "/World/\u00e9paule"), stages.annulus())
    shot = stages.save(stage, tmp_path / "shot.usda")
    done = shell("PYTHONIOENCODING=ascii skinslide check shot.usda", shot)
    assert done.returncode == 0 and "/World/\\xe9paule" in done.stdout


def test_a_machine_without_more_threads(shot, tmp_path, monkeypatch, capsys):
    def refuse(_thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr("threading.Thread.start", refuse)
    assert cli.main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 1
    assert "can't start new thread; ask for fewer jobs" in capsys.readouterr().err


def test_a_core_without_memory(shot, tmp_path, monkeypatch, capsys):
    def refuse(*_arguments, **_options):
        raise skinslide.SliderError("OUT_OF_MEMORY", "out of memory")

    monkeypatch.setattr("skinslide.stage.mesh.PatchedMesh.build", refuse)
    assert cli.main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 1
    assert "error: out of memory" in capsys.readouterr().err
