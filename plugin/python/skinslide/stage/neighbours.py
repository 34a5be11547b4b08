"""Other meshes of a stage in the space of one, whose points may meet its own, as a head does those of a body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from hashlib import sha256
from typing import NamedTuple

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from skinslide.problems import Fault
from skinslide.stage.finding import is_skinned
from skinslide.stage.skinning import Skinning
from skinslide.stage.values import FIRST, triples_of

# Odd numbers by which the bits of three coordinates become one number.
_MIXERS = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
# Meshes below a payload that is not loaded are slid too, where they are defined outside of it.
_LOADED_OR_NOT = Usd.PrimIsActive & Usd.PrimIsDefined & ~Usd.PrimIsAbstract


class Neighbour(NamedTuple):
    """A mesh, and its points (n, 3) at the first time, as they are skinned."""

    path: str
    points: np.ndarray


class Neighbours:
    """The meshes of a stage by the space that they are in, and which of them meet: found once; no points are kept."""

    def __init__(self, stage: Usd.Stage):
        self._stage = stage
        self._found: dict[Gf.Matrix4d, list[Sdf.Path]] | None = None
        self._meetings: dict[Gf.Matrix4d, Meetings] = {}

    def of(self, prim: Usd.Prim) -> Iterator[Neighbour]:
        """Those with points; of meshes that UsdSkel cannot skin, as they are authored."""
        _, paths = self._beside(prim)
        for path in paths:
            points = self._points(path)
            if len(points) and path != prim.GetPath():
                yield Neighbour(str(path), points)

    def meeting(self, prim: Usd.Prim) -> Iterator[Neighbour]:
        """Those with a point in the place of one of its own, but for those whose points are all the same."""
        space, paths = self._beside(prim)
        if len(paths) < 2:
            return
        if space not in self._meetings:
            self._meetings[space] = Meetings(map(self._points, paths))
        for number in self._meetings[space].of(paths.index(prim.GetPath())):
            yield Neighbour(str(paths[number]), self._points(paths[number]))

    def _beside(self, prim: Usd.Prim) -> tuple[Gf.Matrix4d, list[Sdf.Path]]:
        """The space of a mesh, and all meshes in it, itself too; none where its space is none."""
        if self._found is None:
            self._found = self._by_space()
        own = UsdGeom.XformCache(FIRST).GetLocalToWorldTransform(prim)
        return own, self._found.get(own, [])

    def _by_space(self) -> dict[Gf.Matrix4d, list[Sdf.Path]]:
        spaces, found = UsdGeom.XformCache(FIRST), dict[Gf.Matrix4d, list[Sdf.Path]]()
        for prim in filter(UsdGeom.Mesh, Usd.PrimRange.Stage(self._stage, _LOADED_OR_NOT)):
            found.setdefault(spaces.GetLocalToWorldTransform(prim), []).append(prim.GetPath())
        return found

    def _points(self, path: Sdf.Path) -> np.ndarray:
        prim = self._stage.GetPrimAtPath(path)
        return _moved(prim, triples_of(UsdGeom.Mesh(prim).GetPointsAttr()))


class Meetings:
    """Which of some sets of points share a place: all places are sorted at once, those of equal sets but once.

    Places of sets whose boxes touch no other's are not.
    """

    def __init__(self, sets: Iterable[np.ndarray]):
        self._kind = list[int]()  # of each set: those that are the same are of a kind
        places, boxes, kinds = list[np.ndarray](), list[np.ndarray](), dict[bytes, int]()
        for points in sets:
            finite = points[np.isfinite(points).all(axis=1)].astype(np.float32)
            own = _places(finite)
            kind = kinds.setdefault(sha256(own.data).digest(), len(kinds))
            self._kind.append(kind)
            if kind == len(places):
                places.append(own)
                boxes.append(_box(finite))
        touched = _touched(boxes)
        self._meet = _shared([own if touched[kind] else own[:0] for kind, own in enumerate(places)])

    def of(self, number: int) -> list[int]:
        """The sets that a set shares a place with, in order, but for those that are the same."""
        met = self._meet[self._kind[number]]
        return [other for other, kind in enumerate(self._kind) if kind in met]


def _places(points: np.ndarray) -> np.ndarray:
    """A number (n,) for each point, the same for the same place."""
    bits = np.ascontiguousarray(points + np.float32(0)).view(np.uint32).astype(np.uint64)  # -0 is where 0 is
    return (bits * _MIXERS).sum(axis=1, dtype=np.uint64)


def _box(points: np.ndarray) -> np.ndarray:
    """The least and the most of each coordinate (2, 3); of no points a box that touches none."""
    ends = ((np.minimum, np.inf), (np.maximum, -np.inf))
    return np.array([end.reduce(points, axis=0, initial=nothing) for end, nothing in ends])


def _touched(boxes: list[np.ndarray]) -> list[bool]:
    """Whether another box touches each."""
    low, high = np.array(boxes).reshape(-1, 2, 3).transpose(1, 2, 0)
    touching = (
        ((low <= end[:, None]) & (high >= begin[:, None])).all(axis=0) for begin, end in zip(low.T, high.T, strict=True)
    )
    return [bool(np.count_nonzero(each) > 1) for each in touching]


def _shared(sets: list[np.ndarray]) -> list[set[int]]:
    """Of each set of numbers the others that have one of them."""
    found: list[set[int]] = [set() for _ in sets]
    numbers = np.concatenate(sets) if sets else np.empty(0, np.uint64)
    order = np.argsort(numbers, kind="stable")
    numbers, owners = numbers[order], np.repeat(np.arange(len(sets)), [len(each) for each in sets])[order]
    again = np.append(False, (numbers[1:] == numbers[:-1]) & (owners[1:] == owners[:-1]))[: len(numbers)]
    numbers, owners = numbers[~again], owners[~again]
    # Nothing more of np.unique is used, which would load numpy.ma: that takes as long as some frames.
    _, starts, counts = np.unique(numbers, return_index=True, return_counts=True)
    for count in set(counts[counts > 1].tolist()):
        runs = starts[counts == count][:, None] + np.arange(count)
        for several in set(map(tuple, owners[runs].tolist())):
            for each in several:
                found[each].update(several)
    for number, others in enumerate(found):
        others.discard(number)
    return found


def _moved(prim: Usd.Prim, points: np.ndarray) -> np.ndarray:
    with suppress(Fault):
        return Skinning(prim).points(points, FIRST) if len(points) and is_skinned(prim) else points
    return points
