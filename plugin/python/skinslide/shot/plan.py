"""What is going to be slid: a slider for every mesh, and the times at which it is wanted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

from pxr import Usd

from skinslide.arrays.lookup import Lookup
from skinslide.arrays.slider import Slider
from skinslide.problems import Problem, StageProblems, UsageError, counted, errors, frame_text, in_place_of
from skinslide.shot.frames import AUTHORED, AskedFrames, Chunk
from skinslide.shot.options import SlideOptions
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes


class PlannedMesh(NamedTuple):
    mesh: PatchedMesh
    slider: Slider
    times: list[Usd.TimeCode]  # ascending
    between: bool  # whether the frames between samples are slid too, be they among these or not

    @property
    def frames(self) -> list[float]:
        """The times, without the default time."""
        return [time.GetValue() for time in self.times if not time.IsDefault()]


@dataclass(frozen=True)
class Plan:
    """Everything to slide, known to be possible."""

    meshes: list[PlannedMesh]
    paths: list[str]  # of the meshes of all chunks
    problems: list[Problem]  # warnings
    wanted: list[float]  # every frame of any mesh, of which a chunk takes a part
    own: list[float]  # those of the shot, whatever was asked for

    @classmethod
    def read(cls, stage: Usd.Stage, options: SlideOptions, chunk: Chunk | None = None) -> Plan:
        """Raises StageProblems where any mesh cannot be slid, and UsageError for a chunk of more parts than frames."""
        found, problems = read_sliders(stage, options.prims, options.lookup, options.jobs)
        if errors(problems):
            raise StageProblems(problems)
        planned = [_planned(mesh, slider, options.frames) for mesh, slider in found if slider]
        if options.frames is None:
            problems += [note for mesh, *_ in planned for note in mesh.between_problems()]
        wanted = sorted({frame for mesh in planned for frame in mesh.frames})
        problems += [note for mesh, *_ in planned for note in beyond(mesh, options.named)]
        own = sorted({frame for mesh, *_ in planned for frame in _own_frames(mesh)}) if options.named else wanted
        paths = [each.mesh.path for each in planned]
        return cls(_part(planned, set(chunk.of(wanted))) if chunk else planned, paths, problems, wanted, own)

    def check_patches(self, wanted: Sequence[str] | None) -> None:
        """Raises UsageError for no names, and StageProblems for those that no mesh has."""
        there = sorted({patch.name for planned in self.meshes for patch in planned.mesh.patches})
        if wanted is not None and not wanted:
            raise UsageError("patches: there are no names in it")
        missing = [name for name in wanted or () if name not in there]
        if missing:
            raise StageProblems(
                [Problem("error", "", name, None, f"no mesh has it; {in_place_of(name, there)}") for name in missing]
            )


def _own_frames(mesh: PatchedMesh) -> list[float]:
    """None where they are so many that they have to be named."""
    with suppress(StageProblems, UsageError):
        return mesh.frame_times()
    return []


def _part(meshes: Sequence[PlannedMesh], frames: set[float]) -> list[PlannedMesh]:
    """The meshes with only these frames; a default value is in every chunk."""
    parts = [
        mesh._replace(times=[time for time in mesh.times if time.IsDefault() or time.GetValue() in frames])
        for mesh in meshes
    ]
    return [part for part in parts if part.times]


def read_sliders(
    stage: Usd.Stage, prims: Sequence[str] | None, lookup: str | Lookup = "auto", jobs: int = 1
) -> tuple[list[tuple[PatchedMesh, Slider | None]], list[Problem]]:
    """Every mesh that can be read, with a slider unless a patch of it is bad, and every problem."""
    meshes, problems = read_meshes(stage, prims)
    sliders: list[Slider | None] = []
    for mesh in meshes:
        try:
            sliders.append(mesh.slider(lookup, jobs))
            problems.extend(mesh.weld_problems())
        except StageProblems as bad:
            sliders.append(None)
            problems.extend(bad.problems)
    return list(zip(meshes, sliders, strict=True)), problems


def outside(mesh: PatchedMesh, named: Sequence[float]) -> list[float]:
    """The frames that are beyond the mesh's samples, if it has any."""
    samples = mesh.sample_times()
    return [frame for frame in named if samples and not samples[0] <= frame <= samples[-1]]


def beyond(mesh: PatchedMesh, named: Sequence[float]) -> Iterator[Problem]:
    """Warns of frames beyond the samples of a mesh, where USD holds the nearest."""
    frames = outside(mesh, named)
    if frames:
        samples = mesh.sample_times()
        span = f"from {frame_text(samples[0])} to {frame_text(samples[-1])}"
        count = counted(len(frames), "frame is", "frames are")
        message = f"{count} beyond the samples, which go {span}; the nearest is held there"
        yield Problem("warning", mesh.path, None, frames[0], message)


def _planned(mesh: PatchedMesh, slider: Slider, asked: AskedFrames) -> PlannedMesh:
    between = asked != AUTHORED and mesh.interpolates
    return PlannedMesh(mesh, slider, times_of(mesh, asked), between)


def times_of(mesh: PatchedMesh, asked: AskedFrames) -> list[Usd.TimeCode]:
    """When a mesh is wanted, ascending.

    One that never changes has one value, whatever was asked; so has one whose splines have no knots.
    """
    if not mesh.varies:
        return [Usd.TimeCode.Default()]
    times = mesh.frame_times() if asked is None else mesh.sample_times() if isinstance(asked, str) else asked
    return [Usd.TimeCode(time) for time in times] or [Usd.TimeCode.Default()]


def frame_of(time: Usd.TimeCode) -> float | None:
    """None for the default time."""
    return None if time.IsDefault() else time.GetValue()
