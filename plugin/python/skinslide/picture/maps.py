"""Draws what a slide did in the texture coordinates of each mesh:

meshes, problems = read the stage              any error: stop here, nothing is written
for each mesh, for each time in order, several at once:
    points, controls, texture coordinates      read on this thread
    slide, measure by vertex                   on a thread of the pool, as what follows
    for each kind and each tile: draw, make an OpenEXR file
    put the files in place                     on this thread, one by one
"""

from __future__ import annotations

import os
import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from pxr import Usd

from skinslide.arrays.images import LARGEST_MAP
from skinslide.arrays.native import Lookup
from skinslide.picture.meshmaps import KINDS, MapOptions, MeshMaps, WrittenMap
from skinslide.problems import StageProblems
from skinslide.shot.options import BakeOptions, Frames, coordinates_name, listed, whole_number
from skinslide.shot.plan import Plan
from skinslide.shot.report import BakeReport
from skinslide.shot.workers import Progress, pool_of
from skinslide.stage.opening import open_stage
from skinslide.write.folder import OutputFolder, check_frames
from skinslide.write.place import signals_as_exceptions

_MOST_TEXELS = 1 << 28  # drawn at once: each takes some twelve bytes, with its file


@dataclass
class MapsReport(BakeReport):
    """What was slid for the maps, and the maps."""

    folder: str = ""
    size: int = 0
    maps: list[WrittenMap] = field(default_factory=list)

    def as_dict(self) -> dict[str, Any]:
        """What `--json` prints, as of a bake, and each file."""
        return {**super().as_dict(), "maps": [written._asdict() for written in self.maps]}

    def text(self) -> str:
        lines = [super().text()]
        for mesh in self.meshes:
            for kind in KINDS:
                drawn = [written for written in self.maps if (written.prim, written.kind) == (mesh.path, kind)]
                low, high = min(each.lowest for each in drawn), max(each.highest for each in drawn)
                lines.append(f"{mesh.path}: {kind}: {_maps(len(drawn))}, {low:.4g} to {high:.4g}")
        written = f"{self.folder}: {_maps(len(self.maps))} of {self.size} x {self.size} texels written"
        return "\n".join([*lines, written])


def _maps(count: int) -> str:
    return f"{count} map{'s' * (count != 1)}"


def maps(
    stage: str | os.PathLike | Usd.Stage,
    folder: str | os.PathLike,
    *,
    prims: Sequence[str] | str | None = None,
    patches: Sequence[str] | str | None = None,
    frames: Frames = None,
    size: int = 1024,
    st: str = "st",
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
) -> MapsReport:
    """Writes maps of stretch before and after, slide distance and force density over the faces of patches.

    Each is an OpenEXR file of one channel, Y. Force density is that of paint, maps and edges, without what is constant,
    which changes nothing; painting by such a map gives the same densities again, but for what an edge blurs.

    stage     a path, or a stage; never written
    folder    made where it is missing. Files are MESH.KIND.FRAME.exr, or MESH.KIND.TILE.FRAME.exr where the faces reach
              beyond the first tile of a UDIM; each is written whole or not at all
    patches   names; only these are drawn and measured, though all slide; None: every patch
    size      texels along each side
    st        the primvar with texture coordinates; of faces that overlap in it the later in the mesh is seen
    prims, frames, lookup, jobs, progress as for `bake_to_file`
    Raises UsageError, StageProblems, FrameProblem, StageError.
    """
    options = _checked(prims, patches, frames, size, st, lookup, jobs)
    opened = stage if isinstance(stage, Usd.Stage) else open_stage(stage)
    place = OutputFolder(folder, opened, None if stage is opened else stage)
    room = threading.Semaphore(max(1, _MOST_TEXELS // options.size**2))
    plan = Plan.read(opened, options.bake)
    meshes = _meshes(plan, options, place)
    report = MapsReport(list(plan.problems), folder=str(folder), size=options.size)
    frame_count = sum(mesh.frame_count for mesh in meshes)
    with signals_as_exceptions(), pool_of(options.bake.jobs, frame_count) as pool:
        for mesh in meshes:
            report.meshes.append(mesh.report)
            for written in mesh.run(room, pool):
                report.maps.extend(written)
                if progress:
                    progress(report.frame_count, frame_count)
            report.warnings.extend(mesh.problems())
    return report


def _checked(
    prims: Sequence[str] | str | None,
    patches: Sequence[str] | str | None,
    frames: Frames,
    size: int,
    st: str,
    lookup: str | Lookup,
    jobs: int,
) -> MapOptions:
    return MapOptions(
        bake=BakeOptions.checked(prims, frames, lookup, jobs),
        patches=listed(patches),
        size=whole_number("size", size, 1, LARGEST_MAP),
        st=coordinates_name(st),
    )


def _meshes(plan: Plan, options: MapOptions, place: OutputFolder) -> list[MeshMaps]:
    """Raises StageProblems and UsageError for what can be known before a frame is slid."""
    plan.check_patches(options.patches)
    meshes, problems = [], []
    for planned in plan.meshes:
        if not any(map(options.draws, planned.mesh.patches)):
            continue
        check_frames(planned.frames)
        try:
            meshes.append(MeshMaps(planned, options, place))
        except StageProblems as bad:
            problems += bad.problems
    if problems:
        raise StageProblems(problems)
    for mesh in meshes:
        mesh.check_files()
    return meshes
