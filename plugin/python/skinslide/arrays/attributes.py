"""What a cache holds beside points and follows from them: vectors that the skin carries, boxes, rates of change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.checks import as_array
from skinslide.arrays.native import call, enum_value, writable
from skinslide.arrays.setups import Sample
from skinslide.arrays.structs import Arguments


def carry(
    face_counts: np.ndarray, face_indices: np.ndarray, turns: np.ndarray, vectors: np.ndarray, interpolation: str
) -> np.ndarray:
    """The cache's normals, tangents or other vectors on the skin, turned as a frame's skin turned.

    Args:
        face_counts: Vertices of each face (F,).
        face_indices: Vertices (sum of counts,), face by face.
        turns: Of the frame (V, 3): axis times the sine of half the angle.
        vectors: The cache's (n, 3).
        interpolation: Which elements have one: vertex, varying, faceVarying or uniform.

    Returns:
        float32 (n, 3); those that do not turn keep their bits.
    """
    native = Arguments()
    mesh = native.mesh(face_counts, face_indices, turns)
    # On a mesh, varying values sit on the vertices.
    layout = enum_value("normals_layout", "vertex" if interpolation == "varying" else interpolation, "")
    sizes = {
        lib.SKINSLIDE_NORMALS_VERTEX: mesh.vertex_count,
        lib.SKINSLIDE_NORMALS_FACE_VARYING: mesh.index_count,
        lib.SKINSLIDE_NORMALS_UNIFORM: mesh.face_count,
    }
    result = as_array(vectors, np.float32, (sizes[layout], 3), "vectors").copy()
    call(lib.skinslide_carry, ffi.addressof(mesh), mesh.rest_points, layout, writable("float[]", result))
    return result


def extent(points: np.ndarray) -> np.ndarray:
    """The box around points (V, 3): float32 (2, 3), the least of each coordinate, then the largest."""
    box = np.empty((2, 3), np.float32)
    call(lib.skinslide_extent, Arguments().points(points, -1, "points"), len(points), writable("float[]", box))
    return box


def velocities(samples: Sequence[Sample], velocities: np.ndarray) -> np.ndarray:
    """The cache's velocities (V, 3), units per second, corrected by the rate of change over two samples."""
    return _rates(lib.skinslide_velocities, 2, samples, velocities, "velocities")


def accelerations(samples: Sequence[Sample], accelerations: np.ndarray) -> np.ndarray:
    """The cache's accelerations (V, 3), units per second squared, corrected by the second difference over three."""
    return _rates(lib.skinslide_accelerations, 3, samples, accelerations, "accelerations")


def _rates(function: Any, sample_count: int, samples: Sequence[Sample], rates: np.ndarray, what: str) -> np.ndarray:
    native = Arguments()
    vertex_count = len(samples[0].cached) if samples else 0
    given = native.samples(samples, sample_count, vertex_count, what)
    result = as_array(rates, np.float32, (vertex_count, 3), what).copy()
    call(function, vertex_count, given, writable("float[]", result))
    return result
