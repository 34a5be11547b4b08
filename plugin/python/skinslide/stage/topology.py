"""How the points of a mesh make faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.problems import Fault
from skinslide.stage.values import integers, unchanging


@dataclass(frozen=True)
class Topology:
    """Counts and indices as UsdGeomMesh has them, which fit each other and the number of points."""

    face_counts: np.ndarray  # (F,) int32
    face_indices: np.ndarray  # (sum of counts,) int32
    vertex_count: int

    @property
    def face_count(self) -> int:
        return len(self.face_counts)

    def faces_within(self, chosen: np.ndarray) -> np.ndarray:
        """The faces, bool (F,), whose vertices are all `chosen`, bool (V,)."""
        face_of_corner = np.repeat(np.arange(self.face_count), self.face_counts)
        outside = np.bincount(face_of_corner, weights=~chosen[self.face_indices], minlength=self.face_count)
        return (outside == 0) & (self.face_counts > 0)

    def vertices_of(self, faces: np.ndarray) -> np.ndarray:
        """The vertices, bool (V,), of some faces (n,)."""
        inside = np.zeros(self.face_count, dtype=bool)
        inside[faces] = True
        vertices = np.zeros(self.vertex_count, dtype=bool)
        vertices[self.face_indices[np.repeat(inside, self.face_counts)]] = True
        return vertices

    def edges_of(self, faces: np.ndarray) -> np.ndarray:
        """The edges of some faces (n,), int32 (k, 2), each once, the lower vertex first, ascending."""
        inside = np.zeros(self.face_count, dtype=bool)
        inside[faces] = True
        ends = np.cumsum(self.face_counts)
        following = np.arange(1, len(self.face_indices) + 1)
        following[(ends - 1)[self.face_counts > 0]] = (ends - self.face_counts)[self.face_counts > 0]
        sides = np.stack([self.face_indices, self.face_indices[following]], axis=1)
        return np.unique(np.sort(sides[np.repeat(inside, self.face_counts)], axis=1), axis=0)


def read_topology(mesh: UsdGeom.Mesh, vertex_count: int) -> Topology:
    counts, indices = map(_read, (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()))
    negative = np.flatnonzero(counts < 0)
    if negative.size:
        raise Fault(f"face {negative[0]} has {counts[negative[0]]} vertices")
    if counts.sum(dtype=np.int64) != len(indices):
        total = counts.sum(dtype=np.int64)
        raise Fault(f"faceVertexCounts add up to {total}, but faceVertexIndices has {len(indices)} values")
    outside = np.flatnonzero((indices < 0) | (indices >= vertex_count))
    if outside.size:
        face = np.searchsorted(np.cumsum(counts), outside[0], side="right")
        raise Fault(f"face {face} has point {indices[outside[0]]}, but the mesh has {vertex_count} points")
    return Topology(counts, indices, vertex_count)


def _read(attr: Usd.Attribute) -> np.ndarray:
    value = unchanging(attr, attr.GetName())
    found = integers([] if value is None else value, attr.GetName())
    if not found.size:
        raise Fault(f"{attr.GetName()} has no value")
    return found
