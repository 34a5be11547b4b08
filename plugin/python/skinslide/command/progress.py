"""Progress on stderr: a bar on a terminal, at most some twenty plain lines elsewhere, or nothing."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from skinslide.command.outcome import print_error
from skinslide.problems import counted
from skinslide.shot.workers import Progress

if TYPE_CHECKING:
    from tqdm import tqdm

_LINES = 20
_SECONDS = 1.0  # between lines


@contextmanager
def reporter(*, quiet: bool = False) -> Iterator[Progress | None]:
    """What a bake calls after each frame."""
    if quiet:
        yield None
    elif sys.stderr.isatty():
        from tqdm import tqdm

        with tqdm(unit="frame", dynamic_ncols=True, leave=False, file=sys.stderr) as bar:
            yield lambda done, total: _move(bar, done, total)
    else:
        yield _lines()


def _move(bar: tqdm[Any], done: int, total: int) -> None:
    bar.total = total
    with suppress(OSError):  # a terminal that has gone
        bar.update(done - bar.n)


def _lines() -> Progress:
    start = last = time.monotonic()

    def report(done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        if done != total and (done % math.ceil(total / _LINES) or now - last < _SECONDS):
            return
        last, rate = now, done / max(now - start, 1e-9)
        print_error(f"{done} of {counted(total, 'frame')}, {rate:.1f} frames/s, {(total - done) / rate:.0f} s left")

    return report
