"""Checks of what callers give: kinds, numbers, names, and the types and shapes of arrays. Raises SliderError."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from contextlib import suppress
from typing import Any, TypeVar

import numpy as np

from skinslide.problems import SliderError

Kind = TypeVar("Kind")


def all_of(what: str, given: Any, kind: type[Kind]) -> tuple[Kind, ...]:
    """The elements of a sequence. Raises SliderError unless all are of a kind."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        message = f"{what} is of the type {type(given).__name__}; a sequence of {kind.__name__} is wanted"
        raise SliderError("BAD_ARGUMENT", message)
    each = tuple(given)
    for i, one in enumerate(each):
        check_kind(f"{what}[{i}]", one, kind)
    return each


def check_kind(what: str, given: Any, kind: type) -> None:
    if not isinstance(given, kind):
        message = f"{what} is of the type {type(given).__name__}; {kind.__name__} is wanted"
        raise SliderError("BAD_ARGUMENT", message)


def check_count(status: str, what: str, counted: tuple[int, str], of: tuple[int, str]) -> None:
    """Raises SliderError unless both counts are the same: `what` has (1, "values") for (2, "corners")."""
    if counted[0] != of[0]:
        raise SliderError(status, f"{what}: {counted[0]} {counted[1]} for {of[0]} {of[1]}")


def real(value: Any, what: str) -> float:
    """A number as a float, or SliderError."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error


def whole(value: Any, what: str) -> int:
    """A number that is an index or a count, or SliderError."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error


def number_of(what: str, number: int) -> int:
    """A number that fits the core's int32, where those below 0 mean none. Raises SliderError for another."""
    if not 0 <= whole(number, what) < 2**31:
        raise SliderError("BAD_ARGUMENT", f"no such {what}: {number}")
    return number


def device_number(device: int | None) -> int:
    """The core's number for an EGL device; None: any. Raises SliderError for a number that no device can have."""
    return -1 if device is None else number_of("device", device)


def encoded_name(name: str) -> bytes:
    encoded = None
    with suppress(AttributeError, UnicodeEncodeError):
        encoded = name.encode()
    if encoded is None or b"\0" in encoded:
        raise SliderError("BAD_ARGUMENT", f"{name!r} cannot name a patch")
    return encoded


def as_array(values: Any, dtype: type, shape: tuple[int, ...], what: str) -> np.ndarray:
    """A contiguous array of values, or SliderError with both shapes."""
    try:
        source = np.asarray(values)
    except (TypeError, ValueError) as error:  # rows of different lengths
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error
    if source.shape != shape and not _fits(source.shape, shape):
        wanted = " x ".join("n" if size == -1 else str(size) for size in shape)
        got = " x ".join(map(str, source.shape)) or "a single value"
        raise SliderError("BAD_ARGUMENT", f"{what}: the shape is {got}; it must be {wanted}")
    if source.dtype == dtype and source.flags.c_contiguous:
        return source
    # Casts of the same kind lose no more than digits, except for integers that do not fit.
    fits = source.size == 0 or (
        np.can_cast(source.dtype, dtype, "same_kind") and (source.dtype == np.bool_) == (dtype == np.bool_)
    )
    with np.errstate(over="ignore"):
        result = np.ascontiguousarray(source, dtype) if fits else source
    if not fits or (dtype == np.int32 and not np.array_equal(result, source)):
        raise SliderError("BAD_ARGUMENT", f"{what}: {source.dtype} values do not fit {np.dtype(dtype)}")
    return result


def _fits(got: tuple[int, ...], shape: tuple[int, ...]) -> bool:
    return len(got) == len(shape) and all(wanted in (-1, size) for wanted, size in zip(shape, got, strict=True))


def indices_of(chosen: Any, count: int, what: str) -> Any:
    """Indices as they are, or those at which an array of bools is true."""
    flags = np.asarray(chosen) if isinstance(chosen, np.ndarray | list | tuple) and len(chosen) else None
    if flags is None or flags.dtype != np.bool_ or flags.ndim != 1:
        return chosen
    check_count("BAD_ARGUMENT", what, (len(flags), "values"), (count, "faces"))
    return np.flatnonzero(flags).astype(np.int32)
