"""OpenEXR images, and maps drawn of a mesh in its texture coordinates, on numpy arrays: no USD, no files.

The manuals are `paint.h` and `picture.h`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.native import call, enum_value, new, new_array, writable
from skinslide.arrays.structs import Arguments

FIRST_TILE = 1001
LARGEST_MAP: int = lib.SKINSLIDE_LARGEST_MAP  # texels along each side of a map drawn


class Corners(NamedTuple):
    """Some faces of a mesh of V vertices, with the texture coordinates of all its corners."""

    face_counts: np.ndarray  # (F,)
    face_indices: np.ndarray  # (sum of counts,)
    vertex_count: int
    faces: np.ndarray  # (n,)
    st: np.ndarray  # (sum of counts, 2)


def encode_exr(channels: Mapping[str, np.ndarray], wrap: str = "clamp") -> bytes:
    """An OpenEXR file of float channels, each (height, width) from the top row on."""
    native = Arguments()
    shape = next((np.shape(pixels) for pixels in channels.values()), (0, 0))
    given = new_array("channel", len(channels))
    names = [ffi.new("char[]", name.encode()) for name in channels]
    for target, name, (word, pixels) in zip(given, names, channels.items(), strict=True):
        target.name = name
        target.pixels = native.pointer(pixels, np.float32, shape if len(shape) == 2 else (-1, -1), f"channel {word}")
    out = ffi.new("skinslide_bytes **")
    call(lib.skinslide_exr_encode, given, len(channels), shape[1], shape[0], enum_value("wrap", wrap, ""), out)
    made = ffi.gc(out[0], lib.skinslide_bytes_destroy)
    return ffi.buffer(made.data, made.size)[:]


def map_tiles(corners: Corners) -> np.ndarray:
    """The UDIM tile of each corner of the mesh, int32, 0 at those of other faces."""
    native, tiles = Arguments(), np.zeros(len(corners.face_indices), np.int32)
    call(lib.skinslide_texture_tiles, layout_of(native, corners), writable("int32_t[]", tiles))
    return tiles


def draw_map(corners: Corners, values: np.ndarray, side: int, tile: int = FIRST_TILE) -> tuple[np.ndarray, int]:
    """Values by vertex (V,) over a tile, float32 (side, side) from the top row on, and how many faces have no texel."""
    native = Arguments()
    given = native.pointer(values, np.float32, (corners.vertex_count,), "values")
    texels, missed = np.empty((side, side), np.float32), ffi.new("int32_t *")
    call(lib.skinslide_map_draw, layout_of(native, corners), tile, given, side, writable("float[]", texels), missed)
    return texels, missed[0]


def draw_corner_map(corners: Corners, values: np.ndarray, side: int, tile: int = FIRST_TILE) -> np.ndarray:
    """The same of values at the corners of faces (sum of counts,)."""
    native, texels = Arguments(), np.empty((side, side), np.float32)
    given = native.pointer(values, np.float32, (len(corners.face_indices),), "values")
    layout = layout_of(native, corners)
    call(lib.skinslide_map_draw_corners, layout, tile, given, side, writable("float[]", texels), ffi.NULL)
    return texels


def layout_of(native: Arguments, corners: Corners) -> Any:
    """The core's struct of faces and their texture coordinates; points are not read."""
    layout = new("texture_layout")
    mesh = native.mesh(corners.face_counts, corners.face_indices, np.zeros((corners.vertex_count, 3), np.float32))
    layout.mesh = ffi.addressof(mesh)
    layout.faces, layout.face_count = native.pointer(corners.faces, np.int32, (-1,), "faces"), len(corners.faces)
    layout.st = native.pointer(corners.st, np.float32, (len(corners.face_indices), 2), "st")
    return layout
