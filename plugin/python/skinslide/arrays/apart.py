"""Calls of the library that may take minutes, with signals handled meanwhile.

Python handles signals only on its main thread, and not inside a call of C. So the call is made on another thread, and
the main thread waits. The call cannot be stopped: where a signal's handler raises, it runs on to its end, unheeded.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import Any, TypeVar

T = TypeVar("T")
APART = "skinslide"  # the beginning of the names of threads that may run on after a signal
ANSWERED = 0.1  # the most seconds until a signal is handled


def apart(make: Callable[..., T], *arguments: Any) -> T:
    """Calls `make`, and returns what it returns. The arguments are kept alive for as long as it runs."""
    future: Future[T] = Future()

    def run() -> None:
        try:
            future.set_result(make(*arguments))
        except BaseException as error:
            future.set_exception(error)

    if threading.current_thread() is not threading.main_thread():
        return make(*arguments)
    try:
        threading.Thread(target=run, name=APART, daemon=True).start()
    except RuntimeError:  # the machine gives no more threads
        return make(*arguments)
    # In short waits, since a signal does not end one where another thread takes it, or where it comes just before.
    while not future.done():
        wait([future], ANSWERED)
    return future.result()
