"""Prints how smoothly each rule moves skin in the course of a motion: one line for each example and rule.

usage: smoothness.py STAGE...
The cache is sampled a quarter of a frame apart, as motion blur would, along the cubic spline through its samples: on
straight lines, second differences would be zero except at the samples. `ratio` is the largest second difference,
|p(t-h) - 2 p(t) + p(t+h)|, of any vertex of the patch at any time in the result, over the largest in the cache. It is
not found vertex by vertex, since skin may slide over a place where the cache does not move. `above 2` counts the times
at which the result is more than twice as rough as the cache ever is. `worst` is the largest second difference as a
share of the mean edge at rest, followed by its vertex and its frame. `shrinks` is how many times smaller it is with
sub-frames a quarter as long: 16 where the motion is smooth, 4 where it turns sharply, as skin does when it slides over
the edge between two flat faces, and 1 where it jumps. The rules are measured by themselves: with linear interpolation,
without slide weights and largest distances.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Usd
from scipy.interpolate import CubicSpline

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines
from sliders import sliders_of

from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

RULES = ("unit", "even", "relaxed")
HEADINGS = ("example", "rule", "ratio", "above 2", "worst", "vertex", "frame", "shrinks")
STEP = 0.25  # of a frame, between sub-frames
SHORTER = 4

Motion = Callable[[float], np.ndarray]  # points of the patch (V, 3) at a time


@dataclass
class Rough:
    """Second differences of a motion at times (T,) a step apart: lengths (T, V)."""

    times: np.ndarray
    lengths: np.ndarray

    @classmethod
    def of(cls, motion: Motion, times: np.ndarray) -> "Rough":
        points = np.stack([motion(time) for time in times])
        return cls(times[1:-1], np.linalg.norm(np.diff(points, 2, axis=0), axis=2))

    @property
    def most(self) -> float:
        return float(self.lengths.max())

    @property
    def worst(self) -> tuple[float, int]:
        """Time and vertex."""
        row, vertex = np.unravel_index(self.lengths.argmax(), self.lengths.shape)
        return float(self.times[row]), int(vertex)


def shrinks(motion: Motion, rough: Rough) -> float:
    """By how much the worst second difference does with shorter steps near it."""
    time, vertex = rough.worst
    shorter = STEP / SHORTER
    near = time + shorter * np.arange(-SHORTER - 1, SHORTER + 2)
    near = near[(near >= rough.times[0] - STEP) & (near <= rough.times[-1] + STEP)]
    return rough.most / float(Rough.of(motion, near).lengths[:, vertex].max())


def motions(mesh: PatchedMesh) -> tuple[np.ndarray, np.ndarray, dict[str, Motion]]:
    """Mesh vertices of the first patch, the times of its sub-frames, and what moves it: "cache" or a rule."""
    samples = np.array(mesh.sample_times())
    spline = CubicSpline(samples, np.stack([mesh.points_at(Usd.TimeCode(time)) for time in samples]).astype(float))
    sliders = sliders_of(mesh, RULES)
    any_slider = sliders["even"]
    vertices = np.unique(np.concatenate([any_slider.vertices(piece) for piece in range(len(any_slider.patches))]))

    def cached(time: float) -> np.ndarray:
        return spline(time).astype(np.float32)

    found: dict[str, Motion] = {"cache": lambda time: cached(time)[vertices].astype(float)}
    for rule, slider in sliders.items():
        found[rule] = lambda time, slider=slider: slider.slide(cached(time)).points[vertices].astype(float)
    return vertices, np.arange(samples[0], samples[-1] + STEP / 2, STEP), found


def mean_edge(mesh: PatchedMesh, faces: np.ndarray) -> float:
    starts = np.concatenate([[0], np.cumsum(mesh.face_counts)])
    corners = [mesh.rest_points[mesh.face_indices[starts[face] : starts[face + 1]]] for face in faces]
    sides = np.concatenate([points - np.roll(points, -1, axis=0) for points in corners])
    return float(np.linalg.norm(sides, axis=1).mean())


def rows(path: Path) -> list[list[str]]:
    """The cells of one example, a row a rule."""
    mesh = read_meshes(Usd.Stage.Open(str(path)))[0][0]
    vertices, times, moves = motions(mesh)
    edge, cache = mean_edge(mesh, mesh.patches[0].faces), Rough.of(moves["cache"], times)
    found = []
    for rule in [each for each in moves if each != "cache"]:
        rough = Rough.of(moves[rule], times)
        (time, vertex), above = rough.worst, (rough.lengths.max(axis=1) > 2 * cache.most).mean()
        sizes = [f"{rough.most / cache.most:.2f}", f"{100 * above:.0f} %", f"{100 * rough.most / edge:.2f} %"]
        where = [str(vertices[vertex]), f"{time:.2f}", f"{shrinks(moves[rule], rough):.1f}"]
        found.append([path.parent.name, rule, *sizes, *where])
    return found


def main() -> None:
    print(lines(HEADINGS, (row for path in sys.argv[1:] for row in rows(Path(path)))), end="")


if __name__ == "__main__":
    main()
