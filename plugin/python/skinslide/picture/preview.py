"""Pictures of what sliding does to a shot: before and after, side by side; a contact sheet of some, and a page of all.

for each piece of a patch: a series            its triangles, its camera, its chequer
for each time: cameras                         read on the loop's thread
    for each series and view: draw, write titles                on a thread of the pool, on a canvas of its own
        encode                                 on a thread of the encoders, while the next is drawn
    put the pictures in place                  on the loop's thread
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Unpack

from pxr import Sdf, Usd

from skinslide.arrays.canvas import Canvas
from skinslide.arrays.lookup import Lookup, choose_lookup
from skinslide.arrays.native import version
from skinslide.picture.canvases import Canvases
from skinslide.picture.drawing import Budget, DrawnPictures, Easel, MeshPictures
from skinslide.picture.embedded import bytes_of_each
from skinslide.picture.encoders import Encoders
from skinslide.picture.lettering import contact_sheets
from skinslide.picture.page import page
from skinslide.picture.series import targets_of
from skinslide.problems import Problem, StageProblems, UsageError, frame_text
from skinslide.shot.checks import documented
from skinslide.shot.loop import slide
from skinslide.shot.options import Frames, PictureKeywords, PictureOptions, Prims, SlideOptions
from skinslide.shot.plan import PlannedMesh
from skinslide.shot.products import Making, MeshMaking, Shot
from skinslide.shot.report import BakeReport, MeshReport
from skinslide.shot.workers import Progress
from skinslide.stage.given import StageLike, StrPath
from skinslide.write.folder import OutputFolder, check_frames, frame_label
from skinslide.write.inputs import check_not_input
from skinslide.write.place import check_output, given_output
from skinslide.write.replacing import check_writable, replacing, writing

_MOST_PIXELS = 1 << 27  # on canvases at once: each takes some forty bytes


def preview(
    stage: StageLike,
    folder: StrPath | None = None,
    *,
    html: StrPath | None = None,
    prims: Prims = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    **pictures: Unpack[PictureKeywords],
) -> PreviewReport:
    """Draws pictures of every patch into a folder, and a page of them. Each file is written whole or not at all.

    Args:
        stage: The stage, or its path; never written.
        folder: As for `Pictures`.
        html: As for `Pictures`.
        prims: As for `bake_to_file`.
        frames: As for `bake_to_file`.
        lookup: As for `bake_to_file`.
        jobs: As for `bake_to_file`.
        progress: As for `bake_to_file`.
        **pictures: As for `Pictures`.

    Returns:
        What was slid, and the files.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or a file cannot be written.
        StageProblems: The stage cannot be slid, or cannot be drawn.
        FrameProblem: A frame cannot be slid.
    """
    wanted = Pictures(folder, html, **pictures)
    report = slide(Shot.of(stage), SlideOptions.of(prims, frames, lookup, jobs), [wanted], progress)
    return PreviewReport(report.warnings, report.meshes, report.made)


@documented
@dataclass(frozen=True)
class Pictures(PictureOptions):
    """Pictures of every patch, before and after side by side, with a contact sheet, and a page of them.

    Attributes:
        folder: Where the pictures go, made if it is missing; None: they are not kept.
        html: A page of all of them, with curves of what happened at each frame, in one file that loads no other; None:
            none. At least one of folder and html is needed.
    """

    folder: StrPath | None = None
    html: StrPath | None = None

    def begin(self, shot: Shot, options: SlideOptions) -> Making:
        """Begins to draw a shot.

        Args:
            shot: The shot.
            options: What is slid.

        Returns:
            What the loop gives the frames to.

        Raises:
            UsageError: The files cannot be written.
            StageProblems: The stage cannot be drawn.
        """
        if self.folder is None and self.html is None:
            raise UsageError("no folder for pictures (-o) and no page (--html) is asked for")
        folder = None if self.folder is None else OutputFolder(self.folder, shot.stage, shot.path)
        if self.html is not None:
            page_file = given_output("html", self.html)
            check_output(page_file, (".html", ".htm"), made=folder.folder if folder else None)
            check_not_input(page_file, shot.stage, *shot.paths)
            _check_clock(shot.stage)
        return _Previewing(self, shot.stage, options, folder)


@dataclass
class PreviewReport(BakeReport):
    """What was slid for the pictures, and the files.

    Attributes:
        warnings: What reading the stage warned of.
        meshes: One for each mesh.
        made: What was drawn.
        resumed: Never; that is of layers.
    """

    @property
    def device(self) -> str:
        """What the pictures were drawn with."""
        return self._drawn.device

    @property
    def files(self) -> list[str]:
        """The files in the folder, in the order in which they were written."""
        return self._drawn.files

    @property
    def pictures(self) -> int:
        """How many were drawn."""
        return self._drawn.pictures

    @property
    def seconds(self) -> float:
        """How long sliding and drawing took."""
        return self._drawn.seconds

    @property
    def _drawn(self) -> DrawnPictures:
        return next(made for made in self.made if isinstance(made, DrawnPictures))


def _check_clock(stage: Usd.Stage) -> None:
    rate = stage.GetTimeCodesPerSecond()
    if not (math.isfinite(rate) and rate > 0):
        message = f"the stage has {rate:g} time codes per second, at which a page cannot be played"
        raise StageProblems([Problem("error", "", None, None, message)])


def _canvases(options: PictureOptions, lookup: Lookup) -> Canvases:
    width, height = options.size
    pixels = "floats" if options.form == "exr" else "bytes"
    targets = targets_of(options.views)
    return Canvases(lambda: Canvas(width, height, pixels, lookup.device, targets), _most_at_once(options))


def _most_at_once(options: PictureOptions) -> int:
    width, height = options.size
    return max(1, _MOST_PIXELS // (width * height * targets_of(options.views)))


class _Previewing(Making):
    """The pictures of every mesh, and what is made of all of them."""

    def __init__(self, asked: Pictures, stage: Usd.Stage, options: SlideOptions, folder: OutputFolder | None):
        self.patches = asked.patches
        self._stage, self._options, self._folder = stage, options, folder
        self._page = None if asked.html is None else Path(asked.html)
        self._drawn = DrawnPictures()
        canvases = _canvases(asked, options.lookup)  # of a size that can be
        encoders = Encoders(options.jobs, min(options.jobs + 1, _most_at_once(asked)))
        self._easel = Easel(asked, canvases, encoders, folder, self._page, self._drawn, Budget())
        self._meshes: list[MeshPictures] = []

    def of_mesh(self, planned: PlannedMesh, report: MeshReport) -> MeshMaking | None:
        if self._folder:
            check_frames(planned.frames)
        mesh = MeshPictures(planned, report, self._easel)
        if not mesh.picture_count:
            return None
        self._meshes.append(mesh)
        return mesh

    @contextmanager
    def running(self, report: BakeReport) -> Iterator[None]:
        if self._folder:
            pictures = [mesh.files(self._folder) for mesh in self._meshes]
            self._folder.check_all(itertools.chain([self._sheet_path(self._folder, 0)], *pictures))
        if self._page:
            check_writable(self._page)
        with self._easel.canvases.taken() as canvas:
            self._drawn.device = canvas.device.renderer
        report.made.append(self._drawn)
        self._easel.budget.of_each = bytes_of_each(sum(mesh.total for mesh in self._meshes))
        start = time.monotonic()
        with self._easel.encoders.running():
            yield
        self._drawn.seconds = time.monotonic() - start
        self._write_sheets()
        self._write_page(report)

    def _write_sheets(self) -> None:
        if not self._folder:
            return
        for number, sheet in enumerate(contact_sheets([strip for mesh in self._meshes for strip in mesh.thumbnails])):
            path = self._sheet_path(self._folder, number)
            self._folder.write(path, sheet)
            self._drawn.files.append(str(path))

    def _sheet_path(self, folder: OutputFolder, number: int) -> Path:
        """With the frames that were asked for, so that tasks of a farm do not take each other's."""
        asked = self._options.named
        ends = [frame_label(frame) for frame in dict.fromkeys((asked[0], asked[-1]))] if asked else []
        words = ["contact_sheet", *(["-".join(ends)] if ends else []), *([str(number + 1)] if number else [])]
        return folder.folder / ".".join([*words, "png"])

    def _write_page(self, report: BakeReport) -> None:
        if not self._page:
            return
        strips = [strip for mesh in self._meshes for strip in mesh.strips()]
        frames = sorted({frame for strip in strips for frame in strip.patch.frames if frame is not None})
        span = " to ".join(dict.fromkeys(map(frame_text, (frames[0], frames[-1])))) if frames else ""
        root = self._stage.GetRootLayer()
        facts = {
            "stage": Sdf.Layer.SplitIdentifier(root.identifier)[0],
            "frames": f"{len(frames)}, {span}" if frames else "none",
            "skinslide": version(),
            "lookup": choose_lookup(self._options.lookup).lookup,
            "drawn with": self._drawn.device,
        }
        text = page(root.GetDisplayName(), strips, report, facts, self._stage.GetTimeCodesPerSecond())
        with replacing(self._page) as partial, writing(self._page):
            partial.write_text(text, "utf-8")
        self._drawn.files.append(str(self._page))
