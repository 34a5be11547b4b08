"""Fills the structs of the public headers from numpy arrays.

Fields and enums are read from the declarations; only what C cannot see, the lengths of arrays, is checked here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi
from skinslide.arrays.checks import all_of, as_array, check_count, check_kind, encoded_name, indices_of, real
from skinslide.arrays.native import enum_value, new, new_array
from skinslide.arrays.setups import Controls, PatchSetup, Sample, Subdivision
from skinslide.problems import SliderError

_CTYPES: dict[type, str] = {
    np.int32: "int32_t[]",
    np.float32: "float[]",
    np.float64: "double[]",
    np.bool_: "uint8_t[]",
    np.uint8: "uint8_t[]",
}
_SUBDIVISION_ARRAYS = {
    "crease_lengths": np.int32,
    "crease_indices": np.int32,
    "crease_sharpnesses": np.float32,
    "corner_indices": np.int32,
    "corner_sharpnesses": np.float32,
    "hole_indices": np.int32,
}


class Sizes(NamedTuple):
    """How many vertices and faces a mesh has."""

    vertices: int
    faces: int


class Arguments:
    """Fills the core's structs from arrays, and holds the memory they point into for as long as this object lives."""

    def __init__(self) -> None:
        self._alive: list[Any] = []

    def pointer(self, values: Any, dtype: type, shape: tuple[int, ...], what: str) -> Any:
        """A pointer to values as a contiguous array of that type and shape; -1 in the shape is any length."""
        buffer = ffi.from_buffer(_CTYPES[dtype], as_array(values, dtype, shape, what))
        self._alive.append(buffer)
        return buffer

    def optional(self, values: Any, dtype: type, shape: tuple[int, ...], what: str) -> Any:
        return ffi.NULL if values is None else self.pointer(values, dtype, shape, what)

    def points(self, values: Any, vertex_count: int, what: str) -> Any:
        return self.pointer(values, np.float32, (vertex_count, 3), what)

    def mesh(
        self,
        face_counts: Any,
        face_indices: Any,
        points: Any,
        subdivision: Subdivision | None = None,
        weld: Any = None,
        space: Any = None,
    ) -> Any:
        mesh = new("mesh")
        self._alive.append(mesh)
        mesh.face_counts = self.pointer(face_counts, np.int32, (-1,), "face counts")
        mesh.face_indices = self.pointer(face_indices, np.int32, (-1,), "face indices")
        mesh.rest_points = self.points(points, -1, "points")
        mesh.face_count, mesh.index_count, mesh.vertex_count = len(face_counts), len(face_indices), len(points)
        if subdivision is not None:
            mesh.subdivision = self.subdivision(subdivision)
        mesh.weld = self.optional(weld, np.int32, (len(points),), "weld")
        mesh.space = self.optional(space, np.float64, (3, 3), "space")
        return mesh[0]

    def subdivision(self, given: Subdivision) -> Any:
        check_kind("subdivision", given, Subdivision)
        target = new("subdivision")
        self._alive.append(target)
        for setting in ("scheme", "boundary_rule", "triangle_rule"):
            setattr(target, setting, enum_value(setting, getattr(given, setting), ""))
        for name, dtype in _SUBDIVISION_ARRAYS.items():
            values = getattr(given, name)
            setattr(target, name, self.optional(values, dtype, (-1,), name.replace("_", " ")))
        sharpnesses, corners = _length(given.corner_sharpnesses), _length(given.corner_indices)
        check_count("BAD_MESH", "corner sharpnesses", (sharpnesses, "values"), (corners, "corners"))
        target.crease_count, target.crease_index_count = _length(given.crease_lengths), _length(given.crease_indices)
        target.crease_sharpness_count = _length(given.crease_sharpnesses)
        target.corner_count, target.hole_count = _length(given.corner_indices), _length(given.hole_indices)
        return target

    def fill_setup(self, target: Any, patch: PatchSetup, sizes: Sizes) -> None:
        where = f"patch {patch.name}: "
        name = ffi.new("char[]", encoded_name(patch.name))
        self._alive.append(name)
        target.name = name
        faces = indices_of(patch.faces, sizes.faces, f"{where}faces")
        target.faces = self.pointer(faces, np.int32, (-1,), f"{where}faces")
        target.face_count = len(faces)
        target.corners = self.optional(patch.corners, np.int32, (4,), f"{where}corners")
        target.held = self.optional(patch.held, np.bool_, (sizes.vertices,), f"{where}held")
        for setting in ("boundary", "holes", "rule", "interpolation"):
            setattr(target, setting, enum_value(setting, getattr(patch, setting), where))
        controls = new("controls")
        self._alive.append(controls)
        check_kind(f"{where}controls", patch.controls, Controls)
        self.fill_controls(controls, patch.controls, sizes, where)
        target.controls = controls

    def fill_controls(self, target: Any, controls: Controls, sizes: Sizes, where: str) -> None:
        counts = {
            "vertex_density": sizes.vertices,
            "face_density": sizes.faces,
            "weight": sizes.vertices,
            "max_distance": sizes.vertices,
            "hold": sizes.vertices,
        }
        for name, count in counts.items():
            values = getattr(controls, name)
            setattr(target, name, self.optional(values, np.float32, (count,), where + name.replace("_", " ")))
        edges, density = controls.edges, controls.edge_density
        if edges is not None and density is not None and not np.size(edges) and not np.size(density):
            edges = density = None
        if (edges is None) != (density is None):
            raise SliderError("BAD_ARGUMENT", f"{where}edges and edge density must be given together")
        target.edge_count = 0 if edges is None else len(edges)
        target.edges = self.optional(edges, np.int32, (-1, 2), f"{where}edges")
        target.edge_density = self.optional(density, np.float32, (target.edge_count,), f"{where}edge density")
        for name in ("envelope", "stretch_response", "compression_response"):
            setattr(target, name, real(getattr(controls, name), where + name.replace("_", " ")))

    def frame_controls(self, controls: Sequence[Controls] | None, names: tuple[str, ...], sizes: Sizes) -> Any:
        if controls is None:
            return ffi.NULL
        controls = all_of("controls", controls, Controls)
        check_count("BAD_ARGUMENT", "controls", (len(controls), "given"), (len(names), "patches"))
        targets = new_array("controls", len(names))
        self._alive.append(targets)
        for target, patch, name in zip(targets, controls, names, strict=True):
            self.fill_controls(target, patch, sizes, f"patch {name}: ")
        return targets

    def samples(self, samples: Sequence[Sample], count: int, vertex_count: int, what: str) -> Any:
        given = all_of("samples", samples, Sample)
        if len(given) != count:
            raise SliderError("BAD_ARGUMENT", f"{what} need {count} samples, not {len(given)}")
        targets = new_array("sample", count)
        for target, sample in zip(targets, given, strict=True):
            target.seconds = real(sample.seconds, "seconds")
            target.cached = self.points(sample.cached, vertex_count, "cached")
            target.slid = self.points(sample.slid, vertex_count, "slid")
        return targets


def _length(values: Any) -> int:
    return 0 if values is None else len(values)
