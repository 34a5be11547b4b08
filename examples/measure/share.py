"""Prints how much of the removable stretch each rule removes: one line for each example and frame.

usage: share.py STAGE...        (needs libigl)
Stretch is the RMS of log(length / rest length) over the patch's edges. `best` is the least stretch that a search finds,
from the cache and from the result of each rule, moving every free vertex anywhere on the deformed patch; faces may turn
over in it. A share is (cache - slid) / (cache - best): at 1 nothing is left to remove, below 0 sliding adds stretch.
The rules are measured by themselves: with linear interpolation, without slide weights and largest distances. `off` is
how far the result of relaxed is from the deformed patch beyond what rounding to float allows, as a share of the patch's
size.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import igl
import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from pxr import Usd

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines
from sliders import sliders_of

from skinslide.arrays.slider import Frame, Slider
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

RULES = ("unit", "fast", "even", "relaxed")
HEADINGS = ("example", "frame", "cache", "best", *RULES, "steps", "off", "folded")
MOST_STEPS = 400
LEAST_GAIN = 1e-9  # of the energy, by one step of the search
FLOAT_EPSILON = float(np.finfo(np.float32).eps)


@dataclass
class Skin:
    """One patch as the search sees it, in patch vertices."""

    rest: np.ndarray  # (V, 3)
    vertices: np.ndarray  # (V,) mesh vertices
    edges: np.ndarray  # (E, 2)
    triangles: np.ndarray  # (T, 3) fans of the faces
    free: np.ndarray  # vertices that may slide

    @classmethod
    def of(cls, mesh: PatchedMesh, faces: np.ndarray) -> "Skin":
        starts = np.concatenate([[0], np.cumsum(mesh.face_counts)])
        polygons = [mesh.face_indices[starts[face] : starts[face + 1]] for face in faces]
        vertices = np.unique(np.concatenate(polygons))
        polygons = [np.searchsorted(vertices, polygon) for polygon in polygons]
        sides = np.sort(np.concatenate([np.stack([p, np.roll(p, -1)], axis=1) for p in polygons]), axis=1)
        edges, uses = np.unique(sides, axis=0, return_counts=True)
        fans = [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]
        free = np.setdiff1d(np.arange(len(vertices)), edges[uses == 1])
        return cls(mesh.rest_points[vertices].astype(float), vertices, edges, np.array(fans, np.int64), free)

    def lengths(self, points: np.ndarray) -> np.ndarray:
        return np.linalg.norm(points[self.edges[:, 0]] - points[self.edges[:, 1]], axis=1)

    def stretch(self, points: np.ndarray) -> float:
        return float(np.sqrt(np.mean(np.log(self.lengths(points) / self.lengths(self.rest)) ** 2)))

    def off(self, points: np.ndarray, deformed: np.ndarray) -> float:
        """Largest distance to the deformed patch beyond the rounding of points, as a share of the patch's size."""
        distance = np.sqrt(igl.point_mesh_squared_distance(points, deformed, self.triangles)[0].max())
        rounding = FLOAT_EPSILON * np.abs(deformed).max()
        return max(0.0, distance - rounding) / np.linalg.norm(np.ptp(self.rest, axis=0))


class Search:
    """Walks downhill from a start, only where that lowers the stretch.

    Along the gradient as springs of the rest lengths would take it, projected to the patch.
    """

    def __init__(self, skin: Skin):
        self.skin, count = skin, len(skin.edges)
        ends = np.concatenate([skin.edges[:, 0], skin.edges[:, 1]])
        signs, rows = np.repeat([1.0, -1.0], count), np.tile(np.arange(count), 2)
        self.differences = sp.csr_matrix((signs, (rows, ends)), (count, len(skin.rest)))[:, skin.free]
        self.rest_lengths = skin.lengths(skin.rest)
        springs = self.differences.T @ sp.diags(self.rest_lengths**-2) @ self.differences
        self.solve = sla.factorized(springs.tocsc())

    def direction(self, points: np.ndarray) -> np.ndarray:
        vectors = points[self.skin.edges[:, 0]] - points[self.skin.edges[:, 1]]
        lengths = np.linalg.norm(vectors, axis=1)
        pull = self.differences.T @ ((np.log(lengths / self.rest_lengths) / lengths**2)[:, None] * vectors)
        return np.stack([self.solve(pull[:, k]) for k in range(3)], axis=1)

    def moved(self, points: np.ndarray, step: np.ndarray, deformed: np.ndarray) -> np.ndarray:
        result = points.copy()
        target = points[self.skin.free] - step
        result[self.skin.free] = igl.point_mesh_squared_distance(target, deformed, self.skin.triangles)[2]
        return result

    def lowest(self, start: np.ndarray, deformed: np.ndarray) -> float:
        """The stretch where the walk ends."""
        points, stretch, size = start.copy(), self.skin.stretch(start), 1.0
        for _ in range(MOST_STEPS):
            direction, before = self.direction(points), stretch
            while stretch >= before and size > 1e-7:
                trial = self.moved(points, size * direction, deformed)
                stretch, size = self.skin.stretch(trial), size / 2
            if stretch >= before:
                return before
            points, size = trial, min(1.0, 4 * size)
            if before**2 - stretch**2 < LEAST_GAIN * before**2:
                break
        return stretch


class Found(NamedTuple):
    """What a frame came to."""

    time: float
    cache: float  # stretch of the cache
    best: float  # and the least there is; NaN where it was not searched for
    stretch: dict[str, float]  # and slid, by rule
    frames: dict[str, Frame]  # by rule
    off: float  # of the last rule

    def share(self, rule: str) -> float:
        """Of the stretch that can be removed, what a rule removes; NaN where none can, or it was not searched for."""
        return (self.cache - self.stretch[rule]) / (self.cache - self.best) if self.best < self.cache else np.nan


def frames(mesh: PatchedMesh, sliders: dict[str, Slider], *, search: bool = True) -> Iterator[Found]:
    """Each frame of the first patch."""
    skin = Skin.of(mesh, mesh.patches[0].faces)
    walk = Search(skin) if search else None
    for time in mesh.sample_times():
        cached = mesh.points_at(Usd.TimeCode(time))
        slid = {rule: slider.slide(cached) for rule, slider in sliders.items()}
        deformed, points = cached[skin.vertices].astype(float), {}
        for rule, frame in slid.items():
            points[rule] = frame.points[skin.vertices].astype(float)
        cache, stretch = skin.stretch(deformed), {rule: skin.stretch(each) for rule, each in points.items()}
        starts = (deformed, *points.values())
        best = min(walk.lowest(start, deformed) for start in starts) if walk and cache else cache if walk else np.nan
        yield Found(time, cache, best, stretch, slid, skin.off(list(points.values())[-1], deformed))


def rows(path: Path) -> list[list[str]]:
    """The cells of one example, a row a frame."""
    mesh, cells = read_meshes(Usd.Stage.Open(str(path)))[0][0], []
    for found in frames(mesh, sliders_of(mesh, RULES)):
        shares = [found.share(rule) if rule in found.stretch else np.nan for rule in RULES]
        result = found.frames["relaxed"].patches[0]
        where = [path.parent.name, f"{found.time:g}", f"{found.cache:.4f}", f"{found.best:.4f}"]
        quality = [str(result.relax_steps), f"{found.off:.0e}", str(result.folded_faces)]
        cells.append([*where, *("-" if np.isnan(share) else f"{share:.3f}" for share in shares), *quality])
    return cells


def main() -> None:
    print(lines(HEADINGS, (row for path in sys.argv[1:] for row in rows(Path(path)))), end="")


if __name__ == "__main__":
    with np.errstate(divide="ignore"):  # an edge of no length has endless stretch, and is never taken
        main()
