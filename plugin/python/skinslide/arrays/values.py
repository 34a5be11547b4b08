"""What values of a scene are outside any mesh: numbers, points, times, text. Raises Fault for what they cannot be."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.calls import StageRecords, call_stage
from skinslide.arrays.fetched import Value
from skinslide.arrays.native import writable
from skinslide.arrays.schema import Input


def integers(value: Value | None) -> np.ndarray:
    """Whole numbers, int32 (n,). Raises Fault."""
    out = np.empty(_length(value), np.int32)
    call_stage(lib.skinslide_value_integers, value, writable("int32_t[]", out))
    return out


def positions(value: Value | None) -> np.ndarray:
    """Points, float32 (n, 3). Raises Fault."""
    out = np.empty((_length(value), 3), np.float32)
    call_stage(lib.skinslide_value_positions, value, writable("float[]", out))
    return out


def _length(value: Value | None) -> int:
    native = StageRecords()
    return int(lib.skinslide_value_length(native.of(value)))


def merge_times(times: Iterable[float]) -> list[float]:
    """Times in order; of those that differ by noise only, the one given first."""
    merged = np.array(list(times), np.float64)
    count = ffi.new("int64_t *", len(merged))
    call_stage(lib.skinslide_stage_merge_times, writable("double[]", merged), count)
    return merged[: count[0]].tolist()


def times_between(times: Sequence[float]) -> list[float]:
    """The whole times between those of a merged list that are more than 1 apart. Raises Fault for too many."""
    given, count = ffi.new("double[]", list(times)), ffi.new("int64_t *")
    call_stage(lib.skinslide_stage_times_between, given, len(given), ffi.NULL, count)
    between = ffi.new("double[]", count[0])
    call_stage(lib.skinslide_stage_times_between, given, len(given), between, count)
    return list(between)


def check_value(source: Input, value: Value) -> None:
    """Raises Fault for what cannot be authored for an input of the group PATCH or LIVE, whatever the mesh."""
    call_stage(lib.skinslide_stage_check_value, source, value)


def check_text(usda: str) -> None:
    """Raises Fault for text that USD cannot parse, or would end the process over."""
    encoded = usda.encode()
    call_stage(lib.skinslide_stage_text, ffi.from_buffer(encoded), len(encoded))
