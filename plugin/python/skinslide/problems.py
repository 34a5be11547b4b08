"""What can be wrong, and every exception that says so."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from difflib import SequenceMatcher
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from pxr import Tf

MOST_FRAMES = 10_000_000
_MOST_TOLD = 20  # problems of a severity, with a line each
_MOST_NAMES = 8  # in a sentence
# Said of what several parts look for.
NO_SUCH_PRIM = "there is no such prim"
PATH_TOO_LONG = "its path from the root is too long"
NO_PATCH_NAME = "cannot name a patch; use letters, digits and _, such as elbow_L"
NO_EDGE = "chooses no edge of the patch"


@dataclass(frozen=True)
class Problem:
    """One thing to say about a stage.

    Attributes:
        severity: error, warning or note.
        prim: The path of a prim; empty for the stage as a whole.
        patch: The name of a patch; None: of no patch.
        frame: A stage time; None: of no frame.
        message: What there is to say, in one line.
    """

    severity: str
    prim: str
    patch: str | None
    frame: float | None
    message: str

    def __str__(self) -> str:
        place = [self.prim] if self.prim else []
        if self.patch is not None:
            place.append(f"patch {self.patch}")
        if self.frame is not None:
            place.append(f"frame {frame_text(self.frame)}")
        return one_line(": ".join([self.severity, *place, self.message]))

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)


class StageProblems(Exception):
    """The stage cannot be slid. Raised before anything is written.

    Attributes:
        problems: What is wrong with it, the errors among it.
    """

    def __init__(self, problems: Sequence[Problem]):
        super().__init__("\n".join(map(str, problems)))
        self.problems = list(problems)


class FrameProblem(Exception):
    """One frame cannot be slid.

    Attributes:
        problem: What is wrong with it.
    """

    def __init__(self, problem: Problem):
        super().__init__(str(problem))
        self.problem = problem


class StageError(RuntimeError):
    """A stage cannot be opened, or a file cannot be written."""


class UsageError(ValueError):
    """What the caller asked for cannot be done, whatever the stage holds."""

    _template: str = ""
    _flags: Mapping[str, Sequence[str]] = {}

    @classmethod
    def of_options(cls, template: str, flags: Mapping[str, Sequence[str]]) -> Self:
        """An error that names options.

        Args:
            template: What to say, with the keywords of options in braces.
            flags: By keyword, the flags of an option on a command line, the usual one first.

        Returns:
            The error, of which the message has the keywords.
        """
        error = cls(template.format(**{name: name for name in flags}))
        error._template, error._flags = template, flags
        return error

    def name_option(self, name: str, flags: Sequence[str]) -> None:
        """Says that it is of an option, where its message begins with the keyword.

        Args:
            name: The keyword.
            flags: The flags of the option, such as --max-roughness, the usual one first.
        """
        message = str(self)
        if message.startswith((f"{name} ", f"{name}:")):
            rest = message.removeprefix(name).replace("{", "{{").replace("}", "}}")
            self._template, self._flags = f"{{{name}}}{rest}", {name: flags}

    def on_command_line(self, words: Sequence[str] = ()) -> str:
        """The message as a command says it.

        Args:
            words: Those of the command.

        Returns:
            The same, with flags in place of keywords: those that are among the words.
        """
        if not self._template:
            return str(self)
        typed = {word.partition("=")[0] for word in words}
        shown = {name: next((flag for flag in flags if flag in typed), flags[0]) for name, flags in self._flags.items()}
        return self._template.format(**shown)


class FrameSpecError(UsageError):
    """A frame spec that is none; the message names the part."""


class SliderError(RuntimeError):
    """What the core says, in one line that names patch and element.

    Attributes:
        status: The core's code, such as BAD_PATCH.
    """

    def __init__(self, status: str, message: str):
        super().__init__(message)
        self.status = status


class Fault(Exception):
    """What is wrong with a value, by code that need not know the prim, patch and frame it is read for."""


@contextmanager
def noting(faults: list[str]) -> Iterator[None]:
    """Adds a Fault that the block raises to the faults."""
    try:
        yield
    except Fault as fault:
        faults.append(str(fault))


def one_line(text: str) -> str:
    """Text with escapes for what a terminal would obey: a name may hold ends of lines, or the start of a command."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def not_one_of(what: str, word: object, words: Sequence[str]) -> str:
    return f"{what} {word!r} is not one of {', '.join(words)}"


def in_place_of(name: str, others: Iterable[str]) -> str:
    """What there is where nothing has a name, those that are most like it first."""
    there = sorted(others, key=lambda other: -SequenceMatcher(None, name.lower(), other.lower()).ratio())
    more = [f"{len(there) - _MOST_NAMES} more"] if len(there) > _MOST_NAMES else []
    return f"there {'is' if len(there) == 1 else 'are'} {listed([*there[:_MOST_NAMES], *more]) or 'none'}"


def listed(names: Sequence[str]) -> str:
    """Names in a sentence: a, b and c."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if names[1:] else names)


def lines_text(lines: Iterable[str]) -> str:
    """Lines for a terminal; each stays one."""
    return "\n".join(map(one_line, lines))


def counted(count: int, one: str, many: str | None = None) -> str:
    """A number of things: 1 point, 3 points."""
    return f"{count} {one if count == 1 else many or f'{one}s'}"


def problem_lines(problems: Iterable[Problem]) -> Iterator[str]:
    """A line for each problem; of each severity no more than anyone reads, and how many there are beyond."""
    counts: dict[str, int] = {}
    for problem in problems:
        counts[problem.severity] = counts.get(problem.severity, 0) + 1
        if counts[problem.severity] <= _MOST_TOLD:
            yield str(problem)
    for severity, count in counts.items():
        if count > _MOST_TOLD:
            yield f"{severity}: and {count - _MOST_TOLD} more like these; --json has all"


def errors(problems: Sequence[Problem]) -> list[Problem]:
    return [problem for problem in problems if problem.severity == "error"]


def first_of(problems: Iterable[Problem]) -> Iterator[Problem]:
    """Of problems of one kind, each at a frame, the first, which says at how many more there is one."""
    there = list(problems)
    more = len(there) - 1
    frames = f" (and something like it at {counted(more, 'more frame')})" if more > 0 else ""
    yield from (replace(first, message=first.message + frames) for first in there[:1])


def core_problem(prim: str, patches: Sequence[str], message: str, frame: float | None = None) -> Problem:
    """A message of the core as an error; the patch it starts with becomes the problem's own.

    The core cuts long names, to NAME...
    """
    for patch in sorted(patches, key=len, reverse=True):
        label = re.match(rf"patch (?:{re.escape(patch)}|(.+)\.\.\.)(?: \((piece \d+ of \d+)\))?: ", message)
        if label and (label[1] is None or patch.startswith(label[1])):
            piece = f"{label[2]}: " if label[2] else ""
            return Problem("error", prim, patch, frame, piece + message[label.end() :])
    return Problem("error", prim, None, frame, message)


def usd_errors() -> tuple[type[BaseException], ...]:
    """USD's exception, or nothing if USD is not loaded, so that it is not loaded for this."""
    usd = sys.modules.get("pxr.Tf")
    return (usd.ErrorException,) if usd else ()


def usd_message(error: Tf.ErrorException) -> str:
    """What USD says, in one line. Of several errors the first is the cause."""
    try:
        text = error.args[0].commentary if error.args else str(error)
    except UnicodeDecodeError as undecoded:  # it quotes a file
        text = undecoded.object.decode(errors="backslashreplace")
    return " ".join(text.split()) or "USD failed and does not say why"


def frame_text(frame: float) -> str:
    """1012 for 1012.0 and 1012.25 for 1012.25, without the noise that layer offsets leave; 1e+300 as it stands."""
    frame = round(frame, 6)
    return str(int(frame)) if frame == int(frame) and abs(frame) < 1e15 else str(frame)
