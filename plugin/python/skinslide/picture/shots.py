"""One page of many shots, from the records that bakes and previews print with `--json`.

for each .json below a folder: what it says of its patches, and the page beside it
    a row a patch, the shots with most stretch left first
the page: every row, every problem, and the frames to look at
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from skinslide.picture.rendering import render
from skinslide.problems import Problem, UsageError, counted, lines_text, problem_lines
from skinslide.shot.report import RECORD, far_apart, roughness_text, stretch_text, time_text
from skinslide.write.place import check_output, given_output
from skinslide.write.replacing import replacing, writing

if TYPE_CHECKING:
    from skinslide.stage.given import StrPath

_PAGE = "shots.html"


@dataclass(frozen=True)
class ShotPatch:
    """A patch of a shot.

    Attributes:
        prim: The path of its mesh.
        label: Its name, with its piece where it has several.
        frames: How many were slid.
        worst: The frame at which the cache has most stretch; None is the default time.
        before: Stretch there.
        after: And slid.
        roughness: How many times as roughly as its cache it moves; None of fewer than three frames, or some that are
            more than one apart.
        folded: The most faces turned over at a frame.
    """

    prim: str
    label: str
    frames: int
    worst: float | None
    before: float
    after: float
    roughness: float | None
    folded: int

    @property
    def change(self) -> float | None:
        """Of stretch by sliding, as a share of the cache's; None where there is none."""
        return self.after / self.before - 1 if self.before > 0 else None


@dataclass(frozen=True)
class ShotRecord:
    """A shot, as a record has it.

    Attributes:
        file: The record, from the folder on.
        stage: The stage that was slid, as it was named.
        page: The page of its pictures beside it, from the folder on; empty: there is none.
        patches: Those that were slid.
        problems: Warnings and notes of it, errors of one that failed.
    """

    file: str
    stage: str
    page: str
    patches: list[ShotPatch]
    problems: list[Problem]

    @property
    def left(self) -> float:
        """The most stretch that is left of any patch at its worst frame."""
        return max((patch.after for patch in self.patches), default=0.0)


@dataclass(frozen=True)
class ShotsReport:
    """Many shots, those with most stretch left first.

    Attributes:
        page: The page that was written.
        shots: What is on it.
        left_out: A warning of each file that should be a record, and cannot be read as one.
    """

    page: str
    shots: list[ShotRecord]
    left_out: list[Problem]

    @property
    def problems(self) -> list[Problem]:
        """The problems of every shot, and what was left out."""
        return [*self.left_out, *(problem for shot in self.shots for problem in shot.problems)]

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        shots = [
            {
                "file": shot.file,
                "stage": shot.stage,
                "page": shot.page,
                "patches": [vars(patch) for patch in shot.patches],
                "problems": [problem.as_dict() for problem in shot.problems],
            }
            for shot in self.shots
        ]
        return {"page": self.page, "shots": shots, "left_out": [problem.as_dict() for problem in self.left_out]}

    def text(self) -> str:
        """A line for each shot, and for what is left out."""
        return lines_text([*map(_line, self.shots), *problem_lines(self.left_out)])


def report(folder: StrPath, output: StrPath | None = None) -> ShotsReport:
    """Writes one page of all shots whose records are in a folder or below it.

    Args:
        folder: The folder. Records are what `--json` printed, in files of any name that end in .json. A page of
            pictures beside a record, of the same name or called report.html, is linked to.
        output: The page, .html; None: shots.html in the folder.

    Returns:
        What is on the page.

    Raises:
        UsageError: There is no such folder, it has no records, or the output cannot be used.
        StageError: The page cannot be written.
    """
    top = given_output("folder", folder)
    if not top.is_dir():
        raise UsageError(f"{top} is not a folder of records")
    page = top / _PAGE if output is None else given_output("output", output)
    check_output(page, (".html", ".htm"))
    left_out: list[Problem] = []
    shots = sorted(_records(top, page, left_out), key=lambda shot: (-shot.left, shot.file))
    if not shots:
        raise UsageError(f"{top}: there is no record in it or below, such as bake --json prints{_instead(left_out)}")
    patches = counted(sum(len(shot.patches) for shot in shots), "patch", "patches")
    text = render(
        "shots.html",
        shots=shots,
        left_out=left_out,
        title=top.resolve().name or str(top),
        counts=f"{counted(len(shots), 'shot')}, {patches}",
        worst_first=_worst_first,
    )
    with replacing(page) as partial, writing(page):
        partial.write_text(text, "utf-8")
    return ShotsReport(str(page), shots, left_out)


def _instead(left_out: Sequence[Problem]) -> str:
    """What there is in place of records."""
    more = f", and {counted(len(left_out) - 1, 'more file')} too" if left_out[1:] else ""
    return f"; {left_out[0].message}{more}" if left_out else ""


def _line(shot: ShotRecord) -> str:
    worst = max(shot.patches, key=lambda patch: patch.after, default=None)
    problems = counted(len(shot.problems), "problem")
    if worst is None:
        return f"{shot.file}: {shot.stage}: no patches, {problems}"
    stretch = f"stretch {stretch_text(worst.before)}, slid {stretch_text(worst.after)}"
    where = f"{worst.label} at frame {time_text(worst.worst)}"
    return f"{shot.file}: {shot.stage}: {stretch}, {where}, rough {roughness_text(worst.roughness)}, {problems}"


# ---- Records ----


def _records(top: Path, page: Path, left_out: list[Problem]) -> Iterator[ShotRecord]:
    """The files in a folder that are records of this version, or hold only the problems of a command that failed.

    What is not complete JSON may be the record of a bake that still runs or found the disk full: it is reported.
    """
    for file in sorted(top.rglob("*.json")):
        try:
            found = json.loads(_text(file))
            if isinstance(found, dict) and ("record" in found or found.keys() == {"problems"}):
                yield _record({"record": RECORD, "meshes": [], **found}, file, top, page)
        except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
            message = f"{file.relative_to(top)} is left out: {_why(error)}"
            left_out.append(Problem("warning", "", None, None, message))


class _OtherVersion(ValueError):
    """A record of which this version does not know what it means."""


def _why(error: Exception) -> str:
    match error:
        case OSError():
            return f"it cannot be read: {error.strerror}"
        case UnicodeDecodeError():
            return "it holds text that is not UTF-8"
        case json.JSONDecodeError():
            return f"it is not complete JSON, by line {error.lineno}: {error.msg}"
        case _OtherVersion():
            return str(error)
        case LookupError():
            return f"it is not a record, as it lacks {error}"
        case _:
            return "it is not a record, as something in it is of another type"


def _text(file: Path) -> str:
    if not file.is_file():  # a pipe would be waited for
        raise OSError(errno.EINVAL, "it is not a file")
    return file.read_text("utf-8")


def _record(found: dict[str, Any], file: Path, top: Path, page: Path) -> ShotRecord:
    if found["record"] != RECORD:
        raise _OtherVersion(f"it is of version {found['record']!r}, and version {RECORD} is read here")
    pages = (path for path in (file.with_suffix(".html"), file.with_name("report.html")) if path.is_file())
    beside = next((each for each in pages if each.resolve() != page.resolve()), None)
    address = quote(Path(os.path.relpath(beside, page.absolute().parent)).as_posix()) if beside else ""
    patches = [_patch(mesh["prim"], patch) for mesh in found["meshes"] for patch in mesh["patches"] if patch["frames"]]
    problems = [Problem(**problem) for problem in found["problems"]]
    return ShotRecord(str(file.relative_to(top)), str(found.get("stage", "")), address, patches, problems)


def _patch(prim: str, patch: dict[str, Any]) -> ShotPatch:
    pieces = patch["piece_count"]
    label = patch["name"] if pieces == 1 else f"{patch['name']} ({patch['piece'] + 1} of {pieces})"
    before, after = (patch[f"worst_frame_stretch_{when}"] or 0.0 for when in ("before", "after"))
    folded = patch["max"]["folded_faces"]
    roughness = None if far_apart(frame["frame"] for frame in patch["frames"]) else patch["roughness"]
    return ShotPatch(prim, label, len(patch["frames"]), patch["worst_frame"], before, after, roughness, folded)


def _worst_first(patches: Sequence[ShotPatch]) -> list[ShotPatch]:
    """The patches with most stretch left first."""
    return sorted(patches, key=lambda patch: -patch.after)
