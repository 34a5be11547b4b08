"""The meshes of a stage that carry patches, as arrays: what a bake and a check need to know of each."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.derived import DerivedMeaning
from skinslide.arrays.lookup import Lookup
from skinslide.arrays.meaning import MeshMeaning, Weld
from skinslide.arrays.schema import DEFAULT_TIME, Input, inputs
from skinslide.arrays.setups import Controls, PatchSetup, Subdivision
from skinslide.arrays.slider import Slider
from skinslide.arrays.topology import Topology
from skinslide.arrays.values import merge_times, positions, times_between
from skinslide.problems import (
    Fault,
    FrameProblem,
    Problem,
    SliderError,
    StageProblems,
    UsageError,
    core_problem,
    counted,
)
from skinslide.stage.finding import FoundMesh, find_meshes, find_skinned, is_skinned
from skinslide.stage.following import carried, offered
from skinslide.stage.neighbours import Neighbours
from skinslide.stage.patch import Animation, read_patches
from skinslide.stage.skinning import SkinnedPoints, SkinnedVectors, Skinning
from skinslide.stage.values import FIRST, Source, Span, noting, read_value, take


@dataclass(frozen=True)
class PatchedMesh:
    """A mesh with its patches. Times are stage times."""

    stage: Usd.Stage  # without it the prim would expire
    prim: Usd.Prim
    meaning: MeshMeaning
    topology: Topology
    subdivision: Subdivision | None  # None where it renders as its faces
    rest_points: np.ndarray  # (V, 3) float32
    patches: list[PatchSetup]  # with the controls of the first time
    animation: list[Animation]  # of each patch
    skinning: Skinning | None = None  # None where UsdSkel leaves it alone
    space: np.ndarray | None = None  # (3, 3) takes points to where lengths are taken; None: its own space
    neighbours: Neighbours | None = None  # of meshes read together; None: it has no patches

    @classmethod
    def of(
        cls,
        prim: Usd.Prim,
        meaning: MeshMeaning,
        animation: list[Animation],
        skinning: Skinning | None,
        neighbours: Neighbours | None = None,
    ) -> PatchedMesh:
        topology, rest = Topology.of(meaning), meaning.rest_points()
        patches = [each.setup for each in animation]
        kinds = (meaning.subdivision(), rest, patches, animation, skinning, meaning.space(), neighbours)
        return cls(prim.GetStage(), prim, meaning, topology, *kinds)

    @property
    def rest_source(self) -> str:
        """Where rest points were found: "primvars:Pref", "points (default)", ..."""
        return self.meaning.rest_source

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
        return self.meaning.left_handed

    def drawn_subdivision(self) -> Subdivision | None:
        """How the mesh renders, also where no patch depends on it. Raises Fault."""
        if any(each.needs_subdivision for each in self.animation):
            return self.subdivision
        meaning, _ = take_mesh(self.prim)
        faults = take_subdivision(self.prim, meaning)
        if faults:
            raise Fault(faults[0])
        return meaning.subdivision()

    def points_times(self) -> list[float]:
        """The authored samples of points, and of what skins them."""
        if self.skinning:
            return merge_times(self.skinning.times())
        return merge_times(UsdGeom.Mesh(self.prim).GetPointsAttr().GetTimeSamples())

    @property
    def varies(self) -> bool:
        """Whether points or controls have samples."""
        return bool(self.points_times()) or any(patch.varies for patch in self.animation)

    def sample_times(self) -> list[float]:
        """The authored samples of points and of animated controls; none where there are only defaults."""
        animated = (time for patch in self.animation for time in patch.times(self._span()))
        # Points first: where times differ by noise, theirs gives a sample as it was authored.
        return merge_times([*self.points_times(), *animated])

    def animated_times(self) -> list[list[float]]:
        """When controls of each patch were authored; those of a spline that is too long to list are left out."""
        found: list[list[float]] = []
        for patch in self.animation:
            try:
                found.append(patch.times(self._span()))
            except UsageError:
                found.append(patch.samples())
        return found

    @property
    def interpolates(self) -> bool:
        """Whether what is cached goes straight from sample to sample, and does not stay."""
        return self.stage.GetInterpolationType() == Usd.InterpolationTypeLinear

    def frame_times(self) -> list[float]:
        """Samples, and the frames between those that lie more than one time code apart.

        A spline has its own. Raises StageProblems where they are too many.
        """
        samples = self.sample_times()
        if not self.interpolates:
            return samples
        authored = merge_times([*self.points_times(), *(time for patch in self.animation for time in patch.samples())])
        try:
            return merge_times([*samples, *times_between(authored)])
        except Fault as fault:
            raise StageProblems([self.problem(str(fault), FIRST)]) from fault

    def interpolation_of(self, patch: PatchSetup) -> str:
        """That of a patch; what auto comes to on this mesh."""
        if patch.interpolation != "auto":
            return patch.interpolation
        return "limit" if self.subdivision else "linear"

    def between_problems(self) -> Iterator[Problem]:
        """Says how many frames lie between samples."""
        count = len(self.frame_times()) - len(self.sample_times())
        if count:
            slid = counted(count, "frame between samples is", "frames between samples are")
            why = "slid points do not go straight from sample to sample"
            message = f"{slid} slid too, for {why}; --frames authored leaves them out"
            yield Problem("note", self.path, None, None, message)

    def _span(self) -> Span | None:
        """From the first to the last moment that the stage or the samples of points know of."""
        ends = self.points_times()
        if self.stage.HasAuthoredTimeCodeRange():
            ends = [*ends, self.stage.GetStartTimeCode(), self.stage.GetEndTimeCode()]
        return (min(ends), max(ends)) if ends else None

    def points_at(self, time: Usd.TimeCode) -> np.ndarray:
        """Cached points, float32 (V, 3)."""
        try:
            authored = self.meaning.points(read_value(UsdGeom.Mesh(self.prim).GetPointsAttr(), time))
            return self.skinning.points(authored, time) if self.skinning else authored
        except Fault as fault:
            raise FrameProblem(self.problem(str(fault), time)) from fault

    def drawn_points(self, points: np.ndarray) -> np.ndarray:
        """Points (V, 3) as pictures show them: those off the patches that are not finite where they are at rest.

        At the origin where no face has them, and they are nowhere at rest either.
        """
        shown = np.isfinite(points).all(axis=1) | self._patched
        somewhere = np.isfinite(self.rest_points).all(axis=1)
        return np.where(shown[:, None], points, np.where(somewhere[:, None], self.rest_points, np.float32(0)))

    @cached_property
    def _patched(self) -> np.ndarray:
        """Which points are of a patch, bool (V,)."""
        return self.topology.vertices_of(np.concatenate([patch.faces for patch in self.patches]))

    @property
    def skeleton(self) -> str:
        """The path of the Skeleton by which UsdSkel skins it; empty: it does not."""
        return self.skinning.skeleton if self.skinning else ""

    def bound_points(self) -> np.ndarray | None:
        """The default value of points, float32 (V, 3), as `SkinnedPoints` has it; None where there is none."""
        wanted = next(each for each in inputs("mesh") if each.when == DEFAULT_TIME)
        source = _source(self.prim, wanted, self.skinning)
        return positions(source.first()) if source.at(Usd.TimeCode.Default()) else None

    def derived_sources(self, meaning: DerivedMeaning) -> Iterator[Source]:
        """Where values that follow from points come from."""
        turned = {UsdGeom.Tokens.normals, *(each.name for each in self._carried)}
        for wanted in (*inputs("derived"), *offered(self.prim, meaning)):
            yield self._skinned(wanted) if self.skinning and wanted.name in turned else Source(self.prim, wanted)

    def skinned_vectors(self) -> list[SkinnedVectors]:
        """Normals, and other vectors that turn as they do, that it may have."""
        normals = [each for each in inputs("derived") if each.name == UsdGeom.Tokens.normals]
        return [self._skinned(each) for each in (*normals, *self._carried)] if self.skinning else []

    @cached_property
    def _carried(self) -> list[Input]:
        return carried(self.prim, self.meaning) if self.skinning else []

    def _skinned(self, wanted: Input) -> SkinnedVectors:
        assert self.skinning
        return SkinnedVectors(self.prim, wanted, self.skinning, self.face_indices)

    def controls_at(self, time: Usd.TimeCode) -> list[Controls] | None:
        """The controls of each patch, or None where none is animated."""
        if not any(patch.varies for patch in self.animation):
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

    def slider(self, lookup: str | Lookup = "auto", jobs: int = 1) -> Slider:
        """The slider of all patches, or StageProblems with each patch that is bad."""
        try:
            return self.build(self.patches, lookup, jobs)
        except SliderError as error:
            if error.status == "OUT_OF_MEMORY":
                raise MemoryError(str(error)) from error
            raise StageProblems(self._patch_problems(lookup) or [self._core_problem(error)]) from error

    def build(self, patches: Sequence[PatchSetup], lookup: str | Lookup = "auto", jobs: int = 1) -> Slider:
        return Slider(
            self.face_counts,
            self.face_indices,
            self.rest_points,
            patches,
            lookup=lookup,
            subdivision=self.subdivision,
            weld=self.weld.vertices,
            space=self.space,
            jobs=jobs,
        )

    @cached_property
    def weld(self) -> Weld:
        """Which points are one, whatever frames are slid. Raises SliderError."""
        try:
            return self.meaning.weld(self.patches, self._poses())
        except Fault as fault:
            raise SliderError("BAD_ARGUMENT", str(fault)) from fault

    def _poses(self) -> Iterator[tuple[float, np.ndarray]]:
        """All that the cache has, but for those that cannot be slid."""
        for time in map(Usd.TimeCode, self.points_times()) if self.points_times() else [Usd.TimeCode.Default()]:
            with contextlib.suppress(FrameProblem):
                yield 0 if time.IsDefault() else time.GetValue(), self.points_at(time)

    def warnings(self) -> Iterator[Problem]:
        """What rest points and patches are warned of."""
        for said in filter(None, (self.meaning.rest_warning, self.meaning.warning, self.meaning.space_warning)):
            yield Problem("warning", self.path, None, None, said)
        for patch, each in zip(self.patches, self.animation, strict=True):
            if each.warning:
                yield Problem("warning", self.path, patch.name, None, each.warning)

    def weld_problems(self) -> Iterator[Problem]:
        """Points in one place that are not one."""
        info = self.weld.info
        if info.parted_points:
            frame = info.parted_frame if self.points_times() else None
            part = counted(info.parted_points, "point parts from others in its", "points part from others in their")
            first = f"points {info.parted_from} and {info.parted_vertex} first"
            message = f"{part} place at rest, {first}: they are not welded"
            yield Problem("note", self.path, None, frame, message)
        if info.refused_points:
            are = counted(info.refused_points, "point is", "points are")
            message = f"{are} in one place with others and cannot be welded: {info.refused}"
            yield Problem("note", self.path, None, None, message)

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
    found, problems = find_meshes(stage, prim_paths)
    neighbours = Neighbours(stage)
    meshes = [_read_mesh(each, neighbours, problems) for each in found]
    return [mesh for mesh in meshes if mesh is not None], problems


def read_skinned(stage: Usd.Stage, prim_paths: Sequence[str] | None) -> tuple[list[PatchedMesh], list[Problem]]:
    """Every mesh that UsdSkel skins, without patches, and every problem found on the way."""
    found, problems = find_skinned(stage, prim_paths)
    meshes = [_read_skinned(each.prim, problems) for each in found]
    return [mesh for mesh in meshes if mesh is not None], problems


def _read_skinned(prim: Usd.Prim, problems: list[Problem]) -> PatchedMesh | None:
    try:
        return read_moving(prim)
    except Fault as fault:
        problems.append(Problem("error", str(prim.GetPath()), None, None, str(fault)))
        return None


def read_moving(prim: Usd.Prim) -> PatchedMesh:
    """A mesh as it moves, skinned where UsdSkel does so, without patches. Raises Fault."""
    skinning = Skinning(prim) if is_skinned(prim) else None
    meaning, faults = take_mesh(prim, skinning)
    if faults:
        raise Fault(faults[0])
    return PatchedMesh.of(prim, meaning, [], skinning)


def _read_mesh(found: FoundMesh, neighbours: Neighbours, problems: list[Problem]) -> PatchedMesh | None:
    prim, path = found.prim, str(found.prim.GetPath())

    def say(faults: Sequence[str], patch: str | None = None) -> None:
        problems.extend(Problem("error", path, patch, None, fault) for fault in faults)

    try:
        skinning = Skinning(prim) if found.is_skinned else None
    except Fault as fault:
        say([str(fault)])
        return None
    meaning, faults = take_mesh(prim, skinning)
    faults += take_space(prim, meaning) if meaning.has_faces else []
    say(faults)
    if not meaning.has_faces:
        return None
    read = list(read_patches(prim, dict.fromkeys(found.patches), meaning, neighbours))
    for name, _, wrong in read:
        say(wrong, name)
    animation = [good for _, good, _ in read if good]
    if faults or not animation:
        return None
    faults = take_subdivision(prim, meaning) if any(each.needs_subdivision for each in animation) else []
    say(faults)
    if faults:
        return None
    mesh = PatchedMesh.of(prim, meaning, animation, skinning, neighbours)
    problems.extend(mesh.warnings())
    return mesh


def take_mesh(prim: Usd.Prim, skinning: Skinning | None = None) -> tuple[MeshMeaning, list[str]]:
    """The points, faces and rest points of a mesh, and what is wrong with them."""
    meaning, faults = MeshMeaning(), []
    points, *others = (_source(prim, each, skinning) for each in inputs("mesh"))
    faults += take(meaning, [points])
    faults = faults or take(meaning, others)
    for each in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues():
        interpolation = each.GetAttr().GetMetadata("interpolation")
        meaning.offer(each.GetName(), str(each.GetTypeName()), interpolation)
    return meaning, faults


def take_space(prim: Usd.Prim, meaning: MeshMeaning) -> list[str]:
    """How the transforms above a mesh scale it, at each time at which they were authored. Returns what is wrong."""
    faults: list[str] = []
    above = (UsdGeom.Xformable(each) for each in _and_above(prim))
    times = sorted({time for each in above if each for time in each.GetTimeSamples()})
    with noting(faults):
        for time in [FIRST, *map(Usd.TimeCode, times)]:
            matrix = UsdGeom.XformCache(time).GetLocalToWorldTransform(prim)
            meaning.take_space(np.array(matrix), 0.0 if time.IsEarliestTime() else time.GetValue())
    return faults


def _and_above(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    while prim:
        yield prim
        prim = prim.GetParent()


def _source(prim: Usd.Prim, wanted: Input, skinning: Skinning | None) -> Source:
    is_points = wanted.property() == UsdGeom.Tokens.points
    return SkinnedPoints(prim, wanted, skinning) if skinning and is_points else Source(prim, wanted)


def read_faces_of_mesh(prim: Usd.Prim) -> MeshMeaning:
    """A mesh with its points and faces, and with its rest points where they can be read. Raises Fault."""
    meaning, faults = take_mesh(prim)
    if not meaning.has_faces:
        raise Fault(faults[0])
    return meaning


def take_subdivision(prim: Usd.Prim, meaning: MeshMeaning) -> list[str]:
    """How the mesh is subdivided. Returns what is wrong."""
    return take(meaning, [Source(prim, each) for each in inputs("subdivision")])
