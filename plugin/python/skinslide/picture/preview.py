"""Draws what sliding does to a shot: before and after, side by side.

meshes, problems = read the stage              any error: stop here, nothing is written
for each piece of a patch: a series            its triangles, its camera, its chequer
for each mesh, for each time in order, several at once:
    points, controls, cameras at that time     read on this thread
    slide; for each series and view: draw, write titles, encode        on a thread of the pool, on a canvas of its own
    put the pictures in place                  on this thread
a contact sheet of some frames of each series, and a page of all
"""

from __future__ import annotations

import itertools
import math
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from pxr import Sdf, Usd

from skinslide.arrays.canvas import Canvas
from skinslide.arrays.native import Lookup
from skinslide.arrays.slider import choose_lookup, version
from skinslide.picture.canvases import Canvases
from skinslide.picture.drawing import MeshPictures, Picture, Wanted
from skinslide.picture.lettering import contact_sheets
from skinslide.picture.page import page
from skinslide.problems import Problem, StageProblems, UsageError, frame_text
from skinslide.shot.options import VIEWS, BakeOptions, Frames, PictureOptions
from skinslide.shot.plan import Plan
from skinslide.shot.report import BakeReport
from skinslide.shot.workers import Progress, pool_of
from skinslide.stage.opening import open_stage
from skinslide.write.folder import OutputFolder, check_frames, frame_label
from skinslide.write.place import check_not_input, check_output, replacing, signals_as_exceptions, writing

_MOST_PIXELS = 1 << 27  # on canvases at once: each takes some forty bytes


def preview(
    stage: Usd.Stage | str | os.PathLike,
    folder: str | os.PathLike | None = None,
    *,
    html: str | os.PathLike | None = None,
    prims: Sequence[str] | str | None = None,
    patches: Sequence[str] | str | None = None,
    frames: Frames = None,
    views: Sequence[str] | str = VIEWS,
    camera: str | None = None,
    follow: bool = False,
    size: tuple[int, int] = (1920, 1080),
    form: str = "png",
    st: str | None = None,
    squares: float | None = None,
    most_stretch: float = 0.5,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
) -> PreviewReport:
    """Draws pictures of every patch into a folder, which is made where there is none, and a contact sheet.

    html          a page of all of them, with curves of what happened at each frame: one file, which loads no other
    prims, frames, lookup, jobs, progress   as for `bake`
    patches       names of patches; None: all
    views         chequer: on the texture coordinates; stretch: in false colours
    camera        the path of a UsdGeomCamera; None: one that has the patch in sight all through the shot
    follow        frames the patch anew in each frame
    size          width and height of a picture, pixels
    form          png or exr
    st            the primvar for the chequer; None: st, and where a mesh has none, squares in space at rest
    squares       of the chequer, for each unit of st or of length; None: 16 across a patch
    most_stretch  what the highest colour stands for
    Raises UsageError, StageProblems, FrameProblem, StageError. Each picture is written whole or not at all.
    """
    pictures = PictureOptions.checked(
        patches=patches,
        views=views,
        camera=camera,
        follow=follow,
        size=size,
        form=form,
        st=st,
        squares=squares,
        most_stretch=most_stretch,
    )
    options = BakeOptions.checked(prims, frames, lookup, jobs)
    if folder is None and html is None:
        raise UsageError("no folder for pictures (-o) and no page (--html) is asked for")
    opened = stage if isinstance(stage, Usd.Stage) else open_stage(stage)
    place = _Place.of(folder, html, opened, None if opened is stage else stage)
    canvases = _canvases(pictures, options.lookup.device)
    shot = _Shot.of(Plan.read(opened, options), pictures, place)
    with signals_as_exceptions():
        return shot.draw(opened, canvases, progress)


@dataclass
class PreviewReport(BakeReport):
    """What was slid for the pictures, and the files."""

    device: str = ""
    files: list[str] = field(default_factory=list)
    pictures: int = 0
    seconds: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """What `--json` prints, as of a bake, and each file."""
        names = ("device", "files", "pictures", "seconds")
        return {**super().as_dict(), **{name: getattr(self, name) for name in names}}

    def text(self) -> str:
        rate = f"{self.pictures} pictures, {self.pictures / max(self.seconds, 1e-9):.1f} a second"
        return f"{super().text()}\n{rate}, drawn with {self.device}"


def _sheet_name(number: int, asked: Sequence[float] | None) -> str:
    """With the frames that were asked for, so that tasks of a farm do not take each other's."""
    ends = [frame_label(frame) for frame in dict.fromkeys((asked[0], asked[-1]))] if asked else []
    words = ["contact_sheet", *(["-".join(ends)] if ends else []), *([str(number + 1)] if number else [])]
    return ".".join([*words, "png"])


def _canvases(options: PictureOptions, device: int | None) -> Canvases:
    width, height = options.width, options.height
    pixels = "floats" if options.form == "exr" else "bytes"
    return Canvases(lambda: Canvas(width, height, pixels, device), _MOST_PIXELS // (width * height))


class _Place(NamedTuple):
    """Where pictures go."""

    folder: OutputFolder | None
    page: Path | None

    @classmethod
    def of(
        cls,
        folder: str | os.PathLike | None,
        html: str | os.PathLike | None,
        stage: Usd.Stage,
        stage_path: str | os.PathLike | None,
    ) -> _Place:
        """Raises UsageError and StageProblems for what cannot be written."""
        files = None if folder is None else OutputFolder(folder, stage, stage_path)
        page = None if html is None else Path(html)
        if page:
            check_output(page, (".html", ".htm"), made=files and files.folder)
            check_not_input(page, stage, *([] if stage_path is None else [stage_path]))
            _check_clock(stage)
        return cls(files, page)

    @property
    def wanted(self) -> Wanted:
        return Wanted(self.folder is not None, self.page is not None)


def _check_clock(stage: Usd.Stage) -> None:
    rate = stage.GetTimeCodesPerSecond()
    if not (math.isfinite(rate) and rate > 0):
        message = f"the stage has {rate:g} time codes per second, at which a page cannot be played"
        raise StageProblems([Problem("error", "", None, None, message)])


@dataclass(frozen=True)
class _Shot:
    """Every mesh of which pictures are drawn."""

    meshes: list[MeshPictures]
    plan: Plan
    place: _Place

    @classmethod
    def of(cls, plan: Plan, options: PictureOptions, place: _Place) -> _Shot:
        """Raises StageProblems and UsageError for what can be known before a frame is slid."""
        plan.check_patches(options.patches)
        meshes, problems = [], []
        for planned in plan.meshes:
            if place.folder:
                check_frames(planned.frames)
            try:
                meshes.append(MeshPictures(planned, options, place.wanted))
            except StageProblems as bad:
                problems += bad.problems
        if problems:
            raise StageProblems(problems)
        shot = cls([mesh for mesh in meshes if mesh.frame_count], plan, place)
        shot._check_files(options.form)
        return shot

    def _check_files(self, form: str) -> None:
        """Raises UsageError for a file that cannot be written."""
        folder = self.place.folder
        if not folder:
            return
        names = ((mesh.path, words, frame) for mesh in self.meshes for words, frame in mesh.files())
        pictures = (folder.path(path, words, frame, form) for path, words, frame in names)
        folder.check_all(itertools.chain([folder.folder / _sheet_name(0, self.plan.options.frames)], pictures))

    def draw(self, stage: Usd.Stage, canvases: Canvases, progress: Progress | None) -> PreviewReport:
        """Draws every mesh, then what is made of all pictures."""
        warnings = [*self.plan.problems, *(problem for mesh in self.meshes for problem in mesh.problems)]
        report = PreviewReport(warnings)
        with canvases.taken() as canvas:
            report.device = canvas.device.renderer
        jobs, total, start = self.plan.options.jobs, sum(mesh.frame_count for mesh in self.meshes), time.monotonic()
        with pool_of(jobs, total) as pool:
            for mesh in self.meshes:
                report.meshes.append(mesh.report)
                for frame, pictures in mesh.run(canvases, pool, jobs):
                    self._write(mesh, frame, pictures, report)
                    if progress:
                        progress(report.frame_count, total)
        report.seconds = time.monotonic() - start
        self._write_sheets(report)
        self._write_page(stage, report)
        return report

    def _write(self, mesh: MeshPictures, frame: float | None, pictures: list[Picture], report: PreviewReport) -> None:
        report.pictures += mesh.picture_count
        for picture in pictures if self.place.folder else ():
            path = self.place.folder.path(mesh.path, picture.words, frame, picture.form)
            self.place.folder.write(path, picture.data)
            report.files.append(str(path))

    def _write_sheets(self, report: PreviewReport) -> None:
        if not self.place.folder:
            return
        for number, sheet in enumerate(contact_sheets([strip for mesh in self.meshes for strip in mesh.thumbnails])):
            path = self.place.folder.folder / _sheet_name(number, self.plan.options.frames)
            self.place.folder.write(path, sheet)
            report.files.append(str(path))

    def _write_page(self, stage: Usd.Stage, report: PreviewReport) -> None:
        if not self.place.page:
            return
        strips = [strip for mesh in self.meshes for strip in mesh.strips()]
        frames = sorted({frame for strip in strips for frame in strip.patch.frames if frame is not None})
        facts = {
            "stage": Sdf.Layer.SplitIdentifier(stage.GetRootLayer().identifier)[0],
            "frames": f"{len(frames)}, {frame_text(frames[0])} to {frame_text(frames[-1])}" if frames else "none",
            "skinslide": version(),
            "lookup": choose_lookup(self.plan.options.lookup).lookup,
            "drawn with": report.device,
        }
        text = page(stage.GetRootLayer().GetDisplayName(), strips, report, facts, stage.GetTimeCodesPerSecond())
        with replacing(self.place.page) as partial, writing(self.place.page):
            partial.write_text(text, "utf-8")
        report.files.append(str(self.place.page))
