"""Every public name says what it is, takes, gives and raises, in Google's sections, which generators of sites read."""

import dataclasses
import inspect
from collections.abc import Iterator
from typing import Any

import griffe
import pytest

import skinslide


def public_objects() -> Iterator[Any]:
    """Public names, and the public methods and properties of those that are classes, but for what pxr gives them."""
    for name in skinslide.__all__:
        found = getattr(skinslide, name)
        yield pytest.param(found, id=name)
        if inspect.isclass(found):
            yield from (pytest.param(method, id=f"{name}.{each}") for each, method in methods(found))


def methods(cls: type) -> Iterator[tuple[str, Any]]:
    for each in cls.__mro__:
        for name, attribute in vars(each).items():
            of_ours = each.__module__.startswith("skinslide") and (not name.startswith("_") or name == "__init__")
            if of_ours and not is_made(each, name) and getattr(cls, name) is not None:
                callable_ = attribute.fget if isinstance(attribute, property) else getattr(cls, name)
                if inspect.isroutine(callable_):
                    yield name, callable_


def is_made(cls: type, name: str) -> bool:
    """Of a dataclass or a named tuple, whose fields are the class's to describe."""
    return name == "__init__" and (dataclasses.is_dataclass(cls) or issubclass(cls, tuple | Exception))


OBJECTS = list(public_objects())


def sections(found: Any) -> dict[str, list[str]]:
    """The names in each section of a docstring."""
    parsed = griffe.Docstring(inspect.getdoc(found) or "").parse("google", warnings=False)
    return {
        each.kind.value: [getattr(item, "name", None) or item.annotation for item in each.value]
        for each in parsed
        if each.kind.value != "text"
    }


@pytest.mark.parametrize("found", OBJECTS)
def test_it_says_what_it_is(found):
    text = inspect.getdoc(found)
    assert text and text.splitlines()[0].endswith((".", ":")), text
    assert "\n" not in text or text.splitlines()[1] == ""


@pytest.mark.parametrize("found", [each for each in OBJECTS if inspect.isroutine(each.values[0])])
def test_it_says_what_it_takes(found):
    stars = {inspect.Parameter.VAR_KEYWORD: "**", inspect.Parameter.VAR_POSITIONAL: "*"}
    parameters = [
        stars.get(each.kind, "") + name
        for name, each in inspect.signature(found).parameters.items()
        if name not in ("self", "cls")
    ]
    said = sections(found)
    assert said.get("parameters", []) == parameters
    if parameters and inspect.signature(found).return_annotation not in ("None", None) and found.__name__ != "__init__":
        assert "returns" in said


def fields(found: type) -> list[str]:
    if dataclasses.is_dataclass(found):
        return [each.name for each in dataclasses.fields(found)]
    return list(getattr(found, "_fields", ()))


@pytest.mark.parametrize("found", [each for each in OBJECTS if fields(each.values[0])])
def test_it_says_what_it_holds(found):
    assert sorted(sections(found).get("attributes", [])) == sorted(fields(found))


@pytest.mark.parametrize("found", OBJECTS)
def test_what_it_raises_is_public(found):
    ours = set(skinslide.__all__) | {"TypeError", "AttributeError"}
    assert set(sections(found).get("raises", [])) <= ours
