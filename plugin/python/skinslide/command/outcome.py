"""How a command ends: what it prints and its exit code, whatever happens to it, to its output, or to its streams."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any, TextIO

from skinslide.problems import (
    FrameProblem,
    Problem,
    StageError,
    StageProblems,
    UsageError,
    one_line,
    problem_lines,
    usd_errors,
    usd_message,
)

DONE, FAILED, USAGE, PROBLEMS = 0, 1, 2, 3
INTERRUPTED = 130
EXIT_CODES = (
    "exit codes: 0 done, 1 failed, 2 the arguments cannot be used, 3 the stage has problems, 130 interrupted, "
    "143 terminated, 129 hung up"
)
_EXPECTED = (
    StageProblems,
    FrameProblem,
    UsageError,
    StageError,
    OSError,
    UnicodeDecodeError,
    MemoryError,
    KeyboardInterrupt,
    SystemExit,
)


def expected() -> tuple[type[BaseException], ...]:
    """What a command may raise; anything else is a defect, and ends in a traceback."""
    return _EXPECTED + usd_errors()


def prepare_streams() -> None:
    """Makes printing safe for names that the terminal's encoding lacks, and if a stream was closed."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            # Else the next file opened takes this number, and whatever is printed goes into it.
            null = os.open(os.devnull, os.O_RDWR)
            if null != number:
                os.dup2(null, number)
                os.close(null)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115 (open for as long as the process)
        if hasattr(getattr(sys, name), "reconfigure"):
            getattr(sys, name).reconfigure(errors="backslashreplace")


def print_error(line: str) -> None:
    """Prints a line to stderr, if that is possible."""
    with suppress(OSError):
        _print(one_line(line), sys.stderr)


def print_result(text: str | Iterator[str], code: int) -> int:
    """Prints what a command was asked for, or its pieces. Returns the exit code: failed if it cannot be printed."""
    if not text:
        return code
    try:
        _print(text, sys.stdout)
        return code
    except BrokenPipeError:  # whoever read us has left
        return FAILED
    except OSError as error:
        print_error(f"error: the report cannot be printed: {error.strerror}")
        return FAILED


def as_json(value: Any, margin: str = "\n") -> Iterator[str]:
    """A document in pieces; lists may be iterators. Numbers that are not finite, which JSON lacks, become null."""
    inner, before = margin + "  ", "{"
    if isinstance(value, dict) and value:
        for name, each in value.items():
            yield f"{before}{inner}{json.dumps(name)}: "
            yield from as_json(each, inner)
            before = ","
        yield f"{margin}}}"
    elif isinstance(value, list | tuple | Iterator):
        before = "["
        for each in value:
            yield before + inner
            yield from as_json(each, inner)
            before = ","
        yield "[]" if before == "[" else f"{margin}]"
    else:
        yield "null" if isinstance(value, float) and not math.isfinite(value) else json.dumps(value)


def failed(error: BaseException, json: bool, done: str = "", words: Sequence[str] = ()) -> int:
    """Says why nothing came of a command: on stderr, and with json as a document on stdout too. Gives the exit code.

    done   what became of the output, for where that is in question
    words  those of the command
    """
    code, problems = _verdict(error, done, words)
    for line in problem_lines(problems):
        print_error(line)
    if json:
        print_result(as_json({"problems": [problem.as_dict() for problem in problems]}), code)
    return code


def _verdict(error: BaseException, done: str, words: Sequence[str]) -> tuple[int, Sequence[Problem]]:
    if isinstance(error, usd_errors()):
        return FAILED, [_plain(f"USD: {usd_message(error)}")]
    match error:
        case StageProblems():
            return PROBLEMS, error.problems
        case FrameProblem():
            return FAILED, [error.problem]
        case KeyboardInterrupt():
            return INTERRUPTED, [_plain(f"interrupted{done}")]
        case SystemExit():
            return int(error.code or FAILED), [_plain(f"ended by a signal{done}")]
        case MemoryError():
            return FAILED, [_plain(_out_of_memory())]
        case UnicodeDecodeError():  # of USD's: its strings are decoded as they are read
            return FAILED, [_plain(f"the stage holds text that is not UTF-8: {error.object[:200]!r}")]
        case UsageError():
            return USAGE, [_plain(error.on_command_line(words))]
        case _:
            return FAILED, [_plain(str(error))]


def _out_of_memory() -> str:
    from skinslide._core import ffi, lib

    text: bytes = ffi.string(lib.skinslide_status_text(lib.SKINSLIDE_OUT_OF_MEMORY))
    return text.decode()


def _plain(message: str) -> Problem:
    return Problem("error", "", None, None, message)


def _print(text: str | Iterator[str], stream: TextIO) -> None:
    try:
        stream.writelines([text] if isinstance(text, str) else text)
        print(file=stream, flush=True)
    except OSError:
        # What is left in the buffer would fail once more when Python closes the stream.
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        raise
