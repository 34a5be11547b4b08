"""What `check` says: of patches, of what is worth knowing, and of every sample."""

import json

import numpy as np
import pytest
from pxr import Sdf, UsdGeom

import skinslide
import stages
from skinslide.command.cli import main
from skinslide.shot.check import CheckReport
from skinslide.stage.neighbours import Neighbours
from stages import FRAMES, MESH, PATCH

WEIGHT = f"skinSlide:{PATCH}:weight"


def said(report: CheckReport, severity: str) -> list[str]:
    return [str(problem) for problem in report.problems if problem.severity == severity]


def test_a_good_stage_has_no_problems():
    stage, _mesh = stages.patched_stage(faces=stages.annulus())
    report = skinslide.check(stage)
    assert not report.problems and not report.failed
    (mesh,) = report.meshes
    assert (mesh.path, mesh.points, mesh.faces, mesh.rest) == (MESH, 49, 36, "points (default)")
    assert mesh.samples == list(FRAMES)
    (patch,) = mesh.patches
    # 6 x 6 faces with the middle 2 x 2 out: 49 - 1 vertices, 84 - 4 edges; 24 vertices on the rim and 8 on the hole.
    assert (patch.vertices, patch.edges, patch.faces, patch.holes, patch.free) == (48, 80, 32, 1, 16)


def test_pieces_are_listed():
    stage, _mesh = stages.patched_stage(faces=stages.two_pieces())
    report = skinslide.check(stage)
    pieces = [(patch.name, patch.piece, patch.pieces) for patch in report.meshes[0].patches]
    assert pieces == [
        (PATCH, 1, 2),
        (PATCH, 2, 2),
    ]
    assert f"{PATCH} (2 of 2): unit, linear, vertices 21, " in report.text()


def test_nothing_free_is_a_warning():
    stage, _mesh = stages.patched_stage(faces=np.array([0, 1]))
    (warning,) = said(skinslide.check(stage), "warning")
    assert warning.startswith(f"warning: {MESH}: patch {PATCH}: nothing can slide")


def test_collapsed_faces_are_a_warning():
    """The triangle 0-4-1 has two edges on the side of the square from corner 0 to corner 1, so all of it lies there."""
    points = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, -1, 0), (1, 1, 0)]
    shape = stages.from_faces(points, [(0, 4, 1), (0, 1, 5), (1, 2, 5), (2, 3, 5), (3, 0, 5)])
    stage, mesh = stages.patched_stage(shape)
    stages.set_property(mesh, "corners", [0, 1, 2, 3])
    assert any("1 face has no area in the rest embedding" in line for line in said(skinslide.check(stage), "warning"))


def test_overlap_is_a_note():
    stage, mesh = stages.patched_stage(faces=stages.block(6, range(4), range(6)))
    stages.add_patch(mesh, stages.block(6, range(3, 6), range(6)), "wrist_L")
    (note,) = said(skinslide.check(stage), "note")
    # One column of faces is shared: two columns of seven vertices.
    assert note == f"note: {MESH}: patch {PATCH}: overlaps patch wrist_L in 14 vertices, which take the mean of both"


def test_neighbours_do_not_overlap():
    stage, mesh = stages.patched_stage(faces=stages.block(6, range(3), range(6)))
    stages.add_patch(mesh, stages.block(6, range(3, 6), range(6)), "wrist_L")
    assert not skinslide.check(stage).problems


def test_points_of_meshes_far_away_are_read_once(monkeypatch):
    """Of many meshes side by side, each with a patch, and not by each of the others."""
    stage, read = stages.new_stage(), list[str]()
    for number in range(8):
        shape = stages.grid(centre=(3 * number, 0, 0))
        stages.add_patch(stages.add_mesh(stage, shape, f"{MESH}{number}"), shape.all_faces)
    points = Neighbours._points
    monkeypatch.setattr(Neighbours, "_points", lambda self, path: read.append(str(path)) or points(self, path))
    assert len(skinslide.check(stage).meshes) == 8
    assert sorted(read) == [f"{MESH}{number}" for number in range(8)]


def test_paint_that_is_not_applied_is_a_warning():
    stage, mesh = stages.patched_stage()
    stages.set_primvar(mesh, "skinSlide:wrist:R:weight", Sdf.ValueTypeNames.FloatArray, "vertex", [1.0] * 49)
    mesh.GetPrim().CreateAttribute("skinSlide:restPoints", Sdf.ValueTypeNames.Point3fArray, False)
    (warning,) = said(skinslide.check(stage), "warning")
    assert warning.startswith(
        f"warning: {MESH}: patch wrist:R: has properties, but SkinSlideAPI:wrist:R is not applied"
    )


def test_rest_pose_without_samples_is_a_warning():
    stage, mesh = stages.patched_stage()
    for frame in FRAMES:
        mesh.GetPointsAttr().ClearAtTime(frame)
    (warning,) = said(skinslide.check(stage), "warning")
    assert "nothing slides" in warning


def test_missing_cache_is_told():
    stage, mesh = stages.patched_stage()
    stages.add_patch(stages.add_mesh(stage, stages.grid(), "/World/prop/rope_GEO"), stages.annulus())
    mesh.GetPrim().GetReferences().AddReference("./gone.usdc")
    assert any("gone.usdc" in line for line in said(skinslide.check(stage), "error"))
    # What was not asked for cannot hold what was.
    report = skinslide.check(stage, ["/World/prop"])
    assert not report.failed and any("gone.usdc" in line for line in said(report, "warning"))


def test_a_missing_material_is_a_warning():
    stage, _mesh = stages.patched_stage()
    stage.DefinePrim("/World/looks/skin", "Material").GetReferences().AddReference("./gone.usdc")
    report = skinslide.check(stage)
    assert not report.failed and any("gone.usdc" in line for line in said(report, "warning"))


def test_a_missing_sublayer_is_an_error():
    stage, _mesh = stages.patched_stage()
    stage.GetRootLayer().subLayerPaths.append("./gone.usdc")
    assert any("gone.usdc" in line for line in said(skinslide.check(stage, [MESH]), "error"))


def test_first_bad_sample_and_how_many_more():
    stage, mesh = stages.patched_stage()
    for frame, weight in zip(FRAMES, (1.0, 1.5, -2.0), strict=True):
        values = [1.0] * 12 + [weight] * 37
        stages.set_primvar(mesh, WEIGHT, Sdf.ValueTypeNames.FloatArray, "vertex", values, frame)
        mesh.GetPointsAttr().Set(stages.vectors(np.zeros((49 - (weight > 1), 3))), frame)
    report = skinslide.check(stage)
    (error,) = said(report, "error")
    assert error.startswith(f"error: {MESH}: frame 1002: points has 48 values")
    (warning,) = said(report, "warning")
    assert warning.startswith(f"warning: {MESH}: patch {PATCH}: frame 1002: weight of vertex 12 is 1.5, and 36 more")
    assert "at 1 more frame" in warning


def test_bad_patch_does_not_hide_the_good_one(tmp_path):
    stage, mesh = stages.patched_stage(stages.grid(3, 3), stages.pinched())
    stages.add_patch(mesh, stages.block(3, range(2), range(2)), "good")
    report = skinslide.check(stage)
    assert [patch.name for patch in report.meshes[0].patches] == ["good"]
    assert report.failed


def test_json_is_one_document(tmp_path, capsys):
    stage, _mesh = stages.patched_stage(faces=stages.two_pieces())
    path = stages.save(stage, tmp_path / "shot.usda")
    assert main(["check", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["stage"] == str(path)
    assert document["meshes"][0]["patches"][1]["piece"] == 2
    assert document["problems"] == []


def test_json_of_a_bad_stage(tmp_path, capsys):
    stage = stages.new_stage()
    path = stages.save(stage, tmp_path / "shot.usda")
    for command in (["check", str(path), "--json"], ["bake", str(path), "-o", str(tmp_path / "out.usda"), "--json"]):
        assert main(command) == 3
        (problem,) = json.loads(capsys.readouterr().out)["problems"]
        assert problem["severity"] == "error"


def test_prim_option(tmp_path, capsys):
    stage, _mesh = stages.patched_stage()
    other = stages.add_mesh(stage, stages.grid(), "/World/prop/rope_GEO")
    stages.add_patch(other, stages.annulus(), "rope")
    path = stages.save(stage, tmp_path / "shot.usda")
    assert main(["check", str(path), "--prim", "/World/prop"]) == 0
    assert MESH not in (said := capsys.readouterr().out)
    assert "/World/prop/rope_GEO" in said


# ---- Legal, if odd: a bake and a check take them ----


def isolated_vertices() -> stages.Shape:
    shape = stages.grid()
    return stages.Shape(np.vstack([shape.points, [[9, 9, 9]]]).astype(np.float32), shape.counts, shape.indices)


def merged_points() -> stages.Shape:
    """A sheet with an edge of no length, and with slivers next to it."""
    shape = stages.grid()
    points = shape.points.copy()
    points[24] = points[25]
    return stages.Shape(points, shape.counts, shape.indices)


def on_a_line() -> stages.Shape:
    """A sheet on a line, with faces of no area and edges of no length."""
    shape = stages.grid()
    return stages.Shape(shape.points * np.array([1, 0, 0], np.float32), shape.counts, shape.indices)


ODD = {
    "one face": lambda: stages.grid(1, 1),
    "isolated vertex": isolated_vertices,
    "edges of no length": merged_points,
    "faces of no area": on_a_line,
    "far away": lambda: stages.grid(size=1e3, centre=(1e7, -1e7, 1e7)),
    "tiny": lambda: stages.grid(size=1e-4),
    "huge": lambda: stages.grid(size=1e4),
    "left-handed": stages.grid,
}


@pytest.mark.parametrize("name", ODD)
def test_odd_but_legal(name, tmp_path, capsys):
    stage, mesh = stages.patched_stage(ODD[name]())
    if name == "left-handed":
        mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    path = stages.save(stage, tmp_path / "shot.usda")
    assert main(["check", str(path)]) == 0
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 0
    baked = Sdf.Layer.FindOrOpen(str(tmp_path / "out.usda"))
    for frame in FRAMES:
        points = np.array(baked.QueryTimeSample(f"{MESH}.points", frame))
        assert np.isfinite(points).all()
        if frame == FRAMES[0]:
            np.testing.assert_array_equal(points, ODD[name]().points, "rest in, rest out")


def test_a_misspelt_setting_is_told():
    stage, mesh = stages.patched_stage()
    misspelt = (f"skinSlide:{PATCH}:forceDensityRul", f"primvars:skinSlide:{PATCH}:wieght")
    for name in misspelt:
        mesh.GetPrim().CreateAttribute(name, Sdf.ValueTypeNames.Token)
    stages.set_property(mesh, "forceDensityRule", "relaxed")
    told = [line for line in said(skinslide.check(stage), "warning") if "not a setting" in line]
    where = f"warning: {MESH}: patch {PATCH}"
    assert told == [f"{where}: {name} is not a setting of a patch, and has no effect" for name in misspelt]


UNREAD = {
    "even": ("boundary", "corners"),
    "relaxed": ("boundary", "corners"),
    "unit": ("grow", "stretchResponse"),
}


@pytest.mark.parametrize(("rule", "names"), UNREAD.items(), ids=UNREAD)
def test_what_the_rule_does_not_read_is_told(rule, names):
    stage, mesh = stages.patched_stage()
    settings = {"boundary": "square", "corners": [0, 6, 48, 42], "grow": 0.1, "stretchResponse": 0.5}
    for name, value in {"forceDensityRule": rule, **settings}.items():
        stages.set_property(mesh, name, value)
    told = [line for line in said(skinslide.check(stage), "warning") if "has no effect" in line]
    where = f"warning: {MESH}: patch {PATCH}: skinSlide:{PATCH}"
    assert told == [f"{where}:{name} has no effect under the rule {rule}" for name in names]


@pytest.mark.parametrize(("frames", "outside"), [("900", 1), ("1002,1004:1006", 3), ("1001-1003", 0)])
def test_frames_beyond_the_samples_are_told(frames, outside):
    stage, _mesh = stages.patched_stage()
    told = [problem.message for problem in skinslide.bake(stage, frames=frames).problems]
    are = "1 frame is" if outside == 1 else f"{outside} frames are"
    expected = f"{are} beyond the samples, which go from 1001 to 1003; the nearest is held there"
    assert [message for message in told if "beyond" in message] == [expected] * bool(outside)
