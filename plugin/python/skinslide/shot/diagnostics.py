"""What a slide did to skin, as primvars beside the points: to be looked at, and for shaders to draw wrinkles by."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.fetched import Value
from skinslide.arrays.strain import Rest, Strain, measure_strain
from skinslide.problems import Fault, Problem, StageProblems
from skinslide.shot.products import SlidFrame
from skinslide.stage import schema
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST, primvar_source

_ST = "primvars:st"


class Primvar(NamedTuple):
    """What is written under a name, and where it comes from: a field of Diagnostics or of Strain."""

    name: str
    field: str
    kind: Sdf.ValueTypeName = Sdf.ValueTypeNames.FloatArray
    interpolation: str = UsdGeom.Tokens.vertex


PRIMVARS = (
    Primvar(schema.STRETCH, "stretch_after"),
    Primvar(schema.SLIDE, "slide"),
    Primvar(schema.LARGEST, "largest"),
    Primvar(schema.SMALLEST, "smallest"),
    Primvar(schema.AREA, "area_ratio"),
    Primvar(schema.DIRECTION, "direction", Sdf.ValueTypeNames.Float2Array, UsdGeom.Tokens.faceVarying),
)


def texture_coordinates(mesh: PatchedMesh, st: str = _ST) -> Value | None:
    """Those in which directions are measured, as authored. Raises Fault."""
    return primvar_source(mesh.prim, st).at(FIRST)


class MeshStrain:
    """Measures poses of a mesh by the faces of its patches."""

    def __init__(self, mesh: PatchedMesh, st: str = _ST):
        """Raises Fault for texture coordinates that cannot be; without any there are no directions."""
        value = texture_coordinates(mesh, st)
        corners = None if value is None else mesh.meaning.coordinates(value)
        self._rest = Rest(mesh.face_counts, mesh.face_indices, mesh.rest_points, mesh.weld.vertices, corners)
        self._faces = np.unique(np.concatenate([patch.faces for patch in mesh.patches])).astype(np.int32)

    def of(self, points: np.ndarray) -> Strain:
        """Of a pose (V, 3). Raises SliderError."""
        return measure_strain(self._rest, self._faces, points)


class MeshDiagnostics:
    """The primvars of one mesh."""

    def __init__(self, mesh: PatchedMesh):
        """Raises StageProblems where the stage has something else under their names, or bad texture coordinates."""
        found = list(_others(mesh.prim))
        if found:
            raise StageProblems(found)
        try:
            self._mesh, self._strain = mesh, MeshStrain(mesh)
        except Fault as fault:
            raise StageProblems([mesh.problem(str(fault), FIRST)]) from fault

    def values(self, frame: SlidFrame) -> list[tuple[Primvar, Vt.FloatArray | Vt.Vec2fArray]]:
        """Of a frame, those that there are. Raises SliderError."""
        fields = {**frame.measured()._asdict(), **self._strain.of(self._mesh.drawn_points(frame.slid))._asdict()}
        written = [(primvar, fields[primvar.field]) for primvar in PRIMVARS]
        return [(primvar, _as_usd(values)) for primvar, values in written if values is not None]

    def indices(self) -> list[Usd.Attribute]:
        """Those of primvars that the stage has under the names: they would choose among the values that are written."""
        attributes = (self._mesh.prim.GetAttribute(primvar.name) for primvar in PRIMVARS)
        primvars = [UsdGeom.Primvar(attribute) for attribute in attributes if attribute]
        return [primvar.GetIndicesAttr() for primvar in primvars if primvar.IsIndexed()]


def _as_usd(values: np.ndarray) -> Vt.FloatArray | Vt.Vec2fArray:
    return (Vt.FloatArray if values.ndim == 1 else Vt.Vec2fArray).FromNumpy(values)


def _others(prim: Usd.Prim) -> Iterator[Problem]:
    """Errors for what the stage has under the names that is something else."""
    for primvar in PRIMVARS:
        other = _what_else(prim.GetProperty(primvar.name), primvar) if prim.HasProperty(primvar.name) else None
        if other:
            each = "corner" if primvar.interpolation == UsdGeom.Tokens.faceVarying else "vertex"
            written = f"a bake with diagnostics writes {primvar.kind} there, one a {each}"
            yield Problem("error", str(prim.GetPath()), None, None, f"{primvar.name} is {other}; {written}")


def _what_else(found: Usd.Property, primvar: Primvar) -> str | None:
    """What a property is, other than a primvar of such a value for each element."""
    if not isinstance(found, Usd.Attribute):
        return "a relationship"
    if found.GetTypeName() != primvar.kind:
        return str(found.GetTypeName())
    size = UsdGeom.Primvar(found).GetElementSize()
    return None if size == 1 else f"of elementSize {size}"
