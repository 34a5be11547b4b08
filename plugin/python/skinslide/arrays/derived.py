"""What a mesh has beside its points that follows from them: vectors that the skin carries, and rates of change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.calls import call_stage
from skinslide.arrays.fetched import Pose, Poses, Value
from skinslide.arrays.meaning import MeshMeaning
from skinslide.arrays.native import Handle, text, writable
from skinslide.arrays.schema import Input, read_input


class Output(NamedTuple):
    """An attribute to write beside the points, as in `skinslide_stage_output`."""

    name: str
    type_name: str
    pose_count: int
    value_count: int
    reason: str | None
    hidden: str | None
    is_carried: bool
    is_double: bool
    pointer: Any


class DerivedMeaning:
    """What a mesh has beside its points that follows from them: vectors that the skin carries, and rates of change."""

    def __init__(self, mesh: MeshMeaning, point_times: Sequence[float], rate: float):
        out = ffi.new("skinslide_stage_derived **")
        times = ffi.new("double[]", list(point_times))
        call_stage(lib.skinslide_stage_derived_create, mesh.handle, times, len(times), rate, out)
        self.handle = Handle(out[0], lib.skinslide_stage_derived_destroy, mesh.handle)

    def fill(self) -> None:
        """Takes the frames between samples of points for slid too."""
        call_stage(lib.skinslide_stage_derived_fill, self.handle)

    def offer(self, name: str, type_name: str, interpolation: str | None, element_size: int) -> Input | None:
        """The input that a primvar is to be taken as; None where it does not follow, or nobody knows how."""
        out = ffi.new("const skinslide_stage_input **")
        call_stage(lib.skinslide_stage_derived_offer, self.handle, name, type_name, interpolation, element_size, out)
        return read_input(out[0]) if out[0] else None

    def take(self, source: Input, value: Value | None, times: Sequence[float]) -> None:
        """Takes an input of the group derived, or one that was offered, at its first time, with its samples."""
        given = ffi.new("double[]", list(times))
        call_stage(lib.skinslide_stage_derived_take, self.handle, source, value, given, len(times))

    def outputs(self) -> list[Output]:
        found: list[Output] = []
        while each := lib.skinslide_stage_derived_output(self.handle.pointer, len(found)):
            reason, hidden = (text(words) if words else None for words in (each.reason, each.hidden))
            words = (text(each.name), text(each.type_name))
            kind = (bool(each.is_carried), bool(each.is_double))
            found.append(Output(*words, each.pose_count, each.count, reason, hidden, *kind, each))
        return found

    def warnings(self) -> list[str]:
        found: list[str] = []
        while warning := lib.skinslide_stage_derived_warning(self.handle.pointer, len(found)):
            found.append(text(warning))
        return found

    def times(self, output: Output, time: float) -> list[float]:
        """The times of the poses that a value takes."""
        times = ffi.new("double[3]")
        count = lib.skinslide_stage_derived_times(self.handle.pointer, output.pointer, time, times)
        return list(times[0:count])

    def look(self, output: Output, cached: Value | None) -> str:
        """What to warn of in a value of the cache: what is not finite and passes as it is; or nothing."""
        faults, warning = ffi.new("int32_t *"), ffi.new("skinslide_error *")
        call_stage(lib.skinslide_stage_derived_faults, self.handle, output.pointer, cached, faults, warning)
        return text(warning.message) if faults[0] else ""

    def value(self, output: Output, cached: Value | None, poses: Sequence[Pose]) -> np.ndarray:
        """The value at a time, (n, 3) of float32 or, where the output is double, float64. Raises Fault."""
        out = np.empty((output.value_count, 3), np.float64 if output.is_double else np.float32)
        place = writable("char[]", out)
        call_stage(
            lib.skinslide_stage_derived_value, self.handle, output.pointer, cached, Poses(poses), len(poses), place
        )
        return out
