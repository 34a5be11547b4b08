"""Which faces of a mesh a patch is made of."""

from __future__ import annotations

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from skinslide.problems import Fault, frame_text
from skinslide.stage import schema
from skinslide.stage.topology import Topology
from skinslide.stage.values import FIRST, check_length, flattened, integers, primvar_sources, unchanging

TYPES = {"bool[]", "int[]", "float[]"}


def read_faces(prim: Usd.Prim, patch: str, topology: Topology) -> np.ndarray:
    """The faces of a patch, int32, ascending: of its primvar, else of the GeomSubset child of its name."""
    primvar = schema.primvar(prim, patch, "patch")
    if primvar and primvar.HasAuthoredValue():
        faces = primvar_faces(primvar, topology)
        _check_still(primvar, faces, topology)
        return faces
    child = prim.GetChild(patch) if Sdf.Path.IsValidIdentifier(patch) else None
    if not child:
        wanted = f"primvars:{schema.property_name(patch, 'patch')}"
        raise Fault(f"has no faces: there is neither {wanted} nor a GeomSubset {patch} under the mesh")
    return subset_faces(child, topology)


def primvar_faces(primvar: UsdGeom.Primvar, topology: Topology, time: Usd.TimeCode = FIRST) -> np.ndarray:
    """The faces that a primvar chooses: those with a value > 0 (uniform) or with points that all have one (vertex)."""
    name, interpolation = primvar.GetName(), primvar.GetInterpolation()
    if str(primvar.GetTypeName()) not in TYPES:
        raise Fault(f"{name} is {primvar.GetTypeName()}; it must be bool[], int[] or float[]")
    if interpolation not in (UsdGeom.Tokens.uniform, UsdGeom.Tokens.vertex):
        raise Fault(f"{name} has interpolation {interpolation}; it must be uniform (by face) or vertex")
    values = flattened(primvar, time)
    if values is None:
        raise Fault(f"{name} has no value")
    values = np.asarray(values)
    by_face = interpolation == UsdGeom.Tokens.uniform
    check_length(name, len(values), *((topology.face_count, "faces") if by_face else (topology.vertex_count, "points")))
    chosen = _positive(values, name)
    faces = np.flatnonzero(chosen if by_face else topology.faces_within(chosen)).astype(np.int32)
    if not faces.size:
        raise Fault(f"has no faces: {name} is above 0 {'on no face' if by_face else 'on all points of no face'}")
    return faces


def _positive(values: np.ndarray, name: str) -> np.ndarray:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise Fault(f"{name}[{bad[0]}] is {values[bad[0]]}")
    return values > 0


def _check_still(primvar: UsdGeom.Primvar, faces: np.ndarray, topology: Topology) -> None:
    """Values may vary where the faces do not, as those of a mesh that some tool resampled."""
    if not primvar.ValueMightBeTimeVarying():
        return
    for source in primvar_sources(primvar):
        for time in source.GetTimeSamples() if source else ():
            if not np.array_equal(primvar_faces(primvar, topology, Usd.TimeCode(time)), faces):
                raise Fault(f"{primvar.GetName()} chooses other faces at frame {frame_text(time)}; patches are fixed")


def subset_faces(child: Usd.Prim, topology: Topology) -> np.ndarray:
    """The faces of a GeomSubset, int32, ascending."""
    path = child.GetPath()
    if not child.IsA(UsdGeom.Subset):
        raise Fault(f"has no faces: {path} is a {child.GetTypeName() or 'prim without a type'}, not a GeomSubset")
    subset = UsdGeom.Subset(child)
    element = subset.GetElementTypeAttr().Get()
    if element != UsdGeom.Tokens.face:
        raise Fault(f"the GeomSubset {path} has elementType {element}; it must be face")
    value = unchanging(subset.GetIndicesAttr(), f"{path}.indices")
    faces = np.unique(integers([] if value is None else value, f"{path}.indices"))
    if not faces.size:
        raise Fault(f"has no faces: the GeomSubset {path} is empty")
    outside = faces[(faces < 0) | (faces >= topology.face_count)]
    if outside.size:
        raise Fault(f"the GeomSubset {path} has face {outside[0]}, but the mesh has {topology.face_count} faces")
    return faces
