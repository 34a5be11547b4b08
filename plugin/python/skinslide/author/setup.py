"""Writes the set-up of a patch into a layer that sits on a stage."""

from __future__ import annotations

import os
import re

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.author.layer import SetupLayer, check_patch_name
from skinslide.problems import Fault, UsageError
from skinslide.shot.check import CheckReport
from skinslide.stage import schema
from skinslide.stage.faces import primvar_faces, subset_faces
from skinslide.stage.topology import Topology

_RANGE = re.compile(r"(\d{1,18})(?:[-:](\d{1,18}))?", re.ASCII)


def setup(
    stage_path: str | os.PathLike,
    output_path: str | os.PathLike,
    prim: str,
    patch: str,
    *,
    faces: str | None = None,
    subset: str | None = None,
    primvar: str | None = None,
    force: bool = False,
) -> CheckReport:
    """Writes a layer that sublayers the stage and applies a patch to a mesh. Returns what `check` says of that mesh.

    faces    a spec such as "0-120,140"; or else
    subset   the name of a GeomSubset under the mesh; or else
    primvar  the name of a primvar of the mesh, read as the primvar of a patch is
    force    replaces any layer at output_path; without it, one that already sits on the stage gains the patch, and
             another is an error
    Raises UsageError, StageError, and StageProblems where the patch could not be slid; nothing is written then.
    """
    if sum(source is not None for source in (faces, subset, primvar)) != 1:
        raise UsageError("one of faces, subset and primvar is needed")
    check_patch_name(patch)
    layer = SetupLayer.start(stage_path, output_path, prim, force)
    stage = layer.composed()
    mesh, topology = layer.read_mesh(stage, patch)
    try:
        chosen = _choose(mesh, topology, patch, faces, subset, primvar)
    except Fault as fault:
        raise layer.problems(patch, str(fault)) from fault
    layer.apply(patch)
    if chosen is not None:
        values = Vt.BoolArray.FromNumpy(np.isin(np.arange(topology.face_count), chosen))
        name = schema.property_name(patch, "patch")
        layer.primvar(name, Sdf.ValueTypeNames.BoolArray, UsdGeom.Tokens.uniform, values)
    return layer.finish(patch)


def parse_faces(spec: str) -> list[tuple[int, int]]:
    """The ranges, first and last face, of a comma list of faces and ranges that include both ends: 0-120,140."""
    ranges = []
    for part in spec.split(","):
        match = _RANGE.fullmatch(part.strip())
        if not match:
            raise UsageError(f"faces {spec[:40]!r}: {part[:40]!r} is neither a face nor a range such as 0-120")
        first, last = int(match[1]), int(match[2] or match[1])
        if last < first:
            raise UsageError(f"faces {spec!r}: {part!r} runs backwards")
        ranges.append((first, last))
    return ranges


def _choose(
    prim: Usd.Prim, topology: Topology, patch: str, faces: str | None, subset: str | None, primvar: str | None
) -> np.ndarray | None:
    """The faces to write, or None where the patch finds them by itself."""
    own = schema.primvar(prim, patch, "patch")
    if faces is not None:
        return _expand(parse_faces(faces), topology.face_count)
    if subset is not None:
        child = prim.GetChild(subset) if Sdf.Path.IsValidIdentifier(subset) else None
        if not child:
            raise Fault(f"there is no GeomSubset {subset} under the mesh")
        found = subset_faces(child, topology)
        return None if subset == patch and not (own and own.HasAuthoredValue()) else found
    source = UsdGeom.PrimvarsAPI(prim).GetPrimvar(primvar)
    if not source:
        raise Fault(f"there is no primvar {primvar} on the mesh")
    found = primvar_faces(source, topology)
    return None if own and source.GetName() == own.GetName() else found


def _expand(ranges: list[tuple[int, int]], face_count: int) -> np.ndarray:
    for _, last in ranges:
        if last >= face_count:
            raise Fault(f"there is no face {last}: the mesh has {face_count} faces")
    return np.unique(np.concatenate([np.arange(first, last + 1) for first, last in ranges]))
