"""Closed surfaces of quads, facing out. Centimetres."""

from collections.abc import Iterator

import numpy as np


def torus(around: int, across: int, radius: float, thickness: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) and faces (F, 4) of a ring about the Y axis."""
    j, i = np.divmod(np.arange(around * across), around)
    long, short = 2 * np.pi * i / around, 2 * np.pi * j / across
    ring = radius + thickness * np.cos(short)
    points = np.stack([ring * np.cos(long), thickness * np.sin(short), ring * np.sin(long)], axis=1)
    on, up = j * around + (i + 1) % around, (j + 1) % across * around
    return points, np.stack([j * around + i, up + i, up + (i + 1) % around, on], axis=1).astype(np.int32)


def tube(side: int, along: int, radii: tuple[float, float], length: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) and faces (F, 4) of a tube along +X that tapers, and is rounded at both ends.

    It is the surface of a block of side x side x along cubes, inflated. radii are those of its two ends.
    """
    numbers: dict[tuple[int, int, int], int] = {}
    faces = [[numbers.setdefault(corner, len(numbers)) for corner in face] for face in _block(side, along)]
    i, j, k = np.array(list(numbers)).T
    y, z, share = 2 * i / side - 1, 2 * j / side - 1, k / along
    circle = np.stack([y * np.sqrt(1 - z * z / 2), z * np.sqrt(1 - y * y / 2)])  # a square as a disk
    dome = np.sqrt(np.maximum(0, 1 - (circle**2).sum(axis=0))) * np.where(k == 0, -1, 1)
    radius = radii[0] + (radii[1] - radii[0]) * share
    return np.stack([length * share + radius * dome, *(radius * circle)], axis=1), np.array(faces, np.int32)


def _block(side: int, along: int) -> Iterator[tuple[tuple[int, int, int], ...]]:
    """The faces of a block, each by its corners."""
    for i in range(side):
        for k in range(along):
            yield (i, 0, k), (i + 1, 0, k), (i + 1, 0, k + 1), (i, 0, k + 1)
            yield (i + 1, side, k), (i, side, k), (i, side, k + 1), (i + 1, side, k + 1)
            yield (0, i + 1, k), (0, i, k), (0, i, k + 1), (0, i + 1, k + 1)
            yield (side, i, k), (side, i + 1, k), (side, i + 1, k + 1), (side, i, k + 1)
        for j in range(side):
            yield (i, j, 0), (i, j + 1, 0), (i + 1, j + 1, 0), (i + 1, j, 0)
            yield (i, j, along), (i + 1, j, along), (i + 1, j + 1, along), (i, j + 1, along)
