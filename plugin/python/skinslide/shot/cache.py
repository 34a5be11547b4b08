"""Writes what UsdSkel makes of meshes as samples: a cache, for live layers and for tools that do not skin.

meshes that UsdSkel skins                        of the stage, or at and below prims; any error: stop here
for each mesh:
    points by default                            the pose in which it was bound, which is its rest
    at each time points, extent, and normals where they are authored
    unbind it from its skeleton
put the layer in place
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, Vt

from skinslide.arrays.native import version
from skinslide.problems import (
    FrameProblem,
    Problem,
    StageProblems,
    counted,
    errors,
    first_of,
    lines_text,
    problem_lines,
)
from skinslide.shot.frames import AskedFrames
from skinslide.shot.options import Frames, Prims, SlideOptions
from skinslide.shot.plan import times_of
from skinslide.shot.products import Shot
from skinslide.shot.report import time_text
from skinslide.shot.samples import finite_problem
from skinslide.shot.workers import Progress
from skinslide.stage.given import StageLike, StrPath
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_skinned
from skinslide.stage.skinned import SkinnedVectors
from skinslide.write.inputs import check_not_input
from skinslide.write.overs import EXTENSIONS, OverLayer, layer_in_place
from skinslide.write.place import check_output, given_output
from skinslide.write.signals import signals_as_exceptions


@dataclass(frozen=True)
class CachedMesh:
    """A mesh whose skinned points were written.

    Attributes:
        path: Of the prim.
        points: How many it has.
        skeleton: The path of the Skeleton that it is unbound from.
        frames: The stage times that were written.
        normals: The attributes of normals, and of other vectors that turn as they do, that were written.
    """

    path: str
    points: int
    skeleton: str
    frames: list[float]
    normals: list[str]

    def text(self) -> str:
        """The same for a terminal."""
        count = counted(len(self.frames), "frame")
        span = f", {time_text(self.frames[0])} to {time_text(self.frames[-1])}" if len(self.frames) > 1 else ""
        also = f", with {' and '.join(self.normals)}" if self.normals else ""
        return f"{self.path}: {self.points} points, skinned by {self.skeleton}, {count}{span}{also}"


@dataclass(frozen=True)
class CacheReport:
    """What a cache holds.

    Attributes:
        meshes: Those that were skinned.
        problems: What is worth knowing of them.
    """

    meshes: list[CachedMesh]
    problems: list[Problem]

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)

    def text(self) -> str:
        """A line for each mesh, and every problem."""
        return lines_text([*(mesh.text() for mesh in self.meshes), *problem_lines(self.problems)])


def cache(
    stage: StageLike, output: StrPath, *, prims: Prims = None, frames: Frames = None, progress: Progress | None = None
) -> CacheReport:
    """Writes the skinned points of meshes to a layer of overs, in which UsdSkel no longer skins these meshes.

    Args:
        stage: The stage, or its path; never written.
        output: The layer: .usda, .usdc or .usd, written whole or not at all; sublayer it above the stage.
        prims: Prims: the skinned meshes at and below them are written; None: all of the stage.
        frames: As for `bake_to_file`; samples are those of everything that the points follow from.
        progress: As for `bake_to_file`.

    Returns:
        What was written, mesh by mesh.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or the layer cannot be written.
        StageProblems: A mesh cannot be skinned, or there is none.
        FrameProblem: A frame cannot be skinned.
    """
    options, shot = SlideOptions.of(prims, frames, "exact", 1), Shot.of(stage)
    layer = given_output("output", output)
    check_output(layer, EXTENSIONS)
    check_not_input(layer, shot.stage, *shot.paths)
    meshes, problems = read_skinned(shot.stage, options.prims)
    if errors(problems):
        raise StageProblems(problems)
    plans = [_Cached(mesh, _times(mesh, options.frames)) for mesh in meshes]
    total = sum(len(plan.times) for plan in plans)
    comment = f"Skinned by UsdSkel, for skinslide {version()}. Sublayer this above the character."
    with signals_as_exceptions(), layer_in_place(layer, shot.stage, comment, marked=False) as overs:
        done = 0
        for plan in plans:
            for _ in plan.write(overs):
                done += 1
                if progress:
                    progress(done, total)
    problems += [warning for plan in plans for warning in plan.warnings()]
    return CacheReport([plan.report() for plan in plans], problems)


def _times(mesh: PatchedMesh, asked: AskedFrames) -> list[Usd.TimeCode]:
    """One that never moves is posed at the first frame: its default value is its rest."""
    times = times_of(mesh, asked)
    return [Usd.TimeCode(mesh.stage.GetStartTimeCode()) if time.IsDefault() else time for time in times]


class _Cached:
    """One mesh."""

    def __init__(self, mesh: PatchedMesh, times: list[Usd.TimeCode]):
        self._mesh, self.times = mesh, times
        self._vectors: list[SkinnedVectors] = []
        self._told: list[Problem] = []  # of points that are not finite, at each frame

    def write(self, overs: OverLayer) -> Iterator[Usd.TimeCode]:
        """Yields each time once it is written."""
        rest = self._mesh.bound_points()
        if rest is not None:
            points = UsdGeom.PointBased(self._mesh.prim).GetPointsAttr()
            overs.set(points, Vt.Vec3fArray.FromNumpy(rest), Usd.TimeCode.Default())
        for time in self.times:
            cached = self._mesh.points_at(time)
            if time == self.times[0]:
                self._vectors = [each for each in self._mesh.skinned_vectors() if each.skinned(time) is not None]
            self._told += filter(None, [finite_problem(self._mesh, cached, time)])
            overs.set_points(self._mesh.prim, cached, time)
            for source in self._vectors:
                skinned = source.skinned(time)
                if skinned is None:
                    raise FrameProblem(self._mesh.problem(f"{source.name} cannot be skinned as at first", time))
                array = Vt.Vec3dArray if skinned.dtype == np.float64 else Vt.Vec3fArray
                overs.set(source.attribute, array.FromNumpy(skinned), time)
            yield time
        for source in self._vectors:
            if source.indices and source.indices.HasAuthoredValue():
                overs.block(source.indices)
        overs.end_skinning(self._mesh.prim)

    def warnings(self) -> Iterator[Problem]:
        """What there is to say of what was written."""
        return first_of(self._told)

    def report(self) -> CachedMesh:
        mesh, names = self._mesh, [source.name for source in self._vectors]
        frames = [time.GetValue() for time in self.times]
        return CachedMesh(mesh.path, mesh.vertex_count, mesh.skeleton, frames, names)
