"""The benchmark's patches, and that a frame by the core is one from libraries."""

import numpy as np
import pytest
from compare import patches
from compare.ours import Ours, PointsAlone
from compare.peers import Peer


@pytest.mark.parametrize("kind", patches.KINDS)
def test_a_frame_is_that_of_libraries(kind):
    patch = patches.patch_of(kind, 400)
    ours = Ours()
    ours.begin(patch)
    alone = PointsAlone()
    alone.begin(patch)
    peer = Peer("splu", "igl")
    peer.begin(patch.with_border(ours.rest_embedding))
    assert np.abs(ours.rest_embedding - peer.rest_embedding).max() < 1e-9
    for pose in patch.poses:
        one, other = ours.frame(pose), peer.frame(pose)
        assert np.abs(one.embedding - other.embedding).max() < 1e-9
        assert np.abs(one.points - other.points).max() < 1e-6
        assert np.abs(one.points - pose).max() > 1e-3
        assert np.array_equal(alone.frame(pose).points, one.points)


def test_patches_of_the_paper_have_its_counts():
    found = []
    for patch in patches.papers():
        edges = np.unique(np.sort(patch.sides(), axis=1), axis=0)
        assert len(patch.rest) - len(edges) + len(patch.counts) == 1
        found.append((len(patch.rest), len(edges)))
    assert tuple(found) == patches.PAPER


def test_points_lie_as_said():
    """Consecutive points are far apart if they are shuffled, and near if they follow a curve."""
    far = {}
    for kind in patches.KINDS:
        steps = np.diff(patches.patch_of(kind, 2500).rest, axis=0)
        far[kind] = np.median(np.linalg.norm(steps, axis=1))
    assert far["regular"] < 0.03 and far["irregular"] < 0.06 and far["shuffled"] > 0.3
