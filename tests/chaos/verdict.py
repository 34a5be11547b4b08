"""What must hold of a folder and of what the tool said, however it ended."""

import re
import signal
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

from chaos.shot import Command, snapshot
from chaos.tool import Ended

Files = dict[str, str | bytes]
_LINE = re.compile("(error|warning|note): .+")
_PARTIAL = re.compile(r"\.[^/]+\.[0-9a-f]{8}\.[\w.]+")  # ours, and USD's beside it, of any letters and digits
_CODES = {0, 1, 2, 3, 129, 130, 143}
_AT_ONCE = {-signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT}  # a signal that is not answered any more, or not yet

# It writes where it was given no memory, and is ended by an exception where it was given no thread.
_DEATHS_OF_USD = {-signal.SIGSEGV, -signal.SIGABRT}


def faults(
    command: Command, ended: Ended, folder: Path, before: Files, whole: Files, others: bool = False
) -> Iterator[str]:
    """Sentences of what does not hold. others: USD and Python are hurt too, and may say what they like or end it."""
    after = snapshot(folder)
    at_once = _AT_ONCE | _DEATHS_OF_USD if others else _AT_ONCE
    killed = ended.code in at_once - {-signal.SIGTERM, -signal.SIGINT}
    if ended.code is None:
        yield "hung"
    elif ended.code not in _CODES | at_once:
        yield f"ended with {ended.code}: {ended.err[-300:]!r}"
    for name in sorted(before.keys() | after.keys()):
        yield from _fault_of(name, after.get(name), (before.get(name), whole.get(name)), killed)
    if ended.code == 0:
        yield from (
            f"exit code 0 and no new {name}" for name in _outputs(command, whole) if after.get(name) != whole[name]
        )
    elif ended.code is not None and ended.code > 0 and not others:
        yield from _faults_of_words(ended)
        yield from _lies(command, ended, before, after)


def _outputs(command: Command, files: Files) -> list[str]:
    return [name for name in files if any(fnmatch(name.split("/")[0], pattern) for pattern in command.outputs)]


def _fault_of(name: str, now: str | bytes | None, allowed: tuple, killed: bool) -> Iterator[str]:
    if now is not None and now in allowed:
        return
    if now is None and allowed[0] is None:
        return
    if now is not None and allowed == (None, None):
        if not (killed and _PARTIAL.fullmatch(name.rsplit("/", 1)[-1])):
            yield f"{name} is left behind"
    elif now is None:
        yield f"{name} is gone"
    else:
        yield f"{name} is neither what it was nor whole"


def _faults_of_words(ended: Ended) -> Iterator[str]:
    """Of a run that ended itself: a line for each thing that went wrong."""
    lines = ended.err.splitlines()
    if not lines:
        yield f"ended with {ended.code}, and nothing is said"
    yield from (f"says {line!r}" for line in lines[:3] if not _LINE.fullmatch(line))


def _lies(command: Command, ended: Ended, before: Files, after: Files) -> Iterator[str]:
    """Where it says what became of the output, that is so."""
    changed = [name for name in _outputs(command, after) if after[name] != before.get(name)]
    if "nothing was written" in ended.err and changed:
        yield f"says that nothing was written, but {changed[0]} was"
    if " written" in ended.err and "nothing was" not in ended.err and not changed:
        yield "says that something was written, but nothing was"
    if len(command.outputs) == 1 and "." in command.outputs[0] and ended.code in (1, 2, 3) and changed:
        yield f"exit code {ended.code}, and {changed[0]} is another"
