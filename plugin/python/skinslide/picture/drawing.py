"""The pictures of one mesh: each frame slid, measured, drawn, titled, and encoded for whatever they are wanted for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from pxr import Sdf, Usd

from skinslide.arrays.canvas import Canvas
from skinslide.arrays.records import PatchResult
from skinslide.arrays.slider import Diagnostics
from skinslide.picture import lettering
from skinslide.picture.canvases import Canvases
from skinslide.picture.page import Strip, compressed
from skinslide.picture.series import Column, Moment, Series, Skin
from skinslide.picture.settings import settings_of
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, StageProblems, errors
from skinslide.shot.options import PictureOptions
from skinslide.shot.plan import PlannedMesh, frame_of
from skinslide.shot.report import MeshReport
from skinslide.shot.workers import work_ahead

_ON_A_SHEET = 12  # pictures of each series


class Wanted(NamedTuple):
    """What pictures are drawn for."""

    files: bool  # and a contact sheet
    page: bool


class Picture(NamedTuple):
    """A picture as a file, of MESH.WORD.WORD..."""

    words: list[str]
    form: str
    data: bytes


class _Encoded(NamedTuple):
    """A picture as it is wanted."""

    file: bytes | None
    thumbnail: bytes | None
    jpeg: bytes | None


class _Drawn(NamedTuple):
    """A frame: its pictures series by series, view by view."""

    patches: tuple[PatchResult, ...]
    pictures: list[_Encoded]


class MeshPictures:
    """One mesh."""

    def __init__(self, planned: PlannedMesh, options: PictureOptions, wanted: Wanted):
        """Raises StageProblems for what cannot be drawn."""
        self._mesh, self._slider, self._times = planned
        self._options, self._wanted = options, wanted
        self.problems: list[Problem] = []
        self._series = self._make_all()
        self._look()
        self.problems = list(dict.fromkeys(self.problems))  # a fault of the mesh is found with each of its patches
        if errors(self.problems):
            raise StageProblems(self.problems)
        mesh, count = self._mesh, len(self._series) * len(options.views)
        self.report = MeshReport.start(mesh.path, mesh.vertex_count, mesh.rest_source, self._slider.patches)
        self.thumbnails: list[list[bytes]] = [[] for _ in range(count)]  # a strip for each series and view
        self._jpegs: list[list[bytes]] = [[] for _ in range(count)]

    @property
    def frame_count(self) -> int:
        return len(self._times) if self._series else 0

    def _make_all(self) -> list[Series]:
        """A series for each piece of a patch that is wanted; what cannot be drawn joins the problems."""
        wanted, patches = self._options.patches, self._slider.patches
        chosen = [i for i, patch in enumerate(patches) if wanted is None or patch.name in wanted]
        if not chosen:
            return []
        try:
            skin = Skin.of(self._mesh, np.concatenate([self._slider.faces(i) for i in chosen]), self._options.st)
        except (Fault, SliderError) as fault:
            names = dict.fromkeys(patches[i].name for i in chosen)
            self.problems += [Problem("error", self._mesh.path, name, None, str(fault)) for name in names]
            return []
        flat = skin.tessellation.flat_faces
        if flat:
            message = f"{flat} faces are drawn flat: OpenSubdiv before 3.5.1 cannot subdivide them"
            self.problems.append(Problem("warning", self._mesh.path, None, None, message))
        made = (self._make_series(skin, i) for i in chosen)
        return [series for series in made if series]

    def _make_series(self, skin: Skin, index: int) -> Series | None:
        try:
            return Series.of(skin, self._slider, index, self._options)
        except (Fault, SliderError) as fault:
            name = self._slider.patches[index].name
            self.problems.append(Problem("error", self._mesh.path, name, None, str(fault)))
        except FrameProblem as bad:
            self.problems.append(bad.problem)
        return None

    def _look(self) -> None:
        """Finds whether a camera of the stage sees at every time; all series have the same."""
        for time in self._times if self._options.camera is not None and self._series else ():
            try:
                self._series[0].moment(time)
            except FrameProblem as bad:
                self.problems.append(bad.problem)
                return

    def files(self) -> Iterator[tuple[list[str], float | None]]:
        """The words and the frame of every picture's name."""
        for time in self._times[: self.frame_count]:
            for series in self._series:
                for view in self._options.views:
                    yield [*self._words(series), view], frame_of(time)

    def run(
        self, canvases: Canvases, pool: ThreadPoolExecutor, jobs: int
    ) -> Iterator[tuple[float | None, list[Picture]]]:
        """Draws each time in order; yields its frame and files."""
        times = self._times[: self.frame_count]
        on_sheet = {times[i] for i in np.linspace(0, len(times) - 1, _ON_A_SHEET).round().astype(int)}

        def read(time: Usd.TimeCode) -> Callable[[], _Drawn]:
            points, controls = self._mesh.points_at(time), self._mesh.controls_at(time)
            moments = [series.moment(time) for series in self._series]

            def work() -> _Drawn:
                frame = self._slider.slide(points, controls)
                measured = self._slider.diagnose(points, frame.points, controls)
                with canvases.taken() as canvas:
                    pictures = self._draw(canvas, moments, (points, frame.points), measured, frame.patches)
                    return _Drawn(frame.patches, [self._encode(each, time in on_sheet) for each in pictures])

            return work

        for time, drawn in work_ahead(self._mesh, times, read, pool, jobs + 1):
            self.report.add(frame_of(time), drawn.patches)
            yield frame_of(time), list(self._keep(drawn))

    def _draw(
        self,
        canvas: Canvas,
        moments: list[Moment],
        poses: tuple[np.ndarray, np.ndarray],
        measured: Diagnostics,
        results: tuple[PatchResult, ...],
    ) -> Iterator[np.ndarray]:
        """Before and after, series by series, view by view."""
        for series, moment in zip(self._series, moments, strict=True):
            result = results[series.index]
            columns = [
                Column("before", poses[0], measured.stretch_before, result.stretch_before),
                Column("after", poses[1], measured.stretch_after, result.stretch_after),
            ]
            for view in self._options.views:
                yield series.draw(canvas, view, moment, columns, self._options.most_stretch)

    def _encode(self, pixels: np.ndarray, on_sheet: bool) -> _Encoded:
        files, page = self._wanted
        file = lettering.as_file(pixels, self._options.form) if files else None
        thumbnail = lettering.thumbnail(pixels) if files and on_sheet else None
        return _Encoded(file, thumbnail, compressed(lettering.displayed(pixels)) if page else None)

    def _keep(self, drawn: _Drawn) -> Iterator[Picture]:
        """Keeps what sheet and page want; yields the files."""
        for number, picture in enumerate(drawn.pictures):
            series, view = divmod(number, len(self._options.views))
            if picture.thumbnail:
                self.thumbnails[number].append(picture.thumbnail)
            if picture.jpeg:
                self._jpegs[number].append(picture.jpeg)
            if picture.file:
                words = [*self._words(self._series[series]), self._options.views[view]]
                yield Picture(words, self._options.form, picture.file)

    def _words(self, series: Series) -> list[str]:
        info = self._slider.patches[series.index]
        return [info.name, *([str(info.piece + 1)] if info.piece_count > 1 else [])]

    @property
    def path(self) -> Sdf.Path:
        return self._mesh.prim.GetPath()

    @property
    def picture_count(self) -> int:
        """Of each frame."""
        return len(self._series) * len(self._options.views)

    def strips(self) -> Iterator[Strip]:
        """What a page shows of each series."""
        views = self._options.views
        for number, series in enumerate(self._series):
            patch = self.report.patches[series.index]
            own = self._jpegs[number * len(views) : (number + 1) * len(views)]
            settings = settings_of(self._mesh, patch.info.setup)
            yield Strip(self._mesh.path, patch, dict(zip(views, own, strict=True)), settings)
