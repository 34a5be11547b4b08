"""What follows from points and is stored beside them: boxes around them, and vectors that the skin carries."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from skinslide._core import ffi, lib
from skinslide.arrays.checks import as_array
from skinslide.arrays.native import call, enum_value, writable
from skinslide.arrays.structs import Arguments


def carry(
    face_counts: npt.ArrayLike,
    face_indices: npt.ArrayLike,
    turns: npt.ArrayLike,
    vectors: npt.ArrayLike,
    interpolation: str,
) -> np.ndarray:
    """Turns the cache's normals, tangents or other vectors on the skin as a frame's skin turned.

    Args:
        face_counts: Vertices of each face (F,).
        face_indices: Vertices (sum of counts,), face by face.
        turns: Of a `Frame` (V, 3): axis times the sine of half the angle.
        vectors: The cache's (n, 3).
        interpolation: Which elements have one: vertex, varying, faceVarying or uniform.

    Returns:
        float32 (n, 3); those that do not turn keep their bits.

    Raises:
        SliderError: The arrays do not fit each other, or the interpolation is another.
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
