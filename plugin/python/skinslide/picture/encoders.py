"""Pictures encoded on threads of their own while the next ones are drawn."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from skinslide.shot.workers import pool_of, submitted

T = TypeVar("T")


class Encoders:
    """Some threads, and a limit of pictures in hand: whoever brings one more waits until one is encoded."""

    def __init__(self, jobs: int, at_once: int):
        self._jobs, self._room = jobs, threading.Semaphore(at_once)
        self._pool: ThreadPoolExecutor  # while it is running

    @contextmanager
    def running(self) -> Iterator[None]:
        """When the block ends, as `pool_of`."""
        with pool_of(self._jobs, self._jobs, []) as self._pool:
            yield

    def encode(self, work: Callable[[], T]) -> Future[T]:
        """Begins to work on a picture. Raises StageError as `submitted`."""
        self._room.acquire()
        try:
            future = submitted(self._pool, work)
        except BaseException:
            self._room.release()
            raise
        future.add_done_callback(lambda _: self._room.release())  # also of one that never begins
        return future
