"""What must hold of a folder and of what the tool said, however it ended."""

import re
import signal
from collections.abc import Iterator
from pathlib import Path

from chaos.shot import Command, snapshot
from chaos.tool import Ended

Files = dict[str, str | bytes]
_LINE = re.compile("(error|warning|note): .+")
_PARTIAL = re.compile(r"\.[^/]+\.[0-9a-f]{8}\.[a-z.]+\w*")
_CODES = {0, 1, 2, 3, 129, 130, 143}
_AT_ONCE = {-signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT}  # a signal that is not answered any more, or not yet


def faults(
    command: Command, ended: Ended, folder: Path, before: Files, whole: Files, deaths: tuple[int, ...] = ()
) -> Iterator[str]:
    """Sentences of what does not hold. deaths: signals, below 0, by which what is not ours may end the process."""
    after = snapshot(folder)
    killed = ended.code in {-signal.SIGKILL, *deaths}
    if ended.code is None:
        yield "hung"
    if ended.code is not None and ended.code not in {*_CODES, *_AT_ONCE, *deaths}:
        yield f"ended with {ended.code}: {ended.err[-300:]!r}"
    for name in sorted(before.keys() | after.keys()):
        yield from _fault_of(name, command, after.get(name), (before.get(name), whole.get(name)), killed)
    if ended.code == 0:
        yield from (
            f"exit code 0 and no new {name}" for name in _outputs(command, whole) if after.get(name) != whole[name]
        )
    elif ended.code is not None and ended.code > 0:
        yield from _faults_of_words(ended)
        yield from _lies(command, ended, before, after)


def _outputs(command: Command, files: Files) -> list[str]:
    return [name for name in files if name.split("/")[0] in command.outputs]


def _fault_of(name: str, command: Command, now: str | bytes | None, allowed: tuple, killed: bool) -> Iterator[str]:
    base = name.rsplit("/", 1)[-1]
    if now is not None and now in allowed:
        return
    if now is None and allowed[0] is None:
        return
    if now is not None and allowed == (None, None):
        if not (killed and _PARTIAL.fullmatch(base)):
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
