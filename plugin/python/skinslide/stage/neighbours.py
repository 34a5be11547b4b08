"""Other meshes of a stage in the space of one, whose points may meet its own, as a head does those of a body."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from skinslide.problems import Fault
from skinslide.stage.finding import is_skinned
from skinslide.stage.skinning import Skinning
from skinslide.stage.values import FIRST


class Neighbour(NamedTuple):
    """A mesh, and its points (n, 3) at the first time, as they are skinned."""

    path: str
    points: np.ndarray


class Neighbours:
    """The meshes of a stage by the space that they are in: found once, of which boxes are kept but no points."""

    def __init__(self, stage: Usd.Stage):
        self._stage = stage
        self._found: dict[Gf.Matrix4d, list[Sdf.Path]] | None = None
        self._boxes: dict[Sdf.Path, Gf.Range3d] = {}

    def of(self, prim: Usd.Prim) -> Iterator[Neighbour]:
        """Those with points; of meshes that UsdSkel cannot skin, as they are authored."""
        for path in self._beside(prim):
            points = self._points(path)
            if len(points):
                yield Neighbour(str(path), points)

    def near(self, prim: Usd.Prim) -> Iterator[Neighbour]:
        """Those whose boxes are no farther away than a hundredth of its own; of others points are read once."""
        own = self._box(prim.GetPath())
        margin = Gf.Vec3d(0.01 * own.GetSize().GetLength())
        around = Gf.Range3d(own.min - margin, own.max + margin)
        for path in self._beside(prim):
            if not own.IsEmpty() and not Gf.Range3d.GetIntersection(around, self._box(path)).IsEmpty():
                yield Neighbour(str(path), self._points(path))

    def _beside(self, prim: Usd.Prim) -> Iterator[Sdf.Path]:
        if self._found is None:
            self._found = self._by_space()
        own = UsdGeom.XformCache(FIRST).GetLocalToWorldTransform(prim)
        return (path for path in self._found.get(own, ()) if path != prim.GetPath())

    def _by_space(self) -> dict[Gf.Matrix4d, list[Sdf.Path]]:
        spaces, found = UsdGeom.XformCache(FIRST), dict[Gf.Matrix4d, list[Sdf.Path]]()
        for prim in filter(UsdGeom.Mesh, self._stage.Traverse()):
            found.setdefault(spaces.GetLocalToWorldTransform(prim), []).append(prim.GetPath())
        return found

    def _points(self, path: Sdf.Path) -> np.ndarray:
        prim = self._stage.GetPrimAtPath(path)
        points = UsdGeom.Mesh(prim).GetPointsAttr().Get(FIRST)
        return _moved(prim, np.asarray(points)) if points else np.empty((0, 3), np.float32)

    def _box(self, path: Sdf.Path) -> Gf.Range3d:
        """Around the points of a mesh that are finite; empty where there are none."""
        if path not in self._boxes:
            points = self._points(path)
            finite = points[np.isfinite(points).all(axis=1)].astype(float)
            ends = (Gf.Vec3d(*finite.min(axis=0)), Gf.Vec3d(*finite.max(axis=0))) if len(finite) else ()
            self._boxes[path] = Gf.Range3d(*ends)
        return self._boxes[path]


def _moved(prim: Usd.Prim, points: np.ndarray) -> np.ndarray:
    with suppress(Fault):
        return Skinning(prim).points(points, FIRST) if is_skinned(prim) else points
    return points
