"""Calls of `stage.h`: records become structs, arrays are copied out, and statuses are raised as Fault."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.fetched import NOTHING, Asset, File, Other, Poses, PrimFacts, Subset, Value
from skinslide.arrays.native import Handle, new, new_array, text
from skinslide.arrays.schema import Input
from skinslide.problems import Fault

_TYPES = {
    np.dtype(np.bool_): lib.SKINSLIDE_VALUE_BOOL,
    np.dtype(np.uint8): lib.SKINSLIDE_VALUE_UINT8,
    np.dtype(np.int32): lib.SKINSLIDE_VALUE_INT32,
    np.dtype(np.uint32): lib.SKINSLIDE_VALUE_UINT32,
    np.dtype(np.int64): lib.SKINSLIDE_VALUE_INT64,
    np.dtype(np.uint64): lib.SKINSLIDE_VALUE_UINT64,
    np.dtype(np.float16): lib.SKINSLIDE_VALUE_HALF,
    np.dtype(np.float32): lib.SKINSLIDE_VALUE_FLOAT,
    np.dtype(np.float64): lib.SKINSLIDE_VALUE_DOUBLE,
}


def call_stage(function: Any, *arguments: Any) -> None:
    """Raises Fault with the core's sentence, MemoryError."""
    native, error = StageRecords(), ffi.new("skinslide_error *")
    status = function(*map(native.of, arguments), error)
    if status == lib.SKINSLIDE_OUT_OF_MEMORY:
        raise MemoryError(text(error.message))
    if status != lib.SKINSLIDE_OK:
        raise Fault(text(error.message))


class StageRecords:
    """The structs of one call, and the memory they point into for as long as this object lives."""

    def __init__(self) -> None:
        self._alive: list[Any] = []

    def of(self, argument: Any) -> Any:
        """An argument as the core takes it."""
        maker = _MAKERS.get(type(argument))
        return maker(self, argument) if maker else argument

    def _sized(self, struct: str, **fields: Any) -> Any:
        made = self._keep(new(struct))
        for name, value in fields.items():
            setattr(made, name, self.of(value))
        return made

    def _value(self, value: Value) -> Any:
        fields = {"type": lib.SKINSLIDE_VALUE_BLOCKED, "width": 1, "count": 1, **self._content(value.value)}
        record = self._sized("value", name=value.name, interpolation=value.interpolation, **fields)
        record.type_name, record.indices = self._text(value.type_name), self.of(value.indices)
        return record

    def _content(self, value: Any) -> dict[str, Any]:
        if isinstance(value, str):
            kind = lib.SKINSLIDE_VALUE_ASSET if isinstance(value, Asset) else lib.SKINSLIDE_VALUE_TEXT
            return {"type": kind, "data": self._text(value)}
        if value is None or value is NOTHING:
            return {} if value is None else {"type": lib.SKINSLIDE_VALUE_NONE}
        return {"type": lib.SKINSLIDE_VALUE_OTHER} if isinstance(value, Other) else self._numbers(np.asarray(value))

    def _numbers(self, array: np.ndarray) -> dict[str, Any]:
        kind = _TYPES.get(array.dtype) if array.ndim < 3 else None
        fields = {"is_array": array.ndim > 0, "count": len(array) if array.ndim else 1}
        if kind is None:
            return {**fields, "type": lib.SKINSLIDE_VALUE_OTHER}
        width = array.shape[1] if array.ndim == 2 else 1
        return {**fields, "type": kind, "width": max(width, 1), "data": self._array("char[]", array)}

    def _subset(self, subset: Subset) -> Any:
        return self._sized("stage_subset", **subset._asdict())

    def _file(self, file: File) -> Any:
        struct = self._sized("stage_file", path=file.path, reason=file.reason, byte_count=file.size)
        if file.content is not None:
            struct.bytes = self._keep(ffi.from_buffer("uint8_t[]", file.content))
        if file.descriptor is not None:
            struct.descriptor = self._keep(ffi.new("int32_t *", file.descriptor))
        return struct

    def _facts(self, facts: PrimFacts) -> Any:
        fields = vars(facts) | {"schemas": self._texts(facts.schemas), "properties": self._texts(facts.properties)}
        counts = {"schema_count": len(facts.schemas), "property_count": len(facts.properties)}
        return self._sized("stage_prim", **fields, **counts)

    def _poses(self, poses: Poses) -> Any:
        structs = self._keep(new_array("stage_pose", len(poses)))
        for struct, pose in zip(structs, poses, strict=True):
            struct.time = pose.time
            struct.cached, struct.slid = (self._array("float[]", each) for each in (pose.cached, pose.slid))
            struct.turns = ffi.NULL if pose.turns is None else self._array("float[]", pose.turns)
        return structs

    def _text(self, words: str) -> Any:
        return self._keep(ffi.new("char[]", words.encode(errors="replace")))

    def _texts(self, words: Sequence[str]) -> Any:
        return self._keep(ffi.new("char *[]", [self._text(each) for each in words]))

    def _array(self, ctype: str, array: np.ndarray) -> Any:
        return self._keep(ffi.from_buffer(ctype, np.ascontiguousarray(array)))

    def _keep(self, made: Any) -> Any:
        self._alive.append(made)
        return made


_MAKERS: dict[type, Callable[[StageRecords, Any], Any]] = {
    Value: StageRecords._value,
    Subset: StageRecords._subset,
    File: StageRecords._file,
    PrimFacts: StageRecords._facts,
    Poses: StageRecords._poses,
    list: StageRecords._texts,
    str: StageRecords._text,
    Handle: lambda _records, handle: handle.pointer,
    Input: lambda _records, source: source.pointer,
    type(None): lambda _records, _nothing: ffi.NULL,
}


def copied(pointer: Any, dtype: type, count: int, width: int | None = None) -> np.ndarray:
    """A copy of an array of the core, (count,) or (count, width)."""
    size = count * (width or 1) * np.dtype(dtype).itemsize
    array: np.ndarray = np.frombuffer(ffi.buffer(pointer, size), dtype).copy() if size else np.empty(0, dtype)
    return array if width is None else array.reshape(count, width)


def optional(pointer: Any, dtype: type, count: int, width: int | None = None) -> np.ndarray | None:
    """The same, where the core has one."""
    return copied(pointer, dtype, count, width) if pointer else None
