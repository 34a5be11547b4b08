"""Says what a bake would slide, patch by patch, and everything that is wrong or worth knowing."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from pxr import Usd

from skinslide.arrays.lookup import Lookup, choose_lookup
from skinslide.arrays.meaning import Texture
from skinslide.arrays.records import PatchInfo
from skinslide.arrays.setups import PatchSetup
from skinslide.arrays.slider import Slider
from skinslide.problems import (
    Problem,
    SliderError,
    StageProblems,
    UsageError,
    counted,
    errors,
    frame_text,
    lines_text,
    problem_lines,
)
from skinslide.shot.advice import advice
from skinslide.shot.candidates import Candidate, find_candidates
from skinslide.shot.derived import Derived
from skinslide.shot.loop import slide
from skinslide.shot.options import SlideOptions
from skinslide.shot.plan import read_sliders
from skinslide.shot.products import Shot
from skinslide.shot.report import PatchReport, share_text
from skinslide.shot.samples import sample_problems
from skinslide.shot.shares import Shares
from skinslide.shot.workers import Progress
from skinslide.stage.finding import patched_prims
from skinslide.stage.given import PrimsLike, StageLike, given_paths, given_stage
from skinslide.stage.mesh import PatchedMesh

_MOST_PIECES = 20  # of a patch, with a line each


@dataclass(frozen=True)
class CheckedPatch:
    """One piece of a patch.

    Attributes:
        name: Of the patch.
        piece: Its number, from 1.
        pieces: How many the patch has.
        vertices: Of the piece.
        edges: Of the piece.
        faces: Of the piece.
        free: Vertices that may slide.
        holes: Boundary loops but the longest.
        held: Vertices on borders that would slide, but stay since another mesh meets them.
        zero_length_edges: Of no length at rest.
        collapsed_faces: Of no area in the rest embedding.
        folded_faces: Turned over in the rest embedding.
        rule: By which it slides.
        interpolation: linear, meanValue or limit.
    """

    name: str
    piece: int
    pieces: int
    vertices: int
    edges: int
    faces: int
    free: int
    holes: int
    held: int
    zero_length_edges: int
    collapsed_faces: int
    folded_faces: int
    rule: str
    interpolation: str


@dataclass(frozen=True)
class CheckedMap:
    """A texture that is painted by, at the first time.

    Attributes:
        patch: The name of the patch.
        name: Of the attribute that names the file.
        file: As it was found.
        channel: The one that is used.
        st: The primvar at which it is sampled.
        tiles: Those that the patch lies in; 0 is the one image of a texture without.
        width: Of the largest tile, in texels.
        height: Of the largest tile, in texels.
    """

    patch: str
    name: str
    file: str
    channel: str
    st: str
    tiles: list[int]
    width: int
    height: int


@dataclass(frozen=True)
class CheckedMesh:
    """A mesh that a bake would slide.

    Attributes:
        path: Of the prim.
        points: How many it has.
        faces: How many it has.
        rest: Where its rest points were found, such as primvars:Pref.
        welded: Points that are one with others, since they are in one place.
        samples: The stage times that would be written, the frames between samples of the stage too.
        patches: Every piece of every patch.
        maps: The textures that are painted by.
        skeleton: The path of the Skeleton by which UsdSkel skins it; empty: it does not.
    """

    path: str
    points: int
    faces: int
    rest: str
    welded: int
    samples: list[float]
    patches: list[CheckedPatch]
    maps: list[CheckedMap]
    skeleton: str


@dataclass(frozen=True)
class CheckedLookup:
    """What a bake would look up with.

    Attributes:
        lookup: egl or exact.
        reason: Why; empty where it cannot be otherwise.
        device: What egl draws with, or would; empty where there is none.
        renderer: As the driver names it.
        driver: Its version.
        software: Whether it is a software rasteriser.
    """

    lookup: str
    reason: str
    device: str
    renderer: str
    driver: str
    software: bool

    @classmethod
    def choose(cls, lookup: Lookup) -> CheckedLookup:
        """What a lookup comes to on this machine.

        Args:
            lookup: What is asked for.

        Returns:
            What a bake would have.

        Raises:
            SliderError: It cannot be had.
        """
        chosen = choose_lookup(lookup)
        device = chosen
        if chosen.lookup != "egl":
            with contextlib.suppress(SliderError):
                device = choose_lookup(replace(lookup, method="egl"))
        reason = chosen.reason or ("asked for" if lookup.method != "auto" else "")
        return cls(chosen.lookup, reason, device.device_name, device.renderer, device.driver, bool(device.software))

    def lines(self) -> Iterator[str]:
        """The same for a terminal."""
        yield f"lookup {self.lookup}" + (f": {self.reason}" if self.reason else "")
        kind = "a software rasteriser" if self.software else "hardware"
        device = f"{self.device}: {self.renderer}, {self.driver}, {kind}" if self.device else "no device"
        yield f"  {'' if self.lookup == 'egl' else 'egl would have '}{device}"


@dataclass(frozen=True)
class CheckedShare:
    """Of the stretch of a patch that can be removed, what sliding removes, over the frames at which any can.

    Attributes:
        prim: The path of the mesh.
        patch: The patch, with its piece where it has several.
        least: The least of the frames: 1 leaves nothing to gain, below 0 sliding adds stretch.
        median: And their median.
    """

    prim: str
    patch: str
    least: float
    median: float


@dataclass(frozen=True)
class CheckReport:
    """What a bake would slide, and all there is to say about it.

    Attributes:
        stage: Its path, or its identifier.
        meshes: Those that would be slid.
        problems: Errors, then warnings, then notes.
        lookup: What would be looked up with.
        candidates: Where nothing is set up, the meshes on which a patch could be.
        shares: Of each patch, where they are asked for, and a bake would not fail.
    """

    stage: str
    meshes: list[CheckedMesh]
    problems: list[Problem]
    lookup: CheckedLookup
    candidates: list[Candidate]
    shares: list[CheckedShare] = field(default_factory=list)

    @property
    def failed(self) -> bool:
        """Whether there are errors, with which nothing would be baked."""
        return bool(errors(self.problems))

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)

    def text(self, *, lookup: bool = True) -> str:
        """A line for each mesh, patch and problem, and the verdict.

        Args:
            lookup: Whether there are lines of what would be looked up with, too.

        Returns:
            The lines.
        """
        lines = [line for mesh in self.meshes for line in _mesh_lines(mesh)]
        lines += [line for mesh in self.candidates for line in mesh.lines()]
        lines += [f"{each.prim}: {each.patch}: {share_text(each.least, each.median)}" for each in self.shares]
        lines += self.lookup.lines() if lookup else ()
        return lines_text([*lines, *problem_lines(self.problems), self._verdict()])

    def _verdict(self) -> str:
        counts = {kind: sum(p.severity == kind for p in self.problems) for kind in ("error", "warning", "note")}
        found = [counted(count, kind) for kind, count in counts.items() if count]
        patches = counted(sum(len(mesh.patches) for mesh in self.meshes), "patch", "patches")
        meshes = counted(len(self.meshes), "mesh", "meshes")
        return f"{self.stage}: {meshes}, {patches}: {', '.join(found) or 'no problems'}"


def _mesh_lines(mesh: CheckedMesh) -> Iterator[str]:
    if mesh.samples:
        first, last = frame_text(mesh.samples[0]), frame_text(mesh.samples[-1])
        samples = f"{counted(len(mesh.samples), 'sample')}, {first} to {last}"
    else:
        samples = "no samples"
    welded = f", {mesh.welded} of them welded" if mesh.welded else ""
    skinned = f", skinned by {mesh.skeleton}" if mesh.skeleton else ""
    faces = counted(mesh.faces, "face")
    yield f"{mesh.path}: {mesh.points} points{welded}, {faces}{skinned}, rest from {mesh.rest}, {samples}"
    for name in dict.fromkeys(patch.name for patch in mesh.patches):
        yield from _patch_lines(name, [patch for patch in mesh.patches if patch.name == name])
    for used in mesh.maps:
        tiles = f", tiles {', '.join(map(str, used.tiles))}" if used.tiles != [0] else ""
        size = f"{used.width} x {used.height}"
        yield f"  {used.name}: {used.file}, channel {used.channel}, {size}{tiles}, at primvars:{used.st}"


def _patch_lines(name: str, pieces: Sequence[CheckedPatch]) -> Iterator[str]:
    """A line for each piece, or one for more than anyone reads."""
    counts = ("vertices", "free", "edges", "faces", "holes")
    if len(pieces) > _MOST_PIECES:
        spans = [(count, [getattr(piece, count) for piece in pieces]) for count in counts]
        ranges = ", ".join(f"{count} {min(found)} to {max(found)}" for count, found in spans)
        yield f"  {name}: {len(pieces)} pieces, {ranges}"
        return
    for piece in pieces:
        label = name if piece.pieces == 1 else f"{name} ({piece.piece} of {piece.pieces})"
        how = f"{piece.rule}, {piece.interpolation}"
        yield f"  {label}: {how}, " + ", ".join(f"{count} {getattr(piece, count)}" for count in counts)


def check(
    stage: StageLike,
    prims: PrimsLike | None = None,
    *,
    lookup: str | Lookup = "auto",
    share: bool = False,
    jobs: int = 1,
    progress: Progress | None = None,
) -> CheckReport:
    """Says what a bake would slide, patch by patch, and every problem. Reads every sample, and changes nothing.

    Args:
        stage: The stage, or its path.
        prims: Prims to look at, with everything below them; None: the whole stage.
        lookup: The lookup that a bake would be given: auto, egl, exact, or a Lookup.
        share: Slides every frame, and searches for the least stretch that its pose allows. Slow.
        jobs: Frames to slide at once for that.
        progress: Called on this thread after each of these frames, with the number of frames done and of all.

    Returns:
        The meshes, and the problems; those that are errors would stop a bake.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The lookup cannot be had.
        StageError: The stage cannot be opened.
        FrameProblem: With `share`, a frame cannot be slid.
    """
    try:
        chosen = CheckedLookup.choose(Lookup.of(lookup))
    except SliderError as error:
        raise UsageError(str(error)) from error
    paths = None if prims is None else given_paths("prims", prims)
    opened = given_stage(stage)
    name = opened.GetRootLayer().identifier if isinstance(stage, Usd.Stage) else str(stage)
    found, problems = read_sliders(opened, paths)
    checked = [_check_mesh(mesh, slider, problems) for mesh, slider in found]
    severities = ("error", "warning", "note")
    problems.sort(key=lambda problem: severities.index(problem.severity))
    candidates = [] if patched_prims(opened) else find_candidates(opened, paths)
    shares = []
    if share and not errors(problems):
        slid = slide(Shot(opened, None), SlideOptions.of(prims, None, lookup, jobs), [Shares()], progress)
        shares = [_share(mesh.path, patch) for mesh in slid.meshes for patch in mesh.patches if patch.shares]
    return CheckReport(name, checked, problems, chosen, candidates, shares)


def _share(prim: str, patch: PatchReport) -> CheckedShare:
    return CheckedShare(prim, patch.label, min(patch.shares), float(np.median(patch.shares)))


def _check_mesh(mesh: PatchedMesh, slider: Slider | None, problems: list[Problem]) -> CheckedMesh:
    pieces = [info for each in ([slider] if slider else _good_sliders(mesh)) for info in each.patches]
    named = {patch.name: patch for patch in mesh.patches}
    patches = [_checked(info, named[info.name], mesh) for info in pieces]
    for name in dict.fromkeys(patch.name for patch in patches):
        problems += _patch_problems(mesh, [patch for patch in patches if patch.name == name])
    problems += advice(mesh, pieces, slider)
    derived = Derived(mesh, between=mesh.interpolates)
    problems += [*derived.problems, *derived.sample_faults()]
    samples = mesh.sample_times()
    problems += sample_problems(mesh, slider, samples)
    try:
        times = mesh.frame_times()
        problems += mesh.between_problems()
    except StageProblems as bad:
        times = samples
        problems += bad.problems
    pairs = zip(mesh.patches, mesh.animation, strict=True)
    used = [_checked_map(patch.name, each) for patch, read in pairs for each in read.textures]
    faces = mesh.topology.face_count
    welded = mesh.weld.info.welded_points if slider else 0
    return CheckedMesh(
        mesh.path, mesh.vertex_count, faces, mesh.rest_source, welded, times, patches, used, mesh.skeleton
    )


def _checked_map(patch: str, used: Texture) -> CheckedMap:
    width, height = max(used.sizes.values())
    return CheckedMap(patch, used.name, used.file, used.channel, used.st, list(used.sizes), width, height)


def _good_sliders(mesh: PatchedMesh) -> Iterator[Slider]:
    """A slider for each patch that makes one."""
    for patch in mesh.patches:
        try:
            slider = mesh.build([patch])
        except SliderError:
            continue
        yield slider


def _checked(info: PatchInfo, patch: PatchSetup, mesh: PatchedMesh) -> CheckedPatch:
    return CheckedPatch(
        name=info.name,
        piece=info.piece + 1,
        pieces=info.piece_count,
        vertices=info.vertex_count,
        edges=info.edge_count,
        faces=info.face_count,
        free=info.free_count,
        holes=info.hole_count,
        held=info.held_count,
        zero_length_edges=info.zero_length_edges,
        collapsed_faces=info.collapsed_faces,
        folded_faces=info.folded_faces,
        rule=patch.rule,
        interpolation=mesh.interpolation_of(patch),
    )


def _patch_problems(mesh: PatchedMesh, pieces: list[CheckedPatch]) -> Iterator[Problem]:
    """What is worth knowing of the pieces of one patch, a line for each kind."""
    counts = (
        ("edge has", "edges have", "no length at rest", sum(piece.zero_length_edges for piece in pieces)),
        ("face has", "faces have", "no area in the rest embedding", sum(piece.collapsed_faces for piece in pieces)),
        ("face turns", "faces turn", "over in the rest embedding", sum(piece.folded_faces for piece in pieces)),
    )
    for one, many, what, count in counts:
        if count:
            yield Problem("warning", mesh.path, pieces[0].name, None, f"{counted(count, one, many)} {what}")
