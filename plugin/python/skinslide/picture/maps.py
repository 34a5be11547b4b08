"""Maps of what a slide did, in the texture coordinates of each mesh.

for each time: texture coordinates             read on the loop's thread
    for each kind and each tile: draw, make an OpenEXR file     on a thread of the pool
    put the files in place                     on the loop's thread, one by one
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Semaphore
from typing import Any, Unpack

from skinslide.arrays.lookup import Lookup
from skinslide.picture.meshmaps import KINDS, STRAIN, Atlas, MeshMaps, WrittenMap
from skinslide.problems import counted
from skinslide.shot.checks import documented
from skinslide.shot.loop import slide
from skinslide.shot.options import Frames, MapKeywords, MapOptions, Prims, SlideOptions
from skinslide.shot.plan import PlannedMesh
from skinslide.shot.products import Making, MeshMaking, Shot
from skinslide.shot.report import BakeReport, MeshReport
from skinslide.shot.workers import Progress
from skinslide.stage.given import StageLike, StrPath
from skinslide.write.folder import OutputFolder, check_frames

_MOST_TEXELS = 1 << 28  # drawn at once: each takes some twelve bytes, with its file


def maps(
    stage: StageLike,
    folder: StrPath,
    *,
    prims: Prims = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    **maps: Unpack[MapKeywords],
) -> MapsReport:
    """Writes maps of stretch before and after, slide distance and force density over the faces of patches.

    Args:
        stage: The stage, or its path; never written.
        folder: As for `Maps`.
        prims: As for `bake_to_file`.
        frames: As for `bake_to_file`.
        lookup: As for `bake_to_file`.
        jobs: As for `bake_to_file`.
        progress: As for `bake_to_file`.
        **maps: As for `Maps`.

    Returns:
        What was slid, and the maps.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or a file cannot be written.
        StageProblems: The stage cannot be slid, or cannot be drawn.
        FrameProblem: A frame cannot be slid.
    """
    wanted = Maps(folder, **maps)
    report = slide(Shot.of(stage), SlideOptions.of(prims, frames, lookup, jobs), [wanted], progress)
    return MapsReport(report.warnings, report.meshes, report.made)


@documented
@dataclass(frozen=True)
class Maps(MapOptions):
    """Maps of stretch before and after, slide distance and force density over the faces of patches.

    Each is an OpenEXR file, MESH.KIND.FRAME.exr, or MESH.KIND.TILE.FRAME.exr where the faces reach beyond the first
    tile of a UDIM, and has one channel, Y, except strain, which has several. Each is written whole or not at all.
    Force density is that of paint, textures and edges, without constant paint, which changes nothing; painting with
    such a map gives the same densities again, except for what edges blur.

    Attributes:
        folder: Where the maps go, made if it is missing.
    """

    folder: StrPath

    def begin(self, shot: Shot, options: SlideOptions) -> Making:
        """Begins to draw the maps of a shot.

        Args:
            shot: The shot.
            options: What is slid.

        Returns:
            What the loop hands the frames to.

        Raises:
            UsageError: The folder cannot be used.
        """
        return _Mapping(self, OutputFolder(self.folder, shot.stage, shot.path))


@dataclass
class DrawnMaps:
    """The maps that were made of a shot, in `BakeReport.made`.

    Attributes:
        folder: Where they are.
        size: Texels along each side.
        maps: In the order in which they were written.
    """

    folder: str
    size: int
    maps: list[WrittenMap] = field(default_factory=list)

    def as_dict(self) -> dict[str, Any]:
        """The maps for JSON."""
        return {"maps": [written._asdict() for written in self.maps]}

    def lines(self, meshes: Sequence[MeshReport]) -> list[str]:
        """The same for a terminal.

        Args:
            meshes: Those that were slid.

        Returns:
            A line for each kind of map of each mesh, and one of all.
        """
        kinds = [self._line(mesh.path, kind) for mesh in meshes for kind in (*KINDS, STRAIN)]
        written = f"{self.folder}: {_maps(len(self.maps))} of {self.size} x {self.size} texels written"
        return [*filter(None, kinds), written]

    def _line(self, prim: str, kind: str) -> str:
        """What there is of a mesh; nothing, where only others are drawn."""
        drawn = [written for written in self.maps if (written.prim, written.kind) == (prim, kind)]
        if not drawn:
            return ""
        low, high = min(each.lowest for each in drawn), max(each.highest for each in drawn)
        return f"{prim}: {kind}: {_maps(len(drawn))}, {low:.4g} to {high:.4g}"


@dataclass
class MapsReport(BakeReport):
    """What was slid for the maps, and the maps.

    Attributes:
        warnings: What reading the stage warned of.
        meshes: One for each mesh.
        made: What was drawn.
        resumed: Never; that is of layers.
    """

    @property
    def maps(self) -> list[WrittenMap]:
        """The maps, in the order in which they were written."""
        return next(made.maps for made in self.made if isinstance(made, DrawnMaps))


def _maps(count: int) -> str:
    return counted(count, "map")


class _Mapping(Making):
    """The maps of every mesh."""

    def __init__(self, asked: Maps, folder: OutputFolder):
        self.patches = asked.patches
        self._drawn = DrawnMaps(str(asked.folder), asked.size)
        room = Semaphore(max(1, _MOST_TEXELS // asked.size**2))
        self._atlas = Atlas(asked, folder, room, self._drawn.maps)
        self._meshes: list[MeshMaps] = []

    def of_mesh(self, planned: PlannedMesh, _report: MeshReport) -> MeshMaking | None:
        if self.patches is not None and not any(patch.name in self.patches for patch in planned.mesh.patches):
            return None
        check_frames(planned.frames)
        self._meshes.append(MeshMaps(planned, self._atlas))
        return self._meshes[-1]

    @contextmanager
    def running(self, report: BakeReport) -> Iterator[None]:
        for mesh in self._meshes:
            mesh.check_files()
        report.made.append(self._drawn)
        yield
