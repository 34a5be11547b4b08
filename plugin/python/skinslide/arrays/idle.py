"""What a thread needs for itself for a while, such as a canvas: made when it is needed, and used again by others."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Generic, TypeVar

T = TypeVar("T")


class Idle(Generic[T]):
    """Things that no thread uses at the moment."""

    def __init__(self, make: Callable[[], T], *made: T):
        self._make, self._made, self._lock = make, list(made), threading.Lock()

    @contextmanager
    def taken(self) -> Iterator[T]:
        """One of them, or a new one, for the calling thread alone."""
        own = self.take()
        try:
            yield own
        finally:
            self.give_back(own)

    def take(self) -> T:
        """The same, until it is given back."""
        with self._lock:
            own = self._made.pop() if self._made else None
        return self._make() if own is None else own

    def give_back(self, own: T) -> None:
        with self._lock:
            self._made.append(own)
