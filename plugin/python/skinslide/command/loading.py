"""Loads the function that a command calls, and has USD made ready meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from importlib import import_module
from typing import Any

from skinslide.problems import StageError


def loaded(home: str, name: str, *, opens_stage: bool) -> Callable[..., Any]:
    """A function of a module. Raises StageError if there is no USD, which skinslide does not bring."""
    try:
        with _schemas_read() if opens_stage else nullcontext():
            return getattr(import_module(f"skinslide.{home}"), name)
    except ModuleNotFoundError as missing:
        if missing.name != "pxr":
            raise
        hint = "set the show's up, or install skinslide[live], which brings its own"
        raise StageError(f"there is no USD in this Python: {hint}") from missing


@contextmanager
def _schemas_read() -> Iterator[None]:
    """Has USD read its schemas beside the block, as it does for its first stage: that takes long, and no Python."""
    from pxr import Usd, UsdGeom, UsdSkel  # noqa: F401  before, so that USD is not loaded and at work at once

    from skinslide.arrays.apart import beside

    reading = beside(Usd.SchemaRegistry)
    try:
        yield
    finally:
        failed = reading.exception()
    if failed:
        raise failed
