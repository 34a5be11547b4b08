"""A bake against `Slider` on the same arrays, and what it writes, refuses and leaves alone."""

import hashlib
import json
import os
import signal
import subprocess
import sys
import termios
import textwrap
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdValidation, Vt

import skinslide
import stages
from skinslide import (
    FrameProblem,
    Lookup,
    PatchSetup,
    Slider,
    StageError,
    StageProblems,
    UsageError,
    bake,
    bake_to_file,
    output,
    progress,
    slider,
)
from skinslide.derived import samples_around

SIZE = 8  # quads a side
VERTICES, FACES = (SIZE + 1) ** 2, SIZE**2
MESH = "/World/char/geo/body_GEO"
FIRST = np.arange(FACES) // SIZE * (SIZE + 1) + np.arange(FACES) % SIZE
INDICES = np.stack([FIRST, FIRST + 1, FIRST + SIZE + 2, FIRST + SIZE + 1], axis=1).ravel().astype(np.int32)
COUNTS = np.full(FACES, 4, np.int32)
Y, X = np.divmod(np.arange(VERTICES), SIZE + 1)
REST = np.stack([X, Y, 0 * X], axis=1).astype(np.float32)
OFFSET = 1000


def pose(frame: float) -> np.ndarray:
    """The sheet with a bump that travels along x."""
    points = REST.copy()
    points[:, 2] = 3 * np.exp(-0.3 * ((X - frame) ** 2 + (Y - 4.0) ** 2))
    return points


def vectors(array: np.ndarray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(array, np.float32))


class Shot:
    """A cache with frames 1 to 5, under a payload of a shot with an offset of 1000, in a folder."""

    def __init__(self, folder: Path):
        self.path, self.cache_path = folder / "shot.usda", folder / "cache.usdc"
        self.cache = Usd.Stage.CreateNew(str(self.cache_path))
        self.cache.SetDefaultPrim(UsdGeom.Xform.Define(self.cache, "/char").GetPrim())
        self.cache.SetTimeCodesPerSecond(25)
        self.mesh = UsdGeom.Mesh.Define(self.cache, "/char/geo/body_GEO")
        self.mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(COUNTS))
        self.mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(INDICES))
        self.mesh.CreateSubdivisionSchemeAttr("none")
        self.mesh.CreatePointsAttr(vectors(REST))
        for frame in range(1, 6):
            self.mesh.GetPointsAttr().Set(vectors(pose(frame)), frame)
        self.shot = Usd.Stage.CreateNew(str(self.path))
        self.shot.SetDefaultPrim(UsdGeom.Xform.Define(self.shot, "/World").GetPrim())
        self.shot.SetTimeCodesPerSecond(25)
        self.shot.SetFramesPerSecond(25)
        self.shot.SetStartTimeCode(OFFSET + 1)
        self.shot.SetEndTimeCode(OFFSET + 5)
        UsdGeom.SetStageUpAxis(self.shot, "Z")
        UsdGeom.SetStageMetersPerUnit(self.shot, 0.01)
        UsdGeom.Xform.Define(self.shot, "/World/char").GetPrim().GetPayloads().AddPayload(
            Sdf.Payload("./cache.usdc", layerOffset=Sdf.LayerOffset(OFFSET))
        )
        self.over = self.shot.OverridePrim(MESH)
        self.over.AddAppliedSchema("SkinSlideAPI:sheet")
        self.primvar("patch", Sdf.ValueTypeNames.BoolArray, "uniform").Set(Vt.BoolArray(FACES, True))

    def primvar(self, name: str, kind: Sdf.ValueTypeName, interpolation: str) -> UsdGeom.Primvar:
        return UsdGeom.PrimvarsAPI(self.over).CreatePrimvar(f"skinSlide:sheet:{name}", kind, interpolation)

    def envelope(self) -> Usd.Attribute:
        return self.over.CreateAttribute("skinSlide:sheet:envelope", Sdf.ValueTypeNames.Float)

    def save(self) -> "Shot":
        self.cache.Save()
        self.shot.Save()
        return self


@pytest.fixture
def shot(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    return Shot(folder)


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out.usda"


def baked_mesh(path: Path) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    stage = Usd.Stage.Open(str(path))
    return stage, UsdGeom.Mesh(stage.GetPrimAtPath(MESH))


def composed_mesh(shot: Shot, baked: Path) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """The shot with the bake above it."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.subLayerPaths = [str(baked), str(shot.path)]
    stage = Usd.Stage.Open(layer)
    stage.SetTimeCodesPerSecond(25)
    UsdGeom.SetStageUpAxis(stage, "Z")
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.SetDefaultPrim(stage.GetPrimAtPath("/World"))
    return stage, UsdGeom.Mesh(stage.GetPrimAtPath(MESH))


def direct(points: np.ndarray, **controls: float) -> np.ndarray:
    """The same arrays through `Slider`."""
    made = Slider(COUNTS, INDICES, REST, [PatchSetup("sheet", np.arange(FACES))])
    return made.slide(points, [skinslide.Controls(**controls)]).points


def digest(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


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


def test_saving_in_parts_loses_nothing(shot, tmp_path, monkeypatch):
    shot.save()
    bake_to_file(shot.path, tmp_path / "whole.usdc")
    monkeypatch.setattr(output, "_UNSAVED_BYTES", 1)
    bake_to_file(shot.path, tmp_path / "parts.usdc")
    texts = [Sdf.Layer.FindOrOpen(str(tmp_path / name)).ExportToString() for name in ("whole.usdc", "parts.usdc")]
    assert texts[0] == texts[1]


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


# ---- what follows from points ----


def flat_normals(count: int) -> Vt.Vec3fArray:
    return vectors(np.tile([0.0, 0.0, 1.0], (count, 1)))


@pytest.mark.parametrize(
    ("interpolation", "count"),
    [("vertex", VERTICES), ("varying", VERTICES), ("faceVarying", 4 * FACES), ("uniform", FACES)],
)
@pytest.mark.parametrize("animated", [True, False])
def test_normals_are_recomputed_at_their_interpolation(shot, out, interpolation, count, animated):
    shot.mesh.SetNormalsInterpolation(interpolation)
    shot.mesh.CreateNormalsAttr()
    for sample in range(1, 6) if animated else [Usd.TimeCode.Default()]:
        shot.mesh.GetNormalsAttr().Set(flat_normals(count), sample)
    bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetNormalsAttr().GetTimeSamples() == mesh.GetPointsAttr().GetTimeSamples()
    slid = direct(pose(2))
    expected = slider.normals(COUNTS, INDICES, pose(2), slid, np.array(flat_normals(count)), interpolation)
    assert np.array(mesh.GetNormalsAttr().Get(OFFSET + 2)).tobytes() == expected.tobytes()
    assert not mesh.GetNormalsAttr().HasMetadata("interpolation")


def test_indexed_normals_are_flattened(shot, out):
    primvar = UsdGeom.PrimvarsAPI(shot.mesh).CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "faceVarying")
    primvar.Set(flat_normals(1))
    primvar.SetIndices(Vt.IntArray(4 * FACES, 0))
    shot.mesh.CreateNormalsAttr(flat_normals(VERTICES))
    bake_to_file(shot.save().path, out)
    _stage, mesh = composed_mesh(shot, out)
    composed = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
    assert not composed.IsIndexed()
    assert len(composed.Get(OFFSET + 2)) == 4 * FACES
    # primvars:normals win, so normals stay as they are.
    assert not Sdf.Layer.FindOrOpen(str(out)).GetAttributeAtPath(f"{MESH}.normals")


def test_constant_normals_are_left_alone(shot, out):
    shot.mesh.CreateNormalsAttr(flat_normals(1))
    shot.mesh.SetNormalsInterpolation("constant")
    bake_to_file(shot.save().path, out)
    assert not Sdf.Layer.FindOrOpen(str(out)).GetAttributeAtPath(f"{MESH}.normals")


def assert_blocked(path: Path, *names: str) -> None:
    layer = Sdf.Layer.FindOrOpen(str(path))
    for name in names:
        spec = layer.GetAttributeAtPath(f"{MESH}.{name}")
        assert isinstance(spec.default, Sdf.ValueBlock) and not spec.HasInfo("timeSamples"), name


def test_normals_of_a_wrong_length_are_blocked_and_named(shot, out):
    shot.mesh.CreateNormalsAttr(flat_normals(3))
    report = bake_to_file(shot.save().path, out)
    assert_blocked(out, "normals")
    (problem,) = report.problems
    assert problem.frame == 1001 and "normals cannot be recomputed, so the bake blocks them" in problem.message


@pytest.mark.parametrize("indices", [[0, 1, 2] * 5, [7] * 4 * FACES])
def test_indexed_normals_that_cannot_be_recomputed_are_blocked_with_their_indices(shot, out, indices):
    primvar = UsdGeom.PrimvarsAPI(shot.mesh).CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "faceVarying")
    primvar.Set(flat_normals(3))
    primvar.SetIndices(Vt.IntArray(indices))
    shot.mesh.CreateNormalsAttr(flat_normals(VERTICES))
    assert len(bake_to_file(shot.save().path, out).problems) == 1
    # normals would be read once primvars:normals are gone.
    assert_blocked(out, "primvars:normals", "primvars:normals:indices", "normals")


def test_rates_of_a_wrong_length_at_some_frames_are_blocked_at_all(shot, out):
    shot.mesh.CreateVelocitiesAttr()
    shot.mesh.CreateAccelerationsAttr()
    for frame in range(1, 6):
        shot.mesh.GetVelocitiesAttr().Set(vectors(np.zeros((5 if frame in (3, 4) else VERTICES, 3))), frame)
        shot.mesh.GetAccelerationsAttr().Set(vectors(np.zeros_like(REST)), frame)
    shot.mesh.GetAccelerationsAttr().Set(Sdf.ValueBlock(), 2)
    report = bake_to_file(shot.save().path, out)
    assert_blocked(out, "velocities", "accelerations")
    assert [problem.frame for problem in report.problems] == [1002, 1003]


def test_velocities_are_the_rate_of_the_slid_points(shot, out):
    """Where the cache's velocities are the differences of its points, the bake's are those of the slid points."""
    shot.mesh.CreateVelocitiesAttr()
    shot.mesh.CreateAccelerationsAttr()
    between = {1: (1, 2), 2: (1, 3), 3: (2, 4), 4: (3, 5), 5: (4, 5)}
    for frame, (first, last) in between.items():
        rate = (pose(last).astype(float) - pose(first)) * 25 / (last - first)
        shot.mesh.GetVelocitiesAttr().Set(vectors(rate), frame)
        middle = min(max(frame, 2), 4)
        second = (pose(middle - 1).astype(float) - 2 * pose(middle).astype(float) + pose(middle + 1)) * 25**2
        shot.mesh.GetAccelerationsAttr().Set(vectors(second), frame)
    bake_to_file(shot.save().path, out, jobs=2)
    _stage, mesh = baked_mesh(out)
    slid = {frame: direct(pose(frame)).astype(float) for frame in between}
    for frame, (first, last) in between.items():
        expected = (slid[last] - slid[first]) * 25 / (last - first)
        # Float positions of size 10, times 25.
        assert np.allclose(mesh.GetVelocitiesAttr().Get(OFFSET + frame), expected, atol=1e-4)
        middle = min(max(frame, 2), 4)
        expected = (slid[middle - 1] - 2 * slid[middle] + slid[middle + 1]) * 25**2
        assert np.allclose(mesh.GetAccelerationsAttr().Get(OFFSET + frame), expected, atol=5e-3)  # times 625


def test_rates_that_cannot_be_recomputed_are_blocked(shot, out):
    shot.mesh.CreateVelocitiesAttr()
    for frame in (1, 2.5, 5):
        shot.mesh.GetVelocitiesAttr().Set(vectors(np.ones_like(REST)), frame)
    shot.mesh.CreateAccelerationsAttr(vectors(np.ones_like(REST)))
    report = bake_to_file(shot.save().path, out)
    reason = "their samples are at other times than those of points"
    assert [problem.message for problem in report.problems] == [
        f"{name} cannot be recomputed, so the bake blocks them: {reason}" for name in ("velocities", "accelerations")
    ]
    assert skinslide.check(shot.path).problems == report.problems
    _stage, mesh = composed_mesh(shot, out)
    for attribute in (mesh.GetVelocitiesAttr(), mesh.GetAccelerationsAttr()):
        assert attribute.Get(OFFSET + 2) is None and not attribute.HasAuthoredValue()
        assert not attribute.GetTimeSamples()


@pytest.mark.parametrize("clock", [0.0, -24.0, float("nan"), float("inf")])
def test_rates_on_a_clock_that_does_not_run_are_blocked(shot, out, clock):
    shot.mesh.CreateVelocitiesAttr()
    for frame in range(1, 6):
        shot.mesh.GetVelocitiesAttr().Set(vectors(np.ones_like(REST)), frame)
    stage = Usd.Stage.Open(shot.cache.Flatten())
    stage.GetPrimAtPath("/char/geo/body_GEO").AddAppliedSchema("SkinSlideAPI:sheet")
    primvar = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/char/geo/body_GEO")).CreatePrimvar(
        "skinSlide:sheet:patch", Sdf.ValueTypeNames.BoolArray, "uniform"
    )
    primvar.Set(Vt.BoolArray(FACES, True))
    stage.GetRootLayer().timeCodesPerSecond = clock
    (problem,) = bake(stage).problems
    assert f"the stage has {clock:g} time codes per second" in problem.message


def test_frames_between_samples_at_the_end_of_the_cache(shot, out):
    """A second difference at the last sample takes samples from before a time that lies between."""
    shot.mesh.CreateAccelerationsAttr()
    for frame in range(1, 6):
        shot.mesh.GetAccelerationsAttr().Set(vectors(np.zeros_like(REST)), frame)
    bake_to_file(shot.save().path, out, frames="1004,1004.5,1005")
    _stage, mesh = baked_mesh(out)
    assert mesh.GetAccelerationsAttr().GetTimeSamples() == [1004, 1004.5, 1005]


def test_samples_around():
    times = [1.0, 2.0, 3.0, 4.0]
    assert samples_around(times, 2.0, 2) == [1, 3]
    assert samples_around(times, 2.5, 2) == [2, 3]
    assert samples_around(times, 1.0, 2) == [1, 2]
    assert samples_around(times, 4.0, 2) == [3, 4]
    assert samples_around(times, 2.0, 3) == [1, 2, 3]
    assert samples_around(times, 2.5, 3) == [2, 2.5, 3]
    assert samples_around(times, 1.0, 3) == [1, 2, 3]
    assert samples_around(times, 4.0, 3) == [2, 3, 4]
    assert samples_around(times, 2.0 + 1e-9, 2) == [1, 3]


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
    results = report.meshes[0].patches[0].results
    for i, added in ((2, 0.1), (3, 0.2)):
        results[i] = results[i]._replace(stretch_after=results[i].stretch_before + added)
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
        from skinslide import progress
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


# ---- what is refused, and left alone ----


def bad_outputs(shot: Shot, tmp_path: Path) -> dict[str, Path]:
    (tmp_path / "file").touch()
    (tmp_path / "folder.usda").mkdir()
    os.symlink(shot.path, tmp_path / "link.usda")
    os.link(shot.cache_path, tmp_path / "hard.usdc")
    return {
        "must end in": tmp_path / "out.txt",
        "is a folder": tmp_path / "folder.usda",
        "does not exist": tmp_path / "missing" / "out.usda",
        "the stage reads": shot.path,
        "reads this file": shot.cache_path,
        "stage reads this": tmp_path / "link.usda",
        "stage reads this file": tmp_path / "hard.usdc",
        "not exist": tmp_path / "file" / "out.usda",
    }


def test_outputs_that_cannot_be(shot, tmp_path):
    outputs = bad_outputs(shot.save(), tmp_path)
    before = digest(shot.path.parent)
    for message, path in outputs.items():
        with pytest.raises(UsageError, match=message):
            bake_to_file(shot.path, path)
    assert digest(shot.path.parent) == before


def test_a_read_only_folder(public_folder):
    shot = Shot(public_folder).save()
    folder = public_folder / "locked"
    folder.mkdir(mode=0o555)
    with stages.as_nobody(), pytest.raises(UsageError, match="not writable"):
        bake_to_file(shot.path, folder / "out.usda")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"lookup": Lookup("egl", device=999)}, "there is no EGL device 999"),
        ({"lookup": Lookup("egl", device=-1)}, "no such device: -1"),
        ({"lookup": "magic"}, "'magic' is not one of auto, egl, exact"),
        ({"jobs": 0}, "jobs is 0"),
        ({"jobs": 1.5}, "whole number"),
        ({"max_folded": -1}, "at least 0"),
        ({"max_clamped": "few"}, "whole number"),
        ({"frames": 1001.0}, "a list of numbers"),
        ({"frames": ["a"]}, "a list of numbers"),
        ({"frames": [None]}, "a list of numbers"),
        ({"frames": "one"}, "'one'"),
        ({"frames": ""}, "empty"),
        ({"frames": []}, "must be some"),
        ({"frames": [1001, float("nan")]}, "finite"),
    ],
)
def test_options_that_cannot_be(shot, out, options, message):
    with pytest.raises(UsageError, match=message):
        bake_to_file(shot.save().path, out, **options)
    assert not out.exists()


def test_limit_needs_a_mesh_that_is_subdivided(shot, out):
    shot.over.CreateAttribute("skinSlide:sheet:interpolation", Sdf.ValueTypeNames.Token).Set("limit")
    with pytest.raises(StageProblems, match="limit needs a mesh that is subdivided"):
        bake_to_file(shot.save().path, out)


def test_the_input_is_not_written(shot, out):
    before = digest(shot.save().path.parent)
    bake_to_file(shot.path, out)
    assert digest(shot.path.parent) == before


def assert_untouched(out: Path, old: bytes) -> None:
    assert out.read_bytes() == old
    assert [path.name for path in out.parent.iterdir() if path.is_file()] == [out.name]


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_bad_frame_leaves_the_output_and_names_itself(shot, out, jobs):
    out.write_text("old")
    bad = pose(3)
    bad[40, 1] = np.nan
    shot.mesh.GetPointsAttr().Set(vectors(bad), 3)
    shot.mesh.GetPointsAttr().Set(vectors(REST[:-1]), 4)
    with pytest.raises(FrameProblem, match=f"{MESH}: .*1003.*40"):
        bake_to_file(shot.save().path, out, jobs=jobs)
    assert_untouched(out, b"old")


def test_limits(shot, out, monkeypatch):
    out.write_text("old")
    slide = Slider.slide

    def fold(self, points, controls):
        frame = slide(self, points, controls)
        return frame._replace(patches=tuple(patch._replace(folded_faces=2) for patch in frame.patches))

    with monkeypatch.context() as patched:
        patched.setattr(Slider, "slide", fold)
        with pytest.raises(FrameProblem, match=r"patch sheet: frame 1001: 2 folded faces, where at most 1 are allowed"):
            bake_to_file(shot.save().path, out, max_folded=1)
    assert_untouched(out, b"old")
    bake_to_file(shot.path, out, max_folded=0, max_clamped=0)
    assert out.read_bytes() != b"old"


def test_replacing_keeps_the_mode(shot, out):
    out.touch()
    out.chmod(0o640)
    bake_to_file(shot.save().path, out)
    assert out.stat().st_mode & 0o777 == 0o640


def test_a_new_output_has_the_mode_of_a_new_file(shot, tmp_path):
    (tmp_path / "new").touch()
    bake_to_file(shot.save().path, tmp_path / "out.usdc")
    assert (tmp_path / "out.usdc").stat().st_mode == (tmp_path / "new").stat().st_mode


def test_a_link_to_the_output_stays_a_link(shot, tmp_path):
    (tmp_path / "real.usda").touch()
    os.symlink("real.usda", tmp_path / "link.usda")
    bake_to_file(shot.save().path, tmp_path / "link.usda")
    assert (tmp_path / "link.usda").is_symlink()
    _stage, mesh = baked_mesh(tmp_path / "real.usda")
    assert mesh.GetPointsAttr().GetNumTimeSamples() == 5


def test_a_full_disk_leaves_the_output(shot, out):
    """A limit on the size of files stands in for the disk."""
    out.write_text("old")
    code = """
        import resource, signal, sys, skinslide
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        try:
            skinslide.bake_to_file(sys.argv[1], sys.argv[2])
        except skinslide.StageError as error:
            print(error, file=sys.stderr)
            sys.exit(1)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(shot.save().path), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and str(out) in done.stderr and len(done.stderr.splitlines()) == 1
    assert_untouched(out, b"old")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_bake_leaves_the_output(shot, out, number):
    out.write_text("old")
    code = """
        import sys, time, skinslide
        def stop(done, total):
            if done == 2:
                print("now", flush=True)
                time.sleep(60)
        skinslide.bake_to_file(sys.argv[1], sys.argv[2], progress=stop)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(shot.save().path), str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout.readline() == "now\n"
        assert len(list(out.parent.glob(".out*"))) == 1
        process.send_signal(number)
        assert process.wait(30) != 0
    assert_untouched(out, b"old")


# ---- into a stage ----


def test_bake_authors_into_the_edit_target(shot, out):
    shot.save()
    stage = Usd.Stage.Open(str(shot.path))
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.timeCodesPerSecond = 50  # samples lie at twice the stage's times
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    stage.SetEditTarget(stage.GetEditTargetForLocalLayer(layer))
    bake(stage)
    bake_to_file(shot.path, out)
    assert layer.ListTimeSamplesForPath(f"{MESH}.points")[0] == 2 * (OFFSET + 1)
    _stage, written = baked_mesh(out)
    attribute = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    assert attribute.GetTimeSamples() == written.GetPointsAttr().GetTimeSamples()
    for sample in attribute.GetTimeSamples():
        values = [np.array(source.Get(sample)).tobytes() for source in (attribute, written.GetPointsAttr())]
        assert values[0] == values[1]
    assert not stage.GetRootLayer().dirty


def test_bake_maps_times_through_the_edit_target(shot):
    """Authored into the cache, below the payload, samples lie at the cache's own times."""
    shot.save()
    stage = Usd.Stage.Open(str(shot.path))
    cache = Sdf.Layer.FindOrOpen(str(shot.cache_path))
    node = stage.GetPrimAtPath("/World/char").GetPrimIndex().rootNode.children[0]
    stage.SetEditTarget(Usd.EditTarget(cache, node))
    bake(stage)
    assert cache.ListTimeSamplesForPath("/char/geo/body_GEO.points") == [1, 2, 3, 4, 5]
    slid = np.array(cache.QueryTimeSample("/char/geo/body_GEO.points", 2))
    assert slid.tobytes() == direct(pose(2)).tobytes()


def test_a_stage_may_be_open_before_the_import(shot):
    """The schema registry is then without SkinSlideAPI."""
    code = """
        import sys
        from pxr import Usd
        stage = Usd.Stage.Open(sys.argv[1])
        assert not Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("SkinSlideAPI")
        import skinslide
        assert skinslide.bake(stage).frame_count == 5
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code), str(shot.save().path)], check=True)


def test_a_failed_bake_leaves_the_stage(shot):
    bad = pose(5)
    bad[0, 0] = np.inf
    shot.mesh.GetPointsAttr().Set(vectors(bad), 5)
    stage = Usd.Stage.Open(str(shot.save().path))
    before = stage.GetRootLayer().ExportToString()
    with pytest.raises(FrameProblem):
        bake(stage)
    assert stage.GetRootLayer().ExportToString() == before


def test_a_target_that_cannot_be_edited(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    stage.GetRootLayer().SetPermissionToEdit(False)
    with pytest.raises(UsageError, match="not editable"):
        bake(stage)
    stage = Usd.Stage.Open(str(shot.path))
    layer = Sdf.Layer.CreateAnonymous(".usda")
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    stage.SetEditTarget(layer)
    stage.MuteLayer(layer.identifier)
    with pytest.raises(UsageError, match="muted"):
        bake(stage)


def test_a_target_that_covers_only_some_of_the_meshes(shot):
    other = stages.add_mesh(shot.shot, stages.grid(), "/World/other_GEO")
    stages.add_patch(other, stages.annulus())
    stage = Usd.Stage.Open(str(shot.save().path))
    cache = Sdf.Layer.FindOrOpen(str(shot.cache_path))
    node = stage.GetPrimAtPath("/World/char").GetPrimIndex().rootNode.children[0]
    stage.SetEditTarget(Usd.EditTarget(cache, node))
    before = cache.ExportToString()
    with pytest.raises(UsageError, match="cannot hold opinions on /World/other_GEO"):
        bake(stage)
    assert cache.ExportToString() == before
    assert bake(stage, prims=MESH).frame_count == 5


def test_points_that_stay_hidden_are_named(shot):
    stage = Usd.Stage.Open(str(shot.save().path))
    points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    stage.SetEditTarget(stage.GetSessionLayer())
    points.Set(vectors(pose(1)), OFFSET + 1)
    stage.SetEditTarget(stage.GetRootLayer())
    report = bake(stage)
    assert any("hidden" in problem.message for problem in report.problems)


def test_prims_choose_meshes(shot, out):
    other = MESH.replace("body", "other")
    Sdf.CopySpec(shot.cache.GetRootLayer(), "/char/geo/body_GEO", shot.cache.GetRootLayer(), "/char/geo/other_GEO")
    Sdf.CopySpec(shot.shot.GetRootLayer(), MESH, shot.shot.GetRootLayer(), other)
    report = bake_to_file(shot.save().path, out, prims=[other])
    assert [mesh.path for mesh in report.meshes] == [other]
    report = bake_to_file(shot.path, out)
    assert [mesh.path for mesh in report.meshes] == [MESH, other]
    assert report.frame_count == 10


def test_a_file_that_is_no_stage(tmp_path, out):
    (tmp_path / "bad.usda").write_text("nothing")
    with pytest.raises(StageError):
        bake_to_file(tmp_path / "bad.usda", out)
    assert not out.exists()


def test_points_moved_by_clips(shot, tmp_path, out):
    """Value clips are USD's business: a bake reads what composes."""
    shot.save()
    clip = Sdf.Layer.CreateNew(str(tmp_path / "clip.usda"))
    over = Sdf.CreatePrimInLayer(clip, "/char/geo/body_GEO")
    spec = Sdf.AttributeSpec(over, "points", Sdf.ValueTypeNames.Point3fArray)
    for frame in (1, 2):
        clip.SetTimeSample(spec.path, frame, vectors(pose(frame + 4)))
    clip.Save()
    shot.mesh.GetPrim().RemoveProperty("points")
    pref = UsdGeom.PrimvarsAPI(shot.mesh).CreatePrimvar("pref", Sdf.ValueTypeNames.Point3fArray, "vertex")
    pref.Set(vectors(REST))
    model = Usd.ClipsAPI(shot.cache.GetDefaultPrim())
    model.SetClipAssetPaths([Sdf.AssetPath(str(tmp_path / "clip.usda"))])
    model.SetClipPrimPath("/char")
    model.SetClipActive([Gf.Vec2d(1, 0)])
    model.SetClipTimes([Gf.Vec2d(1, 1), Gf.Vec2d(2, 2)])
    manifest = Usd.ClipsAPI.GenerateClipManifestFromLayers([clip], "/char")
    manifest.Export(str(tmp_path / "manifest.usda"))
    model.SetClipManifestAssetPath(Sdf.AssetPath(str(tmp_path / "manifest.usda")))
    bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == [1001, 1002]
    assert np.array(mesh.GetPointsAttr().Get(1002)).tobytes() == direct(pose(6)).tobytes()
