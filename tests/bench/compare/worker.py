"""A contestant in a process and a Python of its own: reads a request a line, answers a line of JSON.

    python worker.py MODULE CLASS [ARGUMENT]...

A request is a list of JSON: a method of `Served`, its arguments. A contestant has begin(patch), frame(points) and, once
it has begun, rest_embedding.
"""

from __future__ import annotations

import importlib
import json
import resource
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from compare.patch import Patch

UNDISTURBED = 0.95  # of the time by the clock, in which a thread ran


class Served:
    """Does what the driver asks of a contestant."""

    def __init__(self, make: Any, arguments: list[str]):
        self._make, self._arguments = make, arguments
        self._given = self._one = self._last = None

    def begin(self, path: str) -> dict[str, float]:
        self._given = Patch.load(path)
        self._one = self._make(*self._arguments)
        start = time.process_time()
        self._one.begin(self._given)
        return {"setup": time.process_time() - start}

    def frame(self, pose: int, times: int) -> dict[str, float]:
        """Slides a frame several times. Returns the quickest that hardly had to wait, or that had to wait least."""
        taken = [self._timed(self._given.poses[pose]) for _ in range(times)]
        steadiest = max(taken, key=lambda one: (min(one["share"], UNDISTURBED), -one["frame"]))
        quickest = {name: min(one[name] for one in taken) for name in ("frame", "by the clock")}
        return {**steadiest, **quickest, "peak": _peak()}

    def _timed(self, points: np.ndarray) -> dict[str, float]:
        """share: of the time by the clock, that in which the thread ran, where its stages are by the clock."""
        clock, start = time.perf_counter(), time.thread_time()
        self._last = self._one.frame(points)
        ran, passed = time.thread_time() - start, time.perf_counter() - clock
        share = ran / passed if self._last.by_clock else 1
        stages = {stage: share * seconds for stage, seconds in self._last.seconds.items()}
        return {**stages, "frame": ran, "by the clock": passed, "share": share}

    def save(self, path: str) -> dict[str, float]:
        arrays = {"embedding": self._last.embedding, "points": self._last.points, "rest": self._one.rest_embedding}
        np.savez(path, **{name: () if array is None else array for name, array in arrays.items()})
        return {}

    def threads(self, count: int, frames: int) -> dict[str, float]:
        """Returns seconds by the clock for each frame, slid in so many threads."""
        several = [self._one, *(self._another() for _ in range(count - 1))]
        poses = self._given.poses
        start = time.perf_counter()
        with ThreadPoolExecutor(count) as pool:
            list(pool.map(lambda one: [one.frame(poses[i % len(poses)]) for i in range(frames)], several))
        return {"wall": (time.perf_counter() - start) / (count * frames)}

    def _another(self) -> Any:
        another = self._make(*self._arguments)
        another.begin(self._given)
        return another


def _peak() -> float:
    """The most memory that this process has had, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main(module: str, name: str, *arguments: str) -> None:
    served = Served(getattr(importlib.import_module(f"compare.{module}"), name), list(arguments))
    for line in sys.stdin:
        asked, *given = json.loads(line)
        print(json.dumps(getattr(served, asked)(*given)), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
