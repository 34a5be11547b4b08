"""What commands are asked for, checked before anything is read."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from skinslide.problems import SliderError, UsageError
from skinslide.shot.frames import checked_frames

if TYPE_CHECKING:
    from skinslide.arrays.native import Lookup

Frames = Sequence[float] | str | None

VIEWS = ("chequer", "stretch")
FORMATS = ("png", "exr")
LEAST, MOST = 1e-37, 1e37  # of what is a float in the core


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
    ) -> BakeOptions:
        """Raises UsageError for what cannot be."""
        from skinslide.arrays.native import Lookup
        from skinslide.arrays.slider import choose_lookup

        try:
            choose_lookup(lookup)
        except SliderError as error:
            raise UsageError(str(error)) from error
        return cls(
            prims=listed(prims),
            frames=None if frames is None else checked_frames(frames),
            lookup=Lookup.of(lookup),
            jobs=whole_number("jobs", jobs, 1),
            max_folded=None if max_folded is None else whole_number("max_folded", max_folded, 0),
            max_clamped=None if max_clamped is None else whole_number("max_clamped", max_clamped, 0),
            diagnostics=bool(diagnostics),
        )


@dataclass(frozen=True)
class PictureOptions:
    """What pictures are drawn."""

    patches: list[str] | None
    views: list[str]
    camera: str | None
    follow: bool
    width: int
    height: int
    form: str
    st: str | None
    squares: float | None
    most_stretch: float

    @classmethod
    def checked(
        cls,
        *,
        views: Sequence[str] | str,
        size: tuple[int, int],
        most_stretch: float,
        patches: Sequence[str] | str | None = None,
        camera: str | None = None,
        follow: bool = False,
        form: str = "png",
        st: str | None = None,
        squares: float | None = None,
    ) -> PictureOptions:
        """Raises UsageError for what cannot be."""
        if camera is not None and follow:
            raise UsageError("a camera of the stage does not follow a patch: give one or the other")
        width, height = _pair("size", size)
        return cls(
            patches=listed(patches),
            views=_views(views),
            camera=None if camera is None else str(camera),
            follow=bool(follow),
            width=whole_number("width", width, 2),
            height=whole_number("height", height, 1),
            form=_one_of("format", form, FORMATS),
            st=None if st is None else coordinates_name(st),
            squares=None if squares is None else _positive("squares", squares),
            most_stretch=_positive("most_stretch", most_stretch),
        )


def _pair(name: str, pair: Sequence[int]) -> tuple[int, int]:
    try:
        first, second = pair
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} is {pair!r}; it must be a width and a height") from error
    return first, second


def _views(asked: Sequence[str] | str) -> list[str]:
    views = [_one_of("view", view, VIEWS) for view in dict.fromkeys(listed(asked) or ())]
    if not views:
        raise UsageError(f"views: there are none in it; there are {', '.join(VIEWS)}")
    return views


def listed(words: Sequence[str] | str | None) -> list[str] | None:
    return [words] if isinstance(words, str) else None if words is None else [str(word) for word in words]


def coordinates_name(st: str) -> str:
    if not st:
        raise UsageError("st: the name of the primvar with texture coordinates is empty")
    return st


def whole_number(name: str, number: int, least: int, most: int | None = None) -> int:
    try:
        whole = operator.index(number)
    except TypeError as error:
        raise UsageError(f"{name} is {number!r}; it must be a whole number") from error
    if whole < least:
        raise UsageError(f"{name} is {whole}; it must be at least {least}")
    if most is not None and whole > most:
        raise UsageError(f"{name} is {whole}; it must be at most {most}")
    return whole


def _positive(name: str, number: float) -> float:
    try:
        found = float(number)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} is {number!r}; it must be a number") from error
    if not LEAST <= found <= MOST:
        raise UsageError(f"{name} is {found:g}; it must be above 0, from {LEAST:g} to {MOST:g}")
    return found


def _one_of(name: str, word: str, words: Sequence[str]) -> str:
    if word not in words:
        raise UsageError(f"{name} {word!r} is not one of {', '.join(words)}")
    return word
