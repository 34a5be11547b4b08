"""The table that bake, preview and maps print: what it says of a patch, and that its words are explained."""

import numpy as np
import pytest

import skinslide
import stages
from skinslide.arrays.records import PatchInfo, PatchResult
from skinslide.command.cli import main
from skinslide.shot.report import PatchReport, far_apart, shape_text
from skinslide.shot.rows import Rows
from stages import MESH, PATCH


def table(shot, tmp_path, *words):
    """The cells of each patch, by heading."""
    lines = skinslide.bake_to_file(shot, tmp_path / "out.usda", **dict(words)).text().splitlines()
    headings = lines[0].replace("at frame", "frame").split()
    cells = [line.replace(" hole", "_hole").split() for line in lines if line.startswith("  ")]
    return [dict(zip(headings, row, strict=True)) for row in cells], lines


@pytest.fixture
def shot(tmp_path):
    def save(**attributes):
        stage, mesh = stages.patched_stage()
        for name, value in attributes.items():
            stages.set_property(mesh, name, value)
        return stages.save(stage, tmp_path / "shot.usda")

    return save


@pytest.mark.parametrize("rule", ["unit", "relaxed"])
@pytest.mark.parametrize(("way", "shown"), [("meanValue", "meanValue"), ("auto", "linear")])
def test_a_row_says_how_a_patch_slides(rule, way, shown, shot, tmp_path):
    (row,), _lines = table(shot(forceDensityRule=rule, interpolation=way), tmp_path)
    assert (row["patch"], row["rule"], row["interpolation"], row["shape"]) == (PATCH, rule, shown, "disk")


def test_the_record_says_it_too(shot, tmp_path):
    report = skinslide.bake_to_file(shot(forceDensityRule="even"), tmp_path / "out.usda").as_dict()
    (patch,) = report["meshes"][0]["patches"]
    assert (patch["rule"], patch["interpolation"]) == ("even", "linear")


def test_change_is_from_stretch_to_slid(shot, tmp_path):
    (row,), _lines = table(shot(), tmp_path)
    change = float(row["slid"]) / float(row["stretch"]) - 1
    assert row["change"] == f"{change:+.0%}"


def test_one_frame_is_no_several(shot, tmp_path):
    _rows, lines = table(shot(), tmp_path, ("frames", [1001]))
    assert any(f"{MESH}: " in line and ", 1 frame, " in line for line in lines)


@pytest.mark.parametrize(
    ("frames", "is_far"),
    [
        ([1, 2, 3], False),
        ([1, 1.5, 2], False),
        ([1, 2, 4], True),
        ([1], False),
        ([None], False),
        ([1, 2.0000001], False),
    ],
)
def test_which_frames_are_far_apart(frames, is_far):
    assert far_apart(frames) == is_far


def test_how_rough_skin_is_is_not_said_of_sparse_frames(shot, tmp_path):
    """Second differences over long steps are none of the shot's; limits and the record keep what was measured."""
    every, sparse = (table(shot(), tmp_path, ("frames", frames))[0][0] for frames in ("1001:1004", "1001,1002,1004"))
    assert float(every["rough"]) > 0 and sparse["rough"] == "-"
    report = skinslide.bake_to_file(shot(), tmp_path / "out.usda", frames=[1001, 1002, 1004])
    assert report.as_dict()["meshes"][0]["patches"][0]["roughness"] is not None


def test_every_heading_is_explained(shot, tmp_path, capsys):
    _rows, lines = table(shot(), tmp_path)
    assert sum("RMS of log(edge length / rest length)" in line for line in lines) == 1
    for command in ("bake", "preview", "maps"):
        assert main([command, "--help"]) == 0
        said = " ".join(capsys.readouterr().out.split()).partition("the table")[2]
        for word in ("shape", "stretch", "slid", "change", "rough", "folded", "clamped", "ms/frame"):
            assert f"{word} " in said


def counts(counts_of_faces, indices):
    """What a patch of these faces has."""
    sides = {
        tuple(sorted(side)) for face in np.split(indices, np.cumsum(counts_of_faces)[:-1]) for side in around(face)
    }
    return len(set(indices.tolist())), len(sides), len(counts_of_faces)


def around(face):
    return zip(face.tolist(), np.roll(face, -1).tolist(), strict=True)


def grid(wide, high, *, round_x=False, round_y=False):
    """Quads of a sheet, joined at its ends in none, one or both directions."""
    columns, rows = wide + (not round_x), high + (not round_y)
    y, x = np.divmod(np.arange(wide * high), wide)
    right, up = (x + 1) % columns, (y + 1) % rows
    corners = [x + y * columns, right + y * columns, right + up * columns, x + up * columns]
    return np.full(wide * high, 4), np.stack(corners, axis=1).ravel()


TETRAHEDRON = np.full(4, 3), np.array([0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2])


@pytest.mark.parametrize(
    ("faces", "holes", "says"),
    [
        (grid(3, 3), 0, "disk"),
        (grid(5, 3, round_x=True), 1, "1 hole"),
        (grid(5, 4, round_x=True, round_y=True), 0, "closed, 1 handle"),
        (TETRAHEDRON, 0, "closed"),
    ],
)
def test_shapes(faces, holes, says):
    vertices, edges, count = counts(*faces)
    nothing = dict.fromkeys(PatchInfo._fields, 0)
    info = PatchInfo(
        **{**nothing, "vertex_count": vertices, "edge_count": edges, "face_count": count, "hole_count": holes}
    )
    assert shape_text(info) == says


@pytest.mark.parametrize(("rule", "is_told"), [("unit", True), ("even", False)])
def test_added_stretch_has_a_remedy(rule, is_told):
    """Of a patch that is laid out in a plane; no other rule does better than even."""
    nothing = PatchInfo(**{**dict.fromkeys(PatchInfo._fields, 0), "name": PATCH, "piece_count": 1})
    zero = PatchResult(**dict.fromkeys(PatchResult._fields, 0))
    report = PatchReport(nothing, [1.0, 2.0], Rows(PatchResult, [zero, zero._replace(stretch_after=0.5)]), rule=rule)
    (problem,) = report.problems(MESH)
    assert "sliding adds stretch: 0.0000 in the cache, 0.5000 slid (at 1 of 2 frames" in problem.message
    assert problem.message.endswith("; the rule even may take some out") == is_told


def test_progress_of_one_frame(shot, tmp_path, capsys):
    assert main(["bake", str(shot()), "-o", str(tmp_path / "out.usda"), "--frames", "1001"]) == 0
    assert capsys.readouterr().err.startswith("1 of 1 frame, ")
