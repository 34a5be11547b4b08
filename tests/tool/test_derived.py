"""What a bake writes that follows from points: what the skin carries, velocities, accelerations."""

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, Vt

import skinslide
from repository import load
from shots import (
    COUNTS,
    FACES,
    INDICES,
    MESH,
    OFFSET,
    REST,
    VERTICES,
    baked_mesh,
    composed_mesh,
    direct,
    pose,
)
from skinslide import PatchSetup, Slider, bake, bake_to_file
from stages import vectors


def flat_normals(count: int) -> Vt.Vec3fArray:
    return vectors(np.tile([0.0, 0.0, 1.0], (count, 1)))


def true_normals(points: np.ndarray, frame: float) -> np.ndarray:
    """The normals (n, 3) of the bump of `pose` at points on it."""
    x, y = points[:, 0].astype(np.float64) - frame, points[:, 1].astype(np.float64) - 4.0
    slope = 1.8 * np.exp(-0.3 * (x * x + y * y))
    normals = np.stack([slope * x, slope * y, np.ones_like(x)], axis=1)
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def angles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Angles between vectors (n, 3), in degrees; exact also if they are small."""
    a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


INTERPOLATIONS = [("vertex", VERTICES), ("varying", VERTICES), ("faceVarying", 4 * FACES), ("uniform", FACES)]


@pytest.mark.parametrize(("interpolation", "count"), INTERPOLATIONS)
@pytest.mark.parametrize("animated", [True, False])
def test_normals_are_carried_at_their_interpolation(shot, out, interpolation, count, animated):
    shot.mesh.SetNormalsInterpolation(interpolation)
    shot.mesh.CreateNormalsAttr()
    for sample in range(1, 6) if animated else [Usd.TimeCode.Default()]:
        shot.mesh.GetNormalsAttr().Set(flat_normals(count), sample)
    report = bake_to_file(shot.save().path, out)
    _stage, mesh = baked_mesh(out)
    assert mesh.GetNormalsAttr().GetTimeSamples() == mesh.GetPointsAttr().GetTimeSamples()
    turns = Slider(COUNTS, INDICES, REST, [PatchSetup("sheet", np.arange(FACES))]).slide(pose(2), turns=True).turns
    expected = skinslide.carry(COUNTS, INDICES, turns, np.array(flat_normals(count)), interpolation)
    assert np.array(mesh.GetNormalsAttr().Get(OFFSET + 2)).tobytes() == expected.tobytes()
    assert not mesh.GetNormalsAttr().HasMetadata("interpolation")
    assert [problem.message for problem in report.problems] == (
        [] if animated else ["normals has one value for all frames, but points moves: it belongs to one pose alone"]
    )
    assert skinslide.check(shot.path).problems == report.problems


def with_normals(shot, envelope: float) -> np.ndarray:
    """The true normals of the cache at frame 2, by corner, on a shot that slides so far."""
    shot.mesh.SetNormalsInterpolation("faceVarying")
    for frame in range(1, 6):
        normals = true_normals(pose(frame), frame)[INDICES]
        shot.mesh.CreateNormalsAttr().Set(vectors(normals), frame)
    shot.envelope().Set(envelope)
    shot.save()
    return np.float32(true_normals(pose(2), 2)[INDICES])


def test_without_a_slide_normals_keep_their_bits(shot, out):
    cached = with_normals(shot, 0)
    bake_to_file(shot.path, out)
    _stage, mesh = baked_mesh(out)
    assert np.array(mesh.GetNormalsAttr().Get(OFFSET + 2)).tobytes() == cached.tobytes()


def test_a_tiny_slide_is_no_jump(shot, out):
    cached = with_normals(shot, 1e-5)
    bake_to_file(shot.path, out)
    _stage, mesh = baked_mesh(out)
    slid = np.array(mesh.GetPointsAttr().Get(OFFSET + 2)) - pose(2)
    assert 1e-7 < np.linalg.norm(slid, axis=1).max() < 2e-5
    assert angles(mesh.GetNormalsAttr().Get(OFFSET + 2), cached).max() < 0.005


def test_angles_across_seams_stay_as_in_the_cache(shot, out):
    """All corners of a vertex turn alike, whatever their normals are."""
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(4 * FACES, 3)).astype(np.float32)
    tangents = rng.normal(size=(4 * FACES, 3)).astype(np.float32)
    shot.mesh.SetNormalsInterpolation("faceVarying")
    primvars = UsdGeom.PrimvarsAPI(shot.mesh)
    primvar = primvars.CreatePrimvar("tangents", Sdf.ValueTypeNames.Vector3fArray, "faceVarying")
    for frame in range(1, 6):
        shot.mesh.CreateNormalsAttr().Set(vectors(normals), frame)
        primvar.Set(vectors(tangents), frame)
    bake_to_file(shot.save().path, out)
    _stage, mesh = composed_mesh(shot, out)
    values = mesh.GetNormalsAttr(), UsdGeom.PrimvarsAPI(mesh).GetPrimvar("tangents")
    after = [np.array(each.Get(OFFSET + 2)) for each in values]
    assert angles(after[0], normals).max() > 1
    by_vertex = np.argsort(INDICES, kind="stable")
    pairs = by_vertex[:-1][np.diff(INDICES[by_vertex]) == 0], by_vertex[1:][np.diff(INDICES[by_vertex]) == 0]
    for cached, carried in zip((normals, tangents), after, strict=True):
        assert np.allclose(
            angles(carried[pairs[0]], carried[pairs[1]]), angles(cached[pairs[0]], cached[pairs[1]]), atol=1e-4
        )
    # And a normal and its tangent, which are floats of length 2 or so.
    assert np.allclose(angles(after[0], after[1]), angles(normals, tangents), atol=1e-4)


def test_normals_of_an_example_are_measured(example_stage):
    _name, _slide, turned, jump, cached, slid = load("measure/normals.py").row(example_stage("chequer"))
    assert float(turned) > 5 and (jump, cached, slid) == ("0.00", "0.00", "0.00")


def test_a_seam_that_parts_is_measured():
    measure = load("measure/normals.py")
    up, tilted, across = (0.0, 0.0, 1.0), (0.0, np.sin(0.1), np.cos(0.1)), (1.0, 0.0, 0.0)
    cached, slid = {1: np.array([up, up, up, across])}, {1: np.array([up, tilted, up, up])}
    pairs = np.array([0, 2]), np.array([1, 3])  # the second of which is a hard edge in the cache
    assert measure.largest_seam(cached, cached, pairs) == 0
    assert measure.largest_seam(cached, slid, pairs) == pytest.approx(np.degrees(0.1))
    assert measure.largest_turn(cached, slid) == pytest.approx(90)


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
    assert problem.frame is None and "normals cannot be recomputed, so the bake blocks them" in problem.message


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
