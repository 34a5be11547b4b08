"""Calls of the library that may take minutes, with signals handled meanwhile.

Python handles signals only on its main thread, and not inside a call of C. So the call is made on another thread, and
the main thread waits. The call cannot be stopped: where a signal's handler raises, it runs on to its end, unheeded.
"""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import Any, TypeVar

T = TypeVar("T")
APART = "skinslide"  # the beginning of the names of threads that may run on after a signal
ANSWERED = 0.1  # the most seconds until a signal is handled


def apart(make: Callable[..., T], *arguments: Any) -> T:
    """Calls `make`, and returns what it returns. The arguments are kept alive for as long as it runs."""
    if threading.current_thread() is not threading.main_thread():
        return make(*arguments)
    future = beside(make, *arguments)
    # In short waits, since a signal does not end one where another thread takes it, or where it comes just before.
    while not future.done():
        wait([future], ANSWERED)
    return future.result()


def beside(make: Callable[..., T], *arguments: Any) -> Future[T]:
    """Calls `make` on another thread, or on this one where the machine gives no more of them."""
    future: Future[T] = Future()
    if not _starts(lambda: _fulfil(future, make, *arguments)):
        _fulfil(future, make, *arguments)
    return future


def together(make: Callable[[int], T], count: int, jobs: int) -> list[T]:
    """Calls `make` with each number below count on several threads, this one included, and returns what it returns.

    Raises what the first of the calls in order raised.
    """
    futures, numbers = [Future[T]() for _ in range(count)], itertools.count()

    def run() -> None:
        while (number := next(numbers)) < count:
            _fulfil(futures[number], make, number)

    for _ in range(min(jobs, count) - 1):
        _starts(run)
    run()
    return [future.result() for future in futures]


def _starts(run: Callable[[], None]) -> bool:
    """Starts a thread. Returns False where the machine gives no more of them."""
    try:
        threading.Thread(target=run, name=APART, daemon=True).start()
    except RuntimeError:
        return False
    return True


def _fulfil(future: Future[T], make: Callable[..., T], *arguments: Any) -> None:
    try:
        future.set_result(make(*arguments))
    except BaseException as error:
        future.set_exception(error)
        if not isinstance(error, Exception):  # such as Ctrl-C
            raise
