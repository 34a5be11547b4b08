"""Paints force density by edge: what no DCC has a brush for."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.geometry import Curves, edges_near
from skinslide.author.layer import SetupLayer
from skinslide.problems import Fault, SliderError, UsageError
from skinslide.shot.check import CheckReport
from skinslide.stage import controls, schema
from skinslide.stage.faces import read_faces
from skinslide.stage.rest import read_rest
from skinslide.stage.topology import Topology
from skinslide.stage.values import FIRST, check_length, flattened, integers, positions, unchanging

DIRECTIONS = ("any", "along", "across")


@dataclass(frozen=True)
class PaintReport:
    """Edges painted now, chosen but left out since they are not of the patch, painted in all; and what `check` says."""

    patch: str
    value: float
    painted: int
    left_out: int
    total: int
    check: CheckReport

    def as_dict(self) -> dict:
        return asdict(self)

    def text(self) -> str:
        out = f", {self.left_out} left out that are not of the patch" if self.left_out else ""
        done = f"{self.patch}: {self.painted} edges painted {self.value:g}{out}; {self.total} painted in all"
        return f"{self.check.text()}\n{done}"


@dataclass(frozen=True)
class _Surface:
    """The mesh that is painted on. `edges` (n, 2) are the patch's."""

    prim: Usd.Prim
    topology: Topology
    edges: np.ndarray

    def split(self, chosen: np.ndarray) -> tuple[np.ndarray, int]:
        """Those of some edges (n, 2) that are the patch's, and how many are not."""
        inside = _rows_in(chosen, self.edges)
        return chosen[inside], int(np.count_nonzero(~inside))


def paint(
    stage_path: str | os.PathLike,
    output_path: str | os.PathLike,
    prim: str,
    patch: str,
    value: float,
    *,
    subset: str | None = None,
    primvar: str | None = None,
    threshold: float = 0.5,
    curve: str | None = None,
    distance: float | None = None,
    direction: str = "any",
    clear: bool = False,
    force: bool = False,
) -> PaintReport:
    """Gives edges of a patch a force density, in a layer that sublayers the stage, as `setup` writes one.

    value      the factor, above 0; it replaces what an edge was painted by edge before
    subset     the name of a GeomSubset under the mesh, of elementType edge; or else
    primvar    the name of a vertex primvar of the mesh: edges with at least `threshold` at both ends; or else
    curve      the path of a BasisCurves prim drawn on the mesh at rest: edges whose middle is within `distance`, in the
               mesh's units, and that run "along" the curve there (at 45 degrees or less), "across" it, or "any" way
    clear      forgets what was painted by edge before
    force      as in `setup`
    Raises UsageError, StageError, and StageProblems where there is nothing to paint; nothing is written then.
    """
    _check_arguments(value, subset, primvar, threshold, curve, distance, direction)
    layer = SetupLayer.start(stage_path, output_path, prim, force)
    stage = layer.composed()
    mesh, topology = layer.read_mesh(stage, patch)
    try:
        if patch not in schema.patch_names(mesh):
            raise Fault(f"there is no such patch on the mesh; {_patches_there(mesh)}")
        surface = _Surface(mesh, topology, topology.edges_of(read_faces(mesh, patch, topology)))
        if subset is not None:
            chosen, left_out = surface.split(_subset_edges(surface, subset))
        elif primvar is not None:
            chosen, left_out = _primvar_edges(surface, primvar, threshold), 0
        else:
            chosen, left_out = _curve_edges(surface, curve, distance, direction), 0
        if not len(chosen):
            raise Fault(f"{subset or primvar or curve} chooses no edge of the patch")
        painted, factors = _before(mesh, patch, clear)
    except Fault as fault:
        raise layer.problems(patch, str(fault)) from fault
    kept = ~_rows_in(painted, chosen)
    painted = np.concatenate([painted[kept], chosen])
    factors = np.concatenate([factors[kept], np.full(len(chosen), value, np.float32)])
    _author(layer, patch, painted, factors)
    return PaintReport(patch, value, len(chosen), left_out, len(painted), layer.finish(patch))


def _check_arguments(value, subset, primvar, threshold, curve, distance, direction) -> None:
    if sum(source is not None for source in (subset, primvar, curve)) != 1:
        raise UsageError("one of subset, primvar and curve is needed")
    with np.errstate(over="ignore"):
        if not (np.isfinite(np.float32(value)) and np.float32(value) > 0):
            raise UsageError(f"value {value:g} must be finite and above 0")
    if not np.isfinite(threshold):
        raise UsageError(f"threshold {threshold:g} must be finite")
    if curve is None and (distance is not None or direction != "any"):
        raise UsageError("distance and direction go with a curve")
    if curve is not None and (distance is None or not (np.isfinite(distance) and distance >= 0)):
        raise UsageError("a curve needs a distance of 0 or more, in the mesh's units")
    if direction not in DIRECTIONS:
        raise UsageError(f"direction {direction!r} is not one of {', '.join(DIRECTIONS)}")
    if curve is not None and not (Sdf.Path.IsValidPathString(curve) and Sdf.Path(curve).IsAbsolutePath()):
        raise UsageError(f"{curve!r} is not the path of a prim, such as /World/lines")


def _patches_there(mesh: Usd.Prim) -> str:
    there = schema.patch_names(mesh)
    return f"it has {', '.join(there)}" if there else "skinslide setup makes one"


def _rows_in(edges: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which edges (n, 2) are among others, either way round: bool (n,)."""
    known = {tuple(edge) for edge in np.sort(others, axis=1).tolist()}
    return np.array([tuple(edge) in known for edge in np.sort(edges, axis=1).tolist()], dtype=bool)


# ---- Which edges ----


def _subset_edges(surface: _Surface, name: str) -> np.ndarray:
    child = surface.prim.GetChild(name) if Sdf.Path.IsValidIdentifier(name) else None
    if not child or not child.IsA(UsdGeom.Subset):
        raise Fault(f"there is no GeomSubset {name} under the mesh")
    subset, path = UsdGeom.Subset(child), child.GetPath()
    element = subset.GetElementTypeAttr().Get()
    if element != UsdGeom.Tokens.edge:
        raise Fault(f"the GeomSubset {path} has elementType {element}; it must be edge")
    value = unchanging(subset.GetIndicesAttr(), f"{path}.indices")
    indices = integers([] if value is None else value, f"{path}.indices")
    if len(indices) % 2:
        raise Fault(f"{path}.indices has {len(indices)} values; it must hold pairs of point indices")
    edges = np.unique(np.sort(indices.reshape(-1, 2), axis=1), axis=0)
    known = _rows_in(edges, surface.topology.edges_of(np.arange(surface.topology.face_count)))
    for a, b in edges[~known][:1]:
        raise Fault(f"the GeomSubset {path} has {a}-{b}, which is no edge of the mesh")
    return edges


def _primvar_edges(surface: _Surface, name: str, threshold: float) -> np.ndarray:
    primvar = UsdGeom.PrimvarsAPI(surface.prim).GetPrimvar(name)
    if not primvar or not primvar.HasAuthoredValue():
        raise Fault(f"there is no primvar {name} on the mesh")
    name, interpolation = primvar.GetName(), primvar.GetInterpolation()
    if str(primvar.GetTypeName()) not in ("bool[]", "int[]", "float[]"):
        raise Fault(f"{name} is {primvar.GetTypeName()}; it must be bool[], int[] or float[]")
    if interpolation not in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying):
        raise Fault(f"{name} has interpolation {interpolation}; it must be vertex")
    value = flattened(primvar, FIRST)
    values = np.asarray([] if value is None else value, np.float64)
    check_length(name, len(values), surface.topology.vertex_count, "points")
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise Fault(f"{name}[{bad[0]}] is {values[bad[0]]:g}")
    return surface.edges[(values >= threshold)[surface.edges].all(axis=1)]


def _curve_edges(surface: _Surface, path: str, distance: float, direction: str) -> np.ndarray:
    rest, _ = read_rest(surface.prim, surface.topology.vertex_count)
    try:
        return surface.edges[edges_near(rest, surface.edges, _read_curves(surface.prim, path), distance, direction)]
    except SliderError as error:
        raise Fault(f"{path}: {error}") from error


def _read_curves(mesh: Usd.Prim, path: str) -> Curves:
    """The curves of a prim as they are at first."""
    prim = mesh.GetStage().GetPrimAtPath(path)
    if not prim or not prim.IsA(UsdGeom.BasisCurves):
        raise Fault(f"there is no BasisCurves prim {path}" + (f", it is a {prim.GetTypeName()}" if prim else ""))
    curves, transforms = UsdGeom.BasisCurves(prim), UsdGeom.XformCache(FIRST)
    to_mesh = transforms.GetLocalToWorldTransform(prim) * transforms.GetLocalToWorldTransform(mesh).GetInverse()
    counts, points = curves.GetCurveVertexCountsAttr().Get(FIRST), curves.GetPointsAttr().Get(FIRST)
    return Curves(
        integers([] if counts is None else counts, f"{path}.curveVertexCounts"),
        positions([] if points is None else points, f"{path}.points"),
        "linear" if curves.GetTypeAttr().Get() == UsdGeom.Tokens.linear else curves.GetBasisAttr().Get(),
        curves.GetWrapAttr().Get(),
        np.array(Gf.Matrix4d(to_mesh)),
    )


# ---- What is written ----


def _before(mesh: Usd.Prim, patch: str, clear: bool) -> tuple[np.ndarray, np.ndarray]:
    """The edges painted so far and their factors."""
    nothing = np.empty((0, 2), np.int32), np.empty(0, np.float32)
    if clear:
        return nothing
    reading = controls.edge_density(mesh, patch)
    if reading.varies:
        name = schema.property_name(patch, "edgeForceDensities")
        raise Fault(f"{name} is animated, and cannot be painted on; clear it first")
    return (reading.first["edges"], reading.first["edge_density"]) if reading.first else nothing


def _author(layer: SetupLayer, patch: str, edges: np.ndarray, factors: np.ndarray) -> None:
    name, factors_name = (schema.property_name(patch, each) for each in ("edges", "edgeForceDensities"))
    pairs = layer.attribute(name, Sdf.ValueTypeNames.IntArray, Sdf.VariabilityUniform)
    pairs.default = Vt.IntArray.FromNumpy(np.ascontiguousarray(edges, np.int32).ravel())
    layer.attribute(factors_name, Sdf.ValueTypeNames.FloatArray).default = Vt.FloatArray.FromNumpy(factors)
