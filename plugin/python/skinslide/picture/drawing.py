"""The pictures of one mesh: each frame drawn, titled, and encoded for whatever it is wanted for."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import asdict, dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np
from pxr import Usd

from skinslide.arrays.canvas import Canvas
from skinslide.arrays.slider import Slider
from skinslide.picture import encoding
from skinslide.picture.canvases import Canvases
from skinslide.picture.embedded import compressed
from skinslide.picture.encoders import Encoders
from skinslide.picture.page import Strip
from skinslide.picture.series import Column, Moment, Series, Skin
from skinslide.picture.settings import settings_of
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, StageProblems, counted, errors
from skinslide.shot.advice import advice
from skinslide.shot.options import PictureOptions
from skinslide.shot.plan import PlannedMesh, frame_of
from skinslide.shot.products import MeshMaking, SlidFrame, SlidFrames
from skinslide.shot.report import MeshReport
from skinslide.shot.workers import core_named
from skinslide.write.folder import OutputFolder

_ON_A_SHEET = 12  # pictures of each series


@dataclass
class DrawnPictures:
    """The pictures that were made of a shot, in `BakeReport.made`.

    Attributes:
        device: What they were drawn with.
        files: In the folder, in the order in which they were written.
        pictures: How many were drawn.
        seconds: How long sliding and drawing took.
    """

    device: str = ""
    files: list[str] = field(default_factory=list)
    pictures: int = 0
    seconds: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)

    def lines(self, meshes: Sequence[MeshReport]) -> list[str]:
        """The same for a terminal.

        Args:
            meshes: Those that were slid.

        Returns:
            A line.
        """
        rate = f"{counted(self.pictures, 'picture')}, {self.pictures / max(self.seconds, 1e-9):.1f} a second"
        return [f"{rate}, drawn with {self.device}"]


@dataclass
class Budget:
    """How many bytes each picture of a page may have, which is known once all meshes are."""

    of_each: int = 0


class Easel(NamedTuple):
    """What all meshes are drawn with."""

    options: PictureOptions
    canvases: Canvases
    encoders: Encoders
    folder: OutputFolder | None
    page: Path | None  # where there will be one
    drawn: DrawnPictures
    budget: Budget


class _Encoded(NamedTuple):
    """A picture as it is wanted."""

    file: bytes | None
    thumbnail: bytes | None
    small: bytes | None  # for a page


class _Drawn(NamedTuple):
    """The pictures of a time."""

    pictures: list[Future[_Encoded]]
    left: dict[str, list[float]]  # by column but the first: the stretch of each series


class MeshPictures(MeshMaking):
    """The pictures of one mesh."""

    def __init__(self, planned: PlannedMesh, report: MeshReport, easel: Easel):
        """Raises StageProblems for what cannot be drawn."""
        self._mesh, self._slider, self._times = planned.mesh, planned.slider, planned.times
        self._report, self._easel, self._options = report, easel, easel.options
        self._problems: list[Problem] = []
        self._rules = self._options.compare or ()
        self.sliders = [self._slider_of(rule) for rule in self._rules]
        if errors(self._problems):
            raise StageProblems(self._problems)
        self._series = self._make_all()
        self._look()
        self._problems = list(dict.fromkeys(self._problems))  # a fault of the mesh is found with each of its patches
        if errors(self._problems):
            raise StageProblems(self._problems)
        shown = np.linspace(0, len(self._times) - 1, _ON_A_SHEET).round().astype(int)
        self._on_sheet = {self._times[i] for i in shown}
        # A strip for each series and view.
        self.thumbnails: list[list[bytes]] = [[] for _ in range(self.picture_count)]
        self._small: list[list[bytes]] = [[] for _ in range(self.picture_count)]
        self._left: list[dict[str, list[float]]] = []  # of each time

    @property
    def total(self) -> int:
        """Pictures of all frames."""
        return self.picture_count * len(self._times)

    @property
    def columns(self) -> int:
        """Poses side by side on a picture."""
        return 1 + max(1, len(self._rules))

    def _slider_of(self, rule: str) -> Slider:
        """A slider in which every patch follows a rule; if there can be none, the mesh's own, and a problem."""
        try:
            found = self._mesh.build([replace(patch, rule=rule) for patch in self._mesh.patches])
            if [each.vertex_count for each in found.patches] == [each.vertex_count for each in self._slider.patches]:
                return found
            reason = "its patches are other pieces"
        except SliderError as error:
            reason = str(error)
        self._problems.append(Problem("error", self._mesh.path, None, None, f"under the rule {rule}: {reason}"))
        return self._slider

    @property
    def picture_count(self) -> int:
        """Of each frame; 0 where no patch is wanted."""
        return len(self._series) * len(self._options.views)

    def _make_all(self) -> list[Series]:
        """A series for each piece of a patch that is wanted; what cannot be drawn joins the problems."""
        wanted, patches = self._options.patches, self._slider.patches
        chosen = [i for i, patch in enumerate(patches) if wanted is None or patch.name in wanted]
        if not chosen:
            return []
        try:
            faces = np.concatenate([self._slider.faces(i) for i in chosen])
            skin = Skin.of(self._mesh, faces, self._options.st, textured="texture" in self._options.views)
        except (Fault, SliderError) as fault:
            names = dict.fromkeys(patches[i].name for i in chosen)
            self._problems += [Problem("error", self._mesh.path, name, None, str(fault)) for name in names]
            return []
        flat = skin.tessellation.flat_faces
        if flat:
            message = f"{counted(flat, 'face is', 'faces are')} drawn flat, without a limit surface"
            self._problems.append(Problem("warning", self._mesh.path, None, None, message))
        if skin.note and "chequer" in self._options.views:
            self._problems.append(Problem("note", self._mesh.path, None, None, skin.note))
        made = (self._make_series(skin, i) for i in chosen)
        return [series for series in made if series]

    def _make_series(self, skin: Skin, index: int) -> Series | None:
        try:
            return Series.of(skin, self._slider, index, self._options, self.columns)
        except (Fault, SliderError) as fault:
            name = self._slider.patches[index].name
            self._problems.append(Problem("error", self._mesh.path, name, None, str(fault)))
        except FrameProblem as bad:
            self._problems.append(bad.problem)
        return None

    def _look(self) -> None:
        """Finds whether a camera of the stage sees at every time; all series have the same."""
        for time in self._times if self._options.camera is not None and self._series else ():
            try:
                self._series[0].moment(time)
            except FrameProblem as bad:
                self._problems.append(bad.problem)
                return

    def files(self, folder: OutputFolder) -> Iterator[Path]:
        """Every file that will be written."""
        for time in self._times:
            for number in range(self.picture_count):
                yield self._path(folder, number, time)

    def read(self, time: Usd.TimeCode) -> Callable[[SlidFrame], _Drawn]:
        moments = [series.moment(time) for series in self._series]

        def work(frame: SlidFrame) -> _Drawn:
            slid = {rule: frame.by(slider) for rule, slider in zip(self._rules, self.sliders, strict=True)}
            with self._easel.canvases.taken() as canvas:
                drawn = self._draw(canvas, moments, frame, slid or {"after": frame})
                works = (partial(self._encode, each, time in self._on_sheet) for each in drawn)
                pictures = [self._easel.encoders.encode(each) for each in works]
            return _Drawn(pictures, {rule: self._stretch(each) for rule, each in slid.items()})

        return work

    def _stretch(self, frame: SlidFrame) -> list[float]:
        return [frame.patches[series.index].stretch_after for series in self._series]

    def take(self, time: Usd.TimeCode, _frames: SlidFrames, made: _Drawn) -> None:
        """Writes the files; keeps what the contact sheet and the page need."""
        self._left.append(made.left)
        self._easel.drawn.pictures += len(made.pictures)
        for number, encoded in enumerate(made.pictures):
            with core_named(self._mesh, time):
                picture = encoded.result()
            if picture.thumbnail:
                self.thumbnails[number].append(picture.thumbnail)
            if picture.small:
                self._small[number].append(picture.small)
            if picture.file and self._easel.folder:
                path = self._path(self._easel.folder, number, time)
                self._easel.folder.write(path, picture.file)
                self._easel.drawn.files.append(str(path))

    def end(self) -> list[Problem]:
        return [*self._problems, *advice(self._mesh, self._slider.patches, self._slider)]

    def _path(self, folder: OutputFolder, number: int, time: Usd.TimeCode) -> Path:
        """MESH.PATCH.VIEW.FRAME.png, or MESH.PATCH.PIECE.VIEW.FRAME.png, of a picture of each frame."""
        series, view = divmod(number, len(self._options.views))
        info = self._slider.patches[self._series[series].index]
        words = [info.name, *([str(info.piece + 1)] if info.piece_count > 1 else []), self._options.views[view]]
        return folder.path(self._mesh.prim.GetPath(), words, frame_of(time), self._options.form)

    def _draw(
        self, canvas: Canvas, moments: list[Moment], frame: SlidFrame, slid: dict[str, SlidFrame]
    ) -> Iterator[np.ndarray]:
        """Before and after, series by series, view by view."""
        for series, moment in zip(self._series, moments, strict=True):
            columns = [self._before(frame, series.index)]
            columns += [self._after(title, each, series.index) for title, each in slid.items()]
            yield from series.draw_all(canvas, self._options.views, moment, columns, self._options.stretch_scale)

    def _before(self, frame: SlidFrame, index: int) -> Column:
        measured, points = frame.measured(), self._mesh.drawn_points(frame.cached)
        measure = frame.patches[index].stretch_before
        return Column("before", points, measured.stretch_before, measure, measured.force_density)

    def _after(self, title: str, frame: SlidFrame, index: int) -> Column:
        measured, points = frame.measured(), self._mesh.drawn_points(frame.slid)
        ways, measure = points - self._mesh.drawn_points(frame.cached), frame.patches[index].stretch_after
        return Column(title, points, measured.stretch_after, measure, measured.force_density, ways)

    def _encode(self, pixels: np.ndarray, on_sheet: bool) -> _Encoded:
        kept, shown = self._easel.folder is not None, cache(lambda: encoding.displayed(pixels))
        file = (encoding.exr(pixels) if self._options.form == "exr" else encoding.png(shown())) if kept else None
        thumbnail = encoding.thumbnail(shown()) if kept and on_sheet else None
        small = compressed(shown(), self._easel.budget.of_each, self.columns) if self._easel.page else None
        return _Encoded(file, thumbnail, small)

    def strips(self) -> Iterator[Strip]:
        """What a page shows of each series."""
        views = self._options.views
        for number, series in enumerate(self._series):
            patch = self._report.patches[series.index]
            which = range(number * len(views), (number + 1) * len(views))
            pictures = {view: self._small[i] for view, i in zip(views, which, strict=True)}
            files = {view: self._addresses(i) for view, i in zip(views, which, strict=True)}
            settings = settings_of(self._mesh, patch.info.setup)
            columns = ("before", *(self._rules or ("after",)))
            compared = {rule: [left[rule][number] for left in self._left] for rule in self._rules}
            yield Strip(self._mesh.path, patch, pictures, settings, columns, files, compared)

    def _addresses(self, number: int) -> list[str]:
        """Of the pictures in full size, seen from the page; none, where they are not kept."""
        folder, page = self._easel.folder, self._easel.page
        if not folder or not page or self._options.form != "png":
            return []
        paths = (self._path(folder, number, time) for time in self._times)
        return [quote(Path(os.path.relpath(path, page.absolute().parent)).as_posix()) for path in paths]
