"""The steps of a job, as commands of the tool, from which a queue's own format is made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from skinslide.problems import UsageError


@dataclass(frozen=True)
class Job:
    """A shot in chunks.

    tool     the command `skinslide`
    stage    absolute, as layer is
    layer    what it makes; the chunks are beside it
    count    of chunks
    sliding  options of the tool that say what is slid, of every command that slides
    baking   options of a bake alone
    drawing  places of a preview, absolute, by their options; none: nothing is drawn
    """

    tool: str
    stage: Path
    layer: Path
    count: int
    sliding: Sequence[str]
    baking: Sequence[str]
    drawing: Mapping[str, Path]

    def __post_init__(self) -> None:
        """Raises UsageError for what would end a line of a script."""
        for word in map(str, (self.tool, self.stage, self.layer, *self.sliding, *self.baking, *self.drawing.values())):
            if "\n" in word:
                raise UsageError(f"{word!r}: a job cannot have a line break in it")

    @property
    def name(self) -> str:
        return f"skinslide {self.layer.stem}"

    @property
    def folder(self) -> Path:
        return self.layer.parent

    def chunk(self, number: int | str) -> str:
        """The name of a chunk; the number may be what a queue puts in its place."""
        return f"{self.layer.stem}.chunk{number}.usdc"

    @property
    def chunks(self) -> list[str]:
        return [self.chunk(number) for number in range(1, self.count + 1)]

    def bake(self, stage: str, folder: str, number: str) -> list[str]:
        """The words of a task."""
        output = f"{folder}/{self.chunk(number)}"
        part = ["--chunk", f"{number}/{self.count}", "--resume"]
        return ["bake", stage, "-o", output, *part, *self.sliding, *self.baking]

    def stitch(self, folder: str) -> list[str]:
        chunks = [f"{folder}/{chunk}" for chunk in self.chunks]
        return ["stitch", "-o", f"{folder}/{self.layer.name}", *chunks]

    def preview(self, stage: str, folder: str) -> list[str]:
        """The words of the task that draws, where there is one."""
        places = [word for flag, place in self.drawing.items() for word in (flag, self._below(place, folder))]
        return ["preview", stage, *self.sliding, *places]

    def _below(self, place: Path, folder: str) -> str:
        """A place by the name that a queue has for the folder, where it is in there."""
        inside = place.is_relative_to(self.folder)
        return f"{folder}/{place.relative_to(self.folder)}" if inside else str(place)
