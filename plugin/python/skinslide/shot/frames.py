"""Frame specs: `101:109x2` as USD writes them, `101-109x2` as farms do, `1001`, and comma lists of these."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final, Literal, SupportsFloat, TypeAlias

from skinslide.problems import MOST_FRAMES, FrameSpecError, UsageError

if TYPE_CHECKING:
    from pxr import Usd

FrameLike: TypeAlias = "SupportsFloat | Usd.TimeCode"
FramesLike: TypeAlias = "Iterable[FrameLike] | str"
AskedFrames: TypeAlias = list[float] | Literal["authored"] | None  # None: samples, and the frames between
AUTHORED: Final = "authored"  # samples alone

_WANTED = "must be a spec such as 101:109x2"
_CHUNK = re.compile(r"(\d{1,9})/(\d{1,9})", re.ASCII)
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)"
_PART = re.compile(rf"(?P<first>{_NUMBER})(?:[:-](?P<last>{_NUMBER})(?:x(?P<step>{_NUMBER}))?)?", re.ASCII)


def parse_frames(spec: str) -> list[float]:
    """Reads a frame spec.

    Args:
        spec: `101:109x2` as USD writes ranges, `101-109x2` as farms do, `1001`, or a comma list of these. Ranges
            include their ends and may descend; steps may be fractions.

    Returns:
        The frames, ascending, each once.

    Raises:
        FrameSpecError: The spec is none; the message names the part.
    """
    if not isinstance(spec, str):
        raise FrameSpecError(f"frames {spec!r}: {_WANTED}")
    frames: set[float] = set()
    left = MOST_FRAMES
    for part in spec.split(","):
        first, step, count = _parse_part(part.strip(), spec)
        left -= count
        if left < 0:
            raise FrameSpecError(f"frames {spec!r}: more than {MOST_FRAMES} frames")
        frames.update(_expand(first, step, count))
    return sorted(frames)


def spec_of(frames: Sequence[float]) -> str:
    """A spec of frames in order, from which `parse_frames` makes the same."""
    exact, parts, start = list(map(Fraction, map(repr, frames))), list[str](), 0
    while start < len(exact):
        end = start + 1
        step = exact[end] - exact[start] if end < len(exact) else Fraction(1)
        while end + 1 < len(exact) and exact[end + 1] - exact[end] == step:
            end += 1
        end = end if end - start > 1 else start
        parts.append(_range_text(exact[start], exact[end], step))
        start = end + 1
    return ",".join(parts)


def _range_text(first: Fraction, last: Fraction, step: Fraction) -> str:
    if first == last:
        return _decimal(first)
    return f"{_decimal(first)}:{_decimal(last)}" + (f"x{_decimal(step)}" if step != 1 else "")


def _decimal(number: Fraction) -> str:
    """The digits of a number that has finitely many."""
    places = 0
    while (number * 10**places).denominator != 1:
        places += 1
    digits = str(abs((number * 10**places).numerator)).rjust(places + 1, "0")
    sign = "-" if number < 0 else ""
    return sign + (f"{digits[:-places]}.{digits[-places:]}" if places else digits)


def checked_frames(frames: FramesLike) -> list[float]:
    """Frames as a spec or one by one, ascending, each once."""
    if isinstance(frames, str):
        return parse_frames(frames)
    try:
        times = sorted(set(map(_number, frames)))
    except (AttributeError, TypeError, ValueError, OverflowError) as error:
        raise FrameSpecError(f"frames {frames!r}: {_WANTED}, or a list of numbers") from error
    if not times or not all(map(math.isfinite, times)):
        raise FrameSpecError(f"frames {times}: there must be some, each a finite number")
    return times


def _number(frame: FrameLike) -> float:
    return float(frame if isinstance(frame, SupportsFloat) else frame.GetValue())


def _parse_part(part: str, spec: str) -> tuple[Fraction, Fraction, int]:
    """First frame, signed step and count of `part`, exactly."""
    if not part:
        raise FrameSpecError(f"frames {spec!r}: empty" if not spec.strip() else f"frames {spec!r}: a part is empty")
    match = _PART.fullmatch(part)
    if not match:
        raise FrameSpecError(f"frames {spec!r}: {part!r} is neither a frame nor a range such as 101:109x2")
    if any(len(number) > 40 for number in match.groups("")):
        raise FrameSpecError(f"frames {spec!r}: a number of {part[:20]!r}... is too long")
    first = Fraction(match["first"])
    last = Fraction(match["last"] or first)
    step = Fraction(match["step"] or 1)
    if step < 0 and first > last:
        step = -step
    if step <= 0:
        raise FrameSpecError(f"frames {spec!r}: the step of {part!r} leads nowhere")
    count = int(abs(last - first) / step) + 1
    return first, step if first <= last else -step, count


def _expand(first: Fraction, step: Fraction, count: int) -> list[float]:
    # Over one denominator every frame is a single, correctly rounded division: nothing accumulates.
    denominator = first.denominator * step.denominator
    start, stride = first.numerator * step.denominator, step.numerator * first.denominator
    return [(start + i * stride) / denominator for i in range(count)]


@dataclass(frozen=True)
class Chunk:
    """One of several parts of a shot's frames, as near to equal as can be: `3/8` is the third of eight."""

    number: int
    count: int

    @classmethod
    def parse(cls, text: object) -> Chunk:
        """Raises UsageError for what is none, and for a number that is beyond the count."""
        found = _CHUNK.fullmatch(text) if isinstance(text, str) else None
        if not found:
            raise UsageError(f"chunk {text!r}: must be a part and how many there are, such as 3/8")
        chunk = cls(int(found[1]), int(found[2]))
        if not 1 <= chunk.number <= chunk.count:
            raise UsageError(f"chunk {chunk}: the part must be from 1 to {chunk.count}")
        return chunk

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def of(self, frames: Sequence[float]) -> Sequence[float]:
        """Its frames, of all frames in order. Raises UsageError where they do not go round."""
        if self.count > len(frames):
            raise UsageError(f"chunk {self}: there are {len(frames)} frames to divide")
        first, last = (number * len(frames) // self.count for number in (self.number - 1, self.number))
        return frames[first:last]
