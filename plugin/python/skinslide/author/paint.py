"""Paints force density by edge, for which no DCC has a brush."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any, NamedTuple, Unpack

import numpy as np
from pxr import Gf, Usd, UsdGeom

from skinslide.arrays.geometry import Curves, edge_distances
from skinslide.arrays.meaning import MeshMeaning, PatchMeaning
from skinslide.arrays.topology import Topology
from skinslide.arrays.values import integers, positions
from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import edited
from skinslide.author.layer import author_layer
from skinslide.author.options import PaintKeywords, PaintOptions
from skinslide.problems import NO_EDGE, Fault, SliderError, counted, one_line
from skinslide.shot.check import CheckReport
from skinslide.shot.checks import takes
from skinslide.stage import schema
from skinslide.stage.given import (
    PrimLike,
    StageLike,
    StrPath,
    given_array,
    given_primvar,
    given_subset,
)
from skinslide.stage.names import prim_of_type
from skinslide.stage.patch import read_edges, read_faces, read_pairs
from skinslide.stage.values import FIRST, read_primvar, read_value


@dataclass(frozen=True)
class PaintReport:
    """What was painted.

    Attributes:
        patch: The patch's name.
        value: The factor.
        painted: How many edges were painted now.
        left_out: How many more were chosen, but are not of the patch.
        total: How many are painted by edge in all.
        check: What `check` says of the mesh; errors of its other patches are warnings.
    """

    patch: str
    value: float
    painted: int
    left_out: int
    total: int
    check: CheckReport

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)

    def text(self, *, lookup: bool = True) -> str:
        """What `check` says, and a line of what was painted.

        Args:
            lookup: As for `CheckReport.text`.

        Returns:
            The lines.
        """
        out = f", {self.left_out} left out that are not of the patch" if self.left_out else ""
        edges = f"{counted(self.painted, 'edge')} painted with {self.value:g}{out}; {self.total} painted in all"
        return f"{self.check.text(lookup=lookup)}\n{one_line(f'{self.patch}: {edges}')}"


@dataclass(frozen=True)
class _Surface:
    """The mesh that is painted on. `edges` (n, 2) are the patch's."""

    prim: Usd.Prim
    meaning: MeshMeaning
    topology: Topology
    edges: np.ndarray


@takes(PaintOptions)
def paint(stage: Usd.Stage, prim: PrimLike, patch: str, value: float, **choice: Unpack[PaintKeywords]) -> PaintReport:
    """Gives edges of a patch a force density, in the stage's edit target.

    One of edges, subset, primvar and curve says which edges.

    Args:
        stage: The stage.
        prim: The mesh.
        patch: The patch's name.
        value: The factor, above 0; it replaces what an edge was painted by edge before.
        **choice: Which edges.

    Returns:
        How many edges were painted, and what `check` says of the mesh.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used, or the edit target takes no opinions.
        StageProblems: There is no such patch, or nothing to paint. Nothing is authored then.
    """
    asked = PaintOptions(prim=prim, patch=patch, value=value, **choice)
    what, choose = _choice(asked)
    with edited(stage, prim, patch) as mesh:
        mesh.check_patch(patch)
        before = read_faces(mesh.prim, patch, mesh.meaning)
        own = mesh.topology.edges_of(before.faces)
        chosen, left_out = _split(choose(_Surface(mesh.prim, mesh.meaning, mesh.topology, own)), own)
        if not len(chosen):
            raise Fault(f"{what} {NO_EDGE}")
        painted, factors = _before(mesh.prim, before, asked.clear)
        kept = ~_rows_in(painted, chosen)
        painted = np.concatenate([painted[kept], chosen])
        factors = np.concatenate([factors[kept], np.full(len(chosen), asked.value, np.float32)])
        SkinSlideAPI(mesh.prim, patch).SetEdges(painted, factors)
        return PaintReport(patch, asked.value, len(chosen), left_out, len(painted), mesh.checked())


@takes(PaintOptions)
def paint_to_file(
    stage: StageLike,
    output: StrPath,
    prim: PrimLike,
    patch: str,
    value: float,
    *,
    force: bool = False,
    **choice: Unpack[PaintKeywords],
) -> PaintReport:
    """Paints as `paint` does, in a layer that sublayers the stage.

    Args:
        stage: The stage, or its path; never written.
        output: The layer, as `setup_to_file` has it.
        prim: The mesh.
        patch: The patch's name.
        value: The factor, above 0.
        force: Replaces any layer at `output`.
        **choice: As for `paint`.

    Returns:
        How many edges were painted, and what `check` says of the mesh.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or the layer cannot be written.
        StageProblems: There is no such patch, or nothing to paint. Nothing is written then.
    """
    report = author_layer(stage, output, force, lambda layered: paint(layered, prim, patch, value, **choice))
    return replace(report, check=replace(report.check, stage=str(output)))


def _choice(asked: PaintOptions) -> tuple[str, Callable[[_Surface], np.ndarray]]:
    """What chooses edges of a mesh, (n, 2), and how it is called. Raises UsageError."""
    if asked.subset is not None:
        return asked.subset, partial(_subset_edges, name=asked.subset)
    if asked.primvar is not None:
        return asked.primvar, partial(_primvar_edges, name=asked.primvar, threshold=asked.threshold)
    if asked.curve is not None and asked.distance is not None:
        curve = str(asked.curve)
        return curve, partial(_curve_edges, near=_Near(curve, asked.distance, asked.direction))
    assert asked.edges is not None  # of several choices one is made
    pairs = given_array("edges", asked.edges, np.int32, (-1, 2))
    return "edges", lambda surface: _edges_of_mesh(surface, pairs, "edges")


class _Near(NamedTuple):
    curve: str
    distance: float
    direction: str


def _rows_in(edges: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Which edges (n, 2) are among others, either way round: bool (n,)."""
    known = {tuple(edge) for edge in np.sort(others, axis=1).tolist()}
    return np.array([tuple(edge) in known for edge in np.sort(edges, axis=1).tolist()], dtype=bool)


def _split(chosen: np.ndarray, own: np.ndarray) -> tuple[np.ndarray, int]:
    """Those of some edges (n, 2) that are the patch's own, and how many are not."""
    inside = _rows_in(chosen, own)
    return chosen[inside], int(np.count_nonzero(~inside))


# ---- Which edges ----


def _edges_of_mesh(surface: _Surface, pairs: np.ndarray, what: str) -> np.ndarray:
    edges = np.unique(np.sort(pairs, axis=1), axis=0)
    known = _rows_in(edges, surface.topology.edges_of(np.arange(surface.topology.face_count)))
    for a, b in edges[~known][:1]:
        raise Fault(f"{what} has {a}-{b}, which is not an edge of the mesh")
    return edges


def _subset_edges(surface: _Surface, name: str) -> np.ndarray:
    child = given_subset(surface.prim, name)
    if not child.IsA(UsdGeom.Subset):
        raise Fault(f"{child.GetPath()} is not a GeomSubset")
    subset, path = UsdGeom.Subset(child), child.GetPath()
    element = subset.GetElementTypeAttr().Get(FIRST)
    if element != UsdGeom.Tokens.edge:
        raise Fault(f"the GeomSubset {path} has elementType {element}; it must be edge")
    pairs = read_pairs(subset.GetIndicesAttr(), surface.meaning)
    return _edges_of_mesh(surface, pairs, f"the GeomSubset {path}")


def _primvar_edges(surface: _Surface, name: str, threshold: float) -> np.ndarray:
    primvar = given_primvar(surface.prim, name)
    values = surface.meaning.painted(read_primvar(primvar))
    return surface.edges[(values >= threshold)[surface.edges].all(axis=1)]


def _curve_edges(surface: _Surface, near: _Near) -> np.ndarray:
    rest = surface.meaning.rest_points()
    curves = _read_curves(surface.prim, near.curve)
    try:
        distances = edge_distances(rest, surface.edges, curves, near.direction)
    except SliderError as error:
        raise Fault(f"{near.curve}: {error}") from error
    found = surface.edges[distances <= near.distance]
    if not len(found):
        raise Fault(f"{near.curve} {NO_EDGE}: {_how_far(distances.min(initial=np.inf), near)}")
    return found


def _how_far(nearest: float, near: _Near) -> str:
    directed = near.direction != "any"
    if not np.isfinite(nearest):
        return f"none runs {near.direction} it" if directed else "the curve has no length"
    runs = f" that runs {near.direction} it" if directed else ""
    return f"the nearest{runs} is {nearest:.3g} away, and the distance is {near.distance:g}"


def _read_curves(mesh: Usd.Prim, path: str) -> Curves:
    """The curves of a prim by their default values, where rest is drawn, or at their first sample without these."""
    prim = prim_of_type(mesh.GetStage(), path, UsdGeom.BasisCurves, f"curve {path}: ")
    curves, transforms = UsdGeom.BasisCurves(prim), UsdGeom.XformCache(FIRST)
    to_mesh = transforms.GetLocalToWorldTransform(prim) * transforms.GetLocalToWorldTransform(mesh).GetInverse()
    counts, points = (
        read_value(each, _at_rest(each), name=f"{path}.{each.GetName()}")
        for each in (curves.GetCurveVertexCountsAttr(), curves.GetPointsAttr())
    )
    return Curves(
        integers(counts),
        positions(points),
        "linear" if curves.GetTypeAttr().Get() == UsdGeom.Tokens.linear else curves.GetBasisAttr().Get(),
        curves.GetWrapAttr().Get(),
        np.array(Gf.Matrix4d(to_mesh)),
    )


def _at_rest(attribute: Usd.Attribute) -> Usd.TimeCode:
    default = Usd.TimeCode.Default()
    return FIRST if attribute.Get(default) is None else default


# ---- What is written ----


def _before(mesh: Usd.Prim, patch: PatchMeaning, clear: bool) -> tuple[np.ndarray, np.ndarray]:
    """The edges painted so far and their factors."""
    nothing = np.empty((0, 2), np.int32), np.empty(0, np.float32)
    if clear:
        return nothing
    animation = read_edges(mesh, patch)
    if animation.varies:
        name = schema.property_name(patch.name, "edgeForceDensities")
        raise Fault(f"{name} is animated, and cannot be painted on; clear it first")
    edges, density = animation.edges()
    return nothing if edges is None or density is None else (edges, density)
