"""Values of attributes: how they change over time, as arrays, and checked."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.problems import MOST_FRAMES, Fault, UsageError, frame_text

T = TypeVar("T")
Span = tuple[float, float]  # first and last moment
FIRST = Usd.TimeCode.EarliestTime()
# Layer offsets leave noise of this size on the times of samples that were authored at one time.
SAME_TIME = 1e-6


class Reading(Generic[T]):
    """A checked value over time, read once where it does not vary.

    read     gives the value at a time, or raises Fault
    varying  those of its sources that may
    """

    def __init__(self, read: Callable[[Usd.TimeCode], T], sources: Iterable[Usd.Attribute]):
        self._read = read
        self.varying = [source for source in sources if source and source.ValueMightBeTimeVarying()]
        self.first = read(FIRST)

    @property
    def varies(self) -> bool:
        return bool(self.varying)

    def at(self, time: Usd.TimeCode) -> T:
        return self._read(time) if self.varying else self.first

    def times(self, span: Span | None) -> list[float]:
        return [time for source in self.varying for time in sample_times(source, span)]


def primvar_sources(primvar: UsdGeom.Primvar) -> list[Usd.Attribute]:
    """The attributes that the value of a primvar comes from; none where it is not authored."""
    return [primvar.GetAttr(), primvar.GetIndicesAttr()] if primvar else []


def sample_times(attr: Usd.Attribute, span: Span | None = None) -> list[float]:
    """When a value was authored, in stage time; for a spline its knots and each whole frame between them in a span."""
    if not attr.HasSpline():
        return list(attr.GetTimeSamples())
    knots = sorted(attr.GetSpline().GetKnotsWithInnerLoopsBaked().keys())
    if not knots:
        return []
    first, last = (
        math.ceil(max(knots[0], span[0] if span else -math.inf)),
        math.floor(min(knots[-1], span[1] if span else math.inf)),
    )
    if last - first >= MOST_FRAMES:
        raise UsageError(f"{attr.GetPath()} is a spline over {last - first} frames; name the frames that are wanted")
    return [*knots, *map(float, range(first, last + 1))]


def merged_times(times: Iterable[float]) -> list[float]:
    """Times in order; of those that differ by noise only, the one given first."""
    order = sorted(enumerate(times), key=lambda item: item[1])
    merged: list[tuple[int, float]] = []
    for given, time in order:
        if not merged or time - merged[-1][1] > SAME_TIME:
            merged.append((given, time))
        elif given < merged[-1][0]:
            merged[-1] = (given, time)
    return [time for _, time in merged]


def unchanging(attr: Usd.Attribute, what: str):
    """The value of an attribute that must not change over time; None where it has none."""
    first = attr.Get(FIRST)
    if attr.ValueMightBeTimeVarying():
        for time in attr.GetTimeSamples():
            if attr.Get(time) != first:
                raise Fault(f"{what} changes at frame {frame_text(time)}; it must stay the same over time")
    return first


def flattened(primvar: UsdGeom.Primvar, time: Usd.TimeCode):
    """The value of a primvar with its indices applied, or None where it has none."""
    value = primvar.Get(time)
    if value is None or not primvar.IsIndexed():
        return value
    indices, count = np.asarray(primvar.GetIndices(time)), len(value)
    bad = np.flatnonzero((indices < 0) | (indices >= count))
    if bad.size:
        raise Fault(
            f"{primvar.GetName()}:indices[{bad[0]}] is {indices[bad[0]]}, but {primvar.GetName()} has {count} values"
        )
    return np.asarray(value)[indices]


def check_length(what: str, got: int, count: int, of: str) -> None:
    if got != count:
        raise Fault(f"{what} has {got} values, but the mesh has {count} {of}")


def integers(value, what: str) -> np.ndarray:
    """An authored int[] as int32 (n,)."""
    array = np.asarray(value)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise Fault(f"{what} is not an array of int")
    small = array.astype(np.int32)
    if not np.array_equal(small, array):
        raise Fault(f"{what} has a value that does not fit an int")
    return small


def floats(value, what: str) -> np.ndarray:
    """An authored float[] as float32 (n,)."""
    array = np.asarray(value)
    if array.ndim != 1 or (array.size and array.dtype.kind != "f"):
        raise Fault(f"{what} is not an array of float")
    with np.errstate(over="ignore"):
        return array.astype(np.float32)


def positions(value, what: str) -> np.ndarray:
    """An authored point3f[], or another array of three numbers each, as float32 (n, 3)."""
    array = np.asarray(value)
    if array.size == 0:
        return np.empty((0, 3), np.float32)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind != "f":
        raise Fault(f"{what} is not an array of points")
    with np.errstate(over="ignore"):  # whoever needs finite values says which is not
        return np.array(array, np.float32)
