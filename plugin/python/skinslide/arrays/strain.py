"""Stretch with its sign, on numpy arrays: no USD. The manual is `picture.h`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.native import call, new, writable
from skinslide.arrays.structs import Arguments


class Strain(NamedTuple):
    """The principal stretches of a pose: lengths over lengths at rest, 1 where nothing is stretched.

    Attributes:
        largest: In the direction that is stretched most (V,).
        smallest: Across it (V,).
        area_ratio: Area over area at rest, the product of both (V,).
        direction: Of the largest, at each corner of the mesh, in its texture coordinates (sum of face_counts, 2): cos
            2a and sin 2a with a its angle from s towards t; 0 where stretch is the same in all directions. None without
            texture coordinates.
    """

    largest: np.ndarray
    smallest: np.ndarray
    area_ratio: np.ndarray
    direction: np.ndarray | None


class Rest(NamedTuple):
    """A mesh at rest, and its texture coordinates, where it has any."""

    face_counts: np.ndarray  # (F,)
    face_indices: np.ndarray  # (sum of counts,)
    points: np.ndarray  # (V, 3)
    weld: np.ndarray | None  # (V,)
    st: np.ndarray | None  # (sum of counts, 2)


def measure_strain(rest: Rest, faces: np.ndarray, points: np.ndarray) -> Strain:
    """Measures a pose (V, 3) at the vertices of some faces (n,)."""
    native, made = Arguments(), new("strain")
    mesh = native.mesh(rest.face_counts, rest.face_indices, rest.points, None, rest.weld)
    count, corners = len(rest.points), len(rest.face_indices)
    largest, smallest, area_ratio = (np.empty(count, np.float32) for _ in range(3))
    found = Strain(largest, smallest, area_ratio, None if rest.st is None else np.empty((corners, 2), np.float32))
    for name, values in found._asdict().items():
        setattr(made, name, ffi.NULL if values is None else writable("float[]", values))
    st = native.optional(rest.st, np.float32, (corners, 2), "st")
    chosen = native.pointer(faces, np.int32, (-1,), "faces")
    pose = native.points(points, count, "points")
    call(lib.skinslide_measure_strain, ffi.addressof(mesh), st, chosen, len(faces), pose, made)
    return found
