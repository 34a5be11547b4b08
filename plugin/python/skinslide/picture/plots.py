"""The curves of a patch over its frames: axes with numbers, a line for each quantity, and marks for one frame.

Everything is placed here, in the units of an SVG: a page shows it without a script, which only moves the marks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from typing import ClassVar

import numpy as np

from skinslide.problems import frame_text
from skinslide.shot.report import PatchReport, milliseconds_text, stretch_text, time_text

_X_TICKS, _Y_TICKS = 5, 5  # at most
_COMPARED = ("after", "relax", "locate", "interpolate")  # classes of lines, of as many rules as there are


@dataclass(frozen=True)
class Quantity:
    """Something with a value at each frame."""

    name: str
    style: str  # the class of its line
    values: np.ndarray  # (frames,)
    texts: list[str]


@dataclass(frozen=True)
class Chart:
    """Quantities over the frames, ascending; None is the default time. Ticks are a place and a text each."""

    width: ClassVar[int] = 300
    height: ClassVar[int] = 140
    left: ClassVar[int] = 38  # the plot lies within the margins
    right: ClassVar[int] = 298
    top: ClassVar[int] = 8
    bottom: ClassVar[int] = 120

    title: str
    unit: str
    quantities: list[Quantity]
    frames: Sequence[float | None]
    columns: list[int]  # of its quantities in the table of all, behind that of frames

    @cached_property
    def x(self) -> list[float]:
        """Where the frames are."""
        return self._across([frame or 0 for frame in self.frames])

    def y(self, quantity: Quantity) -> list[float]:
        """Where its values are."""
        return self._up(quantity.values)

    def points(self, quantity: Quantity) -> str:
        """Its line."""
        return " ".join(f"{x:.2f},{y:.2f}" for x, y in zip(self.x, self.y(quantity), strict=True))

    @property
    def x_ticks(self) -> list[tuple[float, str]]:
        ticks = self._frame_axis.ticks
        texts = [time_text(None) if self.frames == [None] else frame_text(tick) for tick in ticks]
        return list(zip(self._across(ticks), texts, strict=True))

    @property
    def y_ticks(self) -> list[tuple[float, str]]:
        ticks = self._value_axis.ticks
        texts = [_tick_text(tick, ticks[1]) for tick in ticks]
        return list(zip(self._up(ticks), texts, strict=True))

    @property
    def described(self) -> str:
        """The largest value of each quantity, and where it is, in words."""
        parts = []
        for quantity in self.quantities:
            most = int(np.argmax(quantity.values))
            parts.append(f"{quantity.name} at most {quantity.texts[most]}, at frame {time_text(self.frames[most])}")
        return f"{self.title}, {self.unit}: {'; '.join(parts)}"

    @cached_property
    def _frame_axis(self) -> _Axis:
        return _Axis.of_frames(self.frames)

    @cached_property
    def _value_axis(self) -> _Axis:
        return _Axis.of_values(self.quantities)

    def _across(self, frames: Sequence[float]) -> list[float]:
        return [self.left + share * (self.right - self.left) for share in self._frame_axis.shares(frames)]

    def _up(self, values: Sequence[float] | np.ndarray) -> list[float]:
        return [self.bottom - share * (self.bottom - self.top) for share in self._value_axis.shares(values)]


def charts(patch: PatchReport, compared: Mapping[str, Sequence[float]]) -> list[Chart]:
    """What is drawn of a patch. Stages that took no time, such as relax under most rules, are left out.

    Args:
        patch: What happened at each frame.
        compared: The stretch that each of several rules leaves; of none, that of the patch's own is drawn.
    """
    lines = {"before": patch.column("stretch_before"), **{rule: np.array(left) for rule, left in compared.items()}}
    lines |= {} if compared else {"after": patch.column("stretch_after")}
    stretch = [
        Quantity(name, style, values, [stretch_text(value) for value in values])
        for style, (name, values) in zip(("before", *_COMPARED), lines.items(), strict=False)
    ]
    slide = patch.column("largest_slide")
    counts = [
        Quantity(name, style, values, [str(value) for value in values])
        for name, style in (("folded faces", "folded"), ("clamped vertices", "clamped"))
        for values in [patch.column(name.replace(" ", "_"))]
    ]
    times = [
        Quantity(stage, stage, values, [milliseconds_text(value) for value in values])
        for stage, values in patch.milliseconds().items()
        if values.any()
    ]
    drawn = [
        ("Stretch", "RMS log(length / rest length)", stretch),
        ("Largest slide", "units of the mesh", [Quantity("slide", "after", slide, _aligned(slide))]),
        ("Folds and clamps", "count", counts),
        ("Time", "ms a frame", times),
    ]
    ends = list(accumulate((len(quantities) for _, _, quantities in drawn), initial=1))
    columns = [list(range(first, end)) for first, end in pairwise(ends)]
    return [Chart(*each, patch.frames, own) for each, own in zip(drawn, columns, strict=True)]


@dataclass(frozen=True)
class _Axis:
    low: float
    high: float
    ticks: list[float]

    @classmethod
    def of_frames(cls, frames: Sequence[float | None]) -> _Axis:
        known = [frame for frame in frames if frame is not None] or [0.0]
        return cls(known[0], known[-1], _ticks(known[0], known[-1], _X_TICKS))

    @classmethod
    def of_values(cls, quantities: Sequence[Quantity]) -> _Axis:
        """From 0 to a tick at or above the largest value; to 1 where all are 0."""
        largest = max((float(quantity.values.max()) for quantity in quantities), default=0.0)
        step = _step(largest or 1.0, _Y_TICKS)
        if all(quantity.values.dtype.kind == "i" for quantity in quantities):
            step = max(step, 1.0)
        count = max(math.ceil((largest or 1.0) / step - 1e-9), 1)
        return cls(0.0, count * step, [i * step for i in range(count + 1)])

    def shares(self, values: Sequence[float] | np.ndarray) -> list[float]:
        """Where values are between the ends, 0 to 1; in the middle where the ends are one."""
        span = self.high / 2 - self.low / 2  # halves, since frames may be farther apart than the largest number
        return [(float(value) / 2 - self.low / 2) / span if span else 0.5 for value in values]


def _step(span: float, most: int) -> float:
    """The least of 1, 2 and 5 times a power of ten that divides a span into at most `most` parts."""
    power = 10.0 ** math.floor(math.log10(span / most))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power * most >= span * (1 - 1e-9))


def _ticks(low: float, high: float, most: int) -> list[float]:
    if high == low:
        return [low]
    if math.isinf(high - low):
        return [low, high]
    step = _step(high - low, most)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [i * step for i in range(first, last + 1)]


def _tick_text(tick: float, step: float) -> str:
    """A tick with as many decimals as the step, unless they are many."""
    return f"{tick:.{max(-math.floor(math.log10(step)), 0)}f}" if 1e-4 <= step < 1e5 else f"{tick:g}"


def _aligned(values: np.ndarray) -> list[str]:
    """Values with as many decimals as give the largest four digits."""
    largest = float(values.max())
    decimals = min(max(3 - math.floor(math.log10(largest)), 0), 12) if largest > 0 else 0
    return [f"{value:.{decimals}f}" for value in values]
