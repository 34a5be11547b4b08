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

import os
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image
from pxr import Usd

from skinslide import panels
from skinslide.files import (
    check_folder,
    check_not_input,
    check_output,
    frame_suffix,
    replacing,
    unique_names,
    writing,
)
from skinslide.frames import UsageError
from skinslide.meshes import SlidMesh, read_meshes
from skinslide.options import VIEWS, Frames, PictureOptions, SlideOptions
from skinslide.page import Strip, compressed, page
from skinslide.pictures import Canvas
from skinslide.problems import Fault, Problem, StageError, StageProblems, errors, frame_text
from skinslide.progress import Progress
from skinslide.report import BakeReport, MeshReport
from skinslide.series import Column, Series
from skinslide.settings import settings_of
from skinslide.slider import Lookup, PatchResult, Slider, SliderError, choose_lookup, version
from skinslide.solving import Solved, Solver, Work, build_sliders, frame_of, times_of
from skinslide.stage import open_stage

_ON_A_SHEET = 12  # pictures of each series


def preview(
    stage: Usd.Stage | str | os.PathLike,
    folder: str | os.PathLike | None = None,
    *,
    html: str | os.PathLike | None = None,
    prims: Sequence[str] | str | None = None,
    patches: Sequence[str] | str | None = None,
    frames: Frames = None,
    views: Sequence[str] = VIEWS,
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
    options = PictureOptions.checked(patches, views, camera, follow, size, form, st, squares, most_stretch)
    slide = SlideOptions.checked(prims, frames, lookup, jobs)
    if folder is None and html is None:
        raise UsageError("no folder for pictures, and no page")
    canvases = _Canvases(options)
    opened = stage if isinstance(stage, Usd.Stage) else open_stage(stage)
    target = _Target(None if folder is None else check_folder(Path(folder)), None if html is None else Path(html))
    if target.page:
        check_output(target.page, (".html", ".htm"))
        check_not_input(target.page, opened)
    return _Shot.read(opened, slide, options).draw(target, canvases, progress)


@dataclass
class PreviewReport:
    """What was drawn, and what happened at each frame."""

    bake: BakeReport
    device: str
    files: list[str] = field(default_factory=list)
    pictures: int = 0
    seconds: float = 0.0

    def write(self, path: Path, data: bytes) -> None:
        """Puts a file in place, whole or not at all."""
        with replacing(path) as partial, writing(path):
            partial.write_bytes(data)
        self.files.append(str(path))

    def as_dict(self) -> dict:
        counts = {"pictures": self.pictures, "seconds": self.seconds}
        return {**self.bake.as_dict(), "files": self.files, "device": self.device, **counts}

    def text(self) -> str:
        rate = f"{self.pictures} pictures, {self.pictures / self.seconds:.1f} a second"
        return f"{self.bake.text()}\n{rate}, drawn with {self.device}"


class _Target(NamedTuple):
    """Where pictures go."""

    folder: Path | None
    page: Path | None


class _Canvases:
    """A canvas for each thread of the pool. Raises StageError where there is no device to draw with."""

    def __init__(self, options: PictureOptions):
        self._options, self._local = options, threading.local()
        self.device = self.own().device

    def own(self) -> Canvas:
        if not hasattr(self._local, "canvas"):
            pixels = "floats" if self._options.form == "exr" else "bytes"
            try:
                self._local.canvas = Canvas(self._options.width, self._options.height, pixels)
            except SliderError as error:
                failure = UsageError if error.status == "BAD_ARGUMENT" else StageError
                raise failure(f"no pictures can be drawn: {error}") from error
        return self._local.canvas


class _Drawn(NamedTuple):
    """A frame of a mesh."""

    results: tuple[PatchResult, ...]
    pictures: list[_Picture]


class _Picture(NamedTuple):
    """One picture of it."""

    series: int  # of the mesh
    view: str
    file: bytes | None  # for the folder
    thumbnail: Image.Image | None  # for its contact sheet
    jpeg: bytes | None  # for the page


@dataclass(frozen=True)
class _DrawnMesh:
    """A mesh whose pictures are known to be possible."""

    mesh: SlidMesh
    slider: Slider
    series: list[Series]
    names: list[str]  # of the files of each series

    def work_at(self, at: Usd.TimeCode, plan: _Plan, on_sheet: bool) -> Work[_Drawn]:
        """What is to be drawn once the time is slid."""
        moments = [series.moment(at) for series in self.series]

        def draw(solved: Solved) -> _Drawn:
            found = self.slider.diagnose(solved.cached, solved.slid)
            pictures = []
            for number, (series, moment) in enumerate(zip(self.series, moments, strict=True)):
                result = solved.patches[series.place]
                columns = [
                    Column("before", solved.cached, found.stretch_before, result.stretch_before),
                    Column("after", solved.slid, found.stretch_after, result.stretch_after),
                ]
                for view in plan.options.views:
                    pixels = series.draw(plan.canvases.own(), view, moment, columns, plan.options.most_stretch)
                    pictures.append(_Picture(number, view, *plan.encoded(pixels, on_sheet)))
            return _Drawn(solved.patches, pictures)

        return draw


@dataclass(frozen=True)
class _Plan:
    """How a shot is drawn, and what for."""

    options: PictureOptions
    canvases: _Canvases
    target: _Target

    def encoded(self, pixels: np.ndarray, on_sheet: bool) -> tuple[bytes | None, Image.Image | None, bytes | None]:
        """What is wanted of a picture: a file, a thumbnail, a JPEG."""
        folder, page = self.target
        file = panels.as_file(pixels, self.options.form) if folder else None
        thumbnail = panels.thumbnail(pixels) if folder and on_sheet else None
        return file, thumbnail, compressed(panels.displayed(pixels)) if page else None


@dataclass(frozen=True)
class _Shot:
    """Every mesh of a shot, and what is to be drawn of it."""

    stage: Usd.Stage
    meshes: list[_DrawnMesh]
    problems: list[Problem]
    slide: SlideOptions
    options: PictureOptions

    @classmethod
    def read(cls, stage: Usd.Stage, slide: SlideOptions, options: PictureOptions) -> _Shot:
        meshes, problems = read_meshes(stage, slide.prims)
        sliders = build_sliders(meshes, slide.lookup, problems)
        if errors(problems):
            raise StageProblems(problems)
        _check_patches(meshes, options.patches)
        names = unique_names([mesh.path for mesh in meshes])
        prepared = [
            _prepare(*each, options, problems) for each in zip(meshes, sliders, names, strict=True)
        ]  # fmt: skip
        if errors(problems):
            raise StageProblems(problems)
        return cls(stage, [each for each in prepared if each.series], problems, slide, options)

    def draw(self, target: _Target, canvases: _Canvases, progress: Progress | None) -> PreviewReport:
        """Draws every mesh."""
        times = [times_of(each.mesh, self.slide.frames) for each in self.meshes]
        total, done = sum(map(len, times)), 0
        report = PreviewReport(BakeReport(list(self.problems)), canvases.device.renderer)
        start = time.monotonic()
        plan, drawings = _Plan(self.options, canvases, target), []
        pool = ThreadPoolExecutor(min(self.slide.jobs, total), "skinslide")
        try:
            for each, own in zip(self.meshes, times, strict=True):
                drawings.append(_MeshDrawing(each, Solver(each.mesh, each.slider, pool, self.slide.jobs), plan, report))
                for _ in drawings[-1].run(own):
                    done += 1
                    if progress:
                        progress(done, total)
        finally:
            pool.shutdown(cancel_futures=True)
        report.seconds = time.monotonic() - start
        if target.folder:
            sheets = panels.contact_sheets([strip for drawing in drawings for strip in drawing.thumbnails])
            for number, sheet in enumerate(sheets):
                report.write(target.folder / f"contact_sheet{f'.{number + 1}' if number else ''}.png", sheet)
        if target.page:
            strips = [strip for drawing in drawings for strip in drawing.strips()]
            report.write(target.page, self._page(strips, report).encode())
        return report

    def _page(self, strips: list[Strip], report: PreviewReport) -> str:
        stage = self.stage
        name = stage.GetRootLayer().GetDisplayName()
        frames = sorted({frame for strip in strips for frame in strip.patch.frames if frame is not None})
        facts = {
            "stage": stage.GetRootLayer().identifier,
            "frames": f"{len(frames)}, {frame_text(frames[0])} to {frame_text(frames[-1])}" if frames else "none",
            "skinslide": version(),
            "lookup": choose_lookup(self.slide.lookup).lookup,
            "drawn with": report.device,
        }
        return page(name, strips, report.bake, facts, stage.GetTimeCodesPerSecond())


def _check_patches(meshes: Sequence[SlidMesh], wanted: Sequence[str] | None) -> None:
    known = {patch.name for mesh in meshes for patch in mesh.patches}
    for name in wanted or ():
        if name not in known:
            raise UsageError(f"there is no patch {name}; there are {', '.join(sorted(known))}")


def _prepare(mesh: SlidMesh, slider: Slider, name: str, options: PictureOptions, problems: list[Problem]) -> _DrawnMesh:
    """The series of a mesh; what cannot be drawn joins the problems."""
    drawn = _DrawnMesh(mesh, slider, [], [])
    for place, info in enumerate(slider.patches):
        if options.patches is not None and info.name not in options.patches:
            continue
        try:
            drawn.series.append(Series.of(mesh, slider, place, options))
        except (Fault, SliderError) as fault:
            problems.append(Problem("error", mesh.path, info.name, None, str(fault)))
            continue
        drawn.names.append(f"{name}.{info.name}" + (f".{info.piece + 1}" if info.piece_count > 1 else ""))
        flat = drawn.series[-1].tessellation.flat_faces
        if flat:
            message = f"{flat} faces are drawn flat: OpenSubdiv before 3.5.1 cannot subdivide them"
            problems.append(Problem("warning", mesh.path, info.name, None, message))
    return drawn


class _MeshDrawing:
    """Draws one mesh."""

    def __init__(self, drawn: _DrawnMesh, solver: Solver, plan: _Plan, report: PreviewReport):
        mesh, count = drawn.mesh, len(drawn.series) * len(plan.options.views)
        self.thumbnails: list[list[Image.Image]] = [[] for _ in range(count)]  # by series and view
        self._jpegs: list[list[bytes]] = [[] for _ in range(count)]
        self._drawn, self._solver, self._plan, self._report = drawn, solver, plan, report
        self._own = MeshReport.start(mesh.path, mesh.vertex_count, mesh.rest_source, drawn.slider.patches)
        report.bake.meshes.append(self._own)

    def run(self, times: list[Usd.TimeCode]) -> Iterator[Usd.TimeCode]:
        """Draws `times`, ascending; yields each once its pictures are in place."""
        on_sheet = set(times[:: max(1, -(-len(times) // _ON_A_SHEET))])
        drawn_at = self._solver.run(times, lambda moment: self._drawn.work_at(moment, self._plan, moment in on_sheet))
        for moment, drawn in drawn_at:
            self._own.add(frame_of(moment), drawn.results)
            for picture in drawn.pictures:
                self._keep(picture, frame_of(moment))
            self._report.pictures += len(drawn.pictures)
            yield moment

    def _keep(self, picture: _Picture, frame: float | None) -> None:
        place = self._place(picture.series, picture.view)
        if picture.file and self._plan.target.folder:
            stem = f"{self._drawn.names[picture.series]}.{picture.view}{frame_suffix(frame)}"
            self._report.write(self._plan.target.folder / f"{stem}.{self._plan.options.form}", picture.file)
        if picture.thumbnail:
            self.thumbnails[place].append(picture.thumbnail)
        if picture.jpeg:
            self._jpegs[place].append(picture.jpeg)

    def _place(self, series: int, view: str) -> int:
        return series * len(self._plan.options.views) + self._plan.options.views.index(view)

    def strips(self) -> Iterator[Strip]:
        """What a page shows of each series."""
        for number, series in enumerate(self._drawn.series):
            patch = self._own.patches[series.place]
            pictures = {view: self._jpegs[self._place(number, view)] for view in self._plan.options.views}
            yield Strip(self._own.path, patch, pictures, settings_of(self._drawn.mesh, patch.info.setup))
