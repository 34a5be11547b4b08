"""Copies the set-up of a patch to the other side of a symmetric mesh."""

from __future__ import annotations

import os
import re
from collections.abc import Callable

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.geometry import AXES, Mirrored, mirror_faces
from skinslide.author.layer import SetupLayer, check_patch_name
from skinslide.problems import Fault, SliderError, UsageError
from skinslide.shot.check import CheckReport
from skinslide.stage import controls, schema
from skinslide.stage.faces import read_faces
from skinslide.stage.rest import read_rest
from skinslide.stage.textures import read_texture
from skinslide.stage.topology import Topology
from skinslide.stage.values import Reading

_SIDES = {"L": "R", "l": "r", "left": "right", "Left": "Right", "LEFT": "RIGHT"}
_OTHER_SIDE = _SIDES | {right: left for left, right in _SIDES.items()}
_SIDE = re.compile(rf"(?<![A-Za-z0-9])({'|'.join(_OTHER_SIDE)})(?![A-Za-z0-9])")
# Properties that name points, faces or texture coordinates of one side.
_OF_ONE_SIDE = {
    "corners",
    "edges",
    "forceDensityMap",
    "forceDensityMapChannel",
    "weightMap",
    "weightMapChannel",
    "mapSt",
}


def mirror(
    stage_path: str | os.PathLike,
    output_path: str | os.PathLike,
    prim: str,
    patch: str,
    *,
    to: str | None = None,
    axis: str = "x",
    plane: float = 0.0,
    tolerance: float | None = None,
    force: bool = False,
) -> CheckReport:
    """Copies a patch's set-up to the other side, in a layer that sublayers the stage, as `setup` writes one.

    to         the new patch's name; None: the other side's, such as elbow_R for elbow_L
    axis       the mesh is symmetric at rest about the plane where this coordinate is `plane`
    tolerance  how far a point may be from its counterpart's mirror image; None: 1e-4 of the mesh's largest extent
    force      as in `setup`
    Faces, corners, paint and settings are copied, with their animation. Maps are sampled and become paint, since the
    other side's texture coordinates may be anywhere. What the new patch had before is replaced.
    Raises UsageError, StageError, and StageProblems where points or faces have no counterpart; nothing is written then.
    """
    to = other_side(patch) if to is None else to
    _check_arguments(patch, to, axis, plane, tolerance)
    layer = SetupLayer.start(stage_path, output_path, prim, force)
    stage = layer.composed()
    mesh, topology = layer.read_mesh(stage, patch)
    try:
        if patch not in schema.patch_names(mesh):
            raise Fault("there is no such patch on the mesh")
        faces = read_faces(mesh, patch, topology)
        across = _across(mesh, topology, faces, axis, plane, tolerance)
        layer.apply(to)
        _Copy(layer, mesh, topology, patch, to, faces, across).run()
    except Fault as fault:
        raise layer.problems(patch, str(fault)) from fault
    return layer.finish(to)


def other_side(patch: str) -> str:
    """elbow_R for elbow_L, left:cheek for right:cheek."""
    if len(_SIDE.findall(patch)) != 1:
        raise UsageError(f"the name {patch} does not say its side once, as elbow_L does; name the other side's patch")
    return _SIDE.sub(lambda match: _OTHER_SIDE[match[1]], patch)


def _check_arguments(patch: str, to: str, axis: str, plane: float, tolerance: float | None) -> None:
    check_patch_name(to)
    if to == patch:
        raise UsageError(f"{patch} cannot be mirrored to itself")
    if axis not in AXES:
        raise UsageError(f"axis {axis!r} is not one of {', '.join(AXES)}")
    if not np.isfinite(plane):
        raise UsageError(f"plane {plane:g} must be finite")
    if tolerance is not None and not (np.isfinite(tolerance) and tolerance >= 0):
        raise UsageError(f"tolerance {tolerance:g} must be 0 or more")


def _across(
    mesh: Usd.Prim, topology: Topology, faces: np.ndarray, axis: str, plane: float, tolerance: float | None
) -> Mirrored:
    rest, _ = read_rest(mesh, topology.vertex_count)
    try:
        return mirror_faces(
            topology.face_counts, topology.face_indices, rest, faces, axis=axis, plane=plane, tolerance=tolerance
        )
    except SliderError as error:
        raise Fault(f"the mesh is not symmetric here: {error}") from error


class _Copy:
    """Writes what one patch has as another's."""

    def __init__(
        self,
        layer: SetupLayer,
        mesh: Usd.Prim,
        topology: Topology,
        patch: str,
        to: str,
        faces: np.ndarray,
        across: Mirrored,
    ):
        self._layer, self._mesh, self._topology, self._patch, self._to = layer, mesh, topology, patch, to
        self._faces, self._across = faces, across

    def run(self) -> None:
        types, tokens = Sdf.ValueTypeNames, UsdGeom.Tokens
        patch = np.isin(np.arange(self._topology.face_count), self._across.faces)
        self._unindexed("patch")
        name = schema.property_name(self._to, "patch")
        self._layer.primvar(name, types.BoolArray, tokens.uniform, Vt.BoolArray.FromNumpy(patch))
        self._paint()
        corners = controls.corners(self._mesh, self._patch, self._topology.vertex_count)
        self._points("corners", corners)
        self._points("edges", controls.edge_density(self._mesh, self._patch).first.get("edges"))
        for name in schema.declared_names():
            if name in _OF_ONE_SIDE - {"corners", "edges"}:
                self._block(schema.property_name(self._to, name))
            elif name not in _OF_ONE_SIDE:
                self._setting(name)

    # ---- Paint ----

    def _paint(self) -> None:
        arguments = (self._mesh, self._patch, self._topology, self._faces)
        textures = {
            control: read_texture(*arguments[:2], control, *arguments[2:]) for control in ("weight", "forceDensity")
        }
        weight = controls.weight(*arguments, textures["weight"])
        self._by_vertex_or_none("weight", weight)
        self._by_vertex_or_none("maxDistance", controls.max_distance(*arguments))
        density = controls.density(*arguments, textures["forceDensity"])
        kinds = {"vertex_density": UsdGeom.Tokens.vertex, "face_density": UsdGeom.Tokens.uniform}
        if len(density.first) > 1:
            raise Fault("force density is painted by face and has a map; paint it by point to mirror it")
        argument = next(iter(density.first), None)
        self._primvar("forceDensity", density, lambda values: values[argument], kinds.get(argument))

    def _by_vertex_or_none(self, name: str, reading: Reading) -> None:
        self._primvar(name, reading, lambda values: values, None if reading.first is None else UsdGeom.Tokens.vertex)

    def _primvar(self, name: str, reading: Reading, values_of: Callable, interpolation: str | None) -> None:
        """Writes what a reading gives at each of its times; None: nothing."""
        primvar = schema.property_name(self._to, name)
        self._unindexed(name)
        if interpolation is None:
            self._block(f"primvars:{primvar}")
            return
        attr = self._layer.attribute(f"primvars:{primvar}", Sdf.ValueTypeNames.FloatArray)
        attr.SetInfo("interpolation", interpolation)
        move = self._by_vertex if interpolation == UsdGeom.Tokens.vertex else self._by_face
        fallback = 1.0 if name == "forceDensity" else 0.0
        for time in reading.times(None) if reading.varies else [None]:
            value = reading.first if time is None else reading.at(Usd.TimeCode(time))
            moved = Vt.FloatArray.FromNumpy(move(values_of(value), fallback))
            if time is None:
                attr.default = moved
            else:
                self._layer.layer.SetTimeSample(attr.path, time, moved)

    def _by_vertex(self, values: np.ndarray, fallback: float) -> np.ndarray:
        moved, inside = np.full(len(values), fallback, np.float32), self._across.vertices >= 0
        moved[self._across.vertices[inside]] = values[inside]
        return moved

    def _by_face(self, values: np.ndarray, fallback: float) -> np.ndarray:
        moved = np.full(len(values), fallback, np.float32)
        moved[self._across.faces] = values[self._faces]
        return moved

    # ---- Attributes ----

    def _points(self, name: str, points: np.ndarray | None) -> None:
        """Corners, or edges: indices of points of the patch."""
        full = schema.property_name(self._to, name)
        if points is None:
            self._block(full)
            return
        count, vertices = len(self._across.vertices), points.ravel()
        for vertex in vertices:
            if not 0 <= vertex < count or self._across.vertices[vertex] < 0:
                raise Fault(f"{schema.property_name(self._patch, name)} has point {vertex}, which is not of the patch")
        attr = self._layer.attribute(full, Sdf.ValueTypeNames.IntArray, Sdf.VariabilityUniform)
        attr.default = Vt.IntArray.FromNumpy(self._across.vertices[vertices])

    def _setting(self, name: str) -> None:
        """A value that does not depend on the side, with its samples or its spline."""
        full, source = schema.property_name(self._to, name), schema.attribute(self._mesh, self._patch, name)
        if not source or not source.HasAuthoredValue():
            self._block(full)
            return
        declared = schema.declared(name)
        attr = self._layer.attribute(full, declared.typeName, declared.variability)
        if source.HasSpline():
            attr.SetInfo("spline", source.GetSpline())
        default = source.Get()
        if default is not None:
            attr.default = default
        for time in source.GetTimeSamples():
            self._layer.layer.SetTimeSample(attr.path, time, source.Get(time))

    def _unindexed(self, name: str) -> None:
        self._block(f"primvars:{schema.property_name(self._to, name)}:indices")

    def _block(self, name: str) -> None:
        """Leaves the new patch without a value that it had before."""
        before = self._mesh.GetAttribute(name)
        if before and before.HasAuthoredValue():
            self._layer.attribute(name, before.GetTypeName(), before.GetVariability()).default = Sdf.ValueBlock()
