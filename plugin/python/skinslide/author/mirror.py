"""Copies the set-up of a patch to the other side of a symmetric mesh: face by face, or by nearest place."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any, NamedTuple, Unpack

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.geometry import mirror_faces, mirror_nearest
from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import EditedMesh, edited
from skinslide.author.layer import author_layer
from skinslide.author.options import MirrorKeywords, MirrorOptions
from skinslide.problems import Fault, Problem, SliderError, UsageError
from skinslide.shot.check import CheckReport
from skinslide.shot.checks import takes
from skinslide.stage import schema
from skinslide.stage.given import PrimLike, StageLike, StrPath
from skinslide.stage.patch import Animation, read_chosen, read_patch
from skinslide.stage.sides import OTHER_SIDE

_SIDE = re.compile(rf"(?<![A-Za-z0-9])({'|'.join(OTHER_SIDE)})(?![A-Za-z0-9])")
# Properties that name points, faces or texture coordinates of one side.
_OF_ONE_SIDE = {
    "corners",
    "edges",
    "forceDensityMap",
    "forceDensityMapChannel",
    "weightMap",
    "weightMapChannel",
    "holdMap",
    "holdMapChannel",
    "mapSt",
}


@takes(MirrorOptions)
def mirror(stage: Usd.Stage, prim: PrimLike, patch: str, **reflection: Unpack[MirrorKeywords]) -> CheckReport:
    """Copies a patch's set-up to the other side of a symmetric mesh, in the stage's edit target.

    Faces, corners, paint and settings are copied, with their animation. Maps are sampled and become paint, since the
    other side's texture coordinates may be anywhere. What the new patch had before is replaced.

    Where the surface is symmetric, but faces have no counterparts, as when quads are cut along the other diagonal, the
    nearest faces take their place, and paint goes to the nearest points: the report says so, and how far off the
    farthest is.

    Args:
        stage: The stage.
        prim: The mesh.
        patch: The patch's name.
        **reflection: Where it goes.

    Returns:
        What `check` says of the mesh; errors of its other patches are warnings.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used, or the edit target takes no opinions.
        StageProblems: Points or faces have no counterpart, or the new patch could not be slid. Nothing is authored
            then.
    """
    asked = MirrorOptions(prim=prim, patch=patch, **reflection)
    to = other_side(patch) if asked.to is None else asked.to
    if to == patch:
        raise UsageError(f"{patch} cannot be mirrored to itself")
    with edited(stage, prim, to, source=patch) as mesh:
        mesh.check_patch(patch)
        animation, faults = read_patch(mesh.prim, patch, mesh.meaning)
        if animation is None:
            raise Fault(faults[0])
        across = _across(mesh, animation.setup.faces, asked)
        copy = _Copy(mesh, patch, animation, across)
        copy.run(read_chosen(mesh.prim, patch, mesh.meaning))
        report = mesh.checked()
        notes = [Problem("note", str(mesh.prim.GetPath()), to, None, note) for note in copy.notes]
        return replace(report, problems=[*report.problems, *notes])


@takes(MirrorOptions)
def mirror_to_file(
    stage: StageLike,
    output: StrPath,
    prim: PrimLike,
    patch: str,
    *,
    force: bool = False,
    **reflection: Unpack[MirrorKeywords],
) -> CheckReport:
    """Mirrors as `mirror` does, in a layer that sublayers the stage.

    Args:
        stage: The stage, or its path; never written.
        output: The layer, as `setup_to_file` has it.
        prim: The mesh.
        patch: The patch's name.
        force: Replaces any layer at `output`.
        **reflection: As for `mirror`.

    Returns:
        What `check` says of the mesh; errors of its other patches are warnings.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or the layer cannot be written.
        StageProblems: Points or faces have no counterpart, or the new patch could not be slid. Nothing is written
            then.
    """
    report = author_layer(stage, output, force, lambda layered: mirror(layered, prim, patch, **reflection))
    return replace(report, stage=str(output))


def other_side(patch: str) -> str:
    """elbow_R for elbow_L, left:cheek for right:cheek."""
    if len(_SIDE.findall(patch)) != 1:
        raise UsageError(f"the name {patch} does not say its side once, as elbow_L does; name the other side's patch")
    return _SIDE.sub(lambda match: OTHER_SIDE[match[1]], patch)


class _OtherSide(NamedTuple):
    """The faces of the other side, with the faces of this side whose paint they take; the same for vertices."""

    faces: np.ndarray  # (n,)
    face_sources: np.ndarray  # (n,)
    vertex_sources: np.ndarray  # (V,) -1 of vertices that are not of these faces
    vertices: np.ndarray  # (V,) of vertices of this side, where they go: -1 for nowhere
    note: str  # of how they were found, or nothing


def _across(mesh: EditedMesh, faces: np.ndarray, asked: MirrorOptions) -> _OtherSide:
    shape = (mesh.topology.face_counts, mesh.topology.face_indices, mesh.meaning.rest_points(), faces)
    try:
        found = mirror_faces(*shape, axis=asked.axis, plane=asked.plane, tolerance=asked.tolerance)
    except SliderError as error:
        try:
            nearest = mirror_nearest(*shape, axis=asked.axis, plane=asked.plane, tolerance=asked.tolerance)
        except SliderError:
            raise Fault(f"the mesh is not symmetric here: {error}") from error
        note = f"mirrored by nearest place, since faces are not symmetric: the farthest is {nearest.worst:.3g} off"
        there = np.flatnonzero(nearest.face_sources >= 0).astype(np.int32)
        vertices = _inverse(nearest.vertex_sources)
        return _OtherSide(there, nearest.face_sources[there], nearest.vertex_sources, vertices, note)
    return _OtherSide(found.faces, faces, _inverse(found.vertices), found.vertices, "")


def _inverse(places: np.ndarray) -> np.ndarray:
    """For each vertex, the lowest one that goes to it; -1 for none."""
    inverse, known = np.full(len(places), -1, np.int32), np.flatnonzero(places >= 0)[::-1]
    inverse[places[known]] = known
    return inverse


class _Copy:
    """Copies what one patch has to another; `notes` are for the report."""

    def __init__(self, mesh: EditedMesh, patch: str, animation: Animation, across: _OtherSide):
        self.notes = [across.note] if across.note else []
        self._mesh, self._patch, self._name, self._topology = mesh.prim, patch, mesh.patch, mesh.topology
        self._animation, self._setup, self._across = animation, animation.setup, across

    def run(self, chosen: np.ndarray) -> None:
        """Copies all of it. `chosen` are the faces without those that grow adds, which is a setting of its own."""
        faces = self._across.faces[np.isin(self._across.face_sources, chosen)]
        SkinSlideAPI.Apply(self._mesh, self._name).SetFaces(faces)
        self._paint()
        kept, edges = self._kept_edges(), self._setup.controls.edges
        self._points("corners", self._setup.corners)
        self._points("edges", None if kept is None or edges is None else edges[kept])
        for name in schema.declared_names():
            if name in _OF_ONE_SIDE - {"corners", "edges"}:
                self._block(self._new(name))
            elif name not in _OF_ONE_SIDE:
                self._setting(name, kept if name == "edgeForceDensities" else None)

    # ---- Paint ----

    def _paint(self) -> None:
        density = self._setup.controls
        if density.vertex_density is not None and density.face_density is not None:
            raise Fault("force density is painted by face and has a map; paint it by point to mirror it")
        self._primvar("weight", "weight")
        self._primvar("maxDistance", "max_distance")
        self._primvar("hold", "hold")
        self._primvar("forceDensity", "vertex_density" if density.face_density is None else "face_density")

    def _primvar(self, name: str, field: str) -> None:
        """Writes a field of the controls, at all its times, as a primvar; where the field is None, nothing."""
        full = f"primvars:{self._new(name)}"
        self._block(f"{full}:indices")
        if getattr(self._setup.controls, field) is None:
            self._block(full)
            return
        by_face = field == "face_density"
        interpolation = UsdGeom.Tokens.uniform if by_face else UsdGeom.Tokens.vertex
        self._mesh.RemoveProperty(full)
        primvars = UsdGeom.PrimvarsAPI(self._mesh)
        primvar = primvars.CreatePrimvar(full, Sdf.ValueTypeNames.FloatArray, interpolation)
        move, fallback = self._by_face if by_face else self._by_vertex, 1.0 if name in ("forceDensity", "hold") else 0.0
        times = self._animation.times(names={name, f"{name}Map"})
        for time in map(Usd.TimeCode, times) if times else [Usd.TimeCode.Default()]:
            controls = self._animation.at(time) if times else self._setup.controls
            primvar.Set(Vt.FloatArray.FromNumpy(move(getattr(controls, field), fallback)), time)

    def _by_vertex(self, values: np.ndarray, fallback: float) -> np.ndarray:
        moved, inside = np.full(len(values), fallback, np.float32), self._across.vertex_sources >= 0
        moved[inside] = values[self._across.vertex_sources[inside]]
        return moved

    def _by_face(self, values: np.ndarray, fallback: float) -> np.ndarray:
        moved = np.full(len(values), fallback, np.float32)
        moved[self._across.faces] = values[self._across.face_sources]
        return moved

    # ---- Edges ----

    def _kept_edges(self) -> np.ndarray | None:
        """Which painted edges the other side has, bool (n,): all, unless by nearest place; None if none are painted."""
        edges = self._setup.controls.edges
        if edges is None or not self._across.note:
            return None if edges is None else np.ones(len(edges), dtype=bool)
        there = {tuple(edge) for edge in np.sort(self._topology.edges_of(self._across.faces), axis=1).tolist()}
        kept = np.array([tuple(edge) in there for edge in np.sort(self._across.vertices[edges], axis=1).tolist()], bool)
        if not kept.all():
            self.notes.append(f"{np.count_nonzero(~kept)} of {len(kept)} painted edges are not on the other side")
        return kept if kept.any() else None

    # ---- Attributes ----

    def _points(self, name: str, points: np.ndarray | None) -> None:
        """Corners, or edges: indices of points of the patch."""
        if points is None:
            self._block(self._new(name))
            return
        count, vertices = len(self._across.vertices), points.ravel()
        for vertex in vertices:
            if not 0 <= vertex < count or self._across.vertices[vertex] < 0:
                raise Fault(f"{schema.property_name(self._patch, name)} has point {vertex}, which is not of the patch")
        self._anew(name).Set(Vt.IntArray.FromNumpy(self._across.vertices[vertices]))

    def _setting(self, name: str, kept: np.ndarray | None = None) -> None:
        """Copies an attribute that does not depend on the side, with its samples or spline; of arrays, what is kept."""
        source = schema.attribute(self._mesh, self._patch, name)
        if not source or not source.HasAuthoredValue():
            self._block(self._new(name))
            return
        attribute, default = self._anew(name), source.Get()
        if source.HasSpline():
            attribute.SetSpline(source.GetSpline())
        if default is not None:
            attribute.Set(_kept(default, kept))
        for time in source.GetTimeSamples():
            attribute.Set(_kept(source.Get(time), kept), time)

    def _new(self, name: str) -> str:
        return schema.property_name(self._name, name)

    def _anew(self, name: str) -> Usd.Attribute:
        """An attribute of the new patch, without the edit target's earlier opinions on it."""
        declared = schema.declared(name)
        self._mesh.RemoveProperty(self._new(name))
        return self._mesh.CreateAttribute(self._new(name), declared.typeName, False, declared.variability)

    def _block(self, name: str) -> None:
        """Takes away a value that the new patch had before."""
        self._mesh.RemoveProperty(name)
        before = self._mesh.GetAttribute(name)
        if before and before.HasAuthoredValue():
            before.Block()


def _kept(value: Any, kept: np.ndarray | None) -> Any:
    return value if kept is None or kept.all() else Vt.FloatArray.FromNumpy(np.asarray(value, np.float32)[kept])
