"""What a bake is asked for, checked before anything is read."""

import operator
from collections.abc import Sequence
from dataclasses import dataclass

from skinslide.frames import UsageError, checked_frames
from skinslide.slider import Lookup, SliderError, choose_lookup

Frames = Sequence[float] | str | None


@dataclass(frozen=True)
class BakeOptions:
    """The arguments of `skinslide.bake`. Limits are what a patch may have at one frame; None is any number."""

    prims: list[str] | None
    frames: list[float] | None  # ascending
    lookup: Lookup
    jobs: int
    max_folded: int | None
    max_clamped: int | None
    diagnostics: bool

    @classmethod
    def checked(
        cls,
        prims: Sequence[str] | str | None,
        frames: Frames,
        lookup: str | Lookup,
        jobs: int,
        max_folded: int | None = None,
        max_clamped: int | None = None,
        diagnostics: bool = False,
    ) -> "BakeOptions":
        """Raises UsageError for what cannot be."""
        try:
            choose_lookup(lookup)
        except SliderError as error:
            raise UsageError(str(error)) from error
        return cls(
            prims=[prims] if isinstance(prims, str) else None if prims is None else [str(prim) for prim in prims],
            frames=None if frames is None else checked_frames(frames),
            lookup=Lookup.of(lookup),
            jobs=whole_number("jobs", jobs, 1),
            max_folded=None if max_folded is None else whole_number("max_folded", max_folded, 0),
            max_clamped=None if max_clamped is None else whole_number("max_clamped", max_clamped, 0),
            diagnostics=bool(diagnostics),
        )


def whole_number(name: str, number: int, least: int) -> int:
    try:
        whole = operator.index(number)
    except TypeError as error:
        raise UsageError(f"{name} is {number!r}; it must be a whole number") from error
    if whole < least:
        raise UsageError(f"{name} is {whole}; it must be at least {least}")
    return whole
