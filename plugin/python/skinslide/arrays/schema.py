"""What SkinSlideAPI has, by the core: the properties that there are to fetch, and words."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

from skinslide._core import ffi, lib
from skinslide.arrays.native import text

SCHEMA = text(lib.skinslide_stage_schema())
# When an input is fetched that is not simply taken at the first time.
STILL: int = lib.SKINSLIDE_STAGE_STILL
DEFAULT_TIME: int = lib.SKINSLIDE_STAGE_DEFAULT_TIME


class Input(NamedTuple):
    """A property to fetch, as in `skinslide_stage_input`."""

    name: str
    prefix: str
    type_name: str
    when: int
    is_primvar: bool
    is_inherited: bool
    fallback: str | None
    pointer: Any
    tokens: tuple[str, ...] = ()  # that it may be; none: it is no choice

    def property(self, patch: str | None = None) -> str:
        """Its name on a prim, for an input of a patch or of none."""
        return f"{self.prefix}{self.name}" if patch is None else f"{self.prefix}{patch}:{self.name}"


@cache
def inputs(group: str) -> tuple[Input, ...]:
    """What there is to fetch of a group, in order: mesh, subdivision, patch, controls, derived, live."""
    number, found = getattr(lib, f"SKINSLIDE_STAGE_{group.upper()}"), list[Input]()
    while each := lib.skinslide_stage_next_input(number, found[-1].pointer if found else ffi.NULL):
        found.append(read_input(each))
    return tuple(found)


def read_input(each: Any) -> Input:
    is_primvar, is_inherited = bool(each.is_primvar), bool(each.is_inherited)
    words = (text(each.name), text(each.prefix), text(each.type_name))
    fallback = text(each.fallback) if each.fallback else None
    tokens = list[str]()
    while each.tokens and each.tokens[len(tokens)]:
        tokens.append(text(each.tokens[len(tokens)]))
    return Input(*words, each.when, is_primvar, is_inherited, fallback, each, tuple(tokens))


def input_of(group: str, name: str) -> Input:
    """The first input of that name."""
    return next(each for each in inputs(group) if each.name == name)


def is_texture(source: Input) -> bool:
    """Whether the values of an input are paths of files."""
    return bool(lib.skinslide_stage_is_texture(source.pointer))


def can_name_patch(name: str) -> bool:
    """Whether a name may be a patch's, as far as the schema goes."""
    return bool(lib.skinslide_stage_can_name_patch(name.encode(errors="replace")))


def phrase(name: str) -> str:
    """Words that the core says too: no_type, no_file, irregular, unreadable."""
    return text(lib.skinslide_stage_phrase(getattr(lib, f"SKINSLIDE_PHRASE_{name.upper()}")))
