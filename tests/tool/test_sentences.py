"""What goes wrong is said in one place: no sentence of an error stands in two files, or twice in one.

A sentence is said of something, and of what it is said may differ: what stands before a colon, or before the first
value that is filled in. What is left is compared by its words, wherever values stand in it; so is what follows a
semicolon.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = [
    path
    for folder in ("core", "plugin")
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in {".c", ".cpp", ".h", ".inc", ".py"}
]
FEWEST_WORDS = 3

C_TOKENS = re.compile(r"""/\*.*?\*/|//[^\n]*|"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'|\w+|\S""", re.DOTALL)
VALUE = re.compile(r"%[-+ #.*\d]*(?:ll|h|z)?[a-zA-Z]|\{[^{}]*\}")


def c_texts(source: str) -> Iterator[str]:
    """Literals, one of those that are joined, with macros of formats between them; but no text of several lines."""
    text, macro = "", ""
    source = re.sub(r"^\s*#include.*", "", source, flags=re.MULTILINE)
    for token in C_TOKENS.findall(source):
        if token.startswith(("//", "/*")):
            continue
        if token[0] == '"':
            text, macro = text + macro + token[1:-1], ""
        elif token.isupper():
            macro = "%s"
        else:
            if text and "\\n" not in text:
                yield text
            text = macro = ""


def python_texts(source: str) -> Iterator[str]:
    """String literals, except docstrings and the help of options."""
    left_out: set[ast.AST] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr):
            left_out.add(node.value)
        elif isinstance(node, ast.keyword) and node.arg == "help":
            left_out.update(ast.walk(node.value))
        elif node in left_out:
            continue
        elif isinstance(node, ast.JoinedStr):
            left_out.update(node.values)
            yield "".join(part.value if isinstance(part, ast.Constant) else "%s" for part in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def sentences(text: str) -> set[str]:
    """What a text says, of whatever it is said; and how it ends, where that says enough by itself."""
    words = re.findall(r"#|[\w'-]+|[:;]", re.sub(r"#[^\w:;]*#", "#", VALUE.sub("#", text)))
    whole = [0, *(i + 1 for i, word in enumerate(words) if word == ":")]
    ends = [words.index("#", begin) for begin in whole if "#" in words[begin:]]
    ends += [i + 1 for i, word in enumerate(words) if word == ";"]
    return {*said(words, whole, FEWEST_WORDS), *said(words, ends, FEWEST_WORDS + 1)}


def said(words: list[str], begins: list[int], fewest: int) -> Iterator[str]:
    for begin in begins:
        text = " ".join(words[begin:]).strip(" #:;")
        if len(re.findall(r"[\w'-]+", text)) >= fewest:
            yield text


def repeated(texts: dict[str, list[str]]) -> dict[str, list[str]]:
    """Sentences that several texts have, and the files that these are in."""
    places = defaultdict(list)
    for file, literals in texts.items():
        for literal in literals:
            for sentence in sentences(literal):
                places[sentence].append(file)
    return {sentence: files for sentence, files in places.items() if len(files) > 1}


def texts_of(path: Path) -> list[str]:
    return list((python_texts if path.suffix == ".py" else c_texts)(path.read_text()))


def test_no_sentence_stands_in_two_places():
    assert repeated({str(path.relative_to(ROOT)): texts_of(path) for path in SOURCES}) == {}


SAID = "face %d has no st (%g, %g) to follow; paint some first"


@pytest.mark.parametrize(
    "again",
    [
        SAID,
        "patch %s: face %lld has no st (%f, %f) to follow; paint some first",
        "corner {corner!r} has no st ({s}, {t}) to follow; paint some first",
        "there is none: face %d has no st (%g) to follow; paint some first",
        "the map is black; paint some of it first",
    ],
)
def test_other_words_before_it_are_seen_through(again):
    texts = {"a.c": [SAID, "%s is empty; paint some of it first"], "b.py": [again]}
    assert repeated(texts) and not repeated({"b.py": [again]})


@pytest.mark.parametrize("again", ["face %d has no uv (%g, %g) to follow", "%s is %g", "face %d has a st that is %g"])
def test_what_is_said_otherwise_is_another_sentence(again):
    assert not repeated({"a.c": [SAID], "b.c": [again]})


def test_literals_are_joined_and_comments_are_none():
    source = """
    #include "a b c.h"
    /* "nothing at all" */ fail(e, BAD, "%s: face %d " // of the mesh
        "has " SS_NAMED " faces", '"', "more");
    """
    assert list(c_texts(source)) == ["%s: face %d has %s faces", "more"]


def test_docstrings_and_help_are_no_sentences():
    source = """
def f(a):
    \'\'\'What it does.\'\'\'
    g(help="what it is")
    return "one " "two" + f"{a} is {a!r} {'three'}"
"""
    assert list(python_texts(source.replace("\\'", "'"))) == ["one two", "%s is %s %s", "three"]
