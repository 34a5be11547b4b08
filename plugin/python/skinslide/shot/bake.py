"""Slides the skin of a stage's meshes at every frame:

meshes, problems = read the stage              any error: stop here, nothing is written
for each mesh: its slider                      patches embedded at rest, once a shot
for each mesh:
    times = --frames, or the authored samples of points and animated controls, or the default
    for each time in order, and the times beside it that velocities need, each once, several at once:
        points and controls at that time       read on this thread
        slide                                  on a thread of the pool
    for each time in order: author points, extent, normals, velocities, accelerations, and diagnostics where asked for
put the layer in place                         or author it all into the stage's edit target
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.native import Lookup
from skinslide.arrays.slider import Slider
from skinslide.problems import FrameProblem, Problem, StageProblems, UsageError
from skinslide.shot.derived import Derived, Solved
from skinslide.shot.options import BakeOptions, Frames
from skinslide.shot.plan import Plan, PlannedMesh, frame_of
from skinslide.shot.report import BakeReport, MeshReport
from skinslide.shot.workers import Progress, pool_of, work_ahead
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.opening import open_stage
from skinslide.stage.schema import SLIDE, STRETCH
from skinslide.write.earlier import replacing_earlier_bake
from skinslide.write.overs import EXTENSIONS, OverLayer, author_on_stage, layer_in_place
from skinslide.write.place import check_not_input, check_output

# Primvars, each with the field of skinslide.arrays.slider.Diagnostics that it holds.
DIAGNOSTICS = {STRETCH: "stretch_after", SLIDE: "slide"}


def bake_to_file(
    stage_path: str | os.PathLike,
    output_path: str | os.PathLike,
    *,
    prims: Sequence[str] | str | None = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
    diagnostics: bool = False,
) -> BakeReport:
    """Bakes a stage into a layer of overs to be sublayered above it. `output_path` is written whole or not at all.

    prims     paths of prims, to bake the meshes with patches at and below them; None: every mesh with a patch
    frames    stage times, or a spec such as "101:109x2"; None: the authored samples; a mesh without samples has one
              value, written as a default, whatever the frames
    lookup    auto, egl, exact, or a Lookup; the result does not depend on it. egl fails where it cannot be had
    jobs      frames slid at once; the result does not depend on it
    progress  called after each frame with the frames done and in all
    diagnostics  writes primvars:skinSlide:stretch and primvars:skinSlide:slide beside the points
    Raises UsageError, StageProblems, FrameProblem (also where max_folded or max_clamped is exceeded), StageError.
    """
    output = Path(output_path)
    options = BakeOptions.checked(prims, frames, lookup, jobs, max_folded, max_clamped, diagnostics)
    stage = open_stage(stage_path)
    check_output(output, EXTENSIONS)
    check_not_input(output, stage, stage_path)
    plan = Plan.read(stage, options)
    _check_primvars(plan)
    with layer_in_place(output, stage) as overs:
        return _run(plan, overs, progress)


def bake(
    stage: Usd.Stage,
    *,
    prims: Sequence[str] | str | None = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
    diagnostics: bool = False,
) -> BakeReport:
    """Bakes a stage into its edit target, once every frame is known; arguments and exceptions as `bake_to_file`'s.

    Takes the place of an earlier bake there, of the same prims. Where the layer holds the cache too, the cache's values
    move to attributes skinSlide:cached:*, from which the next bake into it starts.
    """
    options = BakeOptions.checked(prims, frames, lookup, jobs, max_folded, max_clamped, diagnostics)
    target = stage.GetEditTarget().GetLayer()
    if not target.permissionToEdit or stage.IsLayerMuted(target.identifier):
        fault = "not editable" if not target.permissionToEdit else "muted"
        raise UsageError(f"the edit target {target.identifier} is {fault}")
    with replacing_earlier_bake(stage, options.prims) as earlier:
        plan = Plan.read(stage, options)
        _check_primvars(plan)
        _check_target(stage.GetEditTarget(), plan)
        overs = OverLayer(Sdf.Layer.CreateAnonymous())
        report = _run(plan, overs, progress)
        author_on_stage(overs, stage, earlier)
    report.warnings.extend(_hidden(plan.meshes, target))
    return report


def _run(plan: Plan, overs: OverLayer, progress: Progress | None) -> BakeReport:
    """Authors every mesh into overs."""
    report = BakeReport(list(plan.problems))
    with pool_of(plan.options.jobs, plan.frame_count) as pool:
        for mesh, slider, times in plan.meshes:
            work = _MeshBake(mesh, slider, pool, plan.options)
            report.meshes.append(work.report)
            for _ in work.run(times, overs):
                if progress:
                    progress(report.frame_count, plan.frame_count)
            report.warnings.extend(work.derived.problems)
    return report


class _MeshBake:
    """Bakes one mesh."""

    def __init__(self, mesh: PatchedMesh, slider: Slider, pool: ThreadPoolExecutor, options: BakeOptions):
        self.derived = Derived(mesh)
        self.report = MeshReport.start(mesh.path, mesh.vertex_count, mesh.rest_source, slider.patches)
        self._mesh, self._slider, self._pool = mesh, slider, pool
        self._limits = {"folded_faces": options.max_folded, "clamped_vertices": options.max_clamped}
        self._in_flight = options.jobs + 1  # one is read while the others are slid
        self._diagnostics = options.diagnostics
        self._blocked = _indices(mesh) if options.diagnostics else []

    def run(self, times: list[Usd.TimeCode], overs: OverLayer) -> Iterator[Usd.TimeCode]:
        """Authors the mesh at `times`, ascending; yields each once it is done."""
        needed = [self.derived.times_needed(time) for time in times]
        last_use = {time: index for index, wanted in enumerate(needed) for time in wanted}
        solutions = work_ahead(self._mesh, sorted(set().union(*needed)), self._read, self._pool, self._in_flight)
        solved: dict[Usd.TimeCode, Solved] = {}
        for index, (time, wanted) in enumerate(zip(times, needed, strict=True)):
            while not wanted <= solved.keys():
                solved.update([next(solutions)])
            self._author(time, solved, overs)
            yield time
            for old in [other for other in solved if last_use[other] <= index]:
                del solved[old]
        for attribute in [*self.derived.blocked, *self._blocked]:
            overs.block(attribute)

    def _read(self, time: Usd.TimeCode) -> Callable[[], Solved]:
        points, controls = self._mesh.points_at(time), self._mesh.controls_at(time)

        def slide() -> Solved:
            frame = self._slider.slide(points, controls)
            measured = self._slider.diagnose(points, frame.points, controls) if self._diagnostics else None
            return Solved(points, frame.points, frame.patches, measured)

        return slide

    def _author(self, time: Usd.TimeCode, solved: dict[Usd.TimeCode, Solved], overs: OverLayer) -> None:
        geometry = UsdGeom.PointBased(self._mesh.prim)
        self._check_limits(time, solved[time])
        points = Vt.Vec3fArray.FromNumpy(solved[time].slid)
        overs.set(geometry.GetPointsAttr(), points, time)
        overs.set(geometry.GetExtentAttr(), UsdGeom.PointBased.ComputeExtent(points), time)
        if solved[time].diagnostics:
            for name, field in DIAGNOSTICS.items():
                values = Vt.FloatArray.FromNumpy(getattr(solved[time].diagnostics, field))
                overs.set_primvar(self._mesh.prim.GetPath(), name, values, time)
        for attribute, sample, value in self.derived.values(time, solved):
            overs.set(attribute, value, sample)
        self.report.add(frame_of(time), solved[time].patches)

    def _check_limits(self, time: Usd.TimeCode, solved: Solved) -> None:
        for field, most in self._limits.items():
            for info, result in zip(self._slider.patches, solved.patches, strict=True):
                count = getattr(result, field)
                if most is not None and count > most:
                    message = f"{count} {field.replace('_', ' ')}, where at most {most} are allowed"
                    raise FrameProblem(Problem("error", self._mesh.path, info.name, frame_of(time), message))


def _indices(mesh: PatchedMesh) -> list[Usd.Attribute]:
    """Those of primvars that the stage has under these names: they would choose among the values that are written."""
    primvars = [UsdGeom.Primvar(mesh.prim.GetAttribute(name)) for name in DIAGNOSTICS if mesh.prim.HasAttribute(name)]
    return [primvar.GetIndicesAttr() for primvar in primvars if primvar.IsIndexed()]


def _hidden(meshes: list[PlannedMesh], target: Sdf.Layer) -> Iterator[Problem]:
    """Warns of meshes whose points a stronger layer than the target has an opinion on."""
    for mesh, _slider, _times in meshes:
        opinions = UsdGeom.PointBased(mesh.prim).GetPointsAttr().GetPropertyStack()
        valued = [spec.layer for spec in opinions if spec.HasInfo("default") or spec.HasInfo("timeSamples")]
        if valued and valued[0] != target:
            message = f"the slid points are hidden by those in {valued[0].identifier}, which is stronger"
            yield Problem("warning", mesh.path, None, None, message)


def _check_primvars(plan: Plan) -> None:
    """Raises StageProblems where the stage has something else under the names of the diagnostics."""
    found = []
    for mesh, _slider, _times in plan.meshes if plan.options.diagnostics else []:
        for name in DIAGNOSTICS:
            other = _what_else(mesh.prim.GetProperty(name)) if mesh.prim.HasProperty(name) else None
            if other:
                message = f"{name} is {other}; a bake with diagnostics writes float[] there, one a vertex"
                found.append(Problem("error", mesh.path, None, None, message))
    if found:
        raise StageProblems(found)


def _what_else(found: Usd.Property) -> str | None:
    """What a property is, other than a primvar of a float for each element."""
    if not isinstance(found, Usd.Attribute):
        return "a relationship"
    if found.GetTypeName() != Sdf.ValueTypeNames.FloatArray:
        return str(found.GetTypeName())
    size = UsdGeom.Primvar(found).GetElementSize()
    return None if size == 1 else f"of elementSize {size}"


def _check_target(target: Usd.EditTarget, plan: Plan) -> None:
    for mesh, _slider, _times in plan.meshes:
        if not target.MapToSpecPath(mesh.prim.GetPath()):
            raise UsageError(f"the edit target {target.GetLayer().identifier} cannot hold opinions on {mesh.path}")
