"""Where files may be written."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from skinslide.arrays.schema import phrase
from skinslide.problems import PATH_TOO_LONG, UsageError
from skinslide.write.replacing import partial_name

if TYPE_CHECKING:
    from skinslide.stage.given import StrPath

_MOST_BYTES = 255  # of a name
_OF_USD = 7  # bytes by which a name is longer that USD writes under before it has the partial file's


def given_output(name: str, given: StrPath) -> Path:
    """The path of an output. Raises UsageError for what is no path."""
    if not isinstance(given, str | os.PathLike):
        raise UsageError(f"{name} is {given!r}; it must be a path")
    if not os.fspath(given):  # Path would take it for the working folder
        raise UsageError(f"{name} is an empty name")
    return Path(given)


def check_output(output: Path, extensions: Sequence[str], made: Path | None = None) -> None:
    """Raises UsageError for an output that cannot be used, before any work is done.

    `made` is a folder that will be made, where it is missing, before the output is written.
    """
    if output.suffix.lower() not in extensions:
        raise UsageError(f"output {output}: the name must end in {', '.join(extensions)}")
    check_place(output, lambda path: _fault(path, made))


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
        return phrase("irregular")
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


def asset_path(path: Path, output: Path) -> str:
    """By which a layer that is written names another file, wherever the two are moved together."""
    relative = os.path.relpath(path.resolve(), output.resolve().parent)
    return relative if relative.startswith("..") else f"./{relative}"
