"""The paper's experiment on stability: its weights are what they are said to be."""

import numpy as np
import pytest
import scipy.sparse as sparse

from repository import load


@pytest.fixture(scope="module")
def stability():
    return load("measure/stability.py")


@pytest.fixture(scope="module")
def sphere(stability):
    return stability.Sphere()


def test_a_spread_is_of_directions(stability):
    """A spread depends on directions alone, and only on displacements that are long enough."""
    towards = np.array([[1.0, 0.0], [2.0, 0.0], [0.0, 0.01]])
    assert stability.spread(towards) == 0
    assert stability.spread(np.array([[1.0, 0.0], [-1.0, 1e-9]])) == pytest.approx(180)
    assert stability.spread(np.array([[-1.0, 0.1], [-1.0, -0.1]])) == pytest.approx(2 * np.degrees(np.arctan(0.1)))


@pytest.mark.parametrize("weights", ["harmonic", "mean_value"])
def test_weights_leave_a_flat_net_where_it_is(stability, sphere, weights):
    """Both weights reproduce the plane: in any flat net each vertex is the mean of its neighbours."""
    chance = np.random.default_rng(0)
    flat = sphere.rest + np.where(np.isnan(sphere._border), chance.normal(0, 0.005, sphere.rest.shape), 0)
    found = getattr(stability, weights)(np.column_stack([flat, np.zeros(len(flat))]), sphere.faces)
    border = np.where(np.isnan(sphere._border), np.nan, flat)
    assert np.abs(stability.embedding(found, border) - flat).max() < 1e-9


def test_unit_is_the_rule_of_the_core(stability, sphere):
    """1 / length, solved by another solver."""
    points = stability.turned(sphere.points, 10).astype(np.float32).astype(float)
    a, b = np.unique(np.sort(sphere.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)), axis=0).T
    density = 1 / np.linalg.norm(points[a] - points[b], axis=1)
    entries = np.tile(density, 2), (np.concatenate([a, b]), np.concatenate([b, a]))
    weights = sparse.csr_matrix(entries, (len(points),) * 2)
    assert np.abs(stability.embedding(weights, sphere._border) - sphere.by_density("unit")(points)).max() < 1e-9


def test_only_harmonic_weights_turn_triangles_over(stability, sphere):
    """All other weights are positive."""
    found = stability.curves(sphere)
    assert {kind: curve.folds > 0 for kind, curve in found.items()} == {
        "unit": False,
        "fast": False,
        "harmonic": True,
        "mean value": False,
        "even": False,
    }
