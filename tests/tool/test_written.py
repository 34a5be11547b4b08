"""A bake against `Slider` on the same arrays: what it writes, and its report."""

import json
import os
import subprocess
import sys
import termios
import textwrap
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, UsdGeom, UsdValidation, Vt

import stages
from shots import (
    MESH,
    OFFSET,
    REST,
    VERTICES,
    baked_mesh,
    composed_mesh,
    direct,
    pose,
)
from skinslide import bake_to_file
from skinslide.arrays.records import PatchResult
from skinslide.command import progress
from skinslide.shot.rows import Rows
from skinslide.write import overs
from stages import vectors

# ---- what is written ----


def test_points_are_those_of_slider(shot, out):
    report = bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == [OFFSET + frame for frame in range(1, 6)]
    for frame in range(1, 6):
        points = np.array(mesh.GetPointsAttr().Get(OFFSET + frame))
        assert points.tobytes() == direct(pose(frame)).tobytes() != pose(frame).tobytes()
    assert report.frame_count == 5


def test_only_overs_of_what_was_slid(shot, out):
    bake_to_file(shot.save().path, out)
    layer = Sdf.Layer.FindOrOpen(str(out))
    paths = []
    layer.Traverse("/", paths.append)
    prims = [str(path) for path in paths if path.IsPrimPath()]
    assert sorted(prims) == ["/World", "/World/char", "/World/char/geo", MESH]
    assert all(layer.GetPrimAtPath(path).specifier == Sdf.SpecifierOver for path in prims)
    assert not any(layer.GetPrimAtPath(path).typeName for path in prims)
    attributes = {path.name: layer.GetAttributeAtPath(path) for path in paths if path.IsPropertyPath()}
    assert {name: str(spec.typeName) for name, spec in attributes.items()} == {
        "points": "point3f[]",
        "extent": "float3[]",
    }
    assert not any(spec.custom or spec.HasDefaultValue() for spec in attributes.values())


@pytest.mark.parametrize(("named", "wanted"), [("Nope", "World"), ("/World/char", "/World/char"), ("", "World")])
def test_the_default_prim_is_one_that_is_there(shot, out, named, wanted):
    shot.save()
    shot.shot.GetRootLayer().defaultPrim = named
    shot.shot.Save()
    bake_to_file(shot.path, out)
    assert Sdf.Layer.FindOrOpen(str(out)).defaultPrim == wanted


def test_the_layer_has_the_clock_and_units_of_the_stage(shot, out):
    bake_to_file(shot.save().path, out)
    stage, _ = baked_mesh(out)
    assert stage.GetTimeCodesPerSecond() == stage.GetFramesPerSecond() == 25
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (OFFSET + 1, OFFSET + 5)
    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == ("Z", 0.01)
    assert stage.GetDefaultPrim().GetPath() == "/World"


def test_usd_finds_nothing_wrong_with_it(shot, out):
    bake_to_file(shot.save().path, out)
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    for stage in (baked_mesh(out)[0], composed_mesh(shot, out)[0]):
        problems = [problem.GetMessage() for problem in context.Validate(stage)]
        assert not [problem for problem in problems if "apiSchema" not in problem], problems


def test_extent_bounds_the_slid_points(shot, out):
    bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    for sample in mesh.GetPointsAttr().GetTimeSamples():
        points = np.array(mesh.GetPointsAttr().Get(sample))
        low, high = np.array(mesh.GetExtentAttr().Get(sample))
        assert (low == points.min(axis=0)).all() and (high == points.max(axis=0)).all()


@pytest.mark.parametrize("extension", [".usda", ".usdc", ".usd"])
def test_any_number_of_jobs_writes_the_same_bytes(shot, tmp_path, extension):
    shot.save()
    written = []
    for jobs in (1, 2, 5):
        bake_to_file(shot.path, tmp_path / f"jobs{jobs}{extension}", jobs=jobs)
        written.append((tmp_path / f"jobs{jobs}{extension}").read_bytes())
    assert written[0] == written[1] == written[2]


@pytest.mark.parametrize("extension", [".usda", ".usdc", ".usd"])
def test_saving_in_parts_loses_nothing(shot, tmp_path, monkeypatch, extension):
    """Of five frames, more than two and fewer than three fit. A crate file's bytes may differ, not what they say."""
    shot.save()
    bake_to_file(shot.path, tmp_path / f"whole{extension}")
    saves, save = [], overs.OverLayer.save
    monkeypatch.setattr(overs, "_UNSAVED_BYTES", 3 * REST.nbytes - 1)
    monkeypatch.setattr(overs.OverLayer, "save", lambda layer: (saves.append(layer), save(layer)))
    bake_to_file(shot.path, tmp_path / f"parts{extension}")
    assert len(saves) == 2  # after three frames, and at the end
    texts = [Sdf.Layer.FindOrOpen(str(tmp_path / f"{name}{extension}")).ExportToString() for name in ("whole", "parts")]
    assert texts[0] == texts[1]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["in", f"parts{extension}", f"whole{extension}"]


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="memory is told by Linux")
@pytest.mark.parametrize("extension", [".usda", ".usdc"])
def test_memory_does_not_grow_with_frames(tmp_path, monkeypatch, extension):
    """40 frames of 1.2 MB, of which 2 MB may wait to be saved; a fifth of all leaves room for what is by the way."""
    shape, frames = stages.grid(320, 320), range(1, 51)
    stage, mesh = stages.patched_stage(shape, stages.block(320, range(6), range(6)))
    for frame in frames:
        mesh.GetPointsAttr().Set(vectors(shape.points + np.float32(frame)), frame)
    held: dict[int, int] = {}
    monkeypatch.setattr(overs, "_UNSAVED_BYTES", 2 << 20)
    path, out = stages.save(stage, tmp_path / "shot.usdc"), tmp_path / f"out{extension}"
    bake_to_file(path, out, frames=frames, progress=lambda done, _total: held.update({done: _own_memory()}))
    assert held[50] - held[10] < 40 * shape.points.nbytes / 5


def _own_memory() -> int:
    """The bytes of this process that are not those of a file."""
    (line,) = [line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("RssAnon")]
    return 1024 * int(line.split()[1])


def test_a_frame_alone_is_the_frame_of_the_range(shot, tmp_path):
    shot.mesh.CreateVelocitiesAttr()
    shot.mesh.CreateAccelerationsAttr()
    for frame in range(1, 6):
        shot.mesh.GetVelocitiesAttr().Set(vectors(np.zeros_like(REST)), frame)
        shot.mesh.GetAccelerationsAttr().Set(vectors(np.zeros_like(REST)), frame)
    bake_to_file(shot.save().path, tmp_path / "all.usda")
    _stage, whole = baked_mesh(tmp_path / "all.usda")
    for frame in range(OFFSET + 1, OFFSET + 6):
        bake_to_file(shot.path, tmp_path / f"{frame}.usda", frames=[frame])
        _one, alone = baked_mesh(tmp_path / f"{frame}.usda")
        for name in ("points", "extent", "velocities", "accelerations"):
            assert alone.GetPrim().GetAttribute(name).GetTimeSamples() == [frame]
            values = [np.array(mesh.GetPrim().GetAttribute(name).Get(frame)) for mesh in (whole, alone)]
            assert values[0].tobytes() == values[1].tobytes()


def test_frames_may_lie_between_samples(shot, out):
    bake_to_file(shot.save().path, out, frames="1001:1002x0.25,1004")
    _stage, mesh = baked_mesh(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == [1001, 1001.25, 1001.5, 1001.75, 1002, 1004]
    _shot, cache = baked_mesh(shot.path)
    cached = np.array(cache.GetPointsAttr().Get(1001.25))
    assert np.array(mesh.GetPointsAttr().Get(1001.25)).tobytes() == direct(cached).tobytes()


def test_animated_controls_count_as_samples(shot, out):
    shot.envelope().Set(0.0, OFFSET + 1)
    shot.envelope().Set(1.0, OFFSET + 2.5)
    bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == [1001, 1002, 1002.5, 1003, 1004, 1005]
    assert np.array(mesh.GetPointsAttr().Get(1001)).tobytes() == pose(1).tobytes()
    half = np.array(mesh.GetPointsAttr().Get(1002))
    assert half.tobytes() == direct(pose(2), envelope=np.float32(2 / 3)).tobytes()


def test_a_control_between_the_last_samples_leaves_accelerations_what_they_need(shot, out):
    """At the last sample they need one that those at the control before it do not."""
    shot.mesh.CreateAccelerationsAttr()
    for frame in range(1, 6):
        shot.mesh.GetAccelerationsAttr().Set(vectors(np.zeros_like(REST)), frame)
    shot.envelope().Set(0.5, OFFSET + 1)
    shot.envelope().Set(1.0, OFFSET + 4.5)
    bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetAccelerationsAttr().GetTimeSamples() == [1001, 1002, 1003, 1004, 1004.5, 1005]


def test_a_cache_without_samples_gives_defaults(shot, out):
    shot.mesh.GetPointsAttr().Clear()
    shot.mesh.GetPointsAttr().Set(vectors(pose(3)))
    primvar = UsdGeom.PrimvarsAPI(shot.mesh).CreatePrimvar("pref", Sdf.ValueTypeNames.Point3fArray, "vertex")
    primvar.Set(vectors(REST))
    bake_to_file(shot.save().path, out, frames="1001:1003")
    _stage, mesh = baked_mesh(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == []
    assert np.array(mesh.GetPointsAttr().Get()).tobytes() == direct(pose(3)).tobytes()
    assert mesh.GetExtentAttr().Get() is not None


# ---- the report ----


def test_report(shot, out):
    report = bake_to_file(shot.save().path, out)
    as_json = json.loads(json.dumps(report.as_dict()))
    (mesh,) = as_json["meshes"]
    (patch,) = mesh["patches"]
    assert mesh["prim"] == MESH and mesh["frames"] == [1001, 1002, 1003, 1004, 1005]
    assert (patch["name"], patch["vertex_count"], patch["folded_faces"]) == ("sheet", VERTICES, 0)
    assert patch["max"]["largest_slide"] >= patch["mean"]["largest_slide"] > 0
    assert patch["worst_frame_stretch_after"] < patch["worst_frame_stretch_before"]
    assert [each["frame"] for each in patch["frames"]] == mesh["frames"]
    worst = max(patch["frames"], key=lambda each: each["stretch_before"])
    assert (worst["frame"], worst["stretch_after"]) == (patch["worst_frame"], patch["worst_frame_stretch_after"])
    assert worst.keys() >= {"slid_vertices", "largest_slide", "clamped_vertices", "folded_faces"}
    for name in ("density", "embed", "locate", "interpolate"):
        assert patch["mean"][f"{name}_seconds"] >= 0
    text = report.text()
    assert MESH in text and "sheet" in text and "clamped" in text


def test_added_stretch_is_reported_with_its_worst_frame(shot, out):
    report = bake_to_file(shot.save().path, out)
    assert not any("adds stretch" in problem.message for problem in report.problems)
    patch = report.meshes[0].patches[0]
    results = list(patch.results)
    for i, added in ((2, 0.1), (3, 0.2)):
        results[i] = results[i]._replace(stretch_after=results[i].stretch_before + added)
    patch.results = Rows(PatchResult, results)
    (problem,) = [problem for problem in report.problems if "adds stretch" in problem.message]
    assert (problem.severity, problem.patch, problem.frame) == ("warning", "sheet", 1004)
    assert "2 of 5 frames" in problem.message


def test_degradations_are_reported(shot, out):
    shot.primvar("weight", Sdf.ValueTypeNames.FloatArray, "vertex").Set(Vt.FloatArray(VERTICES, 2.0))
    report = bake_to_file(shot.save().path, out)
    assert "outside 0..1" in report.text()
    assert any(problem.severity == "warning" and problem.patch == "sheet" for problem in report.problems)


def test_progress_counts_every_frame(shot, out):
    calls = []
    bake_to_file(shot.save().path, out, progress=lambda done, total: calls.append((done, total)))
    assert calls == [(1, 5), (2, 5), (3, 5), (4, 5), (5, 5)]


def test_plain_progress_is_short(capsys):
    with progress.reporter() as report:
        for done in range(1, 1001):
            report(done, 1000)
    lines = capsys.readouterr().err.splitlines()
    assert 1 <= len(lines) <= 21 and lines[-1].startswith("1000 of 1000 frames")
    with progress.reporter(quiet=True) as report:
        assert report is None


def test_a_terminal_gets_a_bar():
    code = """
        from skinslide.command import progress
        with progress.reporter() as report:
            for done in range(1, 6):
                report(done, 5)
    """
    screen, terminal = os.openpty()
    termios.tcsetwinsize(terminal, (24, 80))
    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], stderr=terminal, check=True)
    os.close(terminal)
    shown = os.read(screen, 1 << 16).decode()
    os.close(screen)
    assert "frame" in shown and "\r" in shown
