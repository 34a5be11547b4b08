"""Other meshes of a stage in the space of one, whose points may meet its own, as a head does those of a body."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.problems import Fault
from skinslide.stage.finding import is_skinned
from skinslide.stage.skinning import Skinning
from skinslide.stage.values import FIRST


class Neighbour(NamedTuple):
    """A mesh, and its points (n, 3) at the first time, as they are skinned."""

    path: str
    points: np.ndarray


def find_neighbours(prim: Usd.Prim) -> Iterator[Neighbour]:
    """Those with points; of meshes that UsdSkel cannot skin, as they are authored."""
    spaces = UsdGeom.XformCache(FIRST)
    own = spaces.GetLocalToWorldTransform(prim)
    for other in prim.GetStage().Traverse():
        if other == prim or not other.IsA(UsdGeom.Mesh) or spaces.GetLocalToWorldTransform(other) != own:
            continue
        points = UsdGeom.Mesh(other).GetPointsAttr().Get(FIRST)
        if points:
            yield Neighbour(str(other.GetPath()), _moved(other, np.asarray(points)))


def _moved(prim: Usd.Prim, points: np.ndarray) -> np.ndarray:
    with suppress(Fault):
        return Skinning(prim).points(points, FIRST) if is_skinned(prim) else points
    return points
