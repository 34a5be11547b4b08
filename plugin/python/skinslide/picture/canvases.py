"""Canvases for threads that draw pictures."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from skinslide.arrays.canvas import Canvas
from skinslide.arrays.idle import Idle
from skinslide.problems import SliderError, StageError, UsageError


class Canvases:
    """A canvas for each thread that draws, made when needed; the first one at once, so that its errors show early."""

    def __init__(self, make: Callable[[], Canvas], at_once: int):
        """at_once: how many may be. Raises UsageError where there is no EGL, or where it has no such size."""
        self._room = threading.Semaphore(at_once)
        try:
            self._idle = Idle(make, make())
        except SliderError as error:
            if error.status == "OUT_OF_MEMORY":
                raise MemoryError(str(error)) from error
            asked_for = error.status in ("NO_DEVICE", "BAD_ARGUMENT")
            raise (UsageError if asked_for else StageError)(str(error)) from error

    @contextmanager
    def taken(self) -> Iterator[Canvas]:
        with self._room, self._idle.taken() as canvas:
            yield canvas
