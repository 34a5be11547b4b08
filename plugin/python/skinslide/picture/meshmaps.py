"""The maps of one mesh: each frame slid, measured, drawn in texture coordinates, and written."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from threading import Semaphore
from typing import NamedTuple

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.images import FIRST_TILE, Corners, draw_map, encode_exr, map_tiles
from skinslide.arrays.native import Controls, PatchSetup
from skinslide.arrays.records import PatchResult
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, StageProblems
from skinslide.shot.options import BakeOptions
from skinslide.shot.plan import PlannedMesh, frame_of
from skinslide.shot.report import MeshReport
from skinslide.shot.workers import work_ahead
from skinslide.stage.coordinates import read_coordinates
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST, Reading, primvar_sources
from skinslide.write.folder import OutputFolder

# Kinds of maps, each with the field of skinslide.arrays.slider.Diagnostics that it shows.
KINDS = {
    "stretchBefore": "stretch_before",
    "stretchAfter": "stretch_after",
    "slide": "slide",
    "forceDensity": "force_density",
}
_CHANNEL = "Y"


@dataclass(frozen=True)
class MapOptions:
    """What maps are asked for."""

    bake: BakeOptions
    patches: list[str] | None  # names; None: all
    size: int
    st: str

    def draws(self, patch: PatchSetup) -> bool:
        return self.patches is None or patch.name in self.patches


class MapName(NamedTuple):
    """What tells a map from others of its mesh."""

    kind: str  # such as stretchBefore
    tile: int | None  # of a UDIM
    frame: float | None


class WrittenMap(NamedTuple):
    """One file, with the least and the greatest value of the vertices drawn."""

    file: str
    prim: str
    kind: str
    tile: int | None
    frame: float | None
    lowest: float
    highest: float


class _Map(NamedTuple):
    """A file to write."""

    name: MapName
    data: bytes
    lowest: float
    highest: float


class _Frame(NamedTuple):
    """What is read of the stage for a time."""

    points: np.ndarray
    controls: list[Controls] | None
    corners: Corners
    names: list[MapName]


class _Drawn(NamedTuple):
    patches: tuple[PatchResult, ...]
    maps: list[_Map]
    missed_faces: int  # of one kind


class MeshMaps:
    """One mesh."""

    def __init__(self, planned: PlannedMesh, options: MapOptions, place: OutputFolder):
        """Raises StageProblems where the texture coordinates cannot be used at the first time."""
        self._mesh, self._slider, self._times = planned
        self._options, self._place = options, place
        self._chosen = [options.draws(patch) for patch in self._mesh.patches]
        self._faces = np.unique(np.concatenate([patch.faces for patch in self._drawn_patches()])).astype(np.int32)
        self._vertices = self._mesh.topology.vertices_of(self._faces)
        self._missed: list[tuple[int, float | None]] = []
        mesh = self._mesh
        self.report = MeshReport.start(mesh.path, mesh.vertex_count, mesh.rest_source, self._slider.patches)
        self.frame_count = len(self._times)
        try:
            self._st = _read_st(mesh, options.st)
            self._first = self._corners_at(FIRST)
        except Fault as fault:
            raise StageProblems([mesh.problem(str(fault), FIRST)]) from fault
        except FrameProblem as bad:
            raise StageProblems([bad.problem]) from bad

    def check_files(self) -> None:
        """Raises UsageError for a file that cannot be written."""
        _, tiles = self._first
        self._place.check_all(self._path(name) for time in self._times for name in _map_names(tiles, time))

    def run(self, room: Semaphore, pool: ThreadPoolExecutor) -> Iterator[list[WrittenMap]]:
        """Writes the maps of each time in order; yields them. room: for as many to be drawn at once."""

        def read(time: Usd.TimeCode) -> Callable[[], _Drawn]:
            frame = self._read(time)
            return lambda: self._draw(frame, room)

        for time, drawn in work_ahead(self._mesh, self._times, read, pool, self._options.bake.jobs):
            written = self._write(drawn)
            self.report.add(frame_of(time), drawn.patches)
            self._missed.append((drawn.missed_faces, frame_of(time) if self._st.varies else None))
            yield written

    def problems(self) -> list[Problem]:
        """What is missing in the maps."""
        most, frame = max(self._missed, key=lambda each: each[0])
        message = f"{most} faces are so small or thin that no texel's centre is in them; a larger size draws more"
        return [Problem("warning", self._mesh.path, None, frame, message)] if most else []

    def _drawn_patches(self) -> list[PatchSetup]:
        return [patch for patch in self._mesh.patches if self._options.draws(patch)]

    def _read(self, time: Usd.TimeCode) -> _Frame:
        points, controls = self._mesh.points_at(time), self._mesh.controls_at(time)
        changes = self._st.varies and not time.IsDefault()
        corners, tiles = self._corners_at(time) if changes else self._first
        return _Frame(points, controls, corners, _map_names(tiles, time))

    def _draw(self, frame: _Frame, room: Semaphore) -> _Drawn:
        slid = self._slider.slide(frame.points, frame.controls)
        measured = self._slider.diagnose(frame.points, slid.points, frame.controls, chosen=self._chosen)
        made, missed = [], 0
        with room:
            for name in frame.names:
                values = getattr(measured, KINDS[name.kind])
                texels, without = draw_map(frame.corners, values, self._options.size, name.tile or FIRST_TILE)
                inside = values[self._vertices]
                data = encode_exr({_CHANNEL: texels}, wrap="clamp")
                made.append(_Map(name, data, float(inside.min()), float(inside.max())))
                missed += without if name.kind == frame.names[0].kind else 0
        return _Drawn(slid.patches, made, missed)

    def _write(self, drawn: _Drawn) -> list[WrittenMap]:
        path = self._mesh.prim.GetPath()
        outputs = [self._path(made.name) for made in drawn.maps]
        for output in outputs:  # none, where one cannot be
            self._place.check(output)
        for output, made in zip(outputs, drawn.maps, strict=True):
            self._place.write(output, made.data)
        return [
            WrittenMap(str(output), str(path), *made.name, made.lowest, made.highest)
            for output, made in zip(outputs, drawn.maps, strict=True)
        ]

    def _path(self, name: MapName) -> Path:
        words = [name.kind, *([] if name.tile is None else [str(name.tile)])]
        return self._place.path(self._mesh.prim.GetPath(), words, name.frame, "exr")

    def _corners_at(self, time: Usd.TimeCode) -> tuple[Corners, list[int]]:
        """The texture coordinates of the faces drawn, and the tiles of a UDIM that they reach. Raises FrameProblem."""
        counts, indices = self._mesh.face_counts, self._mesh.face_indices
        try:
            corners = Corners(counts, indices, self._mesh.vertex_count, self._faces, self._st.at(time))
        except Fault as fault:
            raise FrameProblem(self._mesh.problem(str(fault), time)) from fault
        for patch in self._drawn_patches():
            try:
                map_tiles(corners._replace(faces=patch.faces))
            except SliderError as error:
                message = f"primvars:{self._options.st}: {error}"
                raise FrameProblem(self._mesh.problem(message, time, patch.name)) from error
        tiles = np.unique(map_tiles(corners))
        return corners, tiles[tiles > 0].tolist()


def _map_names(tiles: list[int], time: Usd.TimeCode) -> list[MapName]:
    """Without tiles where the first is the only one."""
    shown = [None] if tiles == [FIRST_TILE] else tiles
    return [MapName(kind, tile, frame_of(time)) for kind in KINDS for tile in shown]


def _read_st(mesh: PatchedMesh, name: str) -> Reading[np.ndarray]:
    """The texture coordinates of the corners, over time. Raises Fault."""
    primvar = UsdGeom.PrimvarsAPI(mesh.prim).GetPrimvar(name)
    if not primvar or not primvar.HasAuthoredValue():
        raise Fault(f"has no primvars:{name}, in which its maps would be drawn; name another primvar")
    return Reading(lambda time: read_coordinates(primvar, time, mesh.topology), primvar_sources(primvar))
