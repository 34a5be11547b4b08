"""Prints how many points of bakes lie off the surface of the cache: one line an example.

usage: surface.py STAGE...
Of every free point of a patch at every frame, the distance to the nearest triangle of the cache's own faces, which are
cut along either diagonal. A point is off where that is over 1e-3 of the mean edge.
"""

import sys
from pathlib import Path

import numpy as np
from pxr import Usd

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines

from skinslide.stage.mesh import PatchedMesh, read_meshes

HEADINGS = ("example", "points", "frames", "farthest", "off the surface")
OFF = 1e-3  # of the mean edge


def triangles(quads: np.ndarray) -> np.ndarray:
    """Of quads (F, 4), cut along either diagonal, (4 F, 3)."""
    return np.concatenate([quads[:, corners] for corners in ([0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3])])


def to_segment(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Distances of points (P, 1, 3) to segments (1, T, 3), (P, T)."""
    along = end - start
    share = ((points - start) * along).sum(-1) / np.maximum((along * along).sum(-1), 1e-30)
    return np.linalg.norm(points - start - np.clip(share, 0, 1)[..., None] * along, axis=-1)


def to_surface(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Distances of points (P, 3) to the nearest of some triangles (T, 3, 3), (P,)."""
    a, b, c = (corners[None, :, i] for i in range(3))
    at = points[:, None]
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-30)
    sides = [(np.cross(end - start, at - start) * normal).sum(-1) for start, end in ((a, b), (b, c), (c, a))]
    inside = np.min(sides, axis=0) >= 0
    plane = np.where(inside, np.abs(((at - a) * normal).sum(-1)), np.inf)
    edges = [to_segment(at, start, end) for start, end in ((a, b), (b, c), (c, a))]
    return np.minimum(plane, np.min(edges, axis=0)).min(axis=1)


def distances(mesh: PatchedMesh, time: Usd.TimeCode) -> np.ndarray:
    """Of the points that slid, in mean edges."""
    slider, cached = mesh.slider(), mesh.points_at(time).astype(float)
    slid = slider.slide(mesh.points_at(time), mesh.controls_at(time)).points.astype(float)
    faces = mesh.face_indices.reshape(-1, 4)[slider.faces(0)]
    moved = np.flatnonzero((slid != cached).any(axis=1))
    edge = np.linalg.norm(cached[faces] - cached[np.roll(faces, 1, axis=1)], axis=-1).mean()
    return to_surface(slid[moved], cached[triangles(faces)]) / edge if moved.size else np.zeros(0)


def row(path: Path) -> list[str]:
    """The cells of one example."""
    stage = Usd.Stage.Open(str(path))
    mesh = read_meshes(stage)[0][0]
    found = [distances(mesh, Usd.TimeCode(time)) for time in mesh.sample_times()]
    every = np.concatenate(found)
    farthest, off = f"{every.max(initial=0):.1e}", str(np.count_nonzero(every > OFF))
    return [path.parent.name, str(max(map(len, found))), str(len(found)), farthest, off]


def main() -> None:
    print(lines(HEADINGS, (row(Path(path)) for path in sys.argv[1:])), end="")


if __name__ == "__main__":
    main()
