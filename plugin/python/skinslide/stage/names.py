"""What is at a name that was given, and where that is nothing, what there is: a name may be misspelt."""

from __future__ import annotations

from pxr import Usd, UsdGeom

from skinslide.arrays.schema import phrase
from skinslide.problems import NO_SUCH_PRIM, Fault, in_place_of
from skinslide.stage import schema

_PAINT = ("bool[]", "int[]", "float[]")
_BY_ELEMENT = (UsdGeom.Tokens.uniform, UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying)


def prim_of_type(stage: Usd.Stage, path: str, kind: type[Usd.SchemaBase], named: str = "") -> Usd.Prim:
    """The prim at a path. Raises Fault, which begins with `named`, where there is none, or one of another type."""
    prim = stage.GetPrimAtPath(path) if path.startswith("/") else None
    if not prim:
        raise Fault(named + no_such_prim(stage, path, kind))
    if not prim.IsA(kind):
        other = f"is a {prim.GetTypeName() or phrase('no_type')}, not a {kind.__name__}"
        raise Fault(f"{named}{other}; {_of_kind(stage, path, kind)}")
    return prim


def no_such_prim(stage: Usd.Stage, path: str, kind: type[Usd.SchemaBase] = UsdGeom.Mesh) -> str:
    """What to say of a path that leads nowhere, with the prims of the kind that there are."""
    return f"{NO_SUCH_PRIM}; {_of_kind(stage, path, kind)}"


def _of_kind(stage: Usd.Stage, path: str, kind: type[Usd.SchemaBase]) -> str:
    prims = Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsDefined))
    there = [str(prim.GetPath()) for prim in prims if prim.IsA(kind)]
    return f"of type {kind.__name__} {in_place_of(path, there)}"


def subset_names(prim: Usd.Prim) -> list[str]:
    """Those of the GeomSubsets under a mesh."""
    return [child.GetName() for child in prim.GetChildren() if child.IsA(UsdGeom.Subset)]


def primvar_names(prim: Usd.Prim) -> list[str]:
    """Those of the primvars of a mesh that can be painted by; neither skinslide's own nor UsdSkel's."""
    primvars = UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues()
    return [each.GetPrimvarName() for each in primvars if _is_paint(each)]


def _is_paint(primvar: UsdGeom.Primvar) -> bool:
    own = not primvar.GetPrimvarName().startswith(("skel:", f"{schema.NAMESPACE}:"))
    return own and str(primvar.GetTypeName()) in _PAINT and primvar.GetInterpolation() in _BY_ELEMENT
