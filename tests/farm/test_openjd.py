"""Jobs of Open Job Description, run as a user runs them: whatever happens on the way, the layer of one bake."""

import json
import subprocess
from pathlib import Path

import pytest

import stages
from jobs import SCRIPTS, content, kill_baking, tool
from skinslide import UsageError, farm


def openjd(job: Path, *words: str) -> subprocess.Popen[str]:
    command = [SCRIPTS / "openjd", "run", job, *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def ran(job: Path, *words: str, code: int = 0) -> str:
    running = openjd(job, *words)
    said, _ = running.communicate()
    assert (running.returncode == 0) == (code == 0), said
    return said


@pytest.fixture
def job(shot, tmp_path) -> Path:
    tool("farm", shot, "-o", tmp_path / "slid.usdc", "--chunk", "3")
    return tmp_path / "slid.openjd.json"


def test_a_job_is_the_bake(job, whole, tmp_path):
    subprocess.run([SCRIPTS / "openjd", "check", job], check=True, capture_output=True)
    ran(job)
    assert content(tmp_path / "slid.usdc") == whole


def test_a_task_that_fails_and_is_tried_again(job, whole, tmp_path):
    chunks = [tmp_path / f"slid.chunk{number}.usdc" for number in (1, 2, 3)]
    chunks[1].mkdir()
    said = ran(job, code=1)
    assert f"output {chunks[1]}: is a folder" in said and not (tmp_path / "slid.usdc").exists()
    chunks[1].rmdir()
    first = chunks[0].stat().st_ino
    ran(job, "--step", "Bake", "--task-param", "Chunk=2")
    assert not chunks[2].exists()
    said = ran(job)
    assert said.count("is whole already") == 2 and chunks[0].stat().st_ino == first
    assert content(tmp_path / "slid.usdc") == whole


def test_a_task_that_is_killed(job, whole, tmp_path):
    running = openjd(job)
    kill_baking(tmp_path, "slid.chunk2.usdc")
    said, _ = running.communicate()
    assert running.returncode != 0, said
    assert not (tmp_path / "slid.chunk2.usdc").exists() and not (tmp_path / "slid.usdc").exists()
    ran(job)
    assert content(tmp_path / "slid.usdc") == whole


def test_pictures_and_a_page(tmp_path):
    """And a stage that is not below the job, in a folder whose name is spelt oddly."""
    stage, _mesh = stages.patched_stage()
    stages.save(stage, tmp_path / "it's 1.usda")
    folder = tmp_path / "a {job}"
    folder.mkdir()
    page = folder / "page.html"
    drawn = ("--pictures", folder / "pictures", "--html", page)
    tool("farm", tmp_path / "it's 1.usda", "-o", folder / "job.yaml", "--chunk", "1", "--frames", "1002", *drawn)
    ran(folder / "job.yaml")
    assert page.read_text().rstrip().endswith("</html>") and list((folder / "pictures").glob("*.1002.png"))
    assert (folder / "job.usdc").exists()


def test_options_are_those_of_every_task(shot, tmp_path):
    limits = {"max_folded": 0, "max_stretch": 0.5, "max_roughness": 2.0}
    report = farm(shot, tmp_path / "job.json", chunk=4, prims=stages.MESH, frames=range(1001, 1008), **limits)
    assert (report.frames, len(report.chunks)) == ([float(frame) for frame in range(1001, 1008)], 2)
    bake, stitch = json.loads((tmp_path / "job.json").read_text())["steps"]
    words = " ".join(bake["script"]["actions"]["onRun"]["args"])
    assert f"--prim {stages.MESH} --frames 1001:1007 --max-folded 0 --max-stretch 0.5 --max-roughness 2.0" in words
    assert bake["parameterSpace"]["taskParameterDefinitions"] == [{"name": "Chunk", "type": "INT", "range": "1-2"}]
    assert stitch["dependencies"] == [{"dependsOn": "Bake"}]


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (("--chunk", "3", "--frames", "1001-1010"), 3, "frame 1009: 2 of the frames are beyond the samples"),
        (("--chunk", "3", "--frames", "words"), 2, "is neither a frame nor a range"),
        (("--chunk", "0"), 2, "must be at least 1"),
        (("--chunk", "3", "--format", "condor"), 2, "invalid choice"),
        (("--chunk", "3", "--prim", "/gone"), 3, "there is no such prim"),
        (("--chunk", "3", "-o", "slid.abc"), 2, "the name must end in .usda, .usdc, .usd, .json"),
        (("--chunk", "3", "-o", "gone/slid.usda"), 2, "does not exist"),
        (("--chunk", "3", "-o", "shot.usda"), 2, "the stage reads this file"),
    ],
)
def test_jobs_that_cannot_be(words, code, says, shot, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    assert says in tool("farm", shot, "-o", "slid.usdc", *words, code=code)
    assert sorted(tmp_path.iterdir()) == before


def test_a_stage_that_does_not_move(tmp_path):
    stage, mesh = stages.patched_stage()
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(stages.vectors(stages.grid().points))
    still = stages.save(stage, tmp_path / "still.usda")
    assert "so there are no frames to divide" in tool(
        "farm", still, "-o", tmp_path / "slid.usdc", "--chunk", "1", code=3
    )


def test_what_a_template_cannot_hold(shot, tmp_path):
    page = tmp_path / "{{Param.Stage}}.html"
    with pytest.raises(UsageError, match="would replace what stands in"):
        farm(shot, tmp_path / "slid.usdc", chunk=3, html=page)
    assert not (tmp_path / "slid.openjd.json").exists()


@pytest.mark.parametrize("form", ["openjd", "slurm"])
def test_a_name_of_two_lines(form, shot, tmp_path):
    """Of which the second would be a line of a script."""
    before = sorted(tmp_path.iterdir())
    with pytest.raises(UsageError, match="cannot have a line break in it"):
        farm(shot, tmp_path / "slid\nTASK\ntouch gone; #.usdc", chunk=3, form=form)
    assert sorted(tmp_path.iterdir()) == before
