"""How an option is declared, and the checks of what functions are given and of what stands on a command line."""

from __future__ import annotations

import inspect
import math
import operator
import re
import textwrap
from argparse import ArgumentTypeError
from collections.abc import Callable, Iterable, Sequence
from dataclasses import Field, dataclass, field, fields
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast

from skinslide.problems import SliderError, UsageError, in_place_of, listed, not_one_of
from skinslide.shot.frames import AUTHORED, Chunk, checked_frames

if TYPE_CHECKING:
    from skinslide.arrays.lookup import Lookup
    from skinslide.shot.frames import AskedFrames, FramesLike
    from skinslide.stage.given import PrimLike, PrimsLike

Check = Callable[[str, Any], Any]  # name and value of an option; gives what it holds, or raises UsageError

T = TypeVar("T", bound=type)
F = TypeVar("F", bound=Callable[..., Any])

LEAST, MOST = 1e-37, 1e37  # of what is a float in the core


def option(default: Any, check: Check, flag: str, *, old: str = "", python: str = "", **words: Any) -> Any:
    """A field of Options. flag and words are argparse's; an old flag is understood, but is not in the help.

    What has no flag is for Python alone. python is what docstrings say beside the help.
    """
    known = {"check": check, "flag": flag, "flags": tuple(filter(None, (flag, old))), "words": words, "python": python}
    return field(default=default, metadata=known)


@dataclass(frozen=True)
class Options:
    """Options, which are checked as they are made. Raises UsageError for values that cannot be used."""

    def __post_init__(self) -> None:
        for each in fields(self):
            if "check" in each.metadata:
                try:
                    object.__setattr__(self, each.name, each.metadata["check"](each.name, getattr(self, each.name)))
                except UsageError as error:
                    error.name_option(each.name, each.metadata["flags"])
                    raise

    def _needs_one_of(self, names: Sequence[str]) -> None:
        """Raises UsageError unless one of some options is given, and no other of these."""
        if len([name for name in names if self._is_given(name)]) != 1:
            raise fault(type(self), f"one of {listed([f'{{{name}}}' for name in names])} is needed")

    def _go_with(self, names: Sequence[str], other: str) -> None:
        """Raises UsageError where one of some options is given, but not the other with which they have a meaning."""
        if not self._is_given(other) and any(map(self._is_given, names)):
            verb = "go" if len(names) > 1 else "goes"
            raise fault(type(self), f"{listed([f'{{{name}}}' for name in names])} {verb} with {{{other}}}")

    def _is_given(self, name: str) -> bool:
        value, default = getattr(self, name), self.__dataclass_fields__[name].default
        return value is not default and not (isinstance(value, str) and value == default)


def fault(table: type[Options], template: str) -> UsageError:
    """An error that names options of a table, which are in braces."""
    flags = {each.name: each.metadata["flags"] or (each.name,) for each in fields(table)}
    return UsageError.of_options(template, flags)


def takes(table: type[Options]) -> Callable[[F], F]:
    """Gives a function that takes options as keywords their signature, and a line for each of them in its docstring."""

    def decorate(function: F) -> F:
        signature = inspect.signature(function)
        fixed = [each for each in signature.parameters.values() if each.kind is not inspect.Parameter.VAR_KEYWORD]
        options = [each for each in fields(table) if each.name not in signature.parameters]
        keywords = [
            inspect.Parameter(each.name, inspect.Parameter.KEYWORD_ONLY, default=each.default, annotation=each.type)
            for each in options
        ]
        known = [each.name for each in (*fixed, *keywords)]

        @wraps(function)
        def checked(*arguments: Any, **given: Any) -> Any:
            for name in given:
                if name not in known:
                    raise TypeError(f"{function.__name__}() takes no {name}; {in_place_of(name, known)}")
            return function(*arguments, **given)

        vars(checked)["__signature__"] = signature.replace(parameters=[*fixed, *keywords])
        lines = "\n".join(_argument(each, table) for each in options)
        checked.__doc__ = re.sub(r" +\*\*\w+: .*", lambda _: lines, function.__doc__ or "")
        return cast(F, checked)

    return decorate


def _argument(each: Field[Any], table: type[Options]) -> str:
    """An option in the docstring of a function, which has keywords for flags."""
    keywords = {flag: other.name for other in fields(table) for flag in other.metadata["flags"]}
    choices = each.metadata["words"].get("choices", ())
    more = f"One of {', '.join(choices)}" if choices else each.metadata["python"]
    text = ". ".join(filter(None, [described(each, each.default), more]))
    text = re.sub(r"--[a-z-]+", lambda flag: f"`{keywords[flag[0]]}`", f"{text[0].upper()}{text[1:]}.")
    return textwrap.fill(f"{each.name}: {text}", 120, initial_indent=" " * 8, subsequent_indent=" " * 12)


def described(each: Field[Any], default: Any) -> str:
    """An option in words."""
    return each.metadata["words"]["help"].replace("%(default)s", str(default))


def documented(table: T) -> T:
    """Adds its options to the attributes that a table says it has, which are the last it says of itself."""
    lines = [f"    {each.name}: {described(each, each.default)}" for each in fields(table) if "words" in each.metadata]
    table.__doc__ = "\n".join([inspect.cleandoc(table.__doc__ or ""), *lines])
    return table


# ---- What stands on a command line ----


def words_text(text: str) -> list[str]:
    return text.split(",")


# ---- What a function is given ----


def or_none(check: Check) -> Check:
    return lambda name, value: None if value is None else check(name, value)


def truth(_name: str, value: Any) -> bool:
    return bool(value)


def anything(_name: str, value: Any) -> Any:
    return value


def text(name: str, value: Any) -> str:
    from skinslide.stage.given import given_text

    return given_text(name, value)


def name(what: str) -> Check:
    """Of something on a mesh."""

    def check(name: str, value: Any) -> str:
        from skinslide.stage.given import given_name

        return given_name(what, text(name, value))

    return check


_primvar = name("a primvar")


def names(what: str) -> Check:
    def check(name: str, words: Sequence[str] | str) -> list[str]:
        from skinslide.stage.given import given_name

        return [given_name(what, word) for word in texts(name, words)]

    return check


def path(name: str, given: PrimLike) -> str:
    from skinslide.stage.given import given_path

    return str(given_path(name, given))


def prim(name: str, given: PrimLike) -> str:
    return prims(name, [given])[0]


def prims(name: str, given: PrimsLike) -> list[str]:
    from skinslide.stage.given import given_paths

    return given_paths(name, given)


def texts(name: str, words: Sequence[str] | str) -> list[str]:
    if not isinstance(words, str | Iterable):
        raise UsageError(f"{name} is {words!r}; it must be a text, or several")
    return [words] if isinstance(words, str) else [str(word) for word in words]


def one_of(what: str, words: Sequence[str]) -> Check:
    def check(name: str, word: str) -> str:
        if word not in words:
            raise UsageError(("" if what == name else f"{name}: ") + not_one_of(what, word, words))
        return word

    return check


def some_of(what: str, words: Sequence[str]) -> Check:
    """One or more, each once."""

    def check(name: str, asked: Sequence[str] | str | None) -> list[str]:
        found = [one_of(what, words)(name, word) for word in dict.fromkeys(texts(name, asked or ()))]
        if not found:
            raise UsageError(f"{name}: there are none in it; there are {', '.join(words)}")
        return found

    return check


def whole(least: int, most: int | None = None) -> Check:
    def check(name: str, number: Any) -> int:
        try:
            found = operator.index(number)
        except TypeError as error:
            raise UsageError(f"{name} is {number!r}; it must be a whole number") from error
        if found < least:
            raise UsageError(f"{name} is {found}; it must be at least {least}")
        if most is not None and found > most:
            raise UsageError(f"{name} is {found}; it must be at most {most}")
        return found

    return check


def positive(name: str, number: Any) -> float:
    from skinslide.stage.given import given_number

    found = given_number(name, number)
    if not LEAST <= found <= MOST:
        raise UsageError(f"{name} is {found:g}; it must be above 0, from {LEAST:g} to {MOST:g}")
    return found


def not_negative(name: str, number: Any) -> float:
    from skinslide.stage.given import given_number

    found = given_number(name, number)
    if not 0 <= found <= MOST:
        raise UsageError(f"{name} is {found:g}; it must be 0 or more, to {MOST:g}")
    return found


def finite(name: str, number: Any) -> float:
    from skinslide.stage.given import given_number

    found = given_number(name, number)
    if not math.isfinite(found):
        raise UsageError(f"{name} is {found:g}; it must be finite")
    return found


def weight(name: str, given: Any) -> Any:
    """A number, the name of a primvar, or an array."""
    return _primvar(name, given) if isinstance(given, str) else given


def chunk(_name: str, given: object) -> Chunk:
    return Chunk.parse(given)


def frames(name: str, given: FramesLike) -> AskedFrames:
    return AUTHORED if isinstance(given, str) and given == AUTHORED else named_frames(name, given)


def named_frames(_name: str, given: FramesLike) -> list[float]:
    return checked_frames(given)


def lookup(_name: str, asked: str | Lookup) -> Lookup:
    from skinslide.arrays.lookup import Lookup, choose_lookup

    try:
        choose_lookup(asked)
    except SliderError as error:
        raise UsageError(str(error)) from error
    return Lookup.of(asked)


def picture_size(name: str, pair: Sequence[int]) -> tuple[int, int]:
    try:
        width, height = pair
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} is {pair!r}; it must be a width and a height") from error
    return whole(2)("width", width), whole(1)("height", height)


def map_size(name: str, size: Any) -> int:
    from skinslide.arrays.images import LARGEST_MAP

    return whole(1, LARGEST_MAP)(name, size)


def coordinates(name: str, st: str) -> str:
    if not st:
        raise UsageError(f"{name}: the name of the primvar with texture coordinates is empty")
    return st


# ---- What stands on a command line ----


def count_text(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise ArgumentTypeError(f"{text!r} is not a whole number of 0 or more")
    return int(text)


def positive_text(text: str) -> int:
    if count_text(text) < 1:
        raise ArgumentTypeError("must be at least 1")
    return int(text)


def number_or_name(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def size_text(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,9})[xX](\d{1,9})", text, re.ASCII)
    if not found:
        raise ArgumentTypeError(f"{text!r} is not a size such as 1920x1080")
    return int(found[1]), int(found[2])
