"""Prints how many slid points lie off the surface of the cache: one line for each example.

usage: surface.py STAGE...        (needs libigl)
For every point that slides, in any patch at any frame, finds the distance to the nearest triangle of the patches' faces
in the cache, each cut along both diagonals. A point is off the surface where that is over 1e-3 of the mean edge.
"""

import sys
from pathlib import Path

import igl
import numpy as np
from pxr import Usd

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines

from skinslide.arrays.slider import Slider
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

HEADINGS = ("example", "points", "frames", "farthest", "off the surface")
OFF = 1e-3  # of the mean edge


def triangles(quads: np.ndarray) -> np.ndarray:
    """Those of quads (F, 4), each cut along both diagonals: (4 F, 3)."""
    return np.concatenate([quads[:, corners] for corners in ([0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3])])


def distances(mesh: PatchedMesh, slider: Slider, time: Usd.TimeCode) -> np.ndarray:
    """Distances of the points that slid to the faces of all patches together, in mean edges."""
    cached = mesh.points_at(time)
    slid = slider.slide(cached, mesh.controls_at(time)).points
    chosen = np.unique(np.concatenate([slider.faces(piece) for piece in range(len(slider.patches))]))
    faces, moved = mesh.face_indices.reshape(-1, 4)[chosen], np.flatnonzero((slid != cached).any(axis=1))
    if not moved.size:
        return np.zeros(0)
    edge = np.linalg.norm(cached[faces] - cached[np.roll(faces, 1, axis=1)], axis=-1).mean()
    squares = igl.point_mesh_squared_distance(slid[moved].astype(float), cached.astype(float), triangles(faces))[0]
    return np.sqrt(squares) / edge


def row(path: Path) -> list[str]:
    """The cells of one example."""
    stage = Usd.Stage.Open(str(path))
    mesh = read_meshes(stage)[0][0]
    slider = mesh.slider()
    found = [distances(mesh, slider, Usd.TimeCode(time)) for time in mesh.sample_times()]
    every = np.concatenate(found)
    farthest, off = f"{every.max(initial=0):.1e}", str(np.count_nonzero(every > OFF))
    return [path.parent.name, str(max(map(len, found))), str(len(found)), farthest, off]


def main() -> None:
    print(lines(HEADINGS, (row(Path(path)) for path in sys.argv[1:])), end="")


if __name__ == "__main__":
    main()
