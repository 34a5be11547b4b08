"""What cannot be slid under the rule unit cannot be under even and relaxed, row by row, in the same words."""

from dataclasses import replace

import numpy as np
import pytest

import skinslide
from bad_stages import BAD
from edits import all_of, setting
from good_stages import GOOD
from readers import baked
from rows import Bad, made, named
from skinslide.problems import FrameProblem, Problem, StageProblems
from stages import PATCH

RULES = ("even", "relaxed")
# What only a plane cannot have.
PLANE_ONLY = {"patch: closed", "patch: pinched", "corners: inside", "holes: all free, by a rule in the plane"}


@pytest.fixture(autouse=True)
def no_device(monkeypatch):
    """No stage needs one, and check takes a tenth of a second to look for it."""
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "")


def ruled(row: Bad, rule: str) -> Bad:
    """The row with a rule; a row of another patch, or of a rule itself, keeps its own."""
    first = setting("forceDensityRule", rule)
    return replace(row, edit=all_of(first, row.edit)) if row.patch in (PATCH, None) else row


def errors_of(stage, output) -> list[Problem]:
    """What stops a bake."""
    try:
        skinslide.bake_to_file(stage, output)
    except StageProblems as bad:
        return [problem for problem in bad.problems if problem.severity == "error"]
    except FrameProblem as bad:
        return [bad.problem]
    return []


def is_said(row: Bad, folder, problem: Problem) -> bool:
    text = row.says.replace("{folder}", str(folder)).removesuffix("...")
    place = (problem.prim, problem.patch, problem.frame if row.frame else None)
    return problem.message.startswith(text) and place == (row.prim, row.patch, float(row.frame) if row.frame else None)


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("row", named(BAD))
def test_a_bad_stage_is_bad_by_any_rule(row, rule, tmp_path):
    path, output = made(ruled(row, rule), tmp_path), tmp_path / "out.usda"
    checked = [problem for problem in skinslide.check(path).problems if problem.severity == "error"]
    if row.name in PLANE_ONLY:
        assert not checked and not errors_of(path, output) and output.exists()
        return
    for found in (checked, errors_of(path, output)):
        assert len(found) == 1 and is_said(row, tmp_path, found[0]), found
    assert not output.exists()


def test_rows_that_only_a_plane_refuses_are_there():
    assert {row.name for row in BAD} >= PLANE_ONLY


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("row", named(GOOD))
def test_a_good_stage_is_good_by_any_rule(row, rule, tmp_path):
    """Its points are finite, unless it is of points that are not."""
    path = made(replace(row, edit=all_of(setting("forceDensityRule", rule), row.edit)), tmp_path)
    bake, _ = baked(path)
    slid = [value for name, values in bake.items() if name.endswith(".points") for value in values.at.values()]
    assert slid
    if "point that no patch uses" not in row.warns:
        assert all(np.isfinite(np.frombuffer(value, np.float32)).all() for value in slid)
