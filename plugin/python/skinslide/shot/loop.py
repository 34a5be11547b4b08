"""The loop over a shot: each time of each mesh is read once and slid once, whatever is made of it.

ask each product what it can know           where its files go; any error: stop here, nothing is written
meshes, problems = read the stage           any error: stop here
what is made of them is there already       stop here, and say so
for each mesh: its slider                   patches embedded at rest, once a shot
for each mesh of which something is made:
    times = --frames, or the samples of points and animated controls and the frames between, or the default
    for each time in order, and the times beside it that velocities need, each once, several at once:
        points, controls, and what products read        on this thread
        slide; what products make of the frame          on a thread of the pool
    for each time in order: each product takes what it has made; how roughly the skin moves at the time before
end each product                            a layer is put in place, a page is written
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import replace
from typing import Any, NamedTuple

from pxr import Usd

from skinslide.arrays.setups import Sample
from skinslide.arrays.slider import Slider
from skinslide.problems import Problem, StageProblems, first_of
from skinslide.shot.frames import Chunk
from skinslide.shot.options import SlideOptions
from skinslide.shot.plan import Plan, PlannedMesh, frame_of
from skinslide.shot.products import Making, MeshMaking, Product, Shot, SlidFrame
from skinslide.shot.report import BakeReport, MeshReport
from skinslide.shot.workers import Progress, core_named, pool_of, work_ahead
from skinslide.write.signals import signals_as_exceptions


def slide(
    shot: Shot,
    options: SlideOptions,
    products: Sequence[Product],
    progress: Progress | None = None,
    chunk: Chunk | None = None,
) -> BakeReport:
    """Makes the products. Raises UsageError, StageProblems, FrameProblem, StageError."""
    makings = [product.begin(shot, options) for product in products]
    plan = Plan.read(shot.stage, options, chunk)
    if all([making.planned(plan) for making in makings]):
        return BakeReport(list(plan.problems), resumed=True)
    meshes = _wanted(plan, makings)
    report = BakeReport(list(plan.problems))
    total = sum(len(mesh.planned.times) for mesh in meshes)
    with signals_as_exceptions(), ExitStack() as ending:
        for making in makings:
            ending.enter_context(making.running(report))
        with pool_of(options.jobs, total, [slider for mesh in meshes for slider in mesh.sliders]) as pool:
            for mesh in meshes:
                report.meshes.append(mesh.report)
                for _ in mesh.run(pool, options.jobs):
                    if progress:
                        progress(report.frame_count, total)
                report.warnings.extend(first_of(mesh.warnings))
                ended = [problem for made in mesh.makings for problem in made.end()]
                known = set(report.warnings)
                report.warnings.extend(each for each in dict.fromkeys(ended) if each not in known)
    return report


def _wanted(plan: Plan, makings: Sequence[Making]) -> list[_Mesh]:
    """The meshes of which something is made. Raises StageProblems for all of which nothing can be."""
    for making in makings:
        plan.check_patches(making.patches)
    meshes: list[_Mesh] = []
    problems: list[Problem] = []
    for planned in plan.meshes:
        mesh = _Mesh.of(planned)
        for making in makings:
            try:
                made = making.of_mesh(planned, mesh.report)
            except StageProblems as bad:
                problems += bad.problems
            else:
                mesh.makings.extend([made] if made else [])
        meshes.extend([mesh] if mesh.makings else [])
    if problems:
        raise StageProblems(list(dict.fromkeys(problems)))
    return meshes


class _Mesh(NamedTuple):
    """A mesh, and what is made of it."""

    planned: PlannedMesh
    report: MeshReport
    makings: list[MeshMaking]
    warnings: list[Problem]  # what to warn of in the points of each frame

    @classmethod
    def of(cls, planned: PlannedMesh) -> _Mesh:
        return cls(planned, MeshReport.start(planned.mesh, planned.slider.patches), [], [])

    @property
    def sliders(self) -> list[Slider]:
        return [self.planned.slider, *(slider for making in self.makings for slider in making.sliders)]

    def run(self, pool: ThreadPoolExecutor, jobs: int) -> Iterator[Usd.TimeCode]:
        """Slides the mesh at each of its times, in order; yields each once all is taken."""
        times = self.planned.times
        needed = [set().union(*(making.times_needed(time) for making in self.makings)) for time in times]
        last_use = {time: index for index, wanted in enumerate(needed) for time in wanted}
        # One is read while the others are slid.
        slid = work_ahead(self.planned.mesh, sorted(last_use), self._reader(set(times)), pool, jobs + 1)
        frames: dict[Usd.TimeCode, SlidFrame] = {}
        made: dict[Usd.TimeCode, list[Any]] = {}
        recent: deque[tuple[Usd.TimeCode, SlidFrame]] = deque(maxlen=3)
        for index, (time, wanted) in enumerate(zip(times, needed, strict=True)):
            while not wanted <= frames.keys():
                at, (frame, results) = next(slid)
                frames[at], made[at] = frame, results
            for making, result in zip(self.makings, made.pop(time), strict=True):
                making.take(time, frames, result)
            self.report.add(frame_of(time), frames[time].patches)
            if frames[time].warning:
                self.warnings.append(replace(self.planned.mesh.problem(frames[time].warning, time), severity="warning"))
            recent.append((time, frames[time]))
            self._measure_motion(recent)
            yield time
            for old in [other for other in frames if last_use[other] <= index]:
                del frames[old]

    def _measure_motion(self, recent: Sequence[tuple[Usd.TimeCode, SlidFrame]]) -> None:
        """At the time before the last, once there is one before it. Time codes do for seconds: only ratios count."""
        if len(recent) == 3:
            samples = [Sample(time.GetValue(), frame.cached, frame.slid) for time, frame in recent]
            between = recent[1][0]
            with core_named(self.planned.mesh, between):
                self.report.add_motion(frame_of(between), self.planned.slider.roughness(samples))

    def _reader(self, wanted: set[Usd.TimeCode]) -> Callable[[Usd.TimeCode], Callable[[], tuple[SlidFrame, list[Any]]]]:
        """Reads a time, and what is made of it where it is wanted and not only needed for another."""
        mesh, slider = self.planned.mesh, self.planned.slider
        turns = any(making.turns for making in self.makings)

        def read(time: Usd.TimeCode) -> Callable[[], tuple[SlidFrame, list[Any]]]:
            points, controls = mesh.points_at(time), mesh.controls_at(time)
            works = [making.read(time) for making in self.makings] if time in wanted else []

            def work() -> tuple[SlidFrame, list[Any]]:
                frame = SlidFrame(slider, points, controls, turns=turns)
                return frame, [each(frame) for each in works]

            return work

        return read
