"""Paints force density by edge, for which no DCC has a brush."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any, NamedTuple, TypedDict, Unpack

import numpy as np
import numpy.typing as npt
from pxr import Gf, Usd, UsdGeom

from skinslide.arrays.geometry import Curves, edges_near, nearest_edge
from skinslide.arrays.meaning import MeshMeaning, PatchMeaning
from skinslide.arrays.topology import Topology
from skinslide.arrays.values import integers, positions
from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import edited
from skinslide.author.layer import author_layer
from skinslide.problems import NO_EDGE, Fault, SliderError, UsageError, counted, not_one_of, one_line
from skinslide.shot.check import CheckReport
from skinslide.stage import schema
from skinslide.stage.given import (
    PrimLike,
    StageLike,
    StrPath,
    given_array,
    given_number,
    given_path,
    given_primvar,
    given_subset,
    given_text,
)
from skinslide.stage.names import prim_of_type
from skinslide.stage.patch import read_edges, read_faces, read_pairs
from skinslide.stage.values import FIRST, read_primvar, read_value

DIRECTIONS = ("any", "along", "across")


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

    def text(self) -> str:
        """What `check` says, and a line of what was painted."""
        out = f", {self.left_out} left out that are not of the patch" if self.left_out else ""
        done = f"{self.patch}: {counted(self.painted, 'edge')} painted {self.value:g}{out}; {self.total} painted in all"
        return f"{self.check.text()}\n{one_line(done)}"


@dataclass(frozen=True)
class _Surface:
    """The mesh that is painted on. `edges` (n, 2) are the patch's."""

    prim: Usd.Prim
    meaning: MeshMeaning
    topology: Topology
    edges: np.ndarray


class EdgeChoice(TypedDict, total=False):
    """The keywords of `paint`."""

    edges: npt.ArrayLike | None
    subset: str | None
    primvar: str | None
    threshold: float
    curve: PrimLike | None
    distance: float | None
    direction: str
    clear: bool


def paint(
    stage: Usd.Stage,
    prim: PrimLike,
    patch: str,
    value: float,
    *,
    edges: npt.ArrayLike | None = None,
    subset: str | None = None,
    primvar: str | None = None,
    threshold: float = 0.5,
    curve: PrimLike | None = None,
    distance: float | None = None,
    direction: str = "any",
    clear: bool = False,
) -> PaintReport:
    """Gives edges of a patch a force density, in the stage's edit target.

    One of edges, subset, primvar and curve says which edges.

    Args:
        stage: The stage.
        prim: The mesh.
        patch: The patch's name.
        value: The factor, above 0; it replaces what an edge was painted by edge before.
        edges: Point indices (k, 2), a pair for each edge of the mesh.
        subset: The name of a GeomSubset under the mesh, of elementType edge.
        primvar: The name of a vertex primvar of the mesh: edges with at least `threshold` at both ends.
        threshold: With `primvar`.
        curve: A BasisCurves prim drawn on the mesh at rest; its default points are used if it has any, else its first
            sample. Chooses edges whose middle is within `distance` of it, and that run in `direction` there.
        distance: With `curve`, in the mesh's units.
        direction: With `curve`: "along", at 45 degrees or less to it; "across", at more; or "any".
        clear: First removes what was painted by edge before.

    Returns:
        How many edges were painted, and what `check` says of the mesh.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used, or the edit target takes no opinions.
        StageProblems: There is no such patch, or nothing to paint. Nothing is authored then.
    """
    what, choose = _choice(edges, subset, primvar, threshold, curve, distance, direction)
    _check_value(value)
    with edited(stage, prim, patch) as mesh:
        mesh.check_patch(patch)
        before = read_faces(mesh.prim, patch, mesh.meaning)
        own = mesh.topology.edges_of(before.faces)
        chosen, left_out = _split(choose(_Surface(mesh.prim, mesh.meaning, mesh.topology, own)), own)
        if not len(chosen):
            raise Fault(f"{what} {NO_EDGE}")
        painted, factors = _before(mesh.prim, before, clear)
        kept = ~_rows_in(painted, chosen)
        painted = np.concatenate([painted[kept], chosen])
        factors = np.concatenate([factors[kept], np.full(len(chosen), value, np.float32)])
        SkinSlideAPI(mesh.prim, patch).SetEdges(painted, factors)
        return PaintReport(patch, value, len(chosen), left_out, len(painted), mesh.checked())


def paint_to_file(
    stage: StageLike,
    output: StrPath,
    prim: PrimLike,
    patch: str,
    value: float,
    *,
    force: bool = False,
    **choice: Unpack[EdgeChoice],
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


def _choice(
    edges: npt.ArrayLike | None,
    subset: str | None,
    primvar: str | None,
    threshold: float,
    curve: PrimLike | None,
    distance: float | None,
    direction: str,
) -> tuple[str, Callable[[_Surface], np.ndarray]]:
    """What chooses edges of a mesh, (n, 2), and how it is called. Raises UsageError."""
    if not np.isfinite(given_number("threshold", threshold)):
        raise UsageError(f"threshold {threshold:g} must be finite")
    near = _near(curve, distance, direction)
    choices: list[tuple[str, Callable[[_Surface], np.ndarray]]] = []
    if edges is not None:
        pairs = given_array("edges", edges, np.int32, (-1, 2))
        choices.append(("edges", lambda surface: _edges_of_mesh(surface, pairs, "edges")))
    if subset is not None:
        given_text("subset", subset)
        choices.append((subset, partial(_subset_edges, name=subset)))
    if primvar is not None:
        given_text("primvar", primvar)
        choices.append((primvar, partial(_primvar_edges, name=primvar, threshold=threshold)))
    if near is not None:
        choices.append((near.curve, partial(_curve_edges, near=near)))
    if len(choices) != 1:
        raise UsageError("one of edges, subset, primvar and curve is needed")
    return choices[0]


class _Near(NamedTuple):
    curve: str
    distance: float
    direction: str


def _near(curve: PrimLike | None, distance: float | None, direction: str) -> _Near | None:
    if direction not in DIRECTIONS:
        raise UsageError(not_one_of("direction", direction, DIRECTIONS))
    if curve is None:
        if distance is not None or direction != "any":
            raise UsageError("distance and direction go with a curve")
        return None
    if distance is None or not (np.isfinite(distance) and distance >= 0):
        raise UsageError("a curve needs a distance of 0 or more, in the mesh's units")
    return _Near(str(given_path("curve", curve)), distance, direction)


def _check_value(given: float) -> None:
    value = given_number("value", given)
    with np.errstate(over="ignore"):
        if not (np.isfinite(np.float32(value)) and np.float32(value) > 0):
            raise UsageError(f"value {value:g} must be finite and above 0")


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
        found = surface.edges[edges_near(rest, surface.edges, curves, near.distance, near.direction)]
        nearest = nearest_edge(rest, surface.edges, curves, near.direction)
    except SliderError as error:
        raise Fault(f"{near.curve}: {error}") from error
    if not len(found):
        raise Fault(f"{near.curve} {NO_EDGE}: {_how_far(nearest, near)}")
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
