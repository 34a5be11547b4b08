"""Puts the chunks of a bake together. Time samples of sublayers do not merge, so a shot wants them in one layer.

open every chunk                       any that is missing, or is no bake: stop here
each alone                             whole, by its own record, and not being written
each with the first                    records, clocks, attributes, defaults, and samples of frames that several have
all of them                            no frame is left out
block what any chunk blocks            as a bake of all the frames would have
stitch, or write value clips over the chunks, and put the layer in place
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, UsdUtils

from skinslide.problems import (
    Fault,
    Problem,
    StageError,
    StageProblems,
    UsageError,
    counted,
    frame_text,
    lines_text,
    problem_lines,
)
from skinslide.shot.frames import FramesLike, checked_frames, spec_of
from skinslide.stage.given import StrPath
from skinslide.stage.marks import is_marked
from skinslide.stage.opening import why_not_opened
from skinslide.write.clips import Clip, ClipLayer, block, manifest_of
from skinslide.write.overs import EXTENSIONS, clock_of
from skinslide.write.place import check_output, given_output
from skinslide.write.record import Record, joined
from skinslide.write.replacing import replacing, saved, state, writing

_ORIGINS = {
    "topology": "topology",
    "rest": "rest points",
    "setup": "set-ups or paint",
    "cache": "caches",
    "vectors": "normals, velocities or other vectors",
    "coordinates": "texture coordinates",
}
_LIMIT = "max_"  # how options begin on which no sample depends
_MOST_PARTS = 6  # of a spec in a sentence


@dataclass(frozen=True)
class StitchReport:
    """What a stitched layer holds.

    Attributes:
        prims: The paths of its meshes.
        frames: Of all of them, ascending.
        problems: What is worth knowing of them.
        manifest: The file beside a layer of clips that says what these hold; empty: there are no clips.
    """

    prims: list[str]
    frames: list[float]
    problems: list[Problem]
    manifest: str = ""

    def as_dict(self) -> dict[str, Any]:
        """The same for JSON."""
        return asdict(self)

    def text(self) -> str:
        """What it holds, and every problem, for a terminal."""
        first_to_last = f", {frame_text(self.frames[0])} to {frame_text(self.frames[-1])}" if self.frames else ""
        meshes, frames = counted(len(self.prims), "mesh", "meshes"), counted(len(self.frames), "frame")
        return lines_text([f"{meshes}, {frames}{first_to_last}", *problem_lines(self.problems)])


def stitch(
    chunks: Iterable[StrPath], output: StrPath, *, frames: FramesLike | None = None, clips: bool = False
) -> StitchReport:
    """Writes one layer with the samples of several that were baked from one stage, the same as one bake writes.

    Args:
        chunks: The paths of layers that bake wrote, each with other frames.
        output: The layer: .usda, .usdc or .usd, written whole or not at all.
        frames: The frames that the chunks must have, no more and no fewer; None: those that `chunk` split, which the
            chunks know, or else all of the shot from the first to the last that they have.
        clips: Instead of copying samples, writes value clips of the chunks, which must stay where they are, and a
            manifest beside the layer, with .manifest.DIGEST.usda behind its name. USD reads the same samples. Manifests
            of other content stay, since layers elsewhere, such as copies of an earlier layer, may name them.

    Returns:
        What the layer holds.

    Raises:
        UsageError: The arguments cannot be used, or a chunk was not written by bake.
        StageError: A chunk cannot be opened, or the layer cannot be written.
        StageProblems: A chunk is incomplete, or the chunks do not fit together or leave a frame out.
    """
    files, stitched = _given_chunks(chunks), given_output("output", output)
    asked = None if frames is None else checked_frames(frames)
    written = [stitched, manifest_of(stitched)] if clips else [stitched]
    for file in written:
        check_output(file, EXTENSIONS)
    opened = [_Chunk(file) for file in files]
    _refuse_repeated(files)
    _refuse_chunk(stitched, files)
    blocked = {path for chunk in opened for path in chunk.blocked}
    alone = [problem for chunk in opened for problem in chunk.problems()]
    among = [*_mixtures(opened), *_differences(opened, blocked), *_overlaps(opened, blocked)]
    problems = alone + among or list(_left_out(opened, asked))
    if problems:
        raise StageProblems(problems)
    opened.sort(key=lambda chunk: chunk.record.frames)
    write = _write_clips if clips else _write
    manifest = write(opened, sorted(blocked), stitched)
    return replace(_report(opened, blocked), manifest=manifest)


def _given_chunks(chunks: Iterable[StrPath]) -> list[Path]:
    given = list(chunks) if isinstance(chunks, Iterable) and not isinstance(chunks, str) else None
    if given is None or not all(isinstance(chunk, str | os.PathLike) for chunk in given):
        raise UsageError(f"chunks is {chunks!r}; it must be paths of layers")
    if not given:
        raise UsageError("there are no chunks to stitch")
    return [Path(chunk) for chunk in given]


def _refuse_repeated(files: Sequence[Path]) -> None:
    """Raises UsageError where several names are of one file."""
    for i, file in enumerate(files):
        for other in files[:i]:
            if file.samefile(other):
                same = "" if file == other else f", as {other}"
                raise UsageError(f"chunk {file}: is given twice{same}")


def _refuse_chunk(output: Path, files: Sequence[Path]) -> None:
    """Raises UsageError for an output that is a chunk."""
    if output.exists() and any(file.samefile(output) for file in files):
        raise UsageError(f"output {output}: is one of the chunks")


class _Chunk:
    """One baked layer."""

    def __init__(self, path: Path):
        self._state = state(path)
        self.path, self.layer = path, _open(path)
        self.attributes: dict[Sdf.Path, Sdf.AttributeSpec] = {}
        self.layer.Traverse(Sdf.Path.absoluteRootPath, self._add)
        if not self.attributes or not all(map(is_marked, self.attributes.values())):
            raise UsageError(f"{path} is not a layer that skinslide bake has written")
        self.blocked = [at for at, spec in self.attributes.items() if isinstance(spec.default, Sdf.ValueBlock)]
        self.fault, self.record = "", Record({})
        try:
            self.record = Record.read(self.layer)
        except Fault as fault:
            self.fault = str(fault)

    def problems(self) -> Iterator[Problem]:
        """Why it is not whole."""
        if self.fault:
            yield Problem("error", "", None, None, f"{self.path} {self.fault}")
        for prim, lost in self.record.lacking(self.layer).items():
            what = f"frames {_spec(lost)}" if lost else "its value"
            message = f"{self.path} is not whole: it lacks {what}"
            yield Problem("error", prim, None, lost[0] if lost else None, message)
        yield from self.changes()

    def changes(self) -> Iterator[Problem]:
        if state(self.path) != self._state:
            yield Problem("error", "", None, None, f"{self.path} is being written: it changed as it was read")

    def has(self, path: Sdf.Path) -> bool:
        """Whether it is to have what is on a prim: a mesh without frames in a chunk is not in it."""
        return not self.record.meshes or str(path.GetPrimPath()) in self.record.meshes

    def _add(self, path: Sdf.Path) -> None:
        spec = self.layer.GetAttributeAtPath(path) if path.IsPropertyPath() else None
        if spec:
            self.attributes[path] = spec


def _open(path: Path) -> Sdf.Layer:
    try:
        return Sdf.Layer.OpenAsAnonymous(str(path))
    except Tf.ErrorException as error:
        raise StageError(f"cannot open {path}: {why_not_opened(str(path), error)}") from error


def _mixtures(chunks: Sequence[_Chunk]) -> Iterator[Problem]:
    """What tells that chunks are not of one job: versions, options, and what their meshes were baked from."""
    recorded = [chunk for chunk in chunks if not chunk.fault]
    for first, chunk in ((recorded[0], other) for other in recorded[1:]):
        pair = f"{first.path} and {chunk.path}"
        one, other = first.record, chunk.record
        if one.version != other.version:
            message = f"{pair} were baked by skinslide {one.version} and {other.version}"
            yield Problem("error", "", None, None, message)
        for name in _unequal(_written_by(one), _written_by(other)):
            yield Problem("error", "", None, None, f"{pair} were baked with another option {name}")
        for prim in sorted(set(one.asked) ^ set(other.asked))[:1]:
            yield Problem("error", prim, None, None, f"{pair} were baked from stages of other meshes")
        if one.wanted != other.wanted:
            yield Problem("error", "", None, None, f"{pair} are parts of other frames")
        for prim in sorted(one.meshes.keys() & other.meshes.keys()):
            for name in _unequal(one.meshes[prim].origins, other.meshes[prim].origins):
                message = f"{pair} were baked from other {_ORIGINS.get(name, name)}"
                yield Problem("error", prim, None, None, message)


def _written_by(record: Record) -> dict[str, Any]:
    return {name: value for name, value in record.options.items() if not name.startswith(_LIMIT)}


def _left_out(chunks: Sequence[_Chunk], asked: list[float] | None) -> Iterator[Problem]:
    """Frames that are in no chunk, and where it was said which are wanted, those that are too many."""
    there = {frame for chunk in chunks for frame in chunk.record.frames}
    wanted = asked or sorted(chunks[0].record.wanted)
    missing = sorted(set(wanted) - there) if there else []
    if missing:
        files = ", ".join(str(chunk.path) for chunk in chunks)
        yield Problem("error", "", None, missing[0], f"{_count(missing)} in none of {files}: {_spec(missing)}")
    for chunk in chunks if asked else ():
        more = sorted(set(chunk.record.frames).difference(wanted))
        if more:
            message = f"{_count(more)} not asked for, but in {chunk.path}: {_spec(more)}"
            yield Problem("error", "", None, more[0], message)
    if not wanted:
        yield from _gaps(chunks)


def _gaps(chunks: Sequence[_Chunk]) -> Iterator[Problem]:
    """Frames of the shot that lie between what chunks have."""
    framed = sorted((chunk for chunk in chunks if chunk.record.frames), key=lambda chunk: chunk.record.frames[0])
    last = framed[0] if framed else None
    for chunk in framed[1:]:
        assert last
        end, begin = last.record.after, chunk.record.before
        if chunk.record.frames[0] > last.record.frames[-1] and end is not None and end < chunk.record.frames[0]:
            to = f" to {frame_text(begin)}" if begin is not None and begin > end else ""
            lost = f"no chunk has frame{'s' * bool(to)} {frame_text(end)}{to} of the shot"
            message = f"{lost}, between {last.path} and {chunk.path}; where others are wanted, name them"
            yield Problem("error", "", None, end, message)
        last = max(last, chunk, key=lambda each: each.record.frames[-1])


def _count(frames: Sequence[float]) -> str:
    return counted(len(frames), "frame is", "frames are")


def _spec(frames: Sequence[float]) -> str:
    parts = spec_of(frames).split(",")
    return ",".join(parts[:_MOST_PARTS]) + (",..." if parts[_MOST_PARTS:] else "")


def _differences(chunks: Sequence[_Chunk], blocked: set[Sdf.Path]) -> Iterator[Problem]:
    """What tells that chunks are not of one stage: clocks, prims, attributes, and values that do not vary."""
    first = chunks[0]
    for chunk in chunks[1:]:
        pair = f"{first.path} and {chunk.path}"
        for field in _unequal(clock_of(first.layer), clock_of(chunk.layer)):
            yield Problem("error", "", None, None, f"{pair} differ in {field}")
        for path in sorted((first.attributes.keys() ^ chunk.attributes.keys()) - blocked):
            if not (first.has(path) and chunk.has(path)):
                continue
            only = first if path in first.attributes else chunk
            yield Problem(
                "error", str(path.GetPrimPath()), None, None, f"{path.name} is in {only.path}, not in both {pair}"
            )
        for path in sorted((first.attributes.keys() & chunk.attributes.keys()) - blocked):
            one, other = first.attributes[path], chunk.attributes[path]
            if (one.typeName, one.default) != (other.typeName, other.default):
                yield Problem("error", str(path.GetPrimPath()), None, None, f"{path.name} differs between {pair}")


def _unequal(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    return [key for key in sorted(one.keys() | other.keys()) if one.get(key) != other.get(key)]


def _overlaps(chunks: Sequence[_Chunk], blocked: set[Sdf.Path]) -> Iterator[Problem]:
    """Frames that several chunks have, each with another value."""
    for path in sorted({path for chunk in chunks for path in chunk.attributes} - blocked):
        owners: dict[float, _Chunk] = {}
        for chunk in chunks:
            for time in chunk.layer.ListTimeSamplesForPath(path):
                owner = owners.setdefault(time, chunk)
                if owner is chunk or owner.layer.QueryTimeSample(path, time) == chunk.layer.QueryTimeSample(path, time):
                    continue
                message = f"{path.name} differs between {owner.path} and {chunk.path}"
                yield Problem("error", str(path.GetPrimPath()), None, time, message)


def _write(chunks: Sequence[_Chunk], blocked: Iterable[Sdf.Path], output: Path) -> str:
    with replacing(output) as partial:
        with writing(output):
            layer = Sdf.Layer.CreateNew(str(partial))
        for chunk in chunks:
            UsdUtils.StitchLayers(layer, chunk.layer)
            _save(layer, output)  # a crate file takes what is saved out of memory
        block(layer, blocked)
        joined([chunk.record for chunk in chunks]).write(layer)
        _save(layer, output)
        _refuse_changed(chunks)
    return ""


def _write_clips(chunks: Sequence[_Chunk], blocked: Sequence[Sdf.Path], output: Path) -> str:
    """Gives the manifest's file."""
    made = ClipLayer([Clip(chunk.path, chunk.layer, chunk.record) for chunk in chunks], blocked, output)
    _refuse_chunk(made.manifest_file, [chunk.path for chunk in chunks])
    with made.in_place():
        _refuse_changed(chunks)
    return str(made.manifest_file)


def _refuse_changed(chunks: Sequence[_Chunk]) -> None:
    """Raises StageProblems where a chunk is another than it was when it was read."""
    changed = [problem for chunk in chunks for problem in chunk.changes()]
    if changed:
        raise StageProblems(changed)


def _save(layer: Sdf.Layer, output: Path) -> None:
    with writing(output):
        saved(layer.Save())


def _report(chunks: Sequence[_Chunk], blocked: set[Sdf.Path]) -> StitchReport:
    frames = {
        time for chunk in chunks for path in chunk.attributes for time in chunk.layer.ListTimeSamplesForPath(path)
    }
    prims = {str(path.GetPrimPath()) for chunk in chunks for path in chunk.attributes}
    problems = []
    for path in sorted(blocked):
        where = [str(chunk.path) for chunk in chunks if path in chunk.blocked]
        if len(where) < len(chunks):
            message = f"{path.name} is blocked at all frames, as in {', '.join(where)}"
            problems.append(Problem("warning", str(path.GetPrimPath()), None, None, message))
    return StitchReport(sorted(prims), sorted(frames), problems)
