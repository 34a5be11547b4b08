"""Which points of a mesh that is split at seams or corners are one, for a `Slider`. No USD here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import numpy.typing as npt

from skinslide._core import ffi, lib
from skinslide.arrays.checks import all_of, real
from skinslide.arrays.native import Handle, call, new_array, writable
from skinslide.arrays.setups import PatchSetup
from skinslide.arrays.structs import Arguments, Sizes


def find_weld(
    face_counts: npt.ArrayLike,
    face_indices: npt.ArrayLike,
    rest_points: npt.ArrayLike,
    patches: Sequence[PatchSetup],
    poses: Iterable[npt.ArrayLike] = (),
    *,
    tolerance: float = 0,
) -> np.ndarray:
    """Finds the points that are one: in one place at rest and in each pose, where faces of patches meet edge to edge.

    Args:
        face_counts: Vertices of each face (F,).
        face_indices: Vertices (sum of counts,), face by face.
        rest_points: The pose in which nothing slides (V, 3).
        patches: The set-ups, of which only the faces are read.
        poses: Points of the deformed mesh (V, 3) in all poses of the shot: points that part in any are not one.
        tolerance: The distance within which points are in one place, in the mesh's units.

    Returns:
        int32 (V,): the point that each is one with, most with themselves, as a `Slider` takes it.

    Raises:
        SliderError: The mesh, the points or the tolerance cannot be used.
    """
    native, out = Arguments(), ffi.new("skinslide_weld **")
    mesh = native.mesh(face_counts, face_indices, rest_points)
    given, sizes = all_of("patches", patches, PatchSetup), Sizes(mesh.vertex_count, mesh.face_count)
    setups = new_array("patch_setup", len(given))
    for setup, patch in zip(setups, given, strict=True):
        native.fill_setup(setup, patch, sizes)
    call(lib.skinslide_weld_create, ffi.addressof(mesh), setups, len(given), real(tolerance, "tolerance"), out)
    weld = Handle(out[0], lib.skinslide_weld_destroy)
    for number, pose in enumerate(poses):
        call(lib.skinslide_weld_show, weld.pointer, number, Arguments().points(pose, sizes.vertices, "pose"))
    vertices = np.empty(sizes.vertices, np.int32)
    call(lib.skinslide_weld_get, weld.pointer, writable("int32_t[]", vertices), ffi.NULL)
    return vertices
