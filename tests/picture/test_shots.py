"""The summary of many shots: which records it finds, and what it says of them."""

import json
import os

import pytest

import skinslide
import stages
from skinslide.command.cli import main
from skinslide.shot.report import RECORD
from stages import MESH, PATCH


@pytest.fixture
def baked(tmp_path, capsys):
    """Two shots baked, of which the second stretches more, with a page beside it; and other files."""
    top = tmp_path / "shots"
    for name, frames in (("a", "1001:1002"), ("b", "1001:1003")):
        folder = top / name
        folder.mkdir(parents=True)
        path = stages.save(stages.patched_stage()[0], folder / "shot.usda")
        words = ["--json", "--quiet", "--frames", frames, "--html", str(folder / "report.html"), "--size", "32x16"]
        assert main(["bake", str(path), "-o", str(folder / "slid.usda"), *(words if name == "b" else words[:4])]) == 0
        (folder / "bake.json").write_text(capsys.readouterr().out)
    (top / "other.json").write_text("[1, 2]")
    (top / "half.json").write_text('{"record": 1, "mes')
    (top / "later.json").write_text(json.dumps({"record": RECORD + 1}))
    return top


def test_shots_with_most_stretch_left_come_first(baked):
    report = skinslide.report(baked)
    assert [shot.file for shot in report.shots] == ["b/bake.json", "a/bake.json"]
    assert [shot.page for shot in report.shots] == ["b/report.html", ""]
    record = json.loads((baked / "b/bake.json").read_text())
    (patch,) = record["meshes"][0]["patches"]
    (found,) = report.shots[0].patches
    assert (found.prim, found.label, found.frames, found.worst) == (MESH, PATCH, 3, patch["worst_frame"])
    assert (found.before, found.after) == (patch["worst_frame_stretch_before"], patch["worst_frame_stretch_after"])
    assert report.shots[0].left == found.after > report.shots[1].left
    assert [problem.as_dict() for problem in report.shots[0].problems] == record["problems"]


def test_the_command(baked, capsys):
    assert main(["report", str(baked)]) == 0
    said = capsys.readouterr().out
    assert f"{baked / 'shots.html'}: written" in said and said.count("bake.json") == 2
    text = (baked / "shots.html").read_text()
    assert "2 shots, 2 patches; " in text and 'href="b/report.html"' in text and "a/<wbr>bake.json" in text
    assert main(["report", str(baked), "-o", str(baked / "b" / "all.html"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["page"] == str(baked / "b" / "all.html") and len(told["shots"]) == 2
    assert told["shots"][0]["page"] == "report.html"


def test_a_page_is_not_led_to_from_itself(baked):
    assert skinslide.report(baked, baked / "b" / "report.html").shots[0].page == ""


def test_a_shot_that_failed_is_told_of(baked, capsys):
    """By what the command prints, from its file alone."""
    assert main(["bake", str(baked / "gone.usda"), "-o", str(baked / "slid.usda"), "--json", "--quiet"]) == 1
    (baked / "c.json").write_text(capsys.readouterr().out)
    report = skinslide.report(baked)
    assert report.shots[-1].file == "c.json" and "cannot open" in (baked / "shots.html").read_text()
    assert "no patches, 1 problem" in report.text()


@pytest.mark.parametrize(
    "document",
    [
        {"record": RECORD},
        {"record": RECORD, "meshes": 3, "problems": []},
        {"record": RECORD, "meshes": [{"prim": "/a"}], "problems": []},
        {"problems": "words"},
        {"problems": [{"severity": "error"}]},
    ],
)
def test_what_is_no_record_is_passed_over(document, baked):
    (baked / "d.json").write_text(json.dumps(document))
    report = skinslide.report(baked)
    assert len(report.shots) == 2 and _left_out(report) == ["d.json", "half.json", "later.json"]


NO_FILE = "it cannot be read: it is not a file"
HALF = "half.json is left out: it is not complete JSON, by line 1: Unterminated string starting at"
UNREADABLE = {
    "a pipe": (os.mkfifo, NO_FILE),
    "a device": (lambda path: path.symlink_to("/dev/zero"), NO_FILE),
    "bytes": (lambda path: path.write_bytes(b"\xff"), "it holds text that is not UTF-8"),
    "half": (lambda path: path.write_text("{\n"), "it is not complete JSON, by line 2: "),
    "later": (
        lambda path: path.write_text(json.dumps({"record": RECORD + 1})),
        f"it is of version {RECORD + 1}, and version {RECORD} is read here",
    ),
    "members": (
        lambda path: path.write_text(json.dumps({"record": RECORD})),
        "it is not a record, as it lacks 'problems'",
    ),
    "types": (
        lambda path: path.write_text(json.dumps({"record": RECORD, "meshes": 3, "problems": []})),
        "it is not a record, as something in it is of another type",
    ),
}


@pytest.mark.parametrize(("make", "why"), UNREADABLE.values(), ids=UNREADABLE)
def test_what_cannot_be_read_is_told_of(make, why, baked, capsys):
    """A pipe is not waited for, and of a device nothing is read."""
    make(baked / "a.json")
    assert main(["report", str(baked), "--quiet"]) == 0
    said = capsys.readouterr().err.splitlines()[:3]
    assert [line.partition(" is left out: ")[0] for line in said] == [
        f"warning: {name}" for name in ("a.json", "half.json", "later.json")
    ]
    assert said[0].startswith(f"warning: a.json is left out: {why}") and HALF in said[1]
    assert HALF in (baked / "shots.html").read_text()


@pytest.mark.parametrize(("make", "why"), UNREADABLE.values(), ids=UNREADABLE)
def test_where_nothing_can_be_read_it_is_said_why(make, why, tmp_path, capsys):
    make(tmp_path / "a.json")
    assert main(["report", str(tmp_path)]) == 2
    assert f"such as bake --json prints; a.json is left out: {why}" in capsys.readouterr().err
    make(tmp_path / "b.json")
    assert main(["report", str(tmp_path)]) == 2
    assert capsys.readouterr().err.endswith(", and 1 more file too\n") and not (tmp_path / "shots.html").exists()


def test_how_rough_skin_is_is_not_said_of_sparse_frames(tmp_path, capsys):
    shot = stages.save(stages.patched_stage()[0], tmp_path / "shot.usda")
    for frames in ("1001:1003", "1001,1002,1004"):
        assert (
            main(["bake", str(shot), "-o", str(tmp_path / "slid.usda"), "--frames", frames, "--json", "--quiet"]) == 0
        )
        (tmp_path / f"{frames[-4:]}.json").write_text(capsys.readouterr().out)
    rough = {shot.file: shot.patches[0].roughness for shot in skinslide.report(tmp_path).shots}
    assert rough["1004.json"] is None and rough["1003.json"] > 0


def test_one_shot_is_no_several(tmp_path, capsys):
    shot = stages.save(stages.patched_stage()[0], tmp_path / "shot.usda")
    words = ["--frames", "1001", "--json", "--quiet", "--html", str(tmp_path / "a.html"), "--size", "32x16"]
    assert main(["bake", str(shot), "-o", str(tmp_path / "slid.usda"), *words]) == 0
    (tmp_path / "a.json").write_text(capsys.readouterr().out)
    skinslide.report(tmp_path)
    assert "1 shot, 1 patch; " in (tmp_path / "shots.html").read_text()
    assert "1, 1001<" in (tmp_path / "a.html").read_text()


def _left_out(report) -> list[str]:
    return [problem.message.partition(" ")[0] for problem in report.left_out]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nowhere"], "nowhere is not a folder of records"),
        (["empty"], "there is no record in it or below"),
        (["shots", "-o", "page.txt"], "the name must end in .html, .htm"),
    ],
)
def test_folders_and_pages_that_cannot_be(words, message, baked, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    assert main(["report", *words]) == 2
    assert message in capsys.readouterr().err
