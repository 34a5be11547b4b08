"""How roughly skin moves in the course of a shot: what the report says of it, and a bake that it fails."""

import json

import numpy as np
import pytest

from shots import MESH, OFFSET, baked_mesh, pose
from skinslide import FrameProblem, UsageError, bake_to_file
from skinslide.command.cli import main
from stages import vectors

FRAMES = range(1, 6)
POP = 3  # a frame at which alone nothing slides


def posed(shot, pose_at):
    for frame in FRAMES:
        shot.mesh.GetPointsAttr().Set(vectors(np.float32(pose_at(frame))), frame)
    return shot


def popping(shot):
    """Skin that slides over a pose that stands still, except at one frame."""
    for frame in FRAMES:
        shot.envelope().Set(float(frame != POP), OFFSET + frame)
    return posed(shot, lambda _frame: pose(4)).save()


def patch_of(shot, out, **options):
    return bake_to_file(shot.save().path, out, **options).meshes[0].patches[0]


def second_differences(poses: np.ndarray) -> np.ndarray:
    """The largest second difference of any vertex at each time between two others."""
    return np.linalg.norm(np.diff(poses.astype(float), 2, axis=0), axis=2).max(axis=1)


def test_second_differences_are_those_of_the_points(shot, out):
    found = patch_of(shot, out).as_dict()
    _stage, mesh = baked_mesh(out)
    slid = np.stack([mesh.GetPointsAttr().Get(OFFSET + frame) for frame in FRAMES])
    before = second_differences(np.stack([pose(frame) for frame in FRAMES]))
    after = second_differences(slid)
    frames = found["frames"]
    for name, expected in (("second_difference_before", before), ("second_difference_after", after)):
        assert [frame[name] for frame in frames[1:-1]] == pytest.approx(expected, rel=1e-12)
        assert frames[0][name] is None is frames[-1][name]
    assert found["roughness"] == pytest.approx(after.max() / before.max(), rel=1e-12)
    assert found["roughest_frame"] == OFFSET + 2 + after.argmax()


def test_skin_at_rest_is_as_smooth_as_its_cache(shot, out):
    assert patch_of(posed(shot, lambda _frame: pose(2)), out).roughness == 1


def test_skin_that_moves_evenly_is_too(shot, out):
    """Both differ from even motion by rounding alone, with coordinates up to 100."""
    patch = patch_of(posed(shot, lambda frame: pose(2) + frame * np.array([20, -3.3, 0.7])), out)
    assert patch.results[0].slid_vertices and patch.roughness == 1


def test_a_jump_is_found_at_its_frame(shot, out):
    patch = patch_of(popping(shot), out)
    assert patch.roughest == OFFSET + POP and patch.roughness > 10
    largest, roughest = max(result.largest_slide for result in patch.results), patch.motion[patch.roughest]
    assert roughest.after == pytest.approx(2 * largest) and patch.roughness == roughest.after / roughest.least


def test_what_nobody_sees_is_not_rough(shot, out):
    """Skin that moves by under a hundredth of an edge may move as it likes over a cache that moves evenly."""
    posed(shot, lambda frame: pose(2) + frame * np.array([1, 0, 0]))
    for frame in FRAMES:
        shot.envelope().Set(0.01 * (frame % 2), OFFSET + frame)
    patch = patch_of(shot, out, max_roughness=1)
    after = max(motion.after for motion in patch.motion.values())
    assert 1e-4 < after < 0.01 and patch.roughness == 1


def test_uneven_frames_are_measured_as_they_are_made(shot, out):
    """Even motion counts as even, whatever the frames are."""
    even = posed(shot, lambda frame: pose(2) + frame * np.array([1, 0, 0]))
    patch = patch_of(even, out, frames=[1001, 1001.5, 1004, 1005])
    assert patch.roughness == 1 and list(patch.motion) == [1001.5, 1004.0]


@pytest.mark.parametrize("frames", [[1001], [1001, 1002]])
def test_it_takes_three_frames(shot, out, frames):
    patch = patch_of(shot, out, frames=frames, max_roughness=1e-9)
    assert patch.roughness is None and patch.roughest is None and patch.as_dict()["roughness"] is None


def test_it_is_the_same_with_any_number_of_jobs(shot, out):
    popping(shot)
    found = [patch_of(shot, out, jobs=jobs) for jobs in (1, 4)]
    assert found[0].motion == found[1].motion


def test_a_bake_fails_by_it(shot, out):
    popping(shot)
    out.write_text("old")
    with pytest.raises(FrameProblem) as failed:
        bake_to_file(shot.path, out, max_roughness=1.5)
    problem = failed.value.problem
    assert (problem.prim, problem.patch, problem.frame) == (MESH, "sheet", OFFSET + POP)
    assert "times as roughly as the cache, where at most 1.5 times are allowed" in problem.message
    assert out.read_text() == "old"
    bake_to_file(shot.path, out, max_roughness=1e7)
    assert out.read_bytes() != b"old"


def test_the_command_fails_by_it(shot, out, capsys):
    popping(shot)
    assert main(["bake", str(shot.path), "-o", str(out), "--max-roughness", "2", "--quiet"]) == 1
    assert not out.exists() and "where at most 2 times are allowed" in capsys.readouterr().err
    assert main(["bake", str(shot.path), "-o", str(out), "--json", "--quiet"]) == 0
    (mesh,) = json.loads(capsys.readouterr().out)["meshes"]
    assert mesh["patches"][0]["roughest_frame"] == OFFSET + POP


@pytest.mark.parametrize("most", [0, -1, float("nan"), "rough"])
def test_what_is_no_roughness(shot, out, most):
    with pytest.raises(UsageError, match="max_roughness is"):
        bake_to_file(shot.save().path, out, max_roughness=most)
