"""Puts the chunks of a bake together. Time samples of sublayers do not merge, so a shot wants them in one layer.

open every chunk                       any that is missing, or is no bake: stop here
compare                                clocks, attributes, defaults, and samples of frames that several chunks have
block what any chunk blocks            as a bake of all the frames would have
stitch, and put the layer in place
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, UsdUtils

from skinslide.problems import Problem, StageError, StageProblems, UsageError, frame_text, lines_text
from skinslide.stage.given import StrPath
from skinslide.stage.marks import is_marked
from skinslide.stage.opening import why_not_opened
from skinslide.write.overs import EXTENSIONS
from skinslide.write.place import check_output, given_output, replacing, saved, writing

# Fields of a chunk that say what is in it.
_OWN_FIELDS = {"primChildren", "comment"}


@dataclass(frozen=True)
class StitchReport:
    """What a stitched layer holds.

    Attributes:
        prims: The paths of its meshes.
        frames: Of all of them, ascending.
        problems: What is worth knowing of them.
    """

    prims: list[str]
    frames: list[float]
    problems: list[Problem]

    def text(self) -> str:
        """What it holds, and every problem, for a terminal."""
        first_to_last = f", {frame_text(self.frames[0])} to {frame_text(self.frames[-1])}" if self.frames else ""
        meshes = f"{len(self.prims)} mesh{'es' * (len(self.prims) != 1)}"
        return lines_text([f"{meshes}, {len(self.frames)} frames{first_to_last}", *map(str, self.problems)])


def stitch(chunks: Iterable[StrPath], output: StrPath) -> StitchReport:
    """Writes one layer with the samples of several that were baked from one stage: the layer of one bake.

    Args:
        chunks: The paths of layers that bake wrote, each with other frames.
        output: The layer: .usda, .usdc or .usd, written whole or not at all.

    Returns:
        What the layer holds.

    Raises:
        UsageError: Arguments that cannot be, or a layer that no bake wrote.
        StageError: A chunk cannot be opened, or the layer not be written.
        StageProblems: The chunks do not fit together.
    """
    files, stitched = _given_chunks(chunks), given_output("output", output)
    check_output(stitched, EXTENSIONS)
    opened = [_Chunk(file) for file in files]
    _refuse_repeated(files)
    if stitched.exists() and any(file.samefile(stitched) for file in files):
        raise UsageError(f"output {stitched}: is one of the chunks")
    blocked = {path for chunk in opened for path in chunk.blocked}
    problems = [*_differences(opened, blocked), *_overlaps(opened, blocked)]
    if problems:
        raise StageProblems(problems)
    _write(opened, sorted(blocked), stitched)
    return _report(opened, blocked)


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


class _Chunk:
    """One baked layer."""

    def __init__(self, path: Path):
        self.path, self.layer = path, _open(path)
        self.attributes: dict[Sdf.Path, Sdf.AttributeSpec] = {}
        self.layer.Traverse(Sdf.Path.absoluteRootPath, self._add)
        if not self.attributes or not all(map(is_marked, self.attributes.values())):
            raise UsageError(f"{path} is not a layer that skinslide bake has written")
        self.blocked = [at for at, spec in self.attributes.items() if isinstance(spec.default, Sdf.ValueBlock)]

    def _add(self, path: Sdf.Path) -> None:
        spec = self.layer.GetAttributeAtPath(path) if path.IsPropertyPath() else None
        if spec:
            self.attributes[path] = spec

    def clock(self) -> dict[str, Any]:
        """Everything that says how the layer is to be read."""
        root = self.layer.pseudoRoot
        return {field: root.GetInfo(field) for field in sorted(set(root.ListInfoKeys()) - _OWN_FIELDS)}


def _open(path: Path) -> Sdf.Layer:
    try:
        return Sdf.Layer.OpenAsAnonymous(str(path))
    except Tf.ErrorException as error:
        raise StageError(f"cannot open {path}: {why_not_opened(str(path), error)}") from error


def _differences(chunks: Sequence[_Chunk], blocked: set[Sdf.Path]) -> Iterator[Problem]:
    """What tells that chunks are not of one stage: clocks, prims, attributes, and values that do not vary."""
    first = chunks[0]
    for chunk in chunks[1:]:
        pair = f"{first.path} and {chunk.path}"
        for field in _unequal(first.clock(), chunk.clock()):
            yield Problem("error", "", None, None, f"{pair} differ in {field}")
        for path in sorted((first.attributes.keys() ^ chunk.attributes.keys()) - blocked):
            only = first if path in first.attributes else chunk
            yield Problem(
                "error", str(path.GetPrimPath()), None, None, f"{path.name} is in {only.path}, not in both {pair}"
            )
        for path in sorted((first.attributes.keys() & chunk.attributes.keys()) - blocked):
            one, other = first.attributes[path], chunk.attributes[path]
            if (one.typeName, one.default) != (other.typeName, other.default):
                yield Problem("error", str(path.GetPrimPath()), None, None, f"{path.name} differs between {pair}")


def _unequal(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
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


def _write(chunks: Sequence[_Chunk], blocked: Iterable[Sdf.Path], output: Path) -> None:
    with replacing(output) as partial:
        with writing(output):
            layer = Sdf.Layer.CreateNew(str(partial))
        for chunk in chunks:
            UsdUtils.StitchLayers(layer, chunk.layer)
            _save(layer, output)  # a crate file takes what is saved out of memory
        for path in blocked:
            spec = layer.GetAttributeAtPath(path)
            spec.ClearInfo("timeSamples")
            spec.default = Sdf.ValueBlock()
        _save(layer, output)


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
