"""Meshes in one space: which of them have points in the same places, as comparing them two by two finds it."""

from itertools import product

import numpy as np
import pytest

import skinslide
import stages
from skinslide.stage.neighbours import Meetings
from stages import MESH


def meet(one: np.ndarray, other: np.ndarray) -> bool:
    return any((a == b).all() and np.isfinite(a).all() for a, b in product(one, other))


@pytest.mark.parametrize("seed", range(8))
def test_all_at_once_is_two_by_two(seed):
    """On a lattice on which many meet; some sets are the same, some empty, some have points that are nowhere."""
    dice = np.random.default_rng(seed)
    sets = [dice.integers(-9, 9, (dice.integers(0, 12), 3)).astype(np.float32) for _ in range(12)]
    sets += [
        sets[0],
        sets[1] * np.float32(-1),
        sets[2][::-1],
        np.zeros((1, 3), np.float32),
        -np.zeros((1, 3), np.float32),
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


def test_no_points_at_all():
    assert Meetings([np.empty((0, 3), np.float32)]).of(0) == []


@pytest.mark.parametrize("step", [0.0, 1.0])
def test_check_reads_a_mesh_for_those_it_meets_alone(step, monkeypatch):
    """Of many in one place, which are copies, and of many that each meet the next along a side."""
    stage, compared = stages.new_stage(), []
    for number in range(6):
        shape = stages.grid(centre=(0, 0, 0))
        shape.points[:] = shape.points * np.float32((1, 1, 0)) + np.float32((step * number, 0, 0))
        stages.add_patch(stages.add_mesh(stage, shape, f"{MESH}{number}"), shape.all_faces)
    neighbours = skinslide.Slider.neighbours
    monkeypatch.setattr(
        skinslide.Slider, "neighbours", lambda *given, **more: compared.append(1) or neighbours(*given, **more)
    )
    problems = skinslide.check(stage).problems
    assert len(compared) == (10 if step else 0)
    assert len([each for each in problems if "border points coincide" in each.message]) == (10 if step else 0)
