"""Calls of the library that may take minutes, and a signal that is answered meanwhile.

Python handles signals on its main thread alone, and not inside of a call. So the call is made on another thread, and
the main one waits. It cannot be ended: where a signal raises, it goes on apart to its end, and nothing comes of it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import Any, TypeVar

T = TypeVar("T")
APART = "skinslide"  # what the names of threads begin with that a signal leaves at work
ANSWERED = 0.1  # seconds after which a signal is answered at the latest


def apart(make: Callable[..., T], *arguments: Any) -> T:
    """What `make` gives of the arguments, which are kept for as long as it goes on."""
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
    while not future.done():  # in turns: a signal that another thread takes, or that comes just before, ends no wait
        wait([future], ANSWERED)
    return future.result()
