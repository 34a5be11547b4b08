"""The patches that are slid: disks, their points in order, in no order and along a curve, and a bump that travels."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial import Delaunay

from compare.patch import Patch

POSES = 5
KINDS = ("regular", "irregular", "shuffled")

# Vertices and edges of the patches in the paper's table.
PAPER = ((51, 90), (163, 299), (316, 593), (431, 1218), (538, 1060))


def patch_of(kind: str, size: int) -> Patch:
    """A patch of about as many vertices as size says."""
    side = round(size**0.5)
    if kind == "regular":
        flat, faces = _lattice(side)
    else:
        flat, faces = _scattered(side, np.random.default_rng(size))
        order = _along_a_curve(flat) if kind == "irregular" else np.random.default_rng(1).permutation(len(flat))
        flat, faces = _renumbered(flat, faces, order)
    return _posed(f"{kind} {len(flat)}", flat, np.full(len(faces), 3), faces.ravel())


def quads(size: int) -> Patch:
    """A regular sheet of quads: what is subdivided."""
    side = round(size**0.5)
    flat, _ = _lattice(side)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = corner[:, None] + np.array([0, 1, side + 1, side])
    return _posed(f"quads {len(flat)}", flat, np.full(len(faces), 4), faces.ravel())


def papers() -> Iterator[Patch]:
    """Patches with as many vertices and edges as those of the paper."""
    for vertices, edges in PAPER:
        yield _counted(vertices, edges)


def _lattice(side: int) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side))
    flat = np.column_stack([x.ravel(), y.ravel()])
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower, upper = corner[:, None] + np.array([0, 1, side + 1]), corner[:, None] + np.array([0, side + 1, side])
    return flat, np.stack([lower, upper], 1).reshape(-1, 3)


def _scattered(side: int, chance: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """The lattice with its inner points moved, triangulated anew."""
    flat, _ = _lattice(side)
    inner = np.all((flat > 0) & (flat < 1), axis=1)
    flat[inner] += chance.uniform(-0.4, 0.4, (inner.sum(), 2)) / (side - 1)
    return flat, _turned_left(flat, Delaunay(flat).simplices)


def _turned_left(flat: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Turns all triangles counter-clockwise, and drops those without area on the border."""
    a, b, c = (flat[faces[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    faces = np.where((area < 0)[:, None], faces[:, ::-1], faces)
    return faces[np.abs(area) > 1e-9 / len(flat)]


def _along_a_curve(flat: np.ndarray) -> np.ndarray:
    """The order of points by Morton's curve."""
    cells = np.minimum((flat * 1024).astype(np.int64), 1023)
    code = sum(((cells[:, axis] >> bit) & 1) << (2 * bit + axis) for axis in range(2) for bit in range(10))
    return np.argsort(code, kind="stable")


def _renumbered(flat: np.ndarray, faces: np.ndarray, order: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The patch in which point order[i] has become point i; faces are sorted by their first point."""
    place = np.empty(len(order), int)
    place[order] = np.arange(len(order))
    faces = place[faces]
    return flat[order], faces[np.argsort(faces.min(axis=1), kind="stable")]


def _posed(name: str, flat: np.ndarray, counts: np.ndarray, indices: np.ndarray) -> Patch:
    poses = np.stack([_bump(flat, 0.3 + 0.1 * k) for k in range(POSES)])
    arrays = counts.astype(np.int32), indices.astype(np.int32), _bump(flat, None), poses, np.full_like(flat, np.nan)
    return Patch(name, *arrays)


def _bump(flat: np.ndarray, at: float | None) -> np.ndarray:
    """The poses of a sheet in relief: a bump passes under it and drags along what is above."""
    points = np.column_stack([flat, 0.05 * np.sin(5 * flat[:, 0]) * np.cos(4 * flat[:, 1])])
    if at is not None:
        swell = np.exp(-((flat - (at, 0.5)) ** 2).sum(axis=1) / (2 * 0.12**2))
        points += swell[:, None] * (0.08, 0.02, 0.15)
    return points.astype(np.float32)


def _counted(vertices: int, edges: int) -> Patch:
    """A disk with exactly so many vertices and edges: triangles are joined in pairs until no edge is too many."""
    for border in range(round(2.6 * vertices**0.5), vertices):
        flat = np.concatenate([_rim(border), _sunflower(vertices - border)])
        faces = [list(face) for face in _turned_left(flat, Delaunay(flat).simplices)]
        faces = _joined(flat, faces, vertices + len(faces) - 1 - edges)
        if vertices + len(faces) - 1 == edges:
            counts = np.array([len(face) for face in faces])
            return _posed(f"{vertices} / {edges}", flat, counts, np.concatenate(faces))
    raise ValueError(f"no disk has {vertices} vertices and {edges} edges")


def _rim(count: int) -> np.ndarray:
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return 0.5 + 0.5 * np.column_stack([np.cos(turns), np.sin(turns)])


def _sunflower(count: int) -> np.ndarray:
    """Points that are spread evenly in a disk, well inside its border."""
    k = np.arange(count)
    radius, angle = 0.44 * np.sqrt((k + 0.5) / count), k * np.pi * (3 - 5**0.5)
    return 0.5 + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def _joined(flat: np.ndarray, triangles: list[list[int]], wanted: int) -> list[list[int]]:
    """Joins pairs of triangles to quads, across the longest sides first; each vertex keeps three edges."""
    side_of = {(face[k], face[k - 2]): index for index, face in enumerate(triangles) for k in range(3)}
    shared = [(a, b) for a, b in side_of if a < b and (b, a) in side_of]
    shared.sort(key=lambda side: -np.linalg.norm(flat[side[0]] - flat[side[1]]))
    spare = np.bincount(np.array(shared).ravel(), minlength=len(flat)) - 3  # edges that a vertex can do without
    spare[[v for a, b in side_of if (b, a) not in side_of for v in (a, b)]] = len(flat)
    quads, gone = [], set()
    for a, b in shared:
        one, other = side_of[a, b], side_of[b, a]
        if len(quads) == wanted or {one, other} & gone or min(spare[a], spare[b]) == 0:
            continue
        # a, b turn left in the one, and b, a in the other.
        tip, foot = (next(v for v in triangles[face] if v not in (a, b)) for face in (one, other))
        quads.append([a, foot, b, tip])
        gone |= {one, other}
        spare[[a, b]] -= 1
    return quads + [face for index, face in enumerate(triangles) if index not in gone]
