"""Puts a file in place in one step, or not at all."""

from __future__ import annotations

import fcntl
import glob
import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TypeAlias

from skinslide.problems import StageError, usd_errors, usd_message
from skinslide.write.signals import signals_as_exceptions

_ABANDONED = 24 * 60 * 60  # seconds
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
    partial = output.with_name(partial_name(output))
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


def partial_name(output: Path) -> str:
    """A name under which an output is written, beside it: another each time."""
    return f".{output.stem}.{os.urandom(4).hex()}{output.suffix}"


def check_writable(output: Path) -> None:
    """Raises StageError where no file can be made beside an output, whose folder may be missing still."""
    probe = output.resolve().with_name(partial_name(output))
    if probe.parent.is_dir():
        with writing(output):
            probe.touch(exist_ok=False)
            probe.unlink()


@contextmanager
def writing(output: Path) -> Iterator[None]:
    """Reports whatever fails in the block as the output's fault."""
    faults: tuple[type[BaseException], ...] = (OSError, *usd_errors())
    try:
        yield
    except faults as error:
        reason = str(error.strerror or error) if isinstance(error, OSError) else usd_message(error)
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


def begin_flush(file: str, start: int) -> int:
    """Has the disk begin with what is in a file from a byte on. Returns where that ends: all of it is flushed later."""
    with suppress(OSError), open(file, "rb") as there:
        if hasattr(os, "posix_fadvise"):  # as on Linux, which then writes it, and does not wait
            os.posix_fadvise(there.fileno(), start, 0, os.POSIX_FADV_DONTNEED)
        return os.fstat(there.fileno()).st_size
    return start


def _flush(file: Path) -> None:
    """Flushes a file to the disk: after a loss of power there might else be the new name, but none of the bytes."""
    descriptor = os.open(file, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
