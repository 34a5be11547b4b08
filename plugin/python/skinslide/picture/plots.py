"""The curves of a patch over its frames, as SVG: axes with numbers, a line a quantity, and marks for one frame.

Everything is drawn here, so that a page shows it without a script; the script only moves the marks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from skinslide.problems import frame_text
from skinslide.shot.report import PatchReport, milliseconds_text, stretch_text, time_text

# Units of the viewBox; the plot lies within the margins.
_WIDTH, _HEIGHT = 300, 140
_LEFT, _RIGHT, _TOP, _BOTTOM = 38, 298, 8, 120
_X_TICKS, _Y_TICKS = 5, 5  # at most


@dataclass(frozen=True)
class Quantity:
    """Something with a value at each frame."""

    name: str
    style: str  # the class of its line
    values: np.ndarray  # (frames,)
    texts: list[str]


@dataclass(frozen=True)
class Chart:
    title: str
    unit: str
    quantities: list[Quantity]


def charts(patch: PatchReport) -> list[Chart]:
    """What is drawn of a patch. Stages that took no time, such as relax under most rules, are left out."""
    stretch = [
        Quantity(when, when, values, [stretch_text(value) for value in values])
        for when in ("before", "after")
        for values in [patch.column(f"stretch_{when}")]
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
    return [
        Chart("Stretch", "RMS log(length / rest length)", stretch),
        Chart("Largest slide", "units of the mesh", [Quantity("slide", "after", slide, _aligned(slide))]),
        Chart("Folds and clamps", "count", counts),
        Chart("Time", "ms a frame", times),
    ]


def svg(chart: Chart, frames: Sequence[float | None]) -> str:
    """A chart over the frames, ascending; None is the default time. The marks are at the first of them."""
    across = _Axis.of_frames(frames)
    up = _Axis.of_values(chart.quantities)
    x = [_LEFT + share * (_RIGHT - _LEFT) for share in across.shares([frame or 0 for frame in frames])]
    lines, marks = [], []
    for quantity in chart.quantities:
        y = [_BOTTOM - share * (_BOTTOM - _TOP) for share in up.shares(quantity.values)]
        points = " ".join(f"{px:.2f},{py:.2f}" for px, py in zip(x, y, strict=True))
        lines.append(f'<polyline class="{quantity.style}" points="{points}"/>')
        marks.append(f'<circle class="{quantity.style}" cx="{x[0]:.2f}" cy="{y[0]:.2f}" r="3"/>')
    cursor = f'<line class="cursor" x1="{x[0]:.2f}" x2="{x[0]:.2f}" y1="{_TOP}" y2="{_BOTTOM}"/>'
    drawn = [*_y_axis(up), *_x_axis(across, frames), cursor, *lines, *marks]
    label = escape(_described(chart, frames))
    return f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{label}">{"".join(drawn)}</svg>'


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


def _y_axis(axis: _Axis) -> Iterator[str]:
    for tick, share in zip(axis.ticks, axis.shares(axis.ticks), strict=True):
        y = _BOTTOM - share * (_BOTTOM - _TOP)
        line = f'<line x1="{_LEFT}" x2="{_RIGHT}" y1="{y:.2f}" y2="{y:.2f}"/>'
        text = f'<text x="{_LEFT - 6}" y="{y + 3.5:.2f}">{_tick_text(tick, axis.ticks[1])}</text>'
        yield f'<g class="y tick">{line}{text}</g>'


def _tick_text(tick: float, step: float) -> str:
    """With the step's decimals, unless they are many."""
    return f"{tick:.{max(-math.floor(math.log10(step)), 0)}f}" if 1e-4 <= step < 1e5 else f"{tick:g}"


def _x_axis(axis: _Axis, frames: Sequence[float | None]) -> Iterator[str]:
    for tick, share in zip(axis.ticks, axis.shares(axis.ticks), strict=True):
        x = _LEFT + share * (_RIGHT - _LEFT)
        line = f'<line x1="{x:.2f}" x2="{x:.2f}" y1="{_BOTTOM}" y2="{_BOTTOM + 4}"/>'
        text = f'<text x="{x:.2f}" y="{_HEIGHT - 5}">{time_text(None) if frames == [None] else frame_text(tick)}</text>'
        yield f'<g class="x tick">{line}{text}</g>'


def _described(chart: Chart, frames: Sequence[float | None]) -> str:
    """A chart in words: the most of each quantity and where."""
    parts = []
    for quantity in chart.quantities:
        most = int(np.argmax(quantity.values))
        parts.append(f"{quantity.name} at most {quantity.texts[most]}, at frame {time_text(frames[most])}")
    return f"{chart.title}, {chart.unit}: {'; '.join(parts)}"


def _aligned(values: np.ndarray) -> list[str]:
    """Values with as many decimals as give the largest four digits."""
    largest = float(values.max())
    decimals = min(max(3 - math.floor(math.log10(largest)), 0), 12) if largest > 0 else 0
    return [f"{value:.{decimals}f}" for value in values]
