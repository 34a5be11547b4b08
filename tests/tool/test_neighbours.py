"""Meshes in one space: which of them have points in the same places, as comparing them two by two finds it."""

from itertools import product

import numpy as np
import pytest
from pxr import Usd

import skinslide
import stages
from skinslide.stage.neighbours import Meetings
from stages import MESH


def meet(one: np.ndarray, other: np.ndarray) -> bool:
    return any((a == b).all() and np.isfinite(a).all() for a, b in product(one, other))


@pytest.mark.parametrize("seed", range(8))
def test_all_at_once_is_two_by_two(seed):
    """On a lattice on which many meet; some sets are the same, empty or far, or have points that are nowhere."""
    dice = np.random.default_rng(seed)
    sets = [dice.integers(-9, 9, (dice.integers(0, 12), 3)).astype(np.float32) for _ in range(12)]
    sets += [
        sets[0],
        sets[1] * np.float32(-1),
        sets[2][::-1],
        np.zeros((1, 3), np.float32),
        -np.zeros((1, 3), np.float32),
        sets[5] + np.float32(1000),  # far from all but the next, which it may touch in a corner
        sets[5][:1] + np.float32(1000),
        sets[6] - np.float32(1000),  # and from all
    ]
    for points in sets[3:5]:
        points[::2, 1] = (np.nan, np.inf)[seed % 2]
    meetings = Meetings(sets)
    for number, own in enumerate(sets):
        wanted = [
            other
            for other, points in enumerate(sets)
            if other != number and meet(own, points) and not np.array_equal(own, points)
        ]
        assert meetings.of(number) == wanted


def flat(x: float) -> stages.Shape:
    """A sheet of which a side is where that of the next one is."""
    shape = stages.grid()
    shape.points[:] = shape.points * np.float32((1, 1, 0)) + np.float32((x, 0, 0))
    return shape


def test_no_points_at_all():
    assert Meetings([np.empty((0, 3), np.float32)]).of(0) == []


def test_a_mesh_below_a_payload_that_is_not_loaded(tmp_path):
    """Where it is defined outside of that, it is slid, and meets others as where all is loaded."""
    stages.save(stages.new_stage(), tmp_path / "payload.usda")
    stage = stages.new_stage()
    stage.DefinePrim("/World/far").GetPayloads().AddPayload("./payload.usda", "/World")
    meshes = [
        stages.add_mesh(stage, flat(x), f"/World/{path}") for x, path in enumerate(("near", "far/body_GEO", "end"))
    ]
    stages.add_patch(meshes[1], stages.grid().all_faces)
    file = str(stages.save(stage, tmp_path / "shot.usda"))
    loaded, unloaded = (
        [each.message for each in skinslide.check(Usd.Stage.Open(file, load), lookup="exact").problems]
        for load in (Usd.Stage.LoadAll, Usd.Stage.LoadNone)
    )
    assert loaded == unloaded and sum("border points coincide" in message for message in loaded) == 2


@pytest.mark.parametrize("step", [0.0, 1.0])
def test_check_reads_a_mesh_for_those_it_meets_alone(step, monkeypatch):
    """Of many in one place, which are copies, and of many that each meet the next along a side."""
    stage, compared = stages.new_stage(), []
    for number in range(6):
        shape = flat(step * number)
        stages.add_patch(stages.add_mesh(stage, shape, f"{MESH}{number}"), shape.all_faces)
    neighbours = skinslide.Slider.neighbours
    monkeypatch.setattr(
        skinslide.Slider, "neighbours", lambda *given, **more: compared.append(1) or neighbours(*given, **more)
    )
    problems = skinslide.check(stage).problems
    assert len(compared) == (10 if step else 0)
    assert len([each for each in problems if "border points coincide" in each.message]) == (10 if step else 0)
