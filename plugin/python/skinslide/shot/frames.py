"""Frame specs: `101:109x2` as USD writes them, `101-109x2` as farms do, `1001`, and comma lists of these."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING, Final, Literal, SupportsFloat, TypeAlias

from skinslide.problems import MOST_FRAMES, FrameSpecError

if TYPE_CHECKING:
    from pxr import Usd

FrameLike: TypeAlias = "SupportsFloat | Usd.TimeCode"
FramesLike: TypeAlias = "Iterable[FrameLike] | str"
AskedFrames: TypeAlias = list[float] | Literal["authored"] | None  # None: samples, and the frames between
AUTHORED: Final = "authored"  # samples alone

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
    frames: set[float] = set()
    left = MOST_FRAMES
    for part in spec.split(","):
        first, step, count = _parse_part(part.strip(), spec)
        left -= count
        if left < 0:
            raise FrameSpecError(f"frames {spec!r}: more than {MOST_FRAMES} frames")
        frames.update(_expand(first, step, count))
    return sorted(frames)


def checked_frames(frames: FramesLike) -> list[float]:
    """Frames as a spec or one by one, ascending, each once."""
    if isinstance(frames, str):
        return parse_frames(frames)
    try:
        times = sorted(set(map(_number, frames)))
    except (AttributeError, TypeError, ValueError, OverflowError) as error:
        raise FrameSpecError(f"frames {frames!r}: must be a spec such as 101:109x2, or a list of numbers") from error
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
