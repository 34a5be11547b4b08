"""What else a cache holds that follows from its points: vectors that the skin carries, and rates of change."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from pxr import Usd, Vt

from skinslide.arrays.derived import DerivedMeaning, Output
from skinslide.arrays.fetched import Pose
from skinslide.arrays.fetched import Value as CachedValue
from skinslide.problems import Fault, Problem, first_of
from skinslide.shot.products import SlidFrames
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST


class Value(NamedTuple):
    """A value to author."""

    attribute: Usd.Attribute
    time: Usd.TimeCode
    value: Any


class Cached(NamedTuple):
    """What the cache has of an output at a sample; a Fault where that cannot be read."""

    output: Output
    sample: Usd.TimeCode
    value: CachedValue | Fault | None


class Derived:
    """The attributes of one mesh to recompute beside its points, and those to block because they cannot be."""

    def __init__(self, mesh: PatchedMesh, *, between: bool):
        """between: whether the frames between samples are slid too."""
        self.problems: list[Problem] = []
        self.blocked: list[Usd.Attribute] = []
        self._faults: dict[str, list[Problem]] = {}  # of each output, at each time at which it has one
        self._mesh = mesh
        self._meaning = DerivedMeaning(mesh.meaning, mesh.points_times(), mesh.stage.GetTimeCodesPerSecond())
        with contextlib.suppress(Fault):  # too many, of which some are named
            if between:
                self._meaning.fill()
        sources = list(mesh.derived_sources(self._meaning))
        self._sources = {source.wanted.property(): source for source in sources}
        for source in sources:
            self._meaning.take(source.wanted, source.first(), source.samples())
        for warning in self._meaning.warnings():
            self._warn(warning)
        self._recomputed: list[Output] = []
        for output in self._meaning.outputs():
            if output.pose_count:
                self._recomputed.append(output)
            else:
                self._block(output.name, reason=output.reason and f": {output.reason}")
        self._read = list(self._recomputed)

    @property
    def carries(self) -> bool:
        """Whether values depend on how the skin turned."""
        return any(output.is_carried for output in self._recomputed)

    def times_needed(self, time: Usd.TimeCode) -> set[Usd.TimeCode]:
        """The times that must be slid before the values at `time` are known; it is one of them."""
        return {time}.union(*(self._times_of(output, time) for output in self._recomputed))

    def outline(self) -> Iterator[tuple[Any, ...]]:
        """What is known of each output without its values, with its samples."""
        for output in self._meaning.outputs():
            source = self._sources.get(output.name)  # indices have none of their own
            yield (*output[:-1], source.samples() if source else [])  # the last is a pointer

    def cached(self, time: Usd.TimeCode) -> Iterator[Cached]:
        """What the values at a time come of, beside poses."""
        return (self._cached(output, sample) for output in self._read for sample in self._samples(output, time))

    def cached_at(self, chosen: Callable[[Sequence[float]], Sequence[float]]) -> Iterator[Cached]:
        """The same at some of the samples of each output; at its only value where it has none."""
        for output in self._read:
            for sample in map(Usd.TimeCode, chosen(self._sources[output.name].samples()) or [FIRST]):
                yield self._cached(output, sample)

    def values(self, time: Usd.TimeCode, cached: Iterable[Cached], frames: SlidFrames) -> Iterator[Value]:
        """Everything recomputed at a time from what is cached then; `frames` holds the times it needs."""
        for each in cached:
            if each.output not in self._recomputed:
                continue
            try:
                yield self._value(each, time, frames)
            except Fault as fault:
                # Where a sample is missing, its neighbours would be taken instead.
                self._recomputed.remove(each.output)
                self._block(each.output.name, time, f" at all frames: {fault}")
                if each.output.hidden:
                    self._block(each.output.hidden)

    def sample_faults(self) -> list[Problem]:
        """What is not finite in all samples of the cache."""
        for output in self._recomputed:
            source = self._sources[output.name]
            for time in map(Usd.TimeCode, source.samples() or [FIRST]):
                value = self._cached(output, time).value
                if not isinstance(value, Fault):  # which is said of the points, too
                    self._note_faults(output, value, time)
        return self.faults()

    def faults(self) -> list[Problem]:
        """What was not finite in the values so far."""
        return [first for found in self._faults.values() for first in first_of(found)]

    def _note_faults(self, output: Output, cached: CachedValue | None, time: Usd.TimeCode) -> None:
        warning = self._meaning.look(output, cached)
        if warning:
            problem = replace(self._mesh.problem(warning, time), severity="warning")
            self._faults.setdefault(output.name, []).append(problem)

    def _times_of(self, output: Output, time: Usd.TimeCode) -> list[Usd.TimeCode]:
        if output.pose_count == 1:
            return [time]
        return [Usd.TimeCode(each) for each in self._meaning.times(output, time.GetValue())]

    def _samples(self, output: Output, time: Usd.TimeCode) -> list[Usd.TimeCode]:
        """Those that are written at a time: normals may move over points that do not."""
        samples = self._sources[output.name].samples() if time.IsDefault() else []
        return [Usd.TimeCode(each) for each in samples] or [time]

    def _cached(self, output: Output, sample: Usd.TimeCode) -> Cached:
        try:
            return Cached(output, sample, self._sources[output.name].at(sample))
        except Fault as fault:
            return Cached(output, sample, fault)

    def _value(self, cached: Cached, time: Usd.TimeCode, frames: SlidFrames) -> Value:
        output, sample, value = cached
        if isinstance(value, Fault):
            raise value
        poses = [_pose(each, frames) for each in self._times_of(output, time)]
        recomputed = self._meaning.value(output, value, poses)
        self._note_faults(output, value, sample)
        array = Vt.Vec3dArray if output.is_double else Vt.Vec3fArray
        return Value(self._sources[output.name].attribute, sample, array.FromNumpy(recomputed))

    def _block(self, name: str, time: Usd.TimeCode = FIRST, reason: str | None = None) -> None:
        self.blocked.append(self._mesh.prim.GetAttribute(name))
        if reason is not None:
            self._warn(f"{name} cannot be recomputed, so the bake blocks them{reason}", time)

    def _warn(self, message: str, time: Usd.TimeCode = FIRST) -> None:
        self.problems.append(replace(self._mesh.problem(message, time), severity="warning"))


def _pose(time: Usd.TimeCode, frames: SlidFrames) -> Pose:
    frame = frames[time]
    return Pose(0.0 if time.IsDefault() else time.GetValue(), frame.cached, frame.slid, frame.turns)
