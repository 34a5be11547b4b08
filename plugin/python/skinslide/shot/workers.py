"""Works on the frames of a mesh in a pool of threads, a few ahead, and gives them in order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from pxr import Usd

from skinslide.arrays.apart import APART
from skinslide.arrays.slider import Slider
from skinslide.problems import FrameProblem, SliderError, StageError, core_problem
from skinslide.shot.plan import frame_of
from skinslide.stage.mesh import PatchedMesh

T = TypeVar("T")
Progress = Callable[[int, int], None]  # frames done, frames in all


@contextmanager
def pool_of(jobs: int, frame_count: int, sliders: Sequence[Slider]) -> Iterator[ThreadPoolExecutor]:
    """Threads for frames of sliders. When the block fails, frames that have not begun never do; the others are stopped.

    A signal does not wait even for those: nothing is written on these threads.
    """
    pool = ThreadPoolExecutor(min(jobs, frame_count), APART)
    try:
        yield pool
    except BaseException as error:
        for slider in sliders:
            slider.stop()
        pool.shutdown(wait=isinstance(error, Exception), cancel_futures=True)
        raise
    pool.shutdown()


def work_ahead(
    mesh: PatchedMesh,
    times: Iterable[Usd.TimeCode],
    read: Callable[[Usd.TimeCode], Callable[[], T]],
    pool: ThreadPoolExecutor,
    in_flight: int,
) -> Iterator[tuple[Usd.TimeCode, T]]:
    """Yields what the work on each time returns, in the order of times.

    Args:
        mesh: Whose times they are.
        times: When.
        read: Reads what of the stage a time needs, on this thread; gives the work, which is done in the pool.
        pool: Where it is done.
        in_flight: Times read before the first of them is waited for.

    Raises:
        FrameProblem: The first time that cannot be had.
    """
    waiting: deque[tuple[Usd.TimeCode, Future[T]]] = deque()
    for time in times:
        waiting.append((time, _submit(time, read, pool)))
        if len(waiting) > in_flight:
            yield _take(mesh, *waiting.popleft())
    while waiting:
        yield _take(mesh, *waiting.popleft())


def _submit(time: Usd.TimeCode, read: Callable[[Usd.TimeCode], Callable[[], T]], pool: ThreadPoolExecutor) -> Future[T]:
    try:
        work = read(time)
    except FrameProblem as problem:
        # Kept until its turn, so that the first bad frame is the one named, whatever jobs is.
        failed: Future[T] = Future()
        failed.set_exception(problem)
        return failed
    return submitted(pool, work)


def submitted(pool: ThreadPoolExecutor, work: Callable[[], T]) -> Future[T]:
    """Raises StageError where the machine gives no more threads."""
    try:
        return pool.submit(work)
    except RuntimeError as error:
        raise StageError(f"{error}; ask for fewer jobs") from error


def _take(mesh: PatchedMesh, time: Usd.TimeCode, future: Future[T]) -> tuple[Usd.TimeCode, T]:
    with core_named(mesh, time):
        return time, future.result()


@contextmanager
def core_named(mesh: PatchedMesh, time: Usd.TimeCode) -> Iterator[None]:
    """Turns what the core refuses into a FrameProblem of the mesh and the time."""
    try:
        yield
    except SliderError as error:
        names = [patch.name for patch in mesh.patches]
        raise FrameProblem(core_problem(mesh.path, names, str(error), frame_of(time))) from error
