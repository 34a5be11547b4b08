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
    """The meshes of a stage by the space that they are in: found once, of which no points are kept."""

    def __init__(self, stage: Usd.Stage):
        self._stage = stage
        self._found: dict[Gf.Matrix4d, list[Sdf.Path]] | None = None

    def of(self, prim: Usd.Prim) -> Iterator[Neighbour]:
        """Those with points; of meshes that UsdSkel cannot skin, as they are authored."""
        if self._found is None:
            self._found = self._by_space()
        own = UsdGeom.XformCache(FIRST).GetLocalToWorldTransform(prim)
        for path in self._found.get(own, ()):
            other = self._stage.GetPrimAtPath(path)
            points = UsdGeom.Mesh(other).GetPointsAttr().Get(FIRST) if other != prim else None
            if points:
                yield Neighbour(str(path), _moved(other, np.asarray(points)))

    def _by_space(self) -> dict[Gf.Matrix4d, list[Sdf.Path]]:
        spaces, found = UsdGeom.XformCache(FIRST), dict[Gf.Matrix4d, list[Sdf.Path]]()
        for prim in filter(UsdGeom.Mesh, self._stage.Traverse()):
            found.setdefault(spaces.GetLocalToWorldTransform(prim), []).append(prim.GetPath())
        return found


def _moved(prim: Usd.Prim, points: np.ndarray) -> np.ndarray:
    with suppress(Fault):
        return Skinning(prim).points(points, FIRST) if is_skinned(prim) else points
    return points
