"""How the points of a mesh make faces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from skinslide.arrays.meaning import MeshMeaning


@dataclass(frozen=True)
class Topology:
    """Counts and indices as UsdGeomMesh has them, which fit each other and the number of points."""

    face_counts: np.ndarray  # (F,) int32
    face_indices: np.ndarray  # (sum of counts,) int32
    vertex_count: int

    @classmethod
    def of(cls, mesh: MeshMeaning) -> Topology:
        return cls(mesh.face_counts, mesh.face_indices, mesh.shape.vertex_count)

    @property
    def face_count(self) -> int:
        return len(self.face_counts)

    def vertices_of(self, faces: np.ndarray) -> np.ndarray:
        """The vertices, bool (V,), of some faces (n,)."""
        inside = np.zeros(self.face_count, dtype=bool)
        inside[faces] = True
        vertices = np.zeros(self.vertex_count, dtype=bool)
        vertices[self.face_indices[np.repeat(inside, self.face_counts)]] = True
        return vertices

    def faces_of_any(self, vertices: np.ndarray) -> np.ndarray:
        """The faces, bool (F,), with any of some vertices, bool (V,)."""
        return self._count(vertices) > 0

    def faces_of_all(self, vertices: np.ndarray) -> np.ndarray:
        """The faces, bool (F,), all of whose vertices are among some, bool (V,)."""
        return self._count(~vertices) == 0

    def _count(self, vertices: np.ndarray) -> np.ndarray:
        """How many of some vertices each face has."""
        faces = np.repeat(np.arange(self.face_count), self.face_counts)
        return np.bincount(faces, vertices[self.face_indices], self.face_count)

    def edges_of(self, faces: np.ndarray) -> np.ndarray:
        """The edges of some faces (n,), int32 (k, 2), each once, the lower vertex first, ascending."""
        inside = np.zeros(self.face_count, dtype=bool)
        inside[faces] = True
        ends = np.cumsum(self.face_counts)
        following = np.arange(1, len(self.face_indices) + 1)
        following[(ends - 1)[self.face_counts > 0]] = (ends - self.face_counts)[self.face_counts > 0]
        sides = np.stack([self.face_indices, self.face_indices[following]], axis=1)
        return np.unique(np.sort(sides[np.repeat(inside, self.face_counts)], axis=1), axis=0)
