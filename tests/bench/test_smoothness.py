"""How the relaxed rule moves skin in the course of the examples' motions, where skin crumples most."""

import numpy as np
import pytest
from pxr import Usd

from repository import load
from skinslide.stage.reading import read_meshes


@pytest.mark.parametrize("name", ["elbow", "bicep", "sleeve", "finger"])
def test_relaxed_skin_does_not_jump(name, example_stage):
    smoothness = load("measure/smoothness.py")
    stage = example_stage(name)
    mesh = read_meshes(Usd.Stage.Open(str(stage)))[0][0]
    _, times, moves = smoothness.motions(mesh)
    edge = smoothness.mean_edge(mesh, mesh.patches[0].faces)
    unit, relaxed = (smoothness.Rough.of(moves[rule], times) for rule in ("unit", "relaxed"))
    # A jump stays where steps are four times as short, a sharp turn shrinks by 4, a smooth motion by 16.
    assert smoothness.shrinks(moves["relaxed"], relaxed) > 2
    # A hundredth of an edge in a quarter of a frame is what no eye tells from the motion that it is part of.
    assert relaxed.most < 0.0105 * edge
    # Nor does the measure: what the paper's rule does is no rougher than a sharp turn either.
    assert unit.most < 0.02 * edge and smoothness.shrinks(moves["unit"], unit) > 2


def test_a_jump_is_told():
    smoothness = load("measure/smoothness.py")

    def jumping(time: float) -> np.ndarray:
        return np.array([[np.sin(time), 0, 0], [0.1 * (time > 5.1), 0, 0]])

    times = np.arange(0, 10, smoothness.STEP)
    rough = smoothness.Rough.of(jumping, times)
    assert rough.worst[1] == 1 and smoothness.shrinks(jumping, rough) == pytest.approx(1)
    smooth = smoothness.Rough.of(lambda time: jumping(time)[:1], times)
    assert smoothness.shrinks(lambda time: jumping(time)[:1], smooth) == pytest.approx(16, rel=0.05)
