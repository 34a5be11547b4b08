"""Prints how well each interpolation keeps the limit surface: one line for each example and interpolation.

usage: limit_distance.py STAGE...
Samples the limit surfaces of the cache and of the result at the frame where the cache has most stretch, and finds the
distance of each sample to the other surface, in both directions. `max` and `mean` are of these distances, as a share of
the diagonal of the patch's box at rest; `closer` is how many times smaller they are than with linear. Stretch is the
RMS of log(length / rest length) over the patch's edges. Stages whose mesh is not subdivided are skipped.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from pxr import Usd
from scipy.spatial import cKDTree

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines

from skinslide.arrays.limit import limit_points
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

WAYS = ("linear", "meanValue", "limit")
HEADINGS = ("example", "interpolation", "max", "mean", "closer: max", "mean", "stretch", "change", "ms")
SAMPLES = 4  # steps along each side of a quarter of a face
AROUND = 2  # rings of faces around the patch whose limit surface depends on the patch's vertices
CANDIDATES = 8  # triangles tried for each sample, those with the nearest middles


def rings(mesh: PatchedMesh, faces: np.ndarray, count: int) -> np.ndarray:
    """The faces and `count` rings of faces around them."""
    face_of_corner = np.repeat(np.arange(mesh.topology.face_count), mesh.face_counts)
    for _ in range(count):
        faces = np.unique(face_of_corner[mesh.topology.vertices_of(faces)[mesh.face_indices]])
    return faces


def surface(mesh: PatchedMesh, points: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The limit surface over some faces: samples (n, 3), and triangles (m, 3) of them."""
    corners = np.flatnonzero(np.isin(np.repeat(np.arange(mesh.topology.face_count), mesh.face_counts), faces))
    steps = np.linspace(0, 1, SAMPLES + 1)
    places = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=2).reshape(-1, 2)
    samples = limit_points(
        mesh.face_counts,
        mesh.face_indices,
        points,
        mesh.subdivision,
        np.repeat(corners, len(places)),
        np.tile(places, (len(corners), 1)),
    )
    grid = np.arange(len(places)).reshape(SAMPLES + 1, SAMPLES + 1)
    a, b, c, d = grid[:-1, :-1].ravel(), grid[1:, :-1].ravel(), grid[1:, 1:].ravel(), grid[:-1, 1:].ravel()
    pair = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return samples.astype(np.float64), (np.arange(len(corners))[:, None, None] * len(places) + pair).reshape(-1, 3)


def distances(points: np.ndarray, samples: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """From each point to the nearest triangle among those whose middles are nearest."""
    _, nearest = cKDTree(samples[triangles].mean(axis=1)).query(points, k=CANDIDATES)
    best = np.full(len(points), np.inf)
    for candidate in nearest.T:
        best = np.minimum(best, to_triangle(points, *(samples[triangles[candidate, k]] for k in range(3))))
    return best


def to_triangle(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distances (n,) from points to triangles, row by row."""
    normal = np.cross(b - a, c - a)
    square = (normal**2).sum(axis=1)
    some = np.where(square > 0, square, 1)
    third = (np.cross(b - a, p - a) * normal).sum(axis=1) / some
    second = (np.cross(p - a, c - a) * normal).sum(axis=1) / some
    inside = (square > 0) & (second >= 0) & (third >= 0) & (second + third <= 1)
    sides = np.minimum(np.minimum(to_segment(p, a, b), to_segment(p, b, c)), to_segment(p, c, a))
    return np.where(inside, np.abs(((p - a) * normal).sum(axis=1)) / np.sqrt(some), sides)


def to_segment(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    along = b - a
    square = (along**2).sum(axis=1)
    share = np.clip(((p - a) * along).sum(axis=1) / np.where(square > 0, square, 1), 0, 1)
    return np.linalg.norm(p - a - share[:, None] * along, axis=1)


class Ways:
    """One patch of a mesh, slid in each way at the frame where the cache has most stretch."""

    def __init__(self, mesh: PatchedMesh, index: int):
        self.mesh, self.patch = mesh, mesh.patches[index]
        self.faces = rings(mesh, self.patch.faces, AROUND)
        self.around = rings(mesh, self.faces, 1)  # these may hold the point that is nearest to a sample
        rest = mesh.rest_points[mesh.topology.vertices_of(self.patch.faces)]
        self.size = np.linalg.norm(np.ptp(rest, axis=0))
        times = [Usd.TimeCode(time) for time in mesh.sample_times()]
        self.time = max(times, key=lambda time: self.slide("linear", time)[1].stretch_before)

    def slide(self, way: str, time: Usd.TimeCode):
        """The slid points, and the result of the patch's first piece."""
        slider = self.mesh.build([replace(self.patch, interpolation=way)])
        frame = slider.slide(self.mesh.points_at(time))
        return frame.points, frame.patches[0]

    def measure(self, way: str) -> tuple[np.ndarray, float, float]:
        """Maximum and mean distance, as shares of the patch's size; stretch; ms to interpolate."""
        points, result = self.slide(way, self.time)
        cached = self.mesh.points_at(self.time)
        there = distances(surface(self.mesh, points, self.faces)[0], *surface(self.mesh, cached, self.around))
        back = distances(surface(self.mesh, cached, self.faces)[0], *surface(self.mesh, points, self.around))
        most, mean = max(there.max(), back.max()), (there.mean() + back.mean()) / 2
        return np.array([most, mean]) / self.size, result.stretch_after, 1e3 * result.interpolate_seconds


def rows(path: Path) -> list[list[str]]:
    """The cells of one example, a row for each interpolation."""
    stage = Usd.Stage.Open(str(path))
    meshes, _ = read_meshes(stage)
    found = []
    for mesh in meshes:
        for index in range(len(mesh.patches) if mesh.subdivision else 0):
            ways = Ways(mesh, index)
            linear, plain, _ = ways.measure("linear")
            for way in WAYS:
                share, stretch, milliseconds = ways.measure(way)
                cells = [*(f"{100 * value:.4f} %" for value in share), *(f"{value:.1f}" for value in linear / share)]
                change = f"{100 * (stretch / plain - 1):+.1f} %"
                found.append([path.parent.name, way, *cells, f"{stretch:.4f}", change, f"{milliseconds:.2f}"])
    return found


def main() -> None:
    print(lines(HEADINGS, (row for path in sys.argv[1:] for row in rows(Path(path)))), end="")


if __name__ == "__main__":
    main()
