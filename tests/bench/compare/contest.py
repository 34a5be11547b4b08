"""Contestants in processes of their own, which slide the same poses in turn."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from compare.patch import Patch

MOST_APART = 1e-9  # of embeddings in a square of side 1
_MOST_APART_IN_FLOAT = 1e-6  # of points of a patch of size 1, which come as floats
_MOMENT = 0.03  # seconds
_ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL")}


class Entry(NamedTuple):
    """Who takes part.

    Attributes:
        name: In the tables.
        python: The interpreter.
        words: The module, the class and its arguments.
        path: Folders for the interpreter to look in first.
    """

    name: str
    python: str
    words: tuple[str, ...]
    path: str = ""


@dataclass
class Cost:
    """What one contestant took for one patch.

    Attributes:
        setup: Seconds of a thread.
        frames: Of each frame, seconds of a thread by stage.
        memory: Its process's most, in MB.
        two: Seconds by the clock a frame where two threads slide.
    """

    setup: float = 0
    frames: list[dict[str, float]] = field(default_factory=list)
    memory: float = 0
    two: float = 0

    def stage(self, name: str) -> float:
        """The seconds of a stage in the median frame."""
        return median(frame.get(name, 0) for frame in self.frames)


class Worker:
    """A contestant's process."""

    def __init__(self, entry: Entry):
        self.name = entry.name
        environment = {**os.environ, **_ONE_THREAD, "PYTHONPATH": entry.path}
        words = [entry.python, str(Path(__file__).with_name("worker.py")), *entry.words]
        self._process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )

    def ask(self, *request: Any) -> dict[str, float]:
        """Asks the worker, and returns its answer. Raises RuntimeError if it has ended."""
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self.name} ended at {request}")
        return json.loads(line)

    def end(self) -> None:
        self._process.kill()
        self._process.communicate()


def contest(
    entries: Sequence[Entry], patch: Patch, folder: Path, rounds: int, *, two: bool = False, agree: bool = True
) -> dict[str, Cost]:
    """Returns costs by name. All take the border of the first entry and must agree with it, else raises SystemExit."""
    with _workers(entries) as workers:
        costs = _begun(workers, patch, folder)
        times = {worker.name: _times(worker) for worker in workers}
        for number in range(rounds):
            for worker in workers:
                frame = worker.ask("frame", number % len(patch.poses), times[worker.name])
                costs[worker.name].frames.append(frame)
                costs[worker.name].memory = frame["peak"]
        if agree:
            _check(workers, folder)
        for worker in workers if two else ():
            costs[worker.name].two = worker.ask("threads", 2, 10 * times[worker.name])["wall"]
    return costs


def _times(worker: Worker) -> int:
    """How often to slide a pose in a row: for a moment, and at least once."""
    worker.ask("frame", 0, 1)  # warms caches
    return max(1, round(_MOMENT / worker.ask("frame", 0, 1)["frame"]))


@contextmanager
def _workers(entries: Sequence[Entry]) -> Iterator[list[Worker]]:
    with ExitStack() as ending:
        workers = [Worker(entry) for entry in entries]
        for worker in workers:
            ending.callback(worker.end)
        yield workers


def _begun(workers: Sequence[Worker], patch: Patch, folder: Path) -> dict[str, Cost]:
    first, *others = workers
    patch.save(folder / "patch.npz")
    costs = {first.name: Cost(first.ask("begin", str(folder / "patch.npz"))["setup"])}
    if others:
        first.ask("frame", 0, 1)
        rest = _saved(first, folder)["rest"]
        if rest.size:
            patch.with_border(rest).save(folder / "patch.npz")
    return costs | {worker.name: Cost(worker.ask("begin", str(folder / "patch.npz"))["setup"]) for worker in others}


def _check(workers: Sequence[Worker], folder: Path) -> None:
    first, *others = workers
    right = _saved(first, folder)
    for other in others:
        found = _saved(other, folder)
        for what, most in (("rest", MOST_APART), ("embedding", MOST_APART), ("points", _MOST_APART_IN_FLOAT)):
            if right[what].size and found[what].size:
                apart = np.abs(right[what] - found[what]).max()
                if not apart <= most:
                    raise SystemExit(f"error: {what} of {other.name} and of {first.name} are {apart:.1g} apart")


def _saved(worker: Worker, folder: Path) -> Mapping[str, np.ndarray]:
    worker.ask("save", str(folder / "frame.npz"))
    with np.load(folder / "frame.npz") as file:
        return dict(file)
