"""Calls of the core: structs with their defaults, handles, tokens of enums, and statuses raised as errors."""

from __future__ import annotations

import operator
import re
import weakref
from collections.abc import Callable
from functools import cache, partial
from typing import TYPE_CHECKING, Any, TypeVar

from skinslide._core import ffi, lib
from skinslide.arrays.records import DeviceInfo, LookupInfo, PatchInfo, PatchResult, Roughness, WeldInfo
from skinslide.problems import SliderError, not_one_of

if TYPE_CHECKING:
    import numpy as np

Record = TypeVar("Record", PatchInfo, PatchResult, DeviceInfo, LookupInfo, WeldInfo, Roughness)


def version() -> str:
    """The library's version, "major.minor.patch"."""
    return text(lib.skinslide_version())


@cache
def degradations() -> tuple[str, ...]:
    """The fields of a PatchResult that say it is less than it should be, in the order of their kinds."""
    found: list[str] = []
    while name := lib.skinslide_degradation(len(found), 0, ffi.NULL):
        found.append(text(name))
    return tuple(found)


def degradation_text(kind: int, count: int) -> str:
    """So many of a kind in words."""
    sentence = ffi.new("skinslide_error *")
    lib.skinslide_degradation(kind, count, sentence)
    return text(sentence.message)


def call(function: Any, *arguments: Any) -> None:
    error = ffi.new("skinslide_error *")
    status = function(*arguments, error)
    if status != lib.SKINSLIDE_OK:
        raise SliderError(text(lib.skinslide_status_name(status)), text(error.message))


def new(struct: str) -> Any:
    """A struct of the headers, with its default values."""
    made = ffi.new(f"skinslide_{struct} *")
    getattr(lib, f"skinslide_{struct}_default")(made)
    return made


def new_array(struct: str, count: int) -> Any:
    made = ffi.new(f"skinslide_{struct}[]", count)
    for i in range(count):
        getattr(lib, f"skinslide_{struct}_default")(made + i)
    return made


class Handle:
    """A handle of the core. It is destroyed once nothing refers to this object, and before the handles that it needs.

    ffi.gc would not do: the collector breaks a cycle wherever it likes, and might destroy first what is needed.
    """

    def __init__(self, pointer: Any, destroy: Callable[[Any], None], *needed: Handle):
        self.pointer = pointer
        # The finalizer, which is part of no cycle, keeps alive what is needed.
        weakref.finalize(self, _destroy, destroy, pointer, needed).atexit = False


def _destroy(destroy: Callable[[Any], None], pointer: Any, _needed: tuple[Handle, ...]) -> None:
    destroy(pointer)


def writable(ctype: str, array: np.ndarray) -> Any:
    return ffi.from_buffer(ctype, array, True)  # by position, which is three times as fast


def tokens(setting: str) -> tuple[str, ...]:
    """The tokens of a setting, such as boundary, rule, lookup, scheme or pixels."""
    return tuple(_values_by_token(setting))


def _values_by_token(setting: str) -> dict[str, int]:
    """The enum of a setting by its stage tokens: SKINSLIDE_INTERPOLATION_MEAN_VALUE is meanValue."""
    names = ffi.typeof(f"skinslide_{setting}").relements
    prefix = f"SKINSLIDE_{setting.removesuffix('_layout').upper()}_"
    words = {name: name.removeprefix(prefix).lower() for name in names}
    by_value = sorted(names, key=names.__getitem__)
    return {re.sub("_([a-z])", lambda match: match[1].upper(), words[name]): names[name] for name in by_value}


def enum_value(setting: str, token: str, where: str) -> int:
    values = _values_by_token(setting)
    if not isinstance(token, str) or token not in values:
        raise SliderError("BAD_ARGUMENT", where + not_one_of(setting, token, tuple(values)))
    return values[token]


def token_of(setting: str, value: int) -> str:
    return next(token for token, number in _values_by_token(setting).items() if number == value)


def read(kind: type[Record], *structs: Any) -> Record:
    """A record of the fields of structs, text and tokens as str."""
    numbers = _numbers(kind._fields, ffi.typeof(structs[0]))
    if numbers is not None:
        return kind._make(numbers(structs[0]))  # the fast way, such as for each patch's in each frame
    values: dict[str, Any] = {}
    for struct in structs:
        names, get, meanings = _fields(kind._fields, ffi.typeof(struct))
        values.update(zip(names, get(struct), strict=True))
        for name, meaning in meanings.items():
            values[name] = meaning(values[name])
    return kind(*[values[name] for name in kind._fields])


@cache
def _numbers(wanted: tuple[str, ...], struct: Any) -> Callable[[Any], tuple[Any, ...]] | None:
    """A getter of all fields that are wanted, where a type has them and they are numbers."""
    names, get, meanings = _fields(wanted, struct)
    return get if names == wanted and not meanings else None


@cache
def _fields(
    wanted: tuple[str, ...], struct: Any
) -> tuple[tuple[str, ...], Callable[[Any], tuple[Any, ...]], dict[str, Callable[[Any], str]]]:
    """Which of the wanted fields a type has, a getter of them all, and converters of those that are not numbers."""
    types = {name: field_.type for name, field_ in struct.fields}
    names, meanings = tuple(name for name in wanted if name in types), dict[str, Callable[[Any], str]]()
    for name in names:
        if types[name].kind == "enum":
            meanings[name] = partial(token_of, types[name].cname.removeprefix("enum skinslide_"))
        elif types[name].kind != "primitive":
            meanings[name] = text
    return names, operator.attrgetter(*names), meanings


def text(characters: Any) -> str:
    return ffi.string(characters).decode(errors="replace")
