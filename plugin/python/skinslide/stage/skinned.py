"""Where the points, normals and other vectors of a skinned mesh come from: as UsdSkel skins them."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.fetched import Value
from skinslide.arrays.schema import DEFAULT_TIME, Input
from skinslide.arrays.values import positions
from skinslide.problems import Fault
from skinslide.stage.skinning import Skinning
from skinslide.stage.values import FIRST, Source


class SkinnedPoints(Source):
    """Points of a skinned mesh; their default value is taken in the pose in which they were bound."""

    def __init__(self, prim: Usd.Prim, wanted: Input, skinning: Skinning):
        super().__init__(prim, wanted)
        self._skinning = skinning

    def first(self) -> Value:
        found = super().first()
        try:
            authored = positions(found)
            is_rest = self.wanted.when == DEFAULT_TIME
            moved = self._skinning.bound(authored) if is_rest else self._skinning.points(authored, FIRST)
        except Fault:  # which is said when the value is taken, or of the frame
            return found
        return found._replace(value=moved)


class SkinnedVectors(Source):
    """Normals of a skinned mesh as UsdSkel skins them, and other vectors that turn as they do.

    Those by face, and the one of a whole mesh, it leaves alone.
    """

    def __init__(self, prim: Usd.Prim, wanted: Input, skinning: Skinning, corners: np.ndarray):
        super().__init__(prim, wanted)
        is_normals = wanted.name == UsdGeom.Tokens.normals
        self._skin = skinning.normals if is_normals else skinning.vectors
        self._prim, self._skinning, self._corners = prim, skinning, corners

    def first(self) -> Value:
        try:
            return super().first()
        except Fault:  # which is said of the points
            return Source(self._prim, self.wanted).first()

    def at(self, time: Usd.TimeCode) -> Value | None:
        found, skinned = super().at(time), self.skinned(time)
        if not found or skinned is None:
            return found
        counted = found.indices and found.indices._replace(value=np.arange(len(skinned), dtype=np.int32))
        return found._replace(value=skinned, indices=counted)

    def samples(self) -> list[float]:
        return sorted({*super().samples(), *self._skinning.times()})

    def skinned(self, time: Usd.TimeCode) -> np.ndarray | None:
        """One for each vertex or corner (n, 3); None where there are no others, or what there is cannot be.

        Float32, or float64 where those authored are.
        """
        found = super().at(time)
        try:
            normals = positions(found) if found else None
        except Fault:  # which the core says when it is given the value
            return None
        if found is None or normals is None or not len(normals):  # such as those of a sample that is blocked
            return None
        interpolation = found.interpolation or (
            UsdGeom.Tokens.constant if self.wanted.is_primvar else UsdGeom.Tokens.vertex
        )
        dtype = np.float64 if found.value.dtype == np.float64 else np.float32
        if interpolation == UsdGeom.Tokens.faceVarying and len(normals) == len(self._corners):
            return self._skin(normals, self._corners, time).astype(dtype)
        by_vertex = interpolation in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying)
        fits = by_vertex and len(normals) == self._skinning.point_count
        return self._skin(normals, None, time).astype(dtype) if fits else None
