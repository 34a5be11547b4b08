"""Slides the skin of a stage's meshes at every frame:

meshes, problems = read the stage              any error: stop here, nothing is written
for each mesh: its slider                      patches embedded at rest, once a shot
for each mesh:
    times = --frames, or the authored samples of points and animated controls, or the default
    for each time in order, and the times beside it that velocities need, each once, several at once:
        points and controls at that time       read on this thread
        slide                                  on a thread of the pool
    for each time in order: author points, extent, normals, velocities, accelerations
put the layer in place                         or author it all into the stage's edit target
"""

import os
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.derived import Derived, Solved
from skinslide.frames import UsageError, checked_frames
from skinslide.meshes import SlidMesh, read_meshes
from skinslide.output import OverLayer, author_on_stage, check_output, layer_in_place
from skinslide.problems import FrameProblem, Problem, StageProblems, core_problem, errors
from skinslide.progress import Progress
from skinslide.report import BakeReport, MeshReport
from skinslide.slider import Lookup, Slider, SliderError, choose_lookup
from skinslide.stage import open_stage

Frames = Sequence[float] | str | None


@dataclass(frozen=True)
class Limits:
    """What a patch may have at one frame before the bake fails; None is any number."""

    folded_faces: int | None = None
    clamped_vertices: int | None = None


def bake_to_file(
    stage_path: str | os.PathLike,
    output_path: str | os.PathLike,
    *,
    prims: Sequence[str] | None = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
) -> BakeReport:
    """Bakes a stage into a layer of overs to be sublayered above it. `output_path` is written whole or not at all.

    prims     mesh paths; None: every mesh with a patch
    frames    stage times, or a spec such as "101:109x2"; None: the authored samples
    lookup    auto, egl, exact, or a Lookup; the result does not depend on it. egl fails where it cannot be had
    jobs      frames slid at once; the result does not depend on it
    progress  called after each frame with the frames done and in all
    Raises UsageError, StageProblems, FrameProblem (also where max_folded or max_clamped is exceeded), StageError.
    """
    stage, output = open_stage(stage_path), Path(output_path)
    check_output(output, stage)
    plan = _Plan.read(stage, prims, frames, lookup, jobs, Limits(max_folded, max_clamped))
    with layer_in_place(output, stage) as overs:
        return plan.run(overs, progress)


def bake(
    stage: Usd.Stage,
    *,
    prims: Sequence[str] | None = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
) -> BakeReport:
    """Bakes a stage into its edit target, once every frame is known; arguments and exceptions as `bake_to_file`'s."""
    target = stage.GetEditTarget().GetLayer()
    if not target.permissionToEdit:
        raise UsageError(f"the edit target {target.identifier} is not editable")
    plan = _Plan.read(stage, prims, frames, lookup, jobs, Limits(max_folded, max_clamped))
    overs = OverLayer(Sdf.Layer.CreateAnonymous())
    report = plan.run(overs, progress)
    author_on_stage(overs, stage)
    report.warnings.extend(_hidden(plan.meshes, target))
    return report


@dataclass(frozen=True)
class _Plan:
    """A bake that is known to be possible: a slider for every mesh, and the times to bake it at."""

    meshes: list[tuple[SlidMesh, Slider, list[Usd.TimeCode]]]
    problems: list[Problem]
    jobs: int
    limits: Limits

    @classmethod
    def read(
        cls,
        stage: Usd.Stage,
        prims: Sequence[str] | None,
        frames: Frames,
        lookup: str | Lookup,
        jobs: int,
        limits: Limits,
    ) -> "_Plan":
        if jobs < 1:
            raise UsageError(f"jobs is {jobs}; it must be at least 1")
        with _as_usage_error():
            choose_lookup(lookup)
        asked = None if frames is None else checked_frames(frames)
        meshes, problems = read_meshes(stage, prims)
        sliders = _build_sliders(meshes, lookup, problems)
        if errors(problems):
            raise StageProblems(problems)
        times = [_times(mesh, asked) for mesh in meshes]
        return cls(list(zip(meshes, sliders, times, strict=True)), problems, jobs, limits)

    def run(self, overs: OverLayer, progress: Progress | None) -> BakeReport:
        """Authors every mesh into overs."""
        total = sum(len(times) for _, _, times in self.meshes)
        report = BakeReport(list(self.problems))
        pool = ThreadPoolExecutor(self.jobs, "skinslide")
        try:
            for mesh, slider, times in self.meshes:
                work = _MeshBake(mesh, slider, pool, self.jobs, self.limits)
                report.meshes.append(work.report)
                for _ in work.run(times, overs):
                    if progress:
                        progress(report.frame_count, total)
                report.warnings.extend(work.derived.problems)
        finally:
            pool.shutdown(cancel_futures=True)
        return report


class _MeshBake:
    """Bakes one mesh."""

    def __init__(self, mesh: SlidMesh, slider: Slider, pool: ThreadPoolExecutor, jobs: int, limits: Limits):
        self.derived = Derived(mesh)
        self.report = MeshReport.start(mesh.path, mesh.vertex_count, mesh.rest_source, slider.patches)
        self._mesh, self._slider, self._pool, self._limits = mesh, slider, pool, limits
        self._in_flight = jobs + 1  # one is read while the others are slid

    def run(self, times: list[Usd.TimeCode], overs: OverLayer) -> Iterator[Usd.TimeCode]:
        """Authors the mesh at `times`, ascending; yields each once it is done."""
        needed = [self.derived.times_needed(time) for time in times]
        solutions = self._solve(sorted(set().union(*needed)))
        solved: dict[Usd.TimeCode, Solved] = {}
        # A later time may need an earlier one than this time does, where controls have samples between those of points.
        earliest = list(accumulate(reversed([min(wanted) for wanted in needed]), min))[::-1]
        for time, wanted, oldest in zip(times, needed, earliest, strict=True):
            while not wanted <= solved.keys():
                solved.update([next(solutions)])
            self._author(time, solved, overs)
            yield time
            for old in [other for other in solved if other < oldest]:
                del solved[old]
        for attribute in self.derived.blocked:
            overs.block(attribute)

    def _solve(self, times: Iterable[Usd.TimeCode]) -> Iterator[tuple[Usd.TimeCode, Solved]]:
        """Slides frames in the pool, a few ahead; gives them in the order of times."""
        waiting: deque[tuple[Usd.TimeCode, Future[Solved]]] = deque()
        for time in times:
            waiting.append((time, self._submit(time)))
            if len(waiting) > self._in_flight:
                yield self._take(*waiting.popleft())
        while waiting:
            yield self._take(*waiting.popleft())

    def _submit(self, time: Usd.TimeCode) -> Future[Solved]:
        try:
            points, controls = self._mesh.points_at(time), self._mesh.controls_at(time)
        except FrameProblem as problem:
            # Kept until its turn, so that the first bad frame is the one named, whatever jobs is.
            failed: Future[Solved] = Future()
            failed.set_exception(problem)
            return failed

        def slide() -> Solved:
            frame = self._slider.slide(points, controls)
            return Solved(points, frame.points, frame.patches)

        return self._pool.submit(slide)

    def _take(self, time: Usd.TimeCode, future: Future[Solved]) -> tuple[Usd.TimeCode, Solved]:
        try:
            return time, future.result()
        except SliderError as error:
            names = [patch.name for patch in self._mesh.patches]
            raise FrameProblem(core_problem(self._mesh.path, names, str(error), _frame(time))) from error

    def _author(self, time: Usd.TimeCode, solved: dict[Usd.TimeCode, Solved], overs: OverLayer) -> None:
        geometry = UsdGeom.PointBased(self._mesh.prim)
        self._check_limits(time, solved[time])
        points = Vt.Vec3fArray.FromNumpy(solved[time].slid)
        overs.set(geometry.GetPointsAttr(), points, time)
        overs.set(geometry.GetExtentAttr(), UsdGeom.PointBased.ComputeExtent(points), time)
        for attribute, sample, value in self.derived.values(time, solved):
            overs.set(attribute, value, sample)
        self.report.add(_frame(time), solved[time].patches)

    def _check_limits(self, time: Usd.TimeCode, solved: Solved) -> None:
        for field in ("folded_faces", "clamped_vertices"):
            most = getattr(self._limits, field)
            for info, result in zip(self._slider.patches, solved.patches, strict=True):
                count = getattr(result, field)
                if most is not None and count > most:
                    message = f"{count} {field.replace('_', ' ')}, where at most {most} are allowed"
                    raise FrameProblem(Problem("error", self._mesh.path, info.name, _frame(time), message))


def _build_sliders(meshes: list[SlidMesh], lookup: str | Lookup, problems: list[Problem]) -> list[Slider]:
    sliders = []
    for mesh in meshes:
        try:
            sliders.append(mesh.slider(lookup))
        except StageProblems as error:
            problems.extend(error.problems)
    return sliders


def _hidden(meshes: list[tuple[SlidMesh, Slider, list[Usd.TimeCode]]], target: Sdf.Layer) -> Iterator[Problem]:
    """Warns of meshes whose points a stronger layer than the target has an opinion on."""
    for mesh, _, _ in meshes:
        opinions = UsdGeom.PointBased(mesh.prim).GetPointsAttr().GetPropertyStack()
        valued = [spec.layer for spec in opinions if spec.HasInfo("default") or spec.HasInfo("timeSamples")]
        if valued and valued[0] != target:
            message = f"the slid points are hidden by those in {valued[0].identifier}, which is stronger"
            yield Problem("warning", mesh.path, None, None, message)


def _times(mesh: SlidMesh, asked: list[float] | None) -> list[Usd.TimeCode]:
    """A mesh that never changes has one value, whatever was asked."""
    authored = mesh.sample_times()
    if not authored:
        return [Usd.TimeCode.Default()]
    return [Usd.TimeCode(time) for time in (authored if asked is None else asked)]


def _frame(time: Usd.TimeCode) -> float | None:
    return None if time.IsDefault() else time.GetValue()


@contextmanager
def _as_usage_error() -> Iterator[None]:
    try:
        yield
    except SliderError as error:
        raise UsageError(str(error)) from error
