"""Looks at every sample of a mesh for what would fail, or be clamped, at a frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from pxr import Usd

from skinslide.arrays.setups import Controls
from skinslide.arrays.slider import Slider
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, counted, first_of
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST


def sample_problems(mesh: PatchedMesh, slider: Slider | None, times: Sequence[float]) -> Iterator[Problem]:
    """For points, and for each patch, the first problem of a kind, and at how many more frames there is one."""
    codes = [Usd.TimeCode(time) for time in times]
    yield from _by_severity(_points_problem(mesh, slider, code) for code in codes)
    for index, animation in enumerate(mesh.animation):
        moments = codes if animation.varies else [FIRST]
        yield from _by_severity(_controls_problem(mesh, index, moment) for moment in moments)


def finite_problem(mesh: PatchedMesh, points: np.ndarray, time: Usd.TimeCode) -> Problem | None:
    """A warning of points that are not finite, where all are made, and none is slid."""
    try:
        mesh.meaning.check_points(points)
        return None
    except Fault as fault:
        more = int(np.count_nonzero(~np.isfinite(points).all(axis=1))) - 1
        also = f", and {counted(more, 'more is not', 'more are not')}" if more else ""
        return replace(mesh.problem(f"{fault}{also}", time), severity="warning")


def _by_severity(found: Iterable[Problem | None]) -> Iterator[Problem]:
    there = [problem for problem in found if problem]
    for severity in ("error", "warning"):
        yield from first_of(problem for problem in there if problem.severity == severity)


def _points_problem(mesh: PatchedMesh, slider: Slider | None, time: Usd.TimeCode) -> Problem | None:
    try:
        points = mesh.points_at(time)
        if slider is None:
            mesh.meaning.check_points(points)
            return None
        warning = slider.check_points(points)
    except FrameProblem as bad:
        return bad.problem
    except (Fault, SliderError) as fault:
        return mesh.problem(str(fault), time)
    return replace(mesh.problem(warning, time), severity="warning") if warning else None


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
