"""The rest points of a mesh: the pose in which nothing slides."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.problems import Fault
from skinslide.stage import schema
from skinslide.stage.values import FIRST, flattened, positions

PRIMVARS = ("rest", "pref", "Pref", "__Pref")


def read_rest(prim: Usd.Prim, vertex_count: int) -> tuple[np.ndarray, str]:
    """Rest points, float32 (V, 3), and where they were found."""
    value, source = _find(prim)
    if value is None:
        raise Fault(
            "has no rest points: points has samples but no default value, so author the rest pose as "
            f"{schema.REST_POINTS} or primvars:rest (point3f[], vertex)"
        )
    rest = positions(value, source)
    if len(rest) != vertex_count:
        raise Fault(f"rest points: {source} has {len(rest)} values, but points has {vertex_count}")
    bad = np.flatnonzero(~np.isfinite(rest).all(axis=1))
    if bad.size:
        raise Fault(f"rest points: {source}[{bad[0]}] is {tuple(rest[bad[0]].tolist())}")
    return rest, source


def _find(prim: Usd.Prim):
    attr = prim.GetAttribute(schema.REST_POINTS)
    if attr and attr.HasAuthoredValue():
        return attr.Get(FIRST), schema.REST_POINTS
    for name in PRIMVARS:
        primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar(name)
        if primvar and primvar.HasAuthoredValue():
            interpolation = primvar.GetInterpolation()
            if interpolation not in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying):
                raise Fault(f"rest points: {primvar.GetName()} has interpolation {interpolation}; it must be vertex")
            return flattened(primvar, FIRST), primvar.GetName()
    return UsdGeom.Mesh(prim).GetPointsAttr().Get(Usd.TimeCode.Default()), "points (default)"
