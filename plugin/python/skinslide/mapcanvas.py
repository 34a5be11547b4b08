"""Maps drawn offscreen in texture coordinates, on numpy arrays: no USD, no files. The manual is `picture.h`."""

from __future__ import annotations

import numpy as np

from skinslide._core import ffi, lib
from skinslide.images import Corners
from skinslide.native import Arguments, call, device_number, writable

FIRST_TILE = 1001


class MapCanvas:
    """What maps are drawn on, `side` texels a side, for one thread at a time."""

    def __init__(self, side: int, device: int | None = None):
        out = ffi.new("skinslide_map_canvas **")
        wanted = min(side, 2**31 - 1)
        call(lib.skinslide_map_canvas_create, wanted, device_number(device), out)
        self._handle = ffi.gc(out[0], lib.skinslide_map_canvas_destroy)
        self.side = side

    def draw(self, corners: Corners, values: np.ndarray, tile: int = FIRST_TILE) -> tuple[np.ndarray, int]:
        """Values (V,) over a tile, float32 (side, side) from the top row on, and how many faces it misses."""
        native, charts = Arguments(), ffi.new("skinslide_charts *")
        # Points are not read.
        points = np.zeros((corners.vertex_count, 3), np.float32)
        mesh = native.mesh(corners.face_counts, corners.face_indices, points)
        charts.mesh = ffi.addressof(mesh)
        charts.faces, charts.face_count = native.pointer(corners.faces, np.int32, (-1,), "faces"), len(corners.faces)
        charts.st = native.pointer(corners.st, np.float32, (len(corners.face_indices), 2), "st")
        given = native.pointer(values, np.float32, (corners.vertex_count,), "values")
        texels, missed = np.empty((self.side, self.side), np.float32), ffi.new("int32_t *")
        call(lib.skinslide_map_draw, self._handle, charts, tile, given, writable("float[]", texels), missed)
        return texels, missed[0]
