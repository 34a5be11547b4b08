"""Slides the frames of meshes in a pool of threads, a few ahead, and gives them in the order of their times."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import NamedTuple, TypeVar

import numpy as np
from pxr import Usd

from skinslide.meshes import SlidMesh
from skinslide.problems import FrameProblem, Problem, StageError, StageProblems, core_problem
from skinslide.slider import Lookup, PatchResult, Slider, SliderError

T = TypeVar("T")


class Solved(NamedTuple):
    """One time of a mesh, solved. Points float32 (V, 3)."""

    cached: np.ndarray
    slid: np.ndarray
    patches: tuple[PatchResult, ...]


Work = Callable[[Solved], T]  # done in the pool with what was solved


def frame_of(time: Usd.TimeCode) -> float | None:
    """The frame that messages and reports name; None for the default time."""
    return None if time.IsDefault() else time.GetValue()


def build_sliders(meshes: list[SlidMesh], lookup: str | Lookup, problems: list[Problem]) -> list[Slider]:
    """The slider of each mesh that has a good one; what is wrong with the others joins the problems."""
    sliders = []
    for mesh in meshes:
        try:
            sliders.append(mesh.slider(lookup))
        except StageProblems as error:
            problems.extend(error.problems)
    return sliders


def times_of(mesh: SlidMesh, asked: list[float] | None) -> list[Usd.TimeCode]:
    """A mesh that never changes has one value, whatever was asked."""
    if not mesh.varies:
        return [Usd.TimeCode.Default()]
    return [Usd.TimeCode(time) for time in (mesh.sample_times() if asked is None else asked)]


class Solver:
    """Slides frames of one mesh; as many as there are jobs are in hand, and one is read meanwhile."""

    def __init__(self, mesh: SlidMesh, slider: Slider, pool: ThreadPoolExecutor, jobs: int):
        self._mesh, self._slider, self._pool, self._ahead = mesh, slider, pool, jobs + 1

    def run(
        self, times: Iterable[Usd.TimeCode], work_at: Callable[[Usd.TimeCode], Work[T]]
    ) -> Iterator[tuple[Usd.TimeCode, T]]:
        """What work makes of each time, ascending. `work_at` is called here, in turn: USD is read on this thread."""
        waiting: deque[tuple[Usd.TimeCode, Future[T]]] = deque()
        for time in times:
            waiting.append((time, self._submit(time, work_at)))
            if len(waiting) > self._ahead:
                yield self._take(*waiting.popleft())
        while waiting:
            yield self._take(*waiting.popleft())

    def _submit(self, time: Usd.TimeCode, work_at: Callable[[Usd.TimeCode], Work[T]]) -> Future[T]:
        try:
            points, controls, work = self._mesh.points_at(time), self._mesh.controls_at(time), work_at(time)
        except (FrameProblem, SliderError) as problem:
            # Kept until its turn, so that the first bad frame is the one named, however many are in hand.
            failed: Future[T] = Future()
            failed.set_exception(problem)
            return failed

        def solve() -> T:
            frame = self._slider.slide(points, controls)
            return work(Solved(points, frame.points, frame.patches))

        try:
            return self._pool.submit(solve)
        except RuntimeError as error:  # the machine gives no more threads
            raise StageError(f"{error}; ask for fewer jobs") from error

    def _take(self, time: Usd.TimeCode, future: Future[T]) -> tuple[Usd.TimeCode, T]:
        try:
            return time, future.result()
        except SliderError as error:
            raise FrameProblem(self.problem(error, time)) from error

    def problem(self, error: SliderError, time: Usd.TimeCode) -> Problem:
        """What the core says of a time, of the patch that it names."""
        names = [patch.name for patch in self._mesh.patches]
        return core_problem(self._mesh.path, names, str(error), frame_of(time))
