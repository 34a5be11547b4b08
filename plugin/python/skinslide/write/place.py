"""Where files may be written, and how one is put in place in one step or not at all."""

from __future__ import annotations

import errno
import fcntl
import glob
import os
import re
import secrets
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from pxr import Tf, Usd

from skinslide.arrays.schema import say
from skinslide.problems import PATH_TOO_LONG, StageError, UsageError, usd_message
from skinslide.stage.given import StrPath
from skinslide.stage.seldom import usd_utils

if TYPE_CHECKING:
    from pxr import UsdUtils

_ABANDONED = 24 * 60 * 60  # seconds
_MOST_BYTES = 255  # of a name
_OF_USD = 7  # bytes by which a name is longer that USD writes under before it has the partial file's


def check_output(output: Path, extensions: Sequence[str], made: Path | None = None) -> None:
    """Raises UsageError for an output that cannot be used, before any work is done.

    `made` is a folder that will be made, where it is missing, before the output is written.
    """
    if output.suffix.lower() not in extensions:
        raise UsageError(f"output {output}: the name must end in {', '.join(extensions)}")
    check_place(output, lambda path: _fault(path, made))


def given_output(name: str, given: StrPath) -> Path:
    """The path of an output. Raises UsageError for what is no path."""
    if not isinstance(given, str | os.PathLike):
        raise UsageError(f"{name} is {given!r}; it must be a path")
    if not os.fspath(given):  # Path would take it for the working folder
        raise UsageError(f"{name} is an empty name")
    return Path(given)


def check_place(output: Path, find_fault: Callable[[Path], str | None]) -> None:
    """Raises UsageError where something is wrong with an output: with what it says, or with being looked at."""
    try:
        fault = find_fault(output)
    except (OSError, RuntimeError, ValueError) as error:  # a name too long, links in a circle, a null character
        fault = getattr(error, "strerror", None) or str(error)
        if isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG and not _has_long_name(output):
            fault = PATH_TOO_LONG
    if fault:
        raise UsageError(f"output {output}: {fault}")


def _has_long_name(output: Path) -> bool:
    return any(len(os.fsencode(part)) > _MOST_BYTES for part in output.parts)


def _fault(output: Path, made: Path | None) -> str | None:
    """Why a file cannot be put at the output."""
    target = output.resolve()  # what a link leads to is what is replaced
    folder = target.parent
    if made and folder == made.resolve():
        folder = nearest_folder(folder)
    if target.suffix.lower() != output.suffix.lower():
        return f"is a link to {target}, whose name says that it is in another format"
    if not folder.is_dir():
        return f"the folder {folder} does not exist"
    if target.is_dir():
        return "is a folder"
    if target.exists() and not target.is_file():
        return say("irregular")
    if len(os.fsencode(partial_name(target))) + _OF_USD > os.pathconf(folder, "PC_NAME_MAX"):  # on Linux 255
        return "the name is too long"
    if not os.access(folder, os.W_OK | os.X_OK) or (target.exists() and not os.access(target, os.W_OK)):
        return not_writable()
    return None


def not_writable(what: str = "") -> str:
    """Of the output, or of what is named instead."""
    return f"{what} is not writable".lstrip()


def nearest_folder(folder: Path) -> Path:
    """The folder itself, or the nearest above it that is there; else what is there in its place."""
    nearest = folder.resolve()
    while not nearest.exists():
        nearest = nearest.parent
    return nearest


def partial_name(output: Path, token: str = 8 * "0") -> str:
    """The name under which an output is written, beside it."""
    return f".{output.stem}.{token}{output.suffix}"


def check_not_input(output: Path, stage: Usd.Stage, *others: StrPath) -> None:
    """Raises UsageError where the output is a file that the stage may read, in whatever variant and clip."""
    if output.exists():
        Inputs(stage, *others).refuse(output)


def check_not_read(output: Path, stage: Usd.Stage) -> None:
    """Raises UsageError where the output is a file that the stage has read so far."""
    _refuse(output, _read_so_far(stage))


class Inputs:
    """The files that a stage may read, in whatever variant and clip."""

    def __init__(self, stage: Usd.Stage, *others: StrPath):
        self._stage = stage
        self._known = _identities([*(os.fspath(other) for other in others), *_dependencies(stage)])

    def refuse(self, output: Path) -> None:
        """Raises UsageError where the output is one of them, or one that the stage has read so far."""
        _refuse(output, self._known | _read_so_far(self._stage))


def _read_so_far(stage: Usd.Stage) -> set[tuple[int, int]]:
    return _identities([layer.realPath for layer in stage.GetUsedLayers()])


def _refuse(output: Path, files: set[tuple[int, int]]) -> None:
    if files & _identities([str(output)]):
        raise UsageError(f"output {output}: the stage reads this file; name another, or open the stage without it")


def _identities(files: Sequence[str]) -> set[tuple[int, int]]:
    """Of those that are there: whatever they are called, and through links. What cannot be looked at cannot be read."""
    found = set()
    for file in files:
        with suppress(OSError, ValueError):
            status = os.stat(file)
            found.add((status.st_dev, status.st_ino))
    return found


def _dependencies(stage: Usd.Stage) -> list[str]:
    """Every file that the layers of a stage name, and those that these name in turn."""
    found, utils = list[str](), usd_utils()

    def collect(layer: Any, named: UsdUtils.DependencyInfo) -> UsdUtils.DependencyInfo:
        clips = "#" in named.assetPath and named.dependencies
        files = _clips(named) if clips else [named.assetPath, *named.dependencies]
        found.extend(layer.ComputeAbsolutePath(file) for file in files if file)
        return utils.DependencyInfo() if clips else named  # USD would look for a file of the template's name

    unsaid = utils.CoalescingDiagnosticDelegate()  # while it lives, USD's warnings of missing textures
    with suppress(Tf.ErrorException):  # what does not open is a problem of the stage, told where it matters
        utils.ComputeAllDependencies(stage.GetRootLayer().identifier, collect)
    unsaid.TakeUncoalescedDiagnostics()
    return found


def _clips(template: UsdUtils.DependencyInfo) -> list[str]:
    """The files that a template of value clips stands for; USD gives those with anything in place of the number."""
    wanted = re.compile("-?[0-9]+".join(map(re.escape, re.split("#+", template.assetPath))))
    return [file for file in template.dependencies if wanted.fullmatch(file)]


def asset_path(path: Path, output: Path) -> str:
    """By which a layer that is written names another file, wherever the two are moved together."""
    relative = os.path.relpath(path.resolve(), output.resolve().parent)
    return relative if relative.startswith("..") else f"./{relative}"


State: TypeAlias = tuple[int, ...] | None


def state(file: Path) -> State:
    """What changes when a file is replaced; None where there is none."""
    try:
        status = os.stat(file)
    except FileNotFoundError:
        return None
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns


class Changed(Exception):
    """An output is not what it was when it was read."""


@contextmanager
def replacing(output: Path, if_still: Callable[[], bool] = lambda: True) -> Iterator[Path]:
    """A new file that becomes `output` when the block ends. An exception or a signal leaves `output` as it was.

    if_still  asked last; where it says no, Changed is raised. Nothing else of ours is put in the folder meanwhile
    """
    output = output.resolve()
    partial = output.with_name(partial_name(output, secrets.token_hex(4)))
    with signals_as_exceptions():
        try:
            with writing(output):
                _remove_abandoned(output)
                partial.touch(exist_ok=False)
                if output.exists():
                    shutil.copymode(output, partial)
            yield partial
            with writing(output):
                _flush(partial)
                with _locked(output.parent):
                    if not if_still():
                        raise Changed
                    os.replace(partial, output)
        finally:
            for left in partial.parent.glob(f"{glob.escape(partial.stem)}.*"):  # also what USD writes beside it
                left.unlink(missing_ok=True)


def check_writable(output: Path) -> None:
    """Raises StageError where no file can be made beside an output, whose folder may be missing still."""
    probe = output.resolve().with_name(partial_name(output, secrets.token_hex(4)))
    if probe.parent.is_dir():
        with writing(output):
            probe.touch(exist_ok=False)
            probe.unlink()


@contextmanager
def writing(output: Path) -> Iterator[None]:
    """Reports whatever fails in the block as the output's fault."""
    try:
        yield
    except (OSError, Tf.ErrorException) as error:
        reason = usd_message(error) if isinstance(error, Tf.ErrorException) else str(error.strerror or error)
        target = output.resolve()
        raise StageError(f"output {output}: {re.sub(_partial_names(target), lambda _: target.name, reason)}") from error


def _partial_names(output: Path) -> str:
    """A pattern of the names under which an output is written, by us or by USD."""
    # USD writes beside a file: six letters and digits after its name, or in place of its suffix; never a mere word.
    suffixes = re.escape(output.suffix) + r"(\.\w+)?|\.(?![a-z]{6}$)[A-Za-z0-9]{6}"
    return re.escape(f".{output.stem}.") + f"[0-9a-f]{{8}}({suffixes})"


def saved(written: bool) -> None:
    """Raises OSError where USD has not written a layer, of which it says no more."""
    if not written:
        raise OSError("USD could not save it")


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Locks the folder for a moment, if it can be locked."""
    with ExitStack() as unlocking:
        with suppress(OSError):  # not every file system can, and not every folder may be opened
            descriptor = os.open(folder, os.O_RDONLY)
            unlocking.callback(os.close, descriptor)
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield


def _remove_abandoned(output: Path) -> None:
    """Removes what earlier writers of this output left when they were killed, a day ago or more."""
    ours = re.compile(_partial_names(output))
    for other in output.parent.glob(f".{glob.escape(output.stem)}.*"):
        with suppress(OSError):
            if ours.fullmatch(other.name) and other.is_file() and time.time() - other.stat().st_mtime > _ABANDONED:
                other.unlink()


def _flush(file: Path) -> None:
    """Flushes a file to the disk: after a loss of power there might else be the new name, but none of the bytes."""
    descriptor = os.open(file, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def signals_as_exceptions() -> Iterator[None]:
    """Lets `finally` run when the farm ends the process: SIGTERM and SIGHUP become SystemExit."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _frame: Any) -> None:
        raise SystemExit(128 + number)

    numbers = [number for number in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(number) is signal.SIG_DFL]
    for number in numbers:
        signal.signal(number, leave)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, signal.SIG_DFL)
