"""Files of meshes and frames, such as MESH.KIND.FRAME.exr, in one folder; each is put in place in one step."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from decimal import Decimal
from pathlib import Path

from pxr import Sdf, Usd

from skinslide.problems import UsageError, frame_text
from skinslide.stage import schema
from skinslide.stage.finding import patched_prims
from skinslide.stage.given import StrPath
from skinslide.stage.textures import texture_files
from skinslide.write.inputs import Inputs
from skinslide.write.place import check_output, check_place, given_output, nearest_folder, not_writable
from skinslide.write.replacing import replacing, writing

_PLACES = 6  # of a frame's fraction; layer offsets leave noise beyond


class OutputFolder:
    """Where files of meshes are written. The folder is not made before the first file is."""

    def __init__(self, folder: StrPath, stage: Usd.Stage, stage_path: StrPath | None):
        """Raises UsageError for a folder that cannot be used."""
        self.folder, prims = given_output("folder", folder), patched_prims(stage)
        # A resolver may find maps where their names alone do not lead.
        maps = [file for prim in prims for patch in schema.patch_names(prim) for file in texture_files(prim, patch)]
        self._inputs = Inputs(stage, *maps, *([] if stage_path is None else [stage_path]))
        self._names = _mesh_names(prims)
        check_place(self.folder, _fault)

    def path(self, mesh: Sdf.Path, words: Sequence[str], frame: float | None, extension: str) -> Path:
        """MESH.WORD.FRAME.extension, of each word; of no frame for the default time."""
        at = [] if frame is None else [frame_label(frame)]
        return self.folder / ".".join([self._names[mesh], *words, *at, extension])

    def check(self, output: Path) -> None:
        """Raises UsageError for a file that cannot be written, or that the stage reads."""
        if self.folder.is_dir() or not self.folder.exists():  # else making the folder fails, and says why
            check_output(output, [output.suffix], made=self.folder)
            self._inputs.refuse(output)

    def check_all(self, outputs: Iterable[Path]) -> None:
        """`check` of files that may be very many: those that are there already, and the one with the longest name."""
        there: set[str] = set()
        with suppress(OSError):  # nothing there yet, or nothing to be seen
            there.update(os.listdir(self.folder))
        longest: tuple[int, Path] | None = None
        for output in outputs:
            if output.name in there:
                self.check(output)
            length = len(os.fsencode(output.name))
            if longest is None or length > longest[0]:
                longest = length, output
        if longest:
            self.check(longest[1])

    def write(self, output: Path, data: bytes) -> None:
        """Raises UsageError, StageError; the file is then as it was."""
        with writing(self.folder):
            self.folder.resolve().mkdir(parents=True, exist_ok=True)
        self.check(output)
        with replacing(output) as partial, writing(output):
            partial.write_bytes(data)


def check_frames(frames: Sequence[float]) -> None:
    """Raises UsageError for frames whose files would have one name."""
    seen: dict[str, float] = {}
    for frame in frames:
        other = seen.setdefault(frame_label(frame), frame)
        if other != frame:
            raise UsageError(
                f"frames {other!r} and {frame!r} are too near to be told apart by the names of their files"
            )


def frame_label(frame: float) -> str:
    """1001, 0007, -0007; 1001_25 for 1001.25, since a dot would end the number for those who look for sequences."""
    if abs(frame) >= 1e15:
        return frame_text(frame)
    number = Decimal(round(frame, _PLACES)).quantize(Decimal(1).scaleb(-_PLACES))
    whole, _, fraction = f"{abs(number):f}".partition(".")
    fraction = fraction.rstrip("0")
    return ("-" if number < 0 else "") + whole.zfill(4) + (f"_{fraction}" if fraction else "")


def _mesh_names(prims: Sequence[Usd.Prim]) -> dict[Sdf.Path, str]:
    """The end of each path that no other has, joined by dots: body_GEO, or hero.body_GEO where there are several.

    Letters that differ in case alone are the same to some file systems.
    """
    paths = [prim.GetPath() for prim in prims]
    words = {path: str(path).strip("/").split("/") for path in paths}
    folded = [[word.casefold() for word in words[path]] for path in paths]
    return {path: ".".join(words[path][-_depth(own, folded) :]) for path, own in zip(paths, folded, strict=True)}


def _depth(own: list[str], all_words: list[list[str]]) -> int:
    for depth in range(1, len(own)):
        if sum(other[-depth:] == own[-depth:] for other in all_words) == 1:
            return depth
    return len(own)


def _fault(folder: Path) -> str | None:
    """Why files cannot be put in the folder, which is made where it is missing."""
    nearest = nearest_folder(folder)
    own = nearest == folder.resolve()
    if not nearest.is_dir():
        return f"{'' if own else nearest} is not a folder".lstrip()
    if not os.access(nearest, os.W_OK | os.X_OK):
        return not_writable("" if own else f"the folder {nearest}")
    return None
