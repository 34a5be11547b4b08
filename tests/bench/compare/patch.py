"""A patch to slide, in a file, and what a contestant makes of a frame of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Patch:
    """A whole mesh, slid as one patch.

    Attributes:
        name: What it is.
        counts: Vertices of each face (F,).
        indices: Vertices (sum of counts,), face by face.
        rest: Where nothing slides (V, 3).
        poses: Where it does (poses, V, 3).
        border: Places in the plane (V, 2) of the vertices of the border; NaN of the others.
    """

    name: str
    counts: np.ndarray
    indices: np.ndarray
    rest: np.ndarray
    poses: np.ndarray
    border: np.ndarray

    def save(self, path: Path) -> None:
        np.savez(path, **vars(self))

    @classmethod
    def load(cls, path: Path | str) -> Patch:
        with np.load(path) as file:
            return cls(**{**file, "name": str(file["name"])})

    def with_border(self, embedding: np.ndarray) -> Patch:
        """The same patch, with the border where an embedding has it."""
        sides, uses = np.unique(np.sort(self.sides(), axis=1), axis=0, return_counts=True)
        on_it = np.unique(sides[uses == 1])
        border = np.full((len(self.rest), 2), np.nan)
        border[on_it] = embedding[on_it]
        return replace(self, border=border)

    def sides(self) -> np.ndarray:
        """The sides of all faces (sum of counts, 2); an inner edge is there twice."""
        starts = np.cumsum(self.counts) - self.counts
        following = np.arange(1, len(self.indices) + 1)
        following[starts + self.counts - 1] = starts
        return np.column_stack([self.indices, self.indices[following]])

    def triangles(self) -> np.ndarray:
        """The faces (F, 3), which are triangles."""
        return self.indices.reshape(-1, 3)


@dataclass(frozen=True)
class Slid:
    """A frame.

    Attributes:
        seconds: Of a thread, by stage: embed, locate, interpolate.
        embedding: In the plane (V, 2).
        points: Where vertices went (V, 3).
        by_clock: Seconds are by the clock, in which the thread may have had to wait for its turn.
    """

    seconds: dict[str, float]
    embedding: np.ndarray | None
    points: np.ndarray
    by_clock: bool = False
