"""The meshes of a stage that carry patches, as arrays: what a bake and a check need to know of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from pxr import Tf, Usd, UsdGeom, UsdSkel

from skinslide.arrays.native import Controls, Lookup, PatchSetup, Subdivision
from skinslide.arrays.slider import Slider
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, StageProblems, core_problem, usd_message
from skinslide.stage import controls, schema
from skinslide.stage.controls import PatchControls
from skinslide.stage.faces import read_faces
from skinslide.stage.finding import find_meshes
from skinslide.stage.marks import baked_layer
from skinslide.stage.rest import read_rest
from skinslide.stage.subdivision import read_subdivision
from skinslide.stage.textures import read_texture
from skinslide.stage.topology import Topology, read_topology
from skinslide.stage.values import FIRST, Span, merged_times, positions

T = TypeVar("T")


@dataclass(frozen=True)
class PatchedMesh:
    """A mesh with its patches. Times are stage times."""

    stage: Usd.Stage  # without it the prim would expire
    prim: Usd.Prim
    topology: Topology
    subdivision: Subdivision | None  # None where it renders as its faces
    rest_points: np.ndarray  # (V, 3) float32
    rest_source: str  # "primvars:Pref", "points (default)", ...
    patches: list[PatchSetup]  # with the controls of the first time
    animation: list[PatchControls]  # of each patch

    @property
    def path(self) -> str:
        return str(self.prim.GetPath())

    @property
    def face_counts(self) -> np.ndarray:
        return self.topology.face_counts

    @property
    def face_indices(self) -> np.ndarray:
        return self.topology.face_indices

    @property
    def vertex_count(self) -> int:
        return self.topology.vertex_count

    @property
    def left_handed(self) -> bool:
        return UsdGeom.Mesh(self.prim).GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded

    def points_times(self) -> list[float]:
        """The authored samples of points."""
        return merged_times(UsdGeom.Mesh(self.prim).GetPointsAttr().GetTimeSamples())

    @property
    def varies(self) -> bool:
        """Whether points or controls have samples."""
        return bool(self.points_times()) or any(patch.vary for patch in self.animation)

    def sample_times(self) -> list[float]:
        """The authored samples of points and of animated controls; none where there are only defaults."""
        animated = (time for patch in self.animation for time in patch.times(self._span()))
        # Points first: where times differ by noise, theirs gives a sample as it was authored.
        return merged_times([*self.points_times(), *animated])

    def _span(self) -> Span | None:
        """From the first to the last moment that the stage or the samples of points know of."""
        ends = self.points_times()
        if self.stage.HasAuthoredTimeCodeRange():
            ends = [*ends, self.stage.GetStartTimeCode(), self.stage.GetEndTimeCode()]
        return (min(ends), max(ends)) if ends else None

    def points_at(self, time: Usd.TimeCode) -> np.ndarray:
        """Cached points, float32 (V, 3)."""
        try:
            return read_points(self.prim, time, self.vertex_count)
        except Fault as fault:
            raise FrameProblem(self.problem(str(fault), time)) from fault

    def controls_at(self, time: Usd.TimeCode) -> list[Controls] | None:
        """The controls of each patch, or None where none is animated."""
        if not any(patch.vary for patch in self.animation):
            return None
        return [self.patch_controls_at(i, time) for i in range(len(self.patches))]

    def patch_controls_at(self, index: int, time: Usd.TimeCode) -> Controls:
        """The controls of the patch at `index` of `patches`."""
        try:
            return self.animation[index].at(time)
        except Fault as fault:
            raise FrameProblem(self.problem(str(fault), time, self.patches[index].name)) from fault

    def problem(self, message: str, time: Usd.TimeCode, patch: str | None = None) -> Problem:
        """An error at a time, which for the first time and the default is no frame."""
        frame = None if time.IsDefault() or time.IsEarliestTime() else time.GetValue()
        return Problem("error", self.path, patch, frame, message)

    def slider(self, lookup: str | Lookup = "auto") -> Slider:
        """The slider of all patches, or StageProblems with each patch that is bad."""
        try:
            return self.build(self.patches, lookup)
        except SliderError as error:
            if error.status == "OUT_OF_MEMORY":
                raise MemoryError(str(error)) from error
            raise StageProblems(self._patch_problems(lookup) or [self._core_problem(error)]) from error

    def build(self, patches: Sequence[PatchSetup], lookup: str | Lookup = "auto") -> Slider:
        return Slider(
            self.face_counts,
            self.face_indices,
            self.rest_points,
            patches,
            lookup=lookup,
            subdivision=self.subdivision,
        )

    def _patch_problems(self, lookup: str | Lookup) -> list[Problem]:
        """What is wrong with each patch alone: the core stops at the first."""
        found: list[Problem] = []
        for patch in self.patches:
            try:
                self.build([patch], lookup)
            except SliderError as error:
                found.append(self._core_problem(error))
        return list(dict.fromkeys(found))

    def _core_problem(self, error: SliderError) -> Problem:
        return core_problem(self.path, [patch.name for patch in self.patches], str(error))


def read_meshes(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> tuple[list[PatchedMesh], list[Problem]]:
    """Every mesh with patches that can be read, and every problem found on the way.

    A mesh comes with those of its patches that are good: whoever wants all or none looks for errors among the problems.
    """
    prims, problems = find_meshes(stage, prim_paths)
    meshes = [_read_mesh(prim, problems) for prim in prims]
    return [mesh for mesh in meshes if mesh is not None], problems


def _read_mesh(prim: Usd.Prim, problems: list[Problem]) -> PatchedMesh | None:
    path = str(prim.GetPath())
    points = _attempt(problems, path, None, _first_points, prim)
    if points is None:
        return None
    topology = _attempt(problems, path, None, read_topology, UsdGeom.Mesh(prim), len(points))
    rest = _attempt(problems, path, None, read_rest, prim, len(points))
    if topology is None:
        return None
    read = [_read_patch(prim, name, topology, problems) for name in schema.patch_names(prim)]
    good = [each for each in read if each is not None]
    if rest is None or not good:
        return None
    setups, animation = zip(*good, strict=True)
    before = len(problems)
    subdivision = None
    if any(setup.interpolation in ("auto", "limit") for setup in setups):
        subdivision = _attempt(problems, path, None, read_subdivision, UsdGeom.Mesh(prim))
    if len(problems) > before:
        return None
    return PatchedMesh(prim.GetStage(), prim, topology, subdivision, *rest, list(setups), list(animation))


def _attempt(problems: list[Problem], prim: str, patch: str | None, read: Callable[..., T], *arguments) -> T | None:
    """What `read` returns; None, and an error among the problems, where it finds a fault."""
    try:
        return read(*arguments)
    except Fault as fault:
        problems.append(Problem("error", prim, patch, None, str(fault)))
        return None


def _first_points(prim: Usd.Prim) -> np.ndarray:
    attr = UsdGeom.Mesh(prim).GetPointsAttr()
    layer = baked_layer(prim)
    if layer:
        raise Fault(
            f"points are slid already, by the bake in {layer.identifier}; slide the cache instead: open the stage "
            "without that layer, or remove the baked attributes from it"
        )
    if not attr.GetNumTimeSamples() and is_skinned(prim):
        raise Fault("points are skinned by UsdSkel and have no samples; bake the skinning first (usdbakeskinning)")
    return read_points(prim, FIRST)


def is_skinned(prim: Usd.Prim) -> bool:
    """Whether UsdSkel moves the points of a mesh."""
    joints = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("skel:jointIndices")
    shapes = UsdSkel.BindingAPI(prim).GetBlendShapeTargetsRel()
    return bool(joints and joints.HasAuthoredValue()) or bool(shapes and shapes.HasAuthoredTargets())


def read_points(prim: Usd.Prim, time: Usd.TimeCode, vertex_count: int | None = None) -> np.ndarray:
    """Points of a mesh, float32 (V, 3), and just so many where vertex_count is given."""
    try:
        value = UsdGeom.Mesh(prim).GetPointsAttr().Get(time)
    except Tf.ErrorException as error:
        raise Fault(f"points cannot be read: {usd_message(error)}") from error
    points = positions([] if value is None else value, "points")
    if not len(points):
        raise Fault("points has no value")
    if vertex_count is not None and len(points) != vertex_count:
        raise Fault(f"points has {len(points)} values, but {vertex_count} at first; the count must stay the same")
    return points


def _read_patch(
    prim: Usd.Prim, name: str, topology: Topology, problems: list[Problem]
) -> tuple[PatchSetup, PatchControls] | None:
    before, path = len(problems), str(prim.GetPath())

    def attempt(read: Callable[..., T], *arguments) -> T | None:
        return _attempt(problems, path, name, read, prim, name, *arguments)

    faces = attempt(read_faces, topology)
    tokens = {setting: attempt(schema.token, setting) for setting in ("boundary", "holes", "interpolation")}
    tokens["rule"] = attempt(schema.token, "forceDensityRule")
    corners = attempt(controls.corners, topology.vertex_count)
    painted = np.arange(topology.face_count) if faces is None else faces
    maps = {control: attempt(read_texture, control, topology, painted) for control in ("weight", "forceDensity")}
    readings = (
        attempt(controls.envelope),
        attempt(controls.weight, topology, painted, maps["weight"]),
        attempt(controls.max_distance, topology, painted),
        attempt(controls.density, topology, painted, maps["forceDensity"]),
        attempt(controls.edge_density),
    )
    if len(problems) > before:
        return None
    animation = PatchControls(*readings, maps=[read.first for read in maps.values() if read.first])
    return PatchSetup(name=name, faces=faces, corners=corners, **tokens, controls=animation.at()), animation
