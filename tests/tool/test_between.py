"""Frames between samples that lie more than one time code apart: each is slid for itself, whoever asks for it."""

import numpy as np
import pytest
from pxr import Usd, UsdGeom

import skinslide
import stages
from skinslide import bake
from stages import FRAMES, MESH

SAMPLES = (1001.0, 1004.5, 1006.5)
TIMES = [1001, 1002, 1003, 1004, 1004.5, 1005, 1006, 1006.5]
RATE = 24


@pytest.fixture
def stage() -> Usd.Stage:
    """A stage with velocities of 0."""
    stage, mesh = stages.patched_stage()
    points = mesh.GetPointsAttr()
    for frame in FRAMES:
        points.ClearAtTime(frame)
    for sample, frame in zip(SAMPLES, FRAMES, strict=True):
        points.Set(stages.vectors(stages.grid().moved(frame)), sample)
        mesh.CreateVelocitiesAttr().Set(stages.vectors(np.zeros((49, 3))), sample)
    stage.SetEditTarget(stage.GetSessionLayer())
    return stage


def baked(stage: Usd.Stage, name: str = "points", **options) -> dict[float, np.ndarray]:
    bake(stage, **options)
    attribute = stage.GetPrimAtPath(MESH).GetAttribute(name)
    return {time: np.array(attribute.Get(time)) for time in attribute.GetTimeSamples()}


def cached(stage: Usd.Stage) -> dict[float, np.ndarray]:
    """The points before a bake."""
    points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    return {time: np.array(points.Get(time)) for time in TIMES}


def rates(slid: dict[float, np.ndarray], cache: dict[float, np.ndarray], *times: float) -> np.ndarray:
    """How fast the slide changes between two times."""
    first, last = (slid[time].astype(float) - cache[time] for time in times)
    return (last - first) / (times[1] - times[0]) * RATE


@pytest.mark.parametrize("name", ["points", "velocities"])
def test_a_frame_alone_is_that_of_all(stage, name):
    every = baked(stage, name)
    assert list(every) == TIMES
    for time in TIMES:
        (alone,) = baked(stage, name, frames=[time]).values()
        assert alone.tobytes() == every[time].tobytes()


def test_slid_points_do_not_go_straight(stage):
    """Cached points do, so that slid ones need the frames between samples."""
    cache, slid = cached(stage), baked(stage)
    for points, tolerance in ((cache, 1e-6), (slid, None)):
        off = np.abs(points[1005] - (0.75 * points[1004.5] + 0.25 * points[1006.5])).max()
        assert off < tolerance if tolerance else off > 1e-4


def test_samples_alone(stage):
    every = baked(stage)
    alone = baked(stage, frames="authored")
    assert list(alone) == list(SAMPLES)
    assert all(alone[time].tobytes() == every[time].tobytes() for time in SAMPLES)


def test_velocities_are_those_from_frame_to_frame(stage):
    cache = cached(stage)
    slid, velocities = baked(stage), baked(stage, "velocities")
    np.testing.assert_allclose(velocities[1003], rates(slid, cache, 1002, 1004), atol=1e-5)
    velocities = baked(stage, "velocities", frames="authored")
    np.testing.assert_allclose(velocities[1004.5], rates(slid, cache, 1001, 1006.5), atol=1e-5)


def test_where_values_are_held_so_is_what_was_slid(stage):
    stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    assert not skinslide.check(stage).problems
    assert list(baked(stage)) == list(SAMPLES)


def test_their_count_is_said(stage):
    (said,) = skinslide.check(stage).problems
    (mesh,) = skinslide.check(stage).meshes
    assert mesh.samples == TIMES
    assert said.severity == "note" and said.message.startswith("5 frames between samples are slid too")
    assert bake(stage).problems == [said]
    assert not bake(stage, frames="authored").problems


def test_of_samples_ages_apart_some_can_be_named(stage):
    points = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    with Usd.EditContext(stage, stage.GetRootLayer()):
        points.Set(points.Get(SAMPLES[-1]), 2e7)
    with pytest.raises(skinslide.StageProblems, match="by frame 20000000 there are more than 10000000 frames"):
        bake(stage)
    assert list(baked(stage, frames=[1002])) == [1002]
