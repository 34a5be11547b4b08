"""What else a cache holds that follows from its points: normals, velocities, accelerations."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from pxr import Usd, UsdGeom, Vt

from skinslide.arrays import slider
from skinslide.problems import Fault, Problem
from skinslide.shot.products import SlidFrames
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import SAME_TIME, flattened


class Value(NamedTuple):
    """A value to author."""

    attribute: Usd.Attribute
    time: Usd.TimeCode
    value: Any


class Derived:
    """The attributes of one mesh to recompute beside its points, and those to block because they cannot be."""

    def __init__(self, mesh: PatchedMesh):
        self.problems: list[Problem] = []
        self._path = mesh.path
        normals = _find_normals(mesh)
        rates, blocked = _find_rates(mesh)
        self.blocked = list(blocked)
        for attribute, reason in blocked.items():
            message = f"{attribute.GetName()} cannot be recomputed, so the bake blocks them: {reason}"
            self.problems.append(Problem("warning", mesh.path, None, None, message))
        self._recomputed = [*([normals] if normals else []), *rates]
        if normals and normals.primvar and normals.primvar.IsIndexed():
            self.blocked.append(normals.primvar.GetIndicesAttr())

    def times_needed(self, time: Usd.TimeCode) -> set[Usd.TimeCode]:
        """The times that must be slid before the values at `time` are known; it is one of them."""
        return {time}.union(*(derived.times_needed(time) for derived in self._recomputed))

    def values(self, time: Usd.TimeCode, frames: SlidFrames) -> Iterator[Value]:
        """Everything recomputed at a time; `frames` holds the times it needs."""
        for derived in list(self._recomputed):
            try:
                yield from derived.values(time, frames)
            except (slider.SliderError, Fault) as error:
                self._block(derived, time, str(error))

    def _block(self, derived: _Normals | _Rates, time: Usd.TimeCode, reason: str) -> None:
        """Gives an attribute up at all times: where a sample is missing, its neighbours would be taken instead."""
        self._recomputed = [other for other in self._recomputed if other is not derived]
        self.blocked += [derived.attribute, *derived.hidden()]
        frame = None if time.IsDefault() else time.GetValue()
        message = f"{derived.attribute.GetName()} cannot be recomputed, so the bake blocks them at all frames: {reason}"
        self.problems.append(Problem("warning", self._path, None, frame, message))


@dataclass(frozen=True)
class _Normals:
    mesh: PatchedMesh
    attribute: Usd.Attribute
    primvar: UsdGeom.Primvar | None  # where they are one
    interpolation: str

    def hidden(self) -> list[Usd.Attribute]:
        """What would be read in place of these were they blocked alone."""
        normals = UsdGeom.PointBased(self.mesh.prim).GetNormalsAttr()
        return [normals] if self.primvar and normals.HasAuthoredValue() else []

    def times_needed(self, time: Usd.TimeCode) -> set[Usd.TimeCode]:
        return {time}

    def values(self, time: Usd.TimeCode, frames: SlidFrames) -> Iterator[Value]:
        mesh, points = self.mesh, frames[time]
        # Normals may move over points that do not.
        for sample in (self.attribute.GetTimeSamples() if time.IsDefault() else []) or [time]:
            cached = flattened(self.primvar, sample) if self.primvar else self.attribute.Get(sample)
            if cached is None:
                raise Fault("there is no value")
            recomputed = slider.normals(
                mesh.face_counts,
                mesh.face_indices,
                points.cached,
                points.slid,
                np.asarray(cached),
                self.interpolation,
                left_handed=mesh.left_handed,
            )
            yield Value(self.attribute, Usd.TimeCode(sample), Vt.Vec3fArray.FromNumpy(recomputed))


@dataclass(frozen=True)
class _Rates:
    attribute: Usd.Attribute
    function: Callable[[list[slider.Sample], np.ndarray], np.ndarray]
    sample_count: int
    times: list[float]  # of the cache's points, ascending

    def hidden(self) -> list[Usd.Attribute]:
        return []

    def times_needed(self, time: Usd.TimeCode) -> set[Usd.TimeCode]:
        return {Usd.TimeCode(sample) for sample in samples_around(self.times, time.GetValue(), self.sample_count)}

    def values(self, time: Usd.TimeCode, frames: SlidFrames) -> Iterator[Value]:
        per_second = self.attribute.GetStage().GetTimeCodesPerSecond()
        samples = []
        for sample in samples_around(self.times, time.GetValue(), self.sample_count):
            points = frames[Usd.TimeCode(sample)]
            samples.append(slider.Sample(sample / per_second, points.cached, points.slid))
        cached = self.attribute.Get(time)
        if cached is None:
            raise Fault("there is no value")
        corrected = self.function(samples, np.asarray(cached))
        yield Value(self.attribute, time, Vt.Vec3fArray.FromNumpy(corrected))


def samples_around(times: list[float], time: float, count: int) -> list[float]:
    """The times for a first (2) or second (3) difference at `time`.

    The authored ones next to it on either side, with `time` between them for a second difference; at an end of the
    cache `time` itself and those nearest to it.
    """
    before, after = times[: bisect_left(times, time - SAME_TIME)], times[bisect_right(times, time + SAME_TIME) :]
    if before and after:
        return [before[-1], after[0]] if count == 2 else [before[-1], time, after[0]]
    return [time, *after[: count - 1]] if after else [*before[1 - count :], time]


def _find_normals(mesh: PatchedMesh) -> _Normals | None:
    """primvars:normals, which win over normals; None where there are none that follow from points."""
    geometry = UsdGeom.PointBased(mesh.prim)
    primvar = UsdGeom.PrimvarsAPI(mesh.prim).GetPrimvar("normals")
    if primvar and primvar.HasAuthoredValue():
        found = _Normals(mesh, primvar.GetAttr(), primvar, primvar.GetInterpolation())
    elif geometry.GetNormalsAttr().HasAuthoredValue():
        found = _Normals(mesh, geometry.GetNormalsAttr(), None, geometry.GetNormalsInterpolation())
    else:
        return None
    return None if found.interpolation == UsdGeom.Tokens.constant else found


def _find_rates(mesh: PatchedMesh) -> tuple[list[_Rates], dict[Usd.Attribute, str]]:
    """Velocities and accelerations to recompute, and those to block, each with why: stale ones would blur wrongly."""
    geometry, times = UsdGeom.PointBased(mesh.prim), mesh.points_times()
    kinds = [
        (geometry.GetVelocitiesAttr(), slider.velocities, 2),
        (geometry.GetAccelerationsAttr(), slider.accelerations, 3),
    ]
    rates, blocked = [], {}
    for attribute, function, count in kinds:
        if not attribute.HasAuthoredValue():
            continue
        reason = _why_not(mesh, attribute, count)
        if reason:
            blocked[attribute] = reason
        else:
            rates.append(_Rates(attribute, function, count, times))
    return rates, blocked


def _why_not(mesh: PatchedMesh, attribute: Usd.Attribute, count: int) -> str | None:
    """Why rates of change that take `count` samples of points cannot be recomputed."""
    times, per_second = mesh.points_times(), mesh.stage.GetTimeCodesPerSecond()
    if not (math.isfinite(per_second) and per_second > 0):
        return f"the stage has {per_second:g} time codes per second"
    if len(times) < count:
        return f"that takes {count} samples of points, and there are {len(times)}"
    if attribute.GetTimeSamples() != UsdGeom.PointBased(mesh.prim).GetPointsAttr().GetTimeSamples():
        return "their samples are at other times than those of points"
    return None
