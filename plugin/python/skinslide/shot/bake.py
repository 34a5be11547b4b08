"""A layer with the slid points of every mesh, to be sublayered above the cache; or the same in a stage's edit target.

At each time: points, extent, what the skin carries, rates of change, and diagnostics where they are asked for. A
mesh that UsdSkel skins is slid as it is skinned, and the layer unbinds it from its skeleton.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from pxr import Sdf, Usd, UsdGeom

from skinslide.arrays.lookup import Lookup
from skinslide.arrays.native import version
from skinslide.arrays.records import PatchResult
from skinslide.problems import FrameProblem, Problem
from skinslide.shot.advice import advice
from skinslide.shot.checks import fault
from skinslide.shot.derived import Cached, Derived
from skinslide.shot.diagnostics import MeshDiagnostics, Primvar
from skinslide.shot.frames import AUTHORED
from skinslide.shot.loop import slide
from skinslide.shot.options import ChunkOptions, Frames, LayerOptions, Prims, SlideOptions
from skinslide.shot.origins import frame_digest, is_whole, record_of
from skinslide.shot.plan import Plan, PlannedMesh, frame_of
from skinslide.shot.products import Making, MeshMaking, Product, Shot, SlidFrame, SlidFrames, given_products
from skinslide.shot.report import MEASURES, BakeReport, MeshReport, roughness_text, stretch_text
from skinslide.shot.shares import Shares
from skinslide.shot.workers import Progress
from skinslide.stage.given import StageLike, StrPath
from skinslide.write.earlier import EarlierBake, replacing_earlier_bake
from skinslide.write.inputs import check_not_input
from skinslide.write.overs import EXTENSIONS, OverLayer, author_on_stage, layer_in_place
from skinslide.write.place import check_output, given_output
from skinslide.write.target import check_target, hidden_by, spec_path

# What may be limited at each frame, in words.
_LIMITED = {
    "folded": ("{} folded faces", "are"),
    "clamped": ("{} clamped vertices", "are"),
    "stretch": ("stretch of {}", "is"),
    "added_stretch": ("stretch {} above that of the cache", "is"),
}


def bake_to_file(
    stage: StageLike,
    output: StrPath,
    *,
    prims: Prims = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
    max_stretch: float | None = None,
    max_added_stretch: float | None = None,
    max_roughness: float | None = None,
    share: bool = False,
    diagnostics: bool = False,
    also: Sequence[Product] = (),
    chunk: str | None = None,
    resume: bool = False,
) -> BakeReport:
    """Bakes a stage into a layer of overs, to sublayer above it.

    Samples are saved as they come, so memory does not grow with the number of frames. The same bake gives a `.usda` of
    the same bytes; a `.usdc` holds the same, but its bytes also depend on when it was saved.

    Args:
        stage: The stage, or its path; never written.
        output: The layer: .usda, .usdc or .usd, written whole or not at all.
        prims: Prims: the meshes with patches at and below them are baked; None: every mesh with a patch.
        frames: Stage times, or a spec such as "101:109x2"; "authored": the samples; None: the samples and, where they
            are more than one apart, the whole time codes between, since slid points do not go straight. A mesh without
            samples has one value, written as a default, whatever the frames.
        lookup: auto, egl, exact, or a Lookup; the result does not depend on it. egl fails where there is no device.
        jobs: Frames to slide at once; the result does not depend on it.
        progress: Called on this thread after each frame, with the number of frames done and of all.
        max_folded: The most faces of a patch that may be turned over at a frame; None: any number.
        max_clamped: The most vertices of a patch that may be looked up outside every face at a frame; None: any number.
        max_stretch: The most stretch that a patch may have after sliding at a frame: the RMS of log(length / rest
            length); None: any.
        max_added_stretch: The most stretch that sliding may add to a patch at a frame; None: any.
        max_roughness: The most times as roughly as its cache that a patch may move, by the largest second difference in
            time; None: any number.
        share: Searches at each frame for the least stretch that its pose allows, for the report. Slow.
        diagnostics: Writes primvars:skinSlide:stretch, slide, largestStretch, smallestStretch, areaRatio and
            stretchDirection beside the points, as the documentation of SkinSlideAPI describes them.
        also: What else to make of the frames, each of which is slid once: `Pictures`, `Maps`.
        chunk: One of several parts of the frames, such as "3/8", which `stitch` joins; None: all of them.
        resume: Bakes nothing if the output is complete already, from the same frames, set-up, cache and options.

    Returns:
        What was done, patch by patch.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or the layer cannot be written.
        StageProblems: The stage cannot be slid.
        FrameProblem: A frame cannot be slid, or is above a limit.
    """
    limits = (max_folded, max_clamped, max_stretch, max_added_stretch, max_roughness)
    given: tuple[Any, ...] = (chunk, resume)
    options, part, others = (
        SlideOptions.of(prims, frames, lookup, jobs),
        ChunkOptions(*given),
        given_products("also", also),
    )
    if others and part.resume:
        raise fault(ChunkOptions, "{resume} is for a layer alone, without pictures and maps")
    layer = _Layer(LayerOptions(*limits, share, diagnostics), part, given_output("output", output))
    return slide(Shot.of(stage), options, [layer, *_searches(layer.options), *others], progress, part.chunk)


def bake(
    stage: Usd.Stage,
    *,
    prims: Prims = None,
    frames: Frames = None,
    lookup: str | Lookup = "auto",
    jobs: int = 1,
    progress: Progress | None = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
    max_stretch: float | None = None,
    max_added_stretch: float | None = None,
    max_roughness: float | None = None,
    share: bool = False,
    diagnostics: bool = False,
    also: Sequence[Product] = (),
) -> BakeReport:
    """Bakes a stage into its edit target, once every frame has been slid.

    Memory grows with the number of frames: USD keeps what is authored until the layer is saved. An earlier bake of the
    same prims there is replaced. Where the layer also holds the cache, the cache's values move to attributes
    skinSlide:cached:*, from which the next bake into it starts.

    Args:
        stage: The stage.
        prims: As for `bake_to_file`.
        frames: As for `bake_to_file`.
        lookup: As for `bake_to_file`.
        jobs: As for `bake_to_file`.
        progress: As for `bake_to_file`.
        max_folded: As for `bake_to_file`.
        max_clamped: As for `bake_to_file`.
        max_stretch: As for `bake_to_file`.
        max_added_stretch: As for `bake_to_file`.
        max_roughness: As for `bake_to_file`.
        share: As for `bake_to_file`.
        diagnostics: As for `bake_to_file`.
        also: As for `bake_to_file`.

    Returns:
        What was done, patch by patch.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The arguments cannot be used, or the edit target takes no opinions.
        StageProblems: The stage cannot be slid.
        FrameProblem: A frame cannot be slid, or is above a limit.
    """
    check_target(stage)
    options = SlideOptions.of(prims, frames, lookup, jobs)
    limits = (max_folded, max_clamped, max_stretch, max_added_stretch, max_roughness)
    wanted, others = LayerOptions(*limits, share, diagnostics), given_products("also", also)
    with replacing_earlier_bake(stage, options.prims) as earlier:
        report = slide(Shot(stage, None), options, [_Opinions(wanted, earlier), *_searches(wanted), *others], progress)
    report.warnings.extend(_hidden(stage, (mesh.path for mesh in report.meshes)))
    return report


def _searches(options: LayerOptions) -> list[Shares]:
    return [Shares()] if options.share else []


@dataclass(frozen=True)
class _Layer:
    """A layer in a file."""

    options: LayerOptions
    part: ChunkOptions
    output: Path

    def begin(self, shot: Shot, asked: SlideOptions) -> Making:
        check_output(self.output, EXTENSIONS)
        check_not_input(self.output, shot.stage, *shot.paths)
        comment = f"Slid by skinslide {version()}. Sublayer this above the cache."
        return _BakingFile(self, asked, layer_in_place(self.output, shot.stage, comment))


@dataclass(frozen=True)
class _Opinions:
    """Opinions in the edit target of a stage."""

    options: LayerOptions
    earlier: EarlierBake

    def begin(self, shot: Shot, _options: SlideOptions) -> Making:
        return _Baking(self.options, self._authored(shot.stage), in_stage=True)

    @contextmanager
    def _authored(self, stage: Usd.Stage) -> Iterator[OverLayer]:
        overs = OverLayer(Sdf.Layer.CreateAnonymous())
        yield overs
        author_on_stage(overs, stage, self.earlier)


class _Baking(Making):
    """A layer of overs, and all that is authored in it."""

    overs: OverLayer  # while it is running

    def __init__(self, options: LayerOptions, place: AbstractContextManager[OverLayer], *, in_stage: bool):
        self.options, self._place, self._in_stage = options, place, in_stage

    def of_mesh(self, planned: PlannedMesh, report: MeshReport) -> MeshMaking:
        if self._in_stage:
            spec_path(planned.mesh.stage, planned.mesh.prim.GetPath())
        return _MeshBake(planned, report, self)

    @contextmanager
    def running(self, _report: BakeReport) -> Iterator[None]:
        with self._place as self.overs:
            yield

    def note_frame(self, _mesh: str, *_read: Iterable[Any] | None) -> None:
        """Learns what the samples of a mesh's next frame come of, as `frame_digest` takes it."""


class _BakingFile(_Baking):
    """One in a file, which says what it was baked from."""

    def __init__(self, layer: _Layer, asked: SlideOptions, place: AbstractContextManager[OverLayer]):
        super().__init__(layer.options, place, in_stage=False)
        self._layer, self._asked = layer, asked
        self._poses: dict[str, list[int]] = {}

    def planned(self, plan: Plan) -> bool:
        self._record = record_of(plan, self._layer.part.chunk, {**_given(self._asked), **_given(self._layer.options)})
        return self._layer.part.resume and is_whole(self._layer.output, self._record, plan)

    @contextmanager
    def running(self, report: BakeReport) -> Iterator[None]:
        with super().running(report):
            yield
            self._record.posed(self._poses).write(self.overs.layer)

    def note_frame(self, mesh: str, *read: Any) -> None:
        self._poses.setdefault(mesh, []).append(frame_digest(*read))


def _given(options: SlideOptions | LayerOptions) -> dict[str, Any]:
    """Those options on which the samples of a layer depend, or whether there is one, where they are not the default."""
    if isinstance(options, SlideOptions):
        return {AUTHORED: True} if options.frames == AUTHORED else {}
    asked = {each.name: getattr(options, each.name) for each in fields(options) if each.name != "share"}
    return {name: value for name, value in asked.items() if value is not None and value is not False}


class _MeshBake(MeshMaking):
    """Bakes one mesh."""

    def __init__(self, planned: PlannedMesh, report: MeshReport, baking: _Baking):
        self._mesh, self._patches, self._report, self._baking = planned.mesh, planned.slider.patches, report, baking
        self._slider, self._derived = planned.slider, Derived(planned.mesh, between=planned.between)
        self._needed: dict[Usd.TimeCode, set[Usd.TimeCode]] = {}
        self.turns = self._derived.carries
        self._diagnostics = MeshDiagnostics(planned.mesh) if baking.options.diagnostics else None

    def times_needed(self, time: Usd.TimeCode) -> set[Usd.TimeCode]:
        self._needed[time] = self._derived.times_needed(time)
        return self._needed[time]

    def read(self, _time: Usd.TimeCode) -> Callable[[SlidFrame], list[tuple[Primvar, Any]]]:
        diagnostics = self._diagnostics
        return lambda frame: diagnostics.values(frame) if diagnostics else []

    def take(self, time: Usd.TimeCode, frames: SlidFrames, made: list[tuple[Primvar, Any]]) -> None:
        frame, overs, prim = frames[time], self._baking.overs, self._mesh.prim
        self._check_limits(time, frame)
        overs.set_points(prim, frame.slid, time)
        for primvar, values in made:
            overs.set_primvar(prim.GetPath(), primvar.name, (primvar.kind, primvar.interpolation), values, time)
        for attribute, sample, value in self._derived.values(time, self._cached(time, frames), frames):
            overs.set(attribute, value, sample)

    def _cached(self, time: Usd.TimeCode, frames: SlidFrames) -> Iterable[Cached]:
        """What is derived at a time comes of; noted with all else that was read of a frame."""
        if time.IsDefault():
            return self._derived.cached(time)
        cached, poses = list(self._derived.cached(time)), (frames[at].cached for at in sorted(self._needed[time]))
        self._baking.note_frame(self._mesh.path, poses, frames[time].controls, cached)
        return cached

    def end(self) -> list[Problem]:
        self._check_roughness()
        indices = self._diagnostics.indices() if self._diagnostics else []
        for attribute in [*self._derived.blocked, *indices]:
            self._baking.overs.block(attribute)
        if self._mesh.skinning:
            self._baking.overs.end_skinning(self._mesh.prim)
        advised = advice(self._mesh, self._patches, self._slider)
        return [*advised, *self._derived.problems, *self._derived.faults()]

    def _check_limits(self, time: Usd.TimeCode, frame: SlidFrame) -> None:
        for info, result in zip(self._patches, frame.patches, strict=True):
            for message in _exceeded(result, self._baking.options):
                raise FrameProblem(Problem("error", self._mesh.path, info.name, frame_of(time), message))

    def _check_roughness(self) -> None:
        """Of all frames: a cache may be rough where the skin is not."""
        most = self._baking.options.max_roughness
        for patch in self._report.patches:
            if most is not None and patch.roughness is not None and patch.roughness > most:
                ratio = f"{roughness_text(patch.roughness)} times as roughly as the cache"
                message = f"skin moves {ratio}, where at most {most:g} times are allowed"
                raise FrameProblem(Problem("error", self._mesh.path, patch.label, patch.roughest, message))


def _exceeded(result: PatchResult, options: LayerOptions) -> Iterator[str]:
    """What a patch has at a frame that is more than it may be."""
    for name, (words, verb) in _LIMITED.items():
        most, found = getattr(options, f"max_{name}"), MEASURES[name](result)
        if most is not None and found > most:
            number = str(found) if isinstance(found, int) else stretch_text(found)
            yield f"{words.format(number)}, where at most {most:g} {verb} allowed"


def _hidden(stage: Usd.Stage, meshes: Iterable[str]) -> Iterator[Problem]:
    """Warns of meshes whose points a stronger opinion than the edit target's hides."""
    for path in meshes:
        stronger = hidden_by(UsdGeom.PointBased(stage.GetPrimAtPath(path)).GetPointsAttr())
        if stronger:
            message = f"the slid points are hidden by those in {stronger}, which is stronger"
            yield Problem("warning", path, None, None, message)
