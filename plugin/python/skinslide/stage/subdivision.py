"""How a mesh on a stage is subdivided: scheme, creases, corners, holes and rules, as UsdGeomMesh has them."""

from __future__ import annotations

from pxr import Usd, UsdGeom

from skinslide.arrays.native import Subdivision, tokens
from skinslide.problems import Fault
from skinslide.stage.values import floats, integers, unchanging


def read_subdivision(mesh: UsdGeom.Mesh) -> Subdivision | None:
    """None where the mesh renders as its faces. The core checks how the arrays fit each other and the mesh."""
    scheme = _token(mesh.GetSubdivisionSchemeAttr(), "scheme")
    if scheme == "none":
        return None
    return Subdivision(
        scheme=scheme,
        boundary_rule=_token(mesh.GetInterpolateBoundaryAttr(), "boundary_rule"),
        triangle_rule=_token(mesh.GetTriangleSubdivisionRuleAttr(), "triangle_rule"),
        crease_lengths=_array(mesh.GetCreaseLengthsAttr(), integers),
        crease_indices=_array(mesh.GetCreaseIndicesAttr(), integers),
        crease_sharpnesses=_array(mesh.GetCreaseSharpnessesAttr(), floats),
        corner_indices=_array(mesh.GetCornerIndicesAttr(), integers),
        corner_sharpnesses=_array(mesh.GetCornerSharpnessesAttr(), floats),
        hole_indices=_array(mesh.GetHoleIndicesAttr(), integers),
    )


def _token(attr: Usd.Attribute, setting: str) -> str:
    found, allowed = unchanging(attr, attr.GetName()), tokens(setting)
    if found not in allowed:
        raise Fault(f"{attr.GetName()} is {str(found)!r}; it must be one of {', '.join(allowed)}")
    return str(found)


def _array(attr: Usd.Attribute, convert):
    value = unchanging(attr, attr.GetName())
    return None if value is None or not len(value) else convert(value, attr.GetName())
