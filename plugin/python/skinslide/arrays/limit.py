"""The limit surface of a subdivided mesh, on numpy arrays."""

from __future__ import annotations

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.checks import as_array
from skinslide.arrays.native import call, writable
from skinslide.arrays.setups import Subdivision
from skinslide.arrays.structs import Arguments


def limit_faces(face_counts: np.ndarray, face_indices: np.ndarray, subdivision: Subdivision) -> np.ndarray:
    """Which faces of a subdivided mesh have a limit surface, so that a patch of interpolation limit may have them.

    Args:
        face_counts: Vertices of each face (F,).
        face_indices: Vertices (sum of counts,), face by face.
        subdivision: How it is subdivided.

    Returns:
        bool (F,).
    """
    points = np.zeros((int(face_indices.max(initial=-1)) + 1, 3), np.float32)
    native, found = Arguments(), np.empty(len(face_counts), np.uint8)
    mesh = native.mesh(face_counts, face_indices, points, subdivision)
    call(lib.skinslide_limit_faces, ffi.addressof(mesh), writable("uint8_t[]", found))
    return found.astype(bool)


def limit_points(
    face_counts: np.ndarray,
    face_indices: np.ndarray,
    points: np.ndarray,
    subdivision: Subdivision,
    corners: np.ndarray,
    places: np.ndarray,
) -> np.ndarray:
    """Points of the limit surface of a subdivided mesh.

    A face of n vertices is n quads, one for each corner, that meet at its middle.

    Args:
        face_counts: Vertices of each face (F,).
        face_indices: Vertices (sum of counts,), face by face.
        points: Of the mesh (V, 3).
        subdivision: How it is subdivided.
        corners: Indices of face_indices (n,): which quad.
        places: In 0..1 (n, 2): along the side to the next corner, and to the one before; (1, 1) is the middle of the
            face.

    Returns:
        float32 (n, 3).
    """
    native = Arguments()
    mesh = native.mesh(face_counts, face_indices, points, subdivision)
    given = np.empty(len(corners), [("corner", np.int32), ("st", np.float32, 2)])
    given["corner"] = as_array(corners, np.int32, (-1,), "corners")
    given["st"] = as_array(places, np.float32, (len(corners), 2), "places")
    result = np.empty((len(corners), 3), np.float32)
    pointer = ffi.cast("skinslide_limit_place *", ffi.from_buffer(given))
    out = writable("float[]", result)
    call(lib.skinslide_limit_points, ffi.addressof(mesh), mesh.rest_points, pointer, len(corners), out)
    return result
