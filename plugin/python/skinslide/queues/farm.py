"""Writes a job for a farm: tasks that each bake a chunk of frames, one that stitches them, one that draws.

meshes = read the stage                     any error, or a frame that it does not have: stop here
frames = what a bake would write            divided into chunks
steps = the commands of each                in the words of the queue that is asked for
put the job in place
"""

from __future__ import annotations

import os
import sysconfig
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from skinslide.problems import Problem, StageProblems, counted, errors, frame_text, lines_text, problem_lines
from skinslide.queues.openjd import template
from skinslide.queues.slurm import script
from skinslide.queues.steps import Job
from skinslide.shot.checks import Options
from skinslide.shot.frames import checked_frames, spec_of
from skinslide.shot.options import FarmOptions, Frames, LayerOptions, Prims, SlideOptions
from skinslide.shot.plan import outside, times_of
from skinslide.stage.given import StageLike, StrPath, given_file
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from skinslide.write.inputs import check_not_input
from skinslide.write.overs import EXTENSIONS
from skinslide.write.place import check_output, given_output
from skinslide.write.replacing import replacing, writing

# How a queue's job is written, what its name ends in, and what other names do.
_QUEUES: dict[str, tuple[Callable[[Job], str], str, tuple[str, ...]]] = {
    "openjd": (template, ".openjd.json", (".json", ".yaml", ".yml")),
    "slurm": (script, ".slurm.sh", (".sh",)),
}
_MADE = ".usdc"  # of a job whose own name was given


@dataclass(frozen=True)
class FarmReport:
    """What a job will do.

    Attributes:
        job: The file that was written.
        layer: What the job will make.
        chunks: The layers that its tasks will bake, in order.
        frames: All of them, ascending.
        problems: What is worth knowing of the stage.
    """

    job: str
    layer: str
    chunks: list[str]
    frames: list[float]
    problems: list[Problem]

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)

    def text(self) -> str:
        """What it will do, and every problem, for a terminal."""
        frames, tasks = counted(len(self.frames), "frame"), counted(len(self.chunks), "task")
        span = f"{frame_text(self.frames[0])} to {frame_text(self.frames[-1])}"
        return lines_text([f"{frames}, {span}, in {tasks}", *problem_lines(self.problems)])


def farm(
    stage: StageLike,
    output: StrPath,
    *,
    chunk: int,
    form: str = "openjd",
    prims: Prims = None,
    frames: Frames = None,
    max_folded: int | None = None,
    max_clamped: int | None = None,
    max_stretch: float | None = None,
    max_added_stretch: float | None = None,
    max_roughness: float | None = None,
    diagnostics: bool = False,
    pictures: StrPath | None = None,
    html: StrPath | None = None,
) -> FarmReport:
    """Writes a job that bakes a shot on a farm, with the same samples as one bake of all the frames.

    A task that is run again bakes nothing if its chunk is complete, so a job that failed can be run again as it is.

    Args:
        stage: The stage, as it is in its file, or its path, which must be the same on the machines of the farm.
        output: The layer that the job is to make, .usda, .usdc or .usd; the job and its chunks are written beside it.
            Or the job; its layer then has the same name.
        chunk: The most frames that a task bakes.
        form: openjd, an Open Job Description template; slurm, a script that submits an array of tasks and what follows.
        prims: As for `bake_to_file`.
        frames: As for `bake_to_file`; none may be beyond the samples.
        max_folded: As for `bake_to_file`, of each task.
        max_clamped: As for `bake_to_file`, of each task.
        max_stretch: As for `bake_to_file`, of each task.
        max_added_stretch: As for `bake_to_file`, of each task.
        max_roughness: As for `bake_to_file`, of each task.
        diagnostics: As for `bake_to_file`.
        pictures: A folder for pictures of all frames, which one task draws at the end; None: none.
        html: A page of them; None: none.

    Returns:
        What the job will do.

    Raises:
        TypeError: The stage or the prims are of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or the job cannot be written.
        StageProblems: The stage cannot be slid, or does not have one of the frames.
    """
    file = given_file(stage)
    sliding, own = SlideOptions.of(prims, frames, "auto", 1), FarmOptions(chunk, form)
    limits = (max_folded, max_clamped, max_stretch, max_added_stretch, max_roughness)
    baking = LayerOptions(*limits, False, diagnostics)
    write, suffix, names = _QUEUES[own.form]
    job_file, layer = _places(given_output("output", output), suffix, names)
    wanted, problems = _wanted(file, [job_file, layer], sliding)
    job = Job(
        tool=_tool(),
        stage=Path(os.path.abspath(file)),
        layer=Path(os.path.abspath(layer)),
        count=-(-len(wanted) // own.chunk),
        sliding=[*_words(sliding, "prims"), *(["--frames", _spec(frames)] if frames is not None else [])],
        baking=list(_words(baking)),
        drawing=_drawing(pictures, html),
    )
    with replacing(job_file) as partial, writing(job_file):
        partial.write_text(write(job), encoding="utf-8")
    chunks = [str(layer.with_name(name)) for name in job.chunks]
    return FarmReport(str(job_file), str(layer), chunks, wanted, problems)


def _places(output: Path, suffix: str, own: tuple[str, ...]) -> tuple[Path, Path]:
    """Of the job and of the layer. Raises UsageError."""
    if output.suffix.lower() in own:
        check_output(output, own)
        stem = output.name.removesuffix(suffix) if output.name.endswith(suffix) else output.stem
        return output, output.with_name(stem + _MADE)
    check_output(output, (*EXTENSIONS, *own))
    job = output.with_name(output.stem + suffix)
    check_output(job, own)
    return job, output


def _wanted(stage: Path, written: list[Path], options: SlideOptions) -> tuple[list[float], list[Problem]]:
    """The frames that a bake would write, and what there is to say. Raises StageProblems."""
    opened = open_stage(stage)
    for file in written:
        check_not_input(file, opened, stage)
    meshes, problems = read_meshes(opened, options.prims)
    problems += _beyond(meshes, options.named)
    if errors(problems):
        raise StageProblems(problems)
    times = {time.GetValue() for mesh in meshes for time in times_of(mesh, options.frames) if not time.IsDefault()}
    if not times:
        raise StageProblems(
            [
                Problem(
                    "error",
                    "",
                    None,
                    None,
                    "nothing that is slid has samples, so there are no frames to divide; use skinslide bake",
                )
            ]
        )
    return sorted(times), problems


def _beyond(meshes: list[PatchedMesh], named: list[float]) -> Iterator[Problem]:
    """The frames that no mesh has: a bake would hold others there, and a job of them is a mistake."""
    moving = [mesh for mesh in meshes if mesh.sample_times()]
    lost = set(named).intersection(*(outside(mesh, named) for mesh in moving))
    if lost and moving:
        message = f"{len(lost)} of the frames are beyond the samples of every mesh"
        yield Problem("error", "", None, min(lost), message)


def _tool() -> str:
    """The command, where it is here; where it is elsewhere, queues have ways to say so."""
    script = Path(sysconfig.get_path("scripts")) / "skinslide"
    return str(script) if script.exists() else script.name


def _spec(frames: Any) -> str:
    """As it was given, or as many words."""
    return frames if isinstance(frames, str) else spec_of(checked_frames(frames))


def _words(options: Options, *names: str) -> Iterator[str]:
    """Options as they stand on a command line: those named, or all, that are not as by default."""
    for each in fields(options):
        value = getattr(options, each.name)
        if (names and each.name not in names) or value is None or value is False:
            continue
        for one in value if isinstance(value, list) else [value]:
            yield from [each.metadata["flag"]] if one is True else [each.metadata["flag"], str(one)]


def _drawing(pictures: StrPath | None, html: StrPath | None) -> dict[str, Path]:
    """The places of a preview, by their options; none where it is not wanted."""
    places = {"-o": pictures, "--html": html}
    return {flag: Path(os.path.abspath(place)) for flag, place in places.items() if place}
