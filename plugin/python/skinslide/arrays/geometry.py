"""What painting needs of a mesh's geometry, on numpy arrays: no USD here. The manual is `paint.h`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.native import call, enum_value, new, writable
from skinslide.arrays.structs import Arguments

AXES = ("x", "y", "z")


class Curves(NamedTuple):
    """Curves as UsdGeomBasisCurves has them."""

    vertex_counts: np.ndarray  # (n,)
    points: np.ndarray  # (sum of counts, 3)
    basis: str = "linear"  # linear, bezier, bspline or catmullRom
    wrap: str = "nonperiodic"  # nonperiodic, periodic or pinned
    to_mesh: np.ndarray | None = None  # (4, 4), takes points, as rows, to the mesh's object space


def edge_distances(points: np.ndarray, edges: np.ndarray, curves: Curves, direction: str = "any") -> np.ndarray:
    """How far the middle of each edge (n, 2) of a mesh with points (V, 3) is from the nearest curve: float64 (n,).

    direction  "along": at 45 degrees or less to the curve; "across": at more; or "any". Edges that do not run in it are
               infinitely far
    """
    native, given, distances = Arguments(), new("curves"), np.empty(len(edges))
    given.curve_count, given.point_count = len(curves.vertex_counts), len(curves.points)
    given.vertex_counts = native.pointer(curves.vertex_counts, np.int32, (-1,), "curve vertex counts")
    given.points = native.points(curves.points, -1, "curve points")
    given.basis = enum_value("curve_basis", curves.basis, "")
    given.wrap = enum_value("curve_wrap", curves.wrap, "")
    if curves.to_mesh is not None:
        given.to_mesh = native.pointer(curves.to_mesh, np.float64, (4, 4), "curves' matrix")
    own, pairs = native.points(points, -1, "points"), native.pointer(edges, np.int32, (-1, 2), "edges")
    way, out = enum_value("direction", direction, ""), writable("double[]", distances)
    call(lib.skinslide_edge_distances, own, len(points), pairs, len(edges), given, way, out)
    return distances


class Mirrored(NamedTuple):
    faces: np.ndarray  # (n,) int32, of each face asked for
    vertices: np.ndarray  # (V,) int32, -1 for vertices of none of the faces


def _across(native: Arguments, mesh: Any, faces: np.ndarray, plane: tuple[str, float, float | None]) -> tuple[Any, ...]:
    """What mirroring of either kind is given: the mesh, the plane and how near, and the faces."""
    axis, place, tolerance = plane
    options = new("mirror_options")
    options.axis, options.plane = AXES.index(axis), place
    if tolerance is not None:
        options.tolerance = tolerance
    return ffi.addressof(mesh), options, native.pointer(faces, np.int32, (-1,), "faces"), len(faces)


def mirror_faces(
    face_counts: np.ndarray,
    face_indices: np.ndarray,
    rest_points: np.ndarray,
    faces: np.ndarray,
    *,
    axis: str = "x",
    plane: float = 0.0,
    tolerance: float | None = None,
) -> Mirrored:
    """The faces and vertices on the other side of a mesh that is symmetric about the plane where `axis` is `plane`.

    Points may be within `tolerance` of their mirror images; None: 1e-4 of the mesh's largest extent.
    """
    native = Arguments()
    mesh = native.mesh(face_counts, face_indices, rest_points)
    found = Mirrored(np.empty(len(faces), np.int32), np.empty(len(rest_points), np.int32))
    call(
        lib.skinslide_mirror,
        *_across(native, mesh, faces, (axis, plane, tolerance)),
        writable("int32_t[]", found.faces),
        writable("int32_t[]", found.vertices),
    )
    return found


class Nearest(NamedTuple):
    face_sources: np.ndarray  # (F,) int32, of each face found the one of `faces` that it is nearest to; -1 for others
    vertex_sources: np.ndarray  # (V,) int32, of each vertex of those the one nearest to its mirror image; else -1
    worst: float  # the largest distance of a mirror image from the mesh


def mirror_nearest(
    face_counts: np.ndarray,
    face_indices: np.ndarray,
    rest_points: np.ndarray,
    faces: np.ndarray,
    *,
    axis: str = "x",
    plane: float = 0.0,
    tolerance: float | None = None,
) -> Nearest:
    """The same by nearest place, where faces are not symmetric.

    Mirror images may be within `tolerance` of the mesh.
    """
    native, worst = Arguments(), ffi.new("double *")
    mesh = native.mesh(face_counts, face_indices, rest_points)
    face_sources, vertex_sources = np.empty(len(face_counts), np.int32), np.empty(len(rest_points), np.int32)
    call(
        lib.skinslide_mirror_nearest,
        *_across(native, mesh, faces, (axis, plane, tolerance)),
        writable("int32_t[]", face_sources),
        writable("int32_t[]", vertex_sources),
        worst,
    )
    return Nearest(face_sources, vertex_sources, worst[0])


def note_stretch(
    face_counts: np.ndarray, face_indices: np.ndarray, rest_points: np.ndarray, points: np.ndarray, stretch: np.ndarray
) -> None:
    """Notes how far sides of faces are from their rest lengths in a pose (V, 3).

    stretch  in, out, float32 (sum of counts,): the largest |log(length / rest length)| in any pose so far of the side
             from each corner to the next; all 0 before the first pose
    """
    native = Arguments()
    mesh = native.mesh(face_counts, face_indices, rest_points)
    posed = native.points(points, len(rest_points), "points")
    call(lib.skinslide_note_stretch, ffi.addressof(mesh), posed, writable("float[]", stretch))


def least_stretch() -> float:
    """The |log(length / rest length)| above which a side counts as stretched."""
    return float(new("mask_options").least)


def mask_stretched(
    face_counts: np.ndarray, face_indices: np.ndarray, rest_points: np.ndarray, stretch: np.ndarray
) -> np.ndarray:
    """The faces that a patch needs so that skin may slide wherever it stretched: bool (F,)."""
    native, chosen = Arguments(), np.zeros(len(face_counts), np.uint8)
    mesh = native.mesh(face_counts, face_indices, rest_points)
    given = native.pointer(stretch, np.float32, (mesh.index_count,), "stretch")
    call(lib.skinslide_mask_stretched, ffi.addressof(mesh), given, ffi.NULL, writable("uint8_t[]", chosen))
    return chosen.astype(bool)
