"""The maps of one mesh: each frame measured, drawn in texture coordinates, and written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from threading import Semaphore
from typing import NamedTuple

import numpy as np
from pxr import Usd

from skinslide.arrays.images import FIRST_TILE, Corners, draw_corner_map, draw_map, encode_exr, map_tiles
from skinslide.arrays.setups import PatchSetup
from skinslide.arrays.strain import Strain
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, StageProblems, counted
from skinslide.shot.diagnostics import MeshStrain
from skinslide.shot.options import MapOptions
from skinslide.shot.plan import PlannedMesh, frame_of
from skinslide.shot.products import MeshMaking, SlidFrame, SlidFrames
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST, Source, primvar_source
from skinslide.write.folder import OutputFolder

# Kinds of maps, each with the field of skinslide.arrays.slider.Diagnostics that it shows.
KINDS = {
    "stretchBefore": "stretch_before",
    "stretchAfter": "stretch_after",
    "slide": "slide",
    "forceDensity": "force_density",
}
STRAIN = "strain"
_CHANNEL = "Y"


class MapName(NamedTuple):
    """What tells a map from others of its mesh."""

    kind: str  # such as stretchBefore
    tile: int | None  # of a UDIM
    frame: float | None


class WrittenMap(NamedTuple):
    """One file.

    Attributes:
        file: Its path.
        prim: The path of the mesh.
        kind: stretchBefore, stretchAfter, slide or forceDensity; strain.
        tile: The number of its UDIM tile; None: the mesh has no other.
        frame: The stage time; None: the default time.
        lowest: The least value of the vertices drawn.
        highest: The greatest.
    """

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


class _Drawn(NamedTuple):
    maps: list[_Map]
    missed_faces: int  # of one kind


class Atlas(NamedTuple):
    """What the maps of all meshes are drawn with."""

    options: MapOptions
    folder: OutputFolder
    room: Semaphore  # for as many frames to be drawn at once
    written: list[WrittenMap]


class MeshMaps(MeshMaking):
    """The maps of one mesh."""

    def __init__(self, planned: PlannedMesh, atlas: Atlas):
        """Raises StageProblems where the texture coordinates cannot be used at the first time."""
        mesh, self._times, self._atlas, self._options = planned.mesh, planned.times, atlas, atlas.options
        wanted = self._options.patches
        self._mesh, self._chosen = mesh, [wanted is None or patch.name in wanted for patch in mesh.patches]
        self._faces = np.unique(np.concatenate([patch.faces for patch in self._drawn_patches()])).astype(np.int32)
        self._vertices = mesh.topology.vertices_of(self._faces)
        self._missed: list[tuple[int, float | None]] = []
        try:
            self._st = _find_st(mesh, self._options.st)
            self._first = self._corners_at(FIRST)
            self._strain = MeshStrain(mesh, self._st.attribute.GetName()) if self._options.strain else None
        except Fault as fault:
            raise StageProblems([mesh.problem(str(fault), FIRST)]) from fault
        except FrameProblem as bad:
            raise StageProblems([bad.problem]) from bad

    def check_files(self) -> None:
        """Raises UsageError for a file that cannot be written."""
        _, tiles = self._first
        self._atlas.folder.check_all(self._path(name) for time in self._times for name in self._map_names(tiles, time))

    def read(self, time: Usd.TimeCode) -> Callable[[SlidFrame], _Drawn]:
        changes = self._st.varies and not time.IsDefault()
        corners, tiles = self._corners_at(time) if changes else self._first
        return lambda frame: self._draw(frame, corners, self._map_names(tiles, time))

    def take(self, time: Usd.TimeCode, _frames: SlidFrames, made: _Drawn) -> None:
        """Writes the maps."""
        outputs = [self._path(drawn.name) for drawn in made.maps]
        for output in outputs:  # none, where one cannot be
            self._atlas.folder.check(output)
        for output, drawn in zip(outputs, made.maps, strict=True):
            self._atlas.folder.write(output, drawn.data)
            written = WrittenMap(str(output), self._mesh.path, *drawn.name, drawn.lowest, drawn.highest)
            self._atlas.written.append(written)
        self._missed.append((made.missed_faces, frame_of(time) if self._st.varies else None))

    def end(self) -> list[Problem]:
        """What is missing in the maps."""
        most, frame = max(self._missed, key=lambda each: each[0])
        thin = counted(most, "face is", "faces are")
        message = f"{thin} so small or thin that no texel's centre is in them; a larger size draws more"
        return [Problem("warning", self._mesh.path, None, frame, message)] if most else []

    def _drawn_patches(self) -> list[PatchSetup]:
        return [patch for patch, chosen in zip(self._mesh.patches, self._chosen, strict=True) if chosen]

    def _draw(self, frame: SlidFrame, corners: Corners, names: list[MapName]) -> _Drawn:
        measured = frame.measured(self._chosen)
        strain = self._strain.of(self._mesh.drawn_points(frame.slid)) if self._strain else None
        made, missed = [], 0
        with self._atlas.room:
            for name in names:
                if name.kind == STRAIN and strain:
                    made.append(self._draw_strain(strain, corners, name))
                    continue
                values = getattr(measured, KINDS[name.kind])
                texels, without = draw_map(corners, values, self._options.size, name.tile or FIRST_TILE)
                inside = values[self._vertices]
                data = encode_exr({_CHANNEL: texels}, wrap="clamp")
                made.append(_Map(name, data, float(inside.min()), float(inside.max())))
                missed += without if name.kind == names[0].kind else 0
        return _Drawn(made, missed)

    def _draw_strain(self, strain: Strain, corners: Corners, name: MapName) -> _Map:
        """Its channels in one file."""
        size, tile = self._options.size, name.tile or FIRST_TILE
        fields = {"largest": strain.largest, "smallest": strain.smallest, "area": strain.area_ratio}
        channels = {channel: draw_map(corners, values, size, tile)[0] for channel, values in fields.items()}
        for k, axis in enumerate("xy"):
            values = np.zeros(len(corners.face_indices)) if strain.direction is None else strain.direction[:, k]
            channels[f"direction.{axis}"] = draw_corner_map(corners, values.astype(np.float32), size, tile)
        least, most = strain.smallest[self._vertices].min(), strain.largest[self._vertices].max()
        return _Map(name, encode_exr(channels, wrap="clamp"), float(least), float(most))

    def _map_names(self, tiles: list[int], time: Usd.TimeCode) -> list[MapName]:
        """Without tiles where the first is the only one."""
        shown = [None] if tiles == [FIRST_TILE] else tiles
        kinds = [*KINDS, *([STRAIN] if self._options.strain else [])]
        return [MapName(kind, tile, frame_of(time)) for kind in kinds for tile in shown]

    def _path(self, name: MapName) -> Path:
        words = [name.kind, *([] if name.tile is None else [str(name.tile)])]
        return self._atlas.folder.path(self._mesh.prim.GetPath(), words, name.frame, "exr")

    def _corners_at(self, time: Usd.TimeCode) -> tuple[Corners, list[int]]:
        """The texture coordinates of the faces drawn, and the tiles of a UDIM that they reach. Raises FrameProblem."""
        counts, indices = self._mesh.face_counts, self._mesh.face_indices
        try:
            corners = Corners(
                counts, indices, self._mesh.vertex_count, self._faces, self._mesh.meaning.coordinates(self._st.at(time))
            )
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


def _find_st(mesh: PatchedMesh, name: str) -> Source:
    """Where the texture coordinates of the corners come from. Raises Fault."""
    source = primvar_source(mesh.prim, f"primvars:{name}")
    if source.at(FIRST) is None:
        raise Fault(f"has no primvars:{name}, in which its maps would be drawn; {mesh.meaning.coordinates_there}")
    return source
