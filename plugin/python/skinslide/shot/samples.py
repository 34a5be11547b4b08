"""Looks at every sample of a mesh for what would fail, or be clamped, at a frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from pxr import Usd

from skinslide.arrays.native import Controls
from skinslide.problems import Fault, FrameProblem, Problem
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST


def sample_problems(mesh: PatchedMesh, times: Sequence[float]) -> Iterator[Problem]:
    """For points, and for each patch, the first problem of a kind, and at how many more frames there is one."""
    codes = [Usd.TimeCode(time) for time in times]
    yield from _first_of(_points_problem(mesh, code) for code in codes)
    for index, animation in enumerate(mesh.animation):
        moments = codes if animation.varies else [FIRST]
        found = [_controls_problem(mesh, index, moment) for moment in moments]
        for severity in ("error", "warning"):
            yield from _first_of(problem for problem in found if problem and problem.severity == severity)


def _first_of(found: Iterator[Problem | None]) -> Iterator[Problem]:
    there = [problem for problem in found if problem]
    if not there:
        return
    first, more = there[0], len(there) - 1
    frames = f" (and something like it at {more} more frame{'s' * (more > 1)})" if more else ""
    yield replace(first, message=first.message + frames)


def _points_problem(mesh: PatchedMesh, time: Usd.TimeCode) -> Problem | None:
    try:
        mesh.meaning.check_points(mesh.points_at(time))
    except FrameProblem as bad:
        return bad.problem
    except Fault as fault:
        return mesh.problem(str(fault), time)
    return None


def _controls_problem(mesh: PatchedMesh, index: int, time: Usd.TimeCode) -> Problem | None:
    try:
        message = _clamped(mesh, index, mesh.patch_controls_at(index, time))
    except FrameProblem as bad:
        return bad.problem
    return replace(mesh.problem(message, time, mesh.patches[index].name), severity="warning") if message else None


def _clamped(mesh: PatchedMesh, index: int, controls: Controls) -> str | None:
    """What of a patch's weights is outside 0..1."""
    if not 0 <= controls.envelope <= 1:
        return f"envelope is {controls.envelope:g}, which is clamped to 0..1"
    if controls.weight is None:
        return None
    inside = mesh.topology.vertices_of(mesh.patches[index].faces)
    outside = np.flatnonzero(inside & ((controls.weight < 0) | (controls.weight > 1)))
    if not outside.size:
        return None
    first = f"weight of vertex {outside[0]} is {controls.weight[outside[0]]:g}"
    more = f", and {outside.size - 1} more are outside too" if outside.size > 1 else ""
    return f"{first}{more}; weights are clamped to 0..1"
