"""Writes the set-up of a patch into a layer that sits on a stage."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom, Vt

from skinslide import names
from skinslide.check import CheckReport, check
from skinslide.faces import primvar_faces, subset_faces
from skinslide.files import check_not_input, check_not_read, check_output, replacing, writing
from skinslide.frames import UsageError
from skinslide.meshes import read_points
from skinslide.problems import Fault, Problem, StageError, StageProblems, errors
from skinslide.stage import EXTENSION, anchor_assets, open_stage, read_text_layer
from skinslide.topology import Topology, read_topology
from skinslide.values import FIRST

EXTENSIONS = (EXTENSION, ".usda", ".usdc", ".usd")
# Fields of a root layer that say what is in that layer, not how the stage is to be read.
OWN_FIELDS = {"subLayers", "subLayerOffsets", "primChildren", "comment", "documentation", "customLayerData"}
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
    stage_path, output = Path(stage_path), Path(output_path)
    _check_arguments(stage_path, output, prim, patch, [faces, subset, primvar])
    layer = _starting_layer(stage_path, output, force)
    stage = _composed(layer, output)
    mesh, topology = _read_mesh(stage, prim, patch)
    try:
        chosen = _choose(mesh, topology, patch, faces, subset, primvar)
    except Fault as fault:
        raise StageProblems([Problem("error", prim, patch, None, str(fault))]) from fault
    _author(layer, prim, patch, chosen, topology.face_count)
    stage = _composed(layer, output)
    report = check(stage, [prim])
    bad = [problem for problem in errors(report.problems) if problem.patch in (patch, None)]
    if bad:
        raise StageProblems(bad)
    check_not_read(output, stage)
    _write(layer, output)
    return replace(report, stage=str(output))


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


def _check_arguments(stage: Path, output: Path, prim: str, patch: str, sources: list[str | None]) -> None:
    if sum(source is not None for source in sources) != 1:
        raise UsageError("one of faces, subset and primvar is needed")
    if stage.suffix == EXTENSION:
        raise UsageError(f"{stage} is a set-up itself; give the stage that it sits on, and it as output to add to it")
    check_output(output, EXTENSIONS)
    if not Sdf.Path.IsValidNamespacedIdentifier(patch) or patch.split(":")[0] in names.NOT_PATCHES:
        raise UsageError(f"{patch!r} cannot name a patch; use letters, digits and _, such as elbow_L")
    if not (Sdf.Path.IsValidPathString(prim) and Sdf.Path(prim).IsAbsolutePath() and Sdf.Path(prim).IsPrimPath()):
        raise UsageError(f"{prim!r} is not the path of a prim, such as /World/char/geo/body_GEO")


def _starting_layer(stage_path: Path, output: Path, force: bool) -> Sdf.Layer:
    """The layer at `output`, where it sits on the stage, else a new one; anonymous, with asset paths as in the file."""
    stage = open_stage(stage_path)
    check_not_input(output, stage, stage_path)
    if output.exists() and not force:
        layer = _existing_layer(output)
        sublayers = [Path(output.absolute().parent, path) for path in layer.subLayerPaths]
        if not any(path.exists() and path.samefile(stage_path) for path in sublayers):
            raise UsageError(f"output {output}: exists and does not sublayer {stage_path}; --force replaces it")
        return layer
    return _new_layer(stage, stage_path, output)


def _existing_layer(output: Path) -> Sdf.Layer:
    try:
        layer = read_text_layer(output) if output.suffix == EXTENSION else Sdf.Layer.OpenAsAnonymous(str(output))
    except (Tf.ErrorException, OSError, UnicodeDecodeError, StageError) as error:
        raise UsageError(f"output {output}: exists and is not a layer; --force replaces it") from error
    return layer


def _new_layer(stage: Usd.Stage, stage_path: Path, output: Path) -> Sdf.Layer:
    """A layer that sublayers the stage and is read with the same units, time and default prim."""
    layer, root = Sdf.Layer.CreateAnonymous(".usda"), stage.GetRootLayer().pseudoRoot
    for field in set(root.ListInfoKeys()) - OWN_FIELDS:
        layer.pseudoRoot.SetInfo(field, root.GetInfo(field))
    # Without these a layer counts as 24, whatever it sublayers, and its sublayers' times are scaled to that.
    layer.timeCodesPerSecond, layer.framesPerSecond = stage.GetTimeCodesPerSecond(), stage.GetFramesPerSecond()
    layer.subLayerPaths.append(_asset_path(stage_path, output))
    return layer


def _asset_path(stage_path: Path, output: Path) -> str:
    relative = os.path.relpath(stage_path.resolve(), output.resolve().parent)
    return relative if relative.startswith("..") else f"./{relative}"


def _composed(layer: Sdf.Layer, output: Path) -> Usd.Stage:
    """The stage that the layer will be once it is written to `output`."""
    copy = Sdf.Layer.CreateAnonymous(".usda")
    copy.TransferContent(layer)
    anchor_assets(copy, output)
    return Usd.Stage.Open(copy)


def _read_mesh(stage: Usd.Stage, path: str, patch: str) -> tuple[Usd.Prim, Topology]:
    prim = stage.GetPrimAtPath(path)
    try:
        if not prim:
            raise Fault("there is no such prim")
        if not prim.IsA(UsdGeom.Mesh):
            raise Fault(f"is a {prim.GetTypeName() or 'prim without a type'}, not a Mesh")
        return prim, read_topology(UsdGeom.Mesh(prim), len(read_points(prim, FIRST)))
    except Fault as fault:
        raise StageProblems([Problem("error", path, patch, None, str(fault))]) from fault


def _choose(
    prim: Usd.Prim, topology: Topology, patch: str, faces: str | None, subset: str | None, primvar: str | None
) -> np.ndarray | None:
    """The faces to write, or None where the patch finds them by itself."""
    own = names.primvar(prim, patch, "patch")
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


def _author(layer: Sdf.Layer, prim: str, patch: str, faces: np.ndarray | None, face_count: int) -> None:
    """Applies the schema and writes the faces, as opinions of the layer."""
    spec = Sdf.CreatePrimInLayer(layer, prim)
    applied = spec.GetInfo("apiSchemas") or Sdf.TokenListOp()
    name = f"{names.SCHEMA}:{patch}"
    if applied.isExplicit:
        applied.explicitItems = [*(item for item in applied.explicitItems if item != name), name]
    else:
        applied.prependedItems = [*(item for item in applied.prependedItems if item != name), name]
        applied.deletedItems = [item for item in applied.deletedItems if item != name]
    spec.SetInfo("apiSchemas", applied)
    if faces is None:
        return
    property_name = f"primvars:{names.property_name(patch, 'patch')}"
    if property_name in spec.properties:
        del spec.properties[property_name]
    values = np.zeros(face_count, dtype=bool)
    values[faces] = True
    attr = Sdf.AttributeSpec(spec, property_name, Sdf.ValueTypeNames.BoolArray)
    attr.default = Vt.BoolArray.FromNumpy(values)
    attr.SetInfo("interpolation", UsdGeom.Tokens.uniform)


def _write(layer: Sdf.Layer, output: Path) -> None:
    """Puts the layer in place in one step."""
    with replacing(output) as partial, writing(output):
        if partial.suffix == EXTENSION:
            partial.write_text(layer.ExportToString(), encoding="utf-8")
        elif not layer.Export(str(partial)):
            raise OSError("USD could not save it")
