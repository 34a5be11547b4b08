"""What is not finite off every patch passes as it is, with a warning: in bakes, checks and pictures."""

import subprocess
import sys

import numpy as np
import pytest

import skinslide
import stages
from stages import FRAMES, MESH, PATCH

FAULTY = 3  # no face at the patch has it


@pytest.fixture
def stage():
    """A stage whose patch is in the middle; from the second frame on a point at its border is nowhere."""
    stage, mesh = stages.patched_stage(stages.grid(9, 9), stages.block(9, range(3, 6), range(3, 6)))
    for frame in FRAMES[1:]:
        points = np.array(mesh.GetPointsAttr().Get(frame))
        points[FAULTY] = np.nan
        mesh.GetPointsAttr().Set(stages.vectors(points), frame)
    return stage


def warnings(problems) -> list[str]:
    return [str(problem) for problem in problems if problem.severity == "warning"]


SAYS = (
    f"warning: {MESH}: frame 1002: 1 point that no patch uses is not finite, and stays as it is: vertex {FAULTY} at "
    "(nan, nan, nan) (and something like it at 1 more frame)"
)


def test_check_and_bake_say_the_same(stage, tmp_path):
    report = skinslide.check(stage)
    assert warnings(report.problems) == [SAYS] and not report.failed
    assert warnings(skinslide.bake_to_file(stage, tmp_path / "slid.usdc").problems) == [SAYS]


def test_check_of_a_patch_that_is_bad_names_it_all_the_same(stage):
    stage.GetPrimAtPath(MESH).GetAttribute(f"skinSlide:{PATCH}:corners").Set([0, 1, 2, 3])
    said = [str(problem) for problem in skinslide.check(stage).problems]
    assert any(f"points: vertex {FAULTY} is not finite" in each for each in said)


def test_pictures_are_drawn(stage, tmp_path):
    """In a process of its own: tests that hide EGL's devices leave them hidden."""
    shot, pictures = tmp_path / "shot.usda", tmp_path / "pictures"
    stage.Export(str(shot))
    command = [sys.executable, "-m", "skinslide", "preview", str(shot), "-o", str(pictures)]
    options = ["--size", "64x36", "--view", "chequer"]
    done = subprocess.run([*command, *options], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert [line for line in done.stdout.splitlines() if line.startswith("warning")] == [SAYS]
    assert len(list(pictures.glob("*.chequer.*.png"))) == len(FRAMES)


def test_a_point_of_the_patch_is_no_such(stage, tmp_path):
    mesh = stage.GetPrimAtPath(MESH)
    points = np.array(mesh.GetAttribute("points").Get(FRAMES[2]))
    points[44, 1] = np.inf
    mesh.GetAttribute("points").Set(stages.vectors(points), FRAMES[2])
    with pytest.raises(skinslide.FrameProblem, match="frame 1003: points: vertex 44 is not finite"):
        skinslide.bake_to_file(stage, tmp_path / "slid.usdc")
