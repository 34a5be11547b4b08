"""The public headers as a manual: set alike, so that they can be read and generated from. And the width of all C."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

import pytest

from repository import ROOT

HEADERS = sorted((ROOT / "core" / "include" / "skinslide").glob("*.h"))
WIDTH = 128
# In a comment above a function: names of parameters, two spaces, which way they go, and what they are.
PARAMETER = re.compile(r"(\w+(?:, \w+)*)  +(?:in, out|in|out)(?:[ ,].*)?")


class Function(NamedTuple):
    """A declaration and the comment right above it."""

    name: str
    parameters: list[str]
    comment: str | None


def functions(text: str) -> Iterator[Function]:
    for found in re.finditer(r"SKINSLIDE_API [^;(]*?(\w+)\(([^;]*)\);", text):
        above = re.search(r"/\*((?:(?!\*/).)*)\*/\n$", text[: found.start()], re.DOTALL)
        parameters = [re.sub(r"\[\d*\]$", "", each).split()[-1].lstrip("*") for each in found[2].split(",")]
        yield Function(found[1], parameters, above and above[1])


@pytest.fixture(params=HEADERS, ids=lambda path: path.name)
def text(request) -> str:
    return request.param.read_text()


def test_lines_fit():
    """Of all C and C++ but what is generated; the formatter leaves comments as they are."""
    sources = [path for folder in ("core", "plugin", "tests") for path in (ROOT / folder).rglob("*.*")]
    sources = [path for path in sources if path.suffix in (".c", ".h", ".cpp", ".inc") and path.name != "schema.inc"]
    assert len(sources) > 200
    lines = [(path.name, line) for path in sources for line in path.read_text().splitlines()]
    assert [found for found in lines if len(found[1]) > WIDTH] == []


def test_every_function_has_its_own_comment(text):
    assert [each.name for each in functions(text) if each.comment is None] == []


def test_parameters_are_set_alike(text):
    """Three spaces, a name of the function's, two or more, the way it goes."""
    bad = []
    for function in functions(text):
        for line in (function.comment or "").splitlines()[1:]:
            said = line.removeprefix(" *   ")
            if said == line or said.startswith(" "):
                continue  # prose, or more of a parameter
            found = PARAMETER.fullmatch(said)
            if not found or not set(found[1].split(", ")) <= set(function.parameters):
                bad.append(f"{function.name}: {said}")
    assert bad == []


def test_members_are_not_torn(text):
    """Type and name stand in one line."""
    bodies = re.findall(r"typedef (?:struct|enum) \w+ \{\n(.*?)\n\}", text, re.DOTALL)
    code = [line for body in bodies for line in re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL).splitlines()]
    assert [line for line in code if line.strip() and not re.fullmatch(r"    [\w\s*,=\[\]]+\S[;,]?\s*", line)] == []
    assert [
        line for line in code if re.fullmatch(r"    (?:const )?\w+_t|    (?:const )?(?:float|double|char)", line)
    ] == []


def test_defaults_set_the_size(text):
    """And have a value for every member."""
    for name, body in re.findall(r"typedef struct (\w+) \{\n    size_t size;.*?\n(.*?)\n\} \1;", text, re.DOTALL):
        members = re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL)
        count = 1 + sum(1 + each.count(",") for each in members.split(";") if each.strip())
        (values,) = re.findall(rf"#define {name.upper()}_DEFAULT[\s\\]*\{{(.*?)\}}", text, re.DOTALL)
        given = [each.strip(" \\\n") for each in values.split(",")]
        assert given[0] == f"sizeof({name})" and len(given) == count
        assert re.search(rf"Start[\s*]+from[\s*]+{name.upper()}_DEFAULT", text)
