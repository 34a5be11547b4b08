"""A mesh of a stage with its patches, as arrays: what a bake and a check need to know of it."""

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
from skinslide.stage.following import carried, offered
from skinslide.stage.neighbours import Neighbours
from skinslide.stage.patch import Animation
from skinslide.stage.skinned import SkinnedVectors
from skinslide.stage.skinning import Skinning
from skinslide.stage.taking import source_of, take_mesh, take_subdivision
from skinslide.stage.values import FIRST, Source, Span, read_value


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
        source = source_of(self.prim, wanted, self.skinning)
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
        for warning in filter(None, (self.meaning.rest_warning, self.meaning.warning, self.meaning.space_warning)):
            yield Problem("warning", self.path, None, None, warning)
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
