"""Texture coordinates of a mesh's corners."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.problems import Fault
from skinslide.stage.topology import Topology
from skinslide.stage.values import check_length, flattened


def read_coordinates(primvar: UsdGeom.Primvar, time: Usd.TimeCode, topology: Topology) -> np.ndarray:
    """What a primvar that has a value gives each corner, float32 (sum of counts, 2)."""
    name, interpolation = primvar.GetName(), primvar.GetInterpolation()
    tokens = UsdGeom.Tokens
    by_corner = interpolation == tokens.faceVarying
    if not by_corner and interpolation not in (tokens.vertex, tokens.varying):
        raise Fault(f"{name} has interpolation {interpolation}; a map needs faceVarying, vertex or varying")
    value = flattened(primvar, time)
    found = np.asarray([] if value is None else value)
    if found.size and (found.ndim != 2 or found.shape[1] != 2 or found.dtype.kind != "f"):
        raise Fault(f"{name} is {primvar.GetTypeName()}; a map needs pairs of floats")
    expected = (len(topology.face_indices), "face corners") if by_corner else (topology.vertex_count, "points")
    check_length(name, len(found), *expected)
    with np.errstate(over="ignore"):
        st = found.astype(np.float32)
    return st if by_corner else st[topology.face_indices]
