"""The paper's experiment on stability: turns a triangle along a sphere, and finds how its embedding changes.

usage: stability.py [CURVES.svg]        (needs libigl)
A cap of a sphere is embedded with its border on a circle, once at rest, and once for each turn of the triangle at its
pole about an axis through the sphere's centre, which moves the triangle's corners along the sphere. An edge spans 6
degrees. Prints for each turn the largest angle, in degrees, between any two directions in which vertices are displaced
in the embedding: `corners`, of the triangle's three corners; `all`, of every vertex that is displaced by a tenth of the
largest displacement or more. It is small where all go the same way, and 180 at most. `unit` and `fast` are the paper's
force density rules, `harmonic` has cotangent weights, and `mean value` those of mean value coordinates. `even` has no
embedding: the places that its vertices slide to are looked up in that of unit at rest. `folds` is the most triangles
turned over at any turn.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import igl
import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg
from scipy.spatial import Delaunay

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines

from skinslide import PatchSetup, Slider

RINGS = 10
REACH = np.radians(60)  # of the cap, from its pole
TURNS = np.arange(2, 42, 2)  # degrees
LEAST = 0.1  # of the largest displacement
SHOWN = (2, 6, 10, 20, 30, 40)  # degrees
HEADINGS = ("weights", "of", *(f"{turn}" for turn in SHOWN), "largest", "folds")
COLOURS = {
    "unit": "#1b6ca8",
    "fast": "#46a0d8",
    "harmonic": "#c23b22",
    "mean value": "#e08a1e",
    "even": "#2e8b57",
}


def cap() -> tuple[np.ndarray, np.ndarray]:
    """Points (V, 3) on the unit sphere, three at the pole first; triangles (F, 3), counter-clockwise from outside."""
    rings = [_ring(number) for number in range(RINGS)]
    points = np.concatenate([_on_sphere(ring) for ring in rings])
    flat = np.concatenate(rings)
    faces = _delaunay(flat)
    return points, faces[np.argsort(~(faces < 3).all(axis=1), kind="stable")]


def _ring(number: int) -> np.ndarray:
    """Places (n, 2) in the plane: a triangle, and rings about it that are as far apart."""
    count = 3 + 6 * number
    turns = 2 * np.pi * (np.arange(count) + 0.5 * (number % 2)) / count
    return (number + 0.5) / (RINGS - 0.5) * np.column_stack([np.cos(turns), np.sin(turns)])


def _delaunay(flat: np.ndarray) -> np.ndarray:
    faces = Delaunay(flat).simplices
    return np.where((_areas(flat, faces) < 0)[:, None], faces[:, ::-1], faces)


def _on_sphere(flat: np.ndarray) -> np.ndarray:
    """By distance from the pole and direction."""
    away = REACH * np.linalg.norm(flat, axis=1)
    direction = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    return np.column_stack([direction * np.sin(away)[:, None], np.cos(away)])


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    """With the first three points turned about the y axis."""
    angle, turned = np.radians(degrees), points.copy()
    turn = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
    turned[:3] = points[:3] @ turn
    return turned


# ---- Weights: of each ordered pair of neighbours, a sparse matrix ----


def mean_value(points: np.ndarray, faces: np.ndarray) -> sparse.csr_matrix:
    """(tan(one half angle) + tan(other)) / length, of the angles at the first beside the edge."""
    rows, columns, values = [], [], []
    for k in range(3):
        at, left, right = (faces[:, (k + step) % 3] for step in range(3))
        to_left, to_right = points[left] - points[at], points[right] - points[at]
        lengths = np.linalg.norm(to_left, axis=1), np.linalg.norm(to_right, axis=1)
        cosine = (to_left * to_right).sum(axis=1) / (lengths[0] * lengths[1])
        half = np.sqrt((1 - cosine) / np.maximum(1 + cosine, 1e-12))
        rows += [at, at]
        columns += [left, right]
        values += [half / lengths[0], half / lengths[1]]
    return _matrix(points, rows, columns, values)


def harmonic(points: np.ndarray, faces: np.ndarray) -> sparse.csr_matrix:
    weights = sparse.csr_matrix(igl.cotmatrix(points, faces))
    return weights - sparse.diags(weights.diagonal())


def _matrix(points: np.ndarray, rows: list, columns: list, values: list) -> sparse.csr_matrix:
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sparse.csr_matrix(entries, (len(points), len(points)))


def embedding(weights: sparse.csr_matrix, border: np.ndarray) -> np.ndarray:
    """Places (V, 2): each vertex in the weighted mean of its neighbours; those of the border, not NaN, are given."""
    free, fixed = np.isnan(border[:, 0]), ~np.isnan(border[:, 0])
    system = sparse.diags(np.asarray(weights.sum(axis=1)).ravel()) - weights
    uv = border.copy()
    uv[free] = linalg.spsolve(system[free][:, free].tocsc(), -system[free][:, fixed] @ border[fixed])
    return uv


# ---- The experiment ----


def spread(displacement: np.ndarray) -> float:
    """The largest angle between any two of those (V, 2) that are long enough, in degrees."""
    length = np.linalg.norm(displacement, axis=1)
    seen = displacement[length > LEAST * length.max()]
    angle = np.sort(np.degrees(np.arctan2(seen[:, 1], seen[:, 0])))
    apart = np.abs(angle[:, None] - angle)
    return float(np.minimum(apart, 360 - apart).max())


def _areas(flat: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (flat[faces[:, k]] for k in range(3))
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]


class Sphere:
    """The cap, and its embeddings by each kind of weight."""

    def __init__(self) -> None:
        self.points, self.faces = cap()
        self._sliders = {rule: self._slider(rule) for rule in ("unit", "fast", "even")}
        self.rest = self._sliders["unit"].embedding(0)
        border = np.unique(igl.boundary_loop(self.faces))
        self._border = np.full_like(self.rest, np.nan)
        self._border[border] = self.rest[border]

    def _slider(self, rule: str) -> Slider:
        setup = PatchSetup("cap", faces=np.arange(len(self.faces)), rule=rule, interpolation="linear")
        return Slider(np.full(len(self.faces), 3), self.faces.ravel(), self.points, [setup], lookup="exact")

    def by_density(self, rule: str) -> Callable[[np.ndarray], np.ndarray]:
        return lambda points: self._sliders[rule].slide(points, embeddings=True).embeddings[0]

    def by_weights(self, weights: Callable[[np.ndarray, np.ndarray], sparse.csr_matrix]) -> Callable:
        return lambda points: embedding(weights(points, self.faces), self._border)

    def by_slide(self, rule: str) -> Callable[[np.ndarray], np.ndarray]:
        """Each vertex where it slides to, in the embedding of rest."""

        def place(points: np.ndarray) -> np.ndarray:
            slid = self._sliders[rule].slide(points).points.astype(float)
            _, face, nearest = igl.point_mesh_squared_distance(slid, points, self.faces)
            corners = self.faces[face]
            weights = igl.barycentric_coordinates(nearest, *(points[corners[:, k]] for k in range(3)))
            return np.einsum("ij,ijk->ik", weights, self.rest[corners])

        return place

    def kinds(self) -> dict[str, Callable[[np.ndarray], np.ndarray]]:
        return {
            "unit": self.by_density("unit"),
            "fast": self.by_density("fast"),
            "harmonic": self.by_weights(harmonic),
            "mean value": self.by_weights(mean_value),
            "even": self.by_slide("even"),
        }


class Curve(NamedTuple):
    """Spreads at each turn, and the most folds."""

    corners: list[float]
    all: list[float]
    folds: int


def curves(sphere: Sphere) -> dict[str, Curve]:
    found = {}
    for kind, place in sphere.kinds().items():
        rest = place(sphere.points.astype(np.float32).astype(float))
        there = [place(turned(sphere.points, turn)) for turn in TURNS]
        folds = max(int((_areas(uv, sphere.faces) <= 0).sum()) for uv in there)
        found[kind] = Curve([spread(uv[:3] - rest[:3]) for uv in there], [spread(uv - rest) for uv in there], folds)
    return found


def drawn(found: dict[str, Curve]) -> str:
    """An SVG: a curve of the corners for each, over degrees of the turn."""
    body = [f'<text x="{12 + 8 * turn}" y="215">{turn}</text>' for turn in range(0, 41, 10)]
    for line in (0, 90, 180):
        body.append(f'<text x="4" y="{204 - line}">{line}</text><path d="M32 {200 - line}H360" stroke="#ddd"/>')
    for number, (kind, curve) in enumerate(found.items()):
        points = " ".join(f"{16 + 8 * turn},{200 - each:.1f}" for turn, each in zip(TURNS, curve.corners, strict=True))
        body.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[kind]}" stroke-width="2"/>')
        body.append(f'<text x="370" y="{30 + 16 * number}" fill="{COLOURS[kind]}">{kind}</text>')
    head = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 460 225" font-family="sans-serif" font-size="12">'
    return "\n".join([head, *body, "</svg>", ""])


def main() -> None:
    found = curves(Sphere())
    at = [int(np.flatnonzero(turn == TURNS)[0]) for turn in SHOWN]
    rows = (
        [kind, of, *(f"{spreads[k]:.0f}" for k in at), f"{max(spreads):.0f}", str(curve.folds)]
        for of in ("corners", "all")
        for kind, curve in found.items()
        for spreads in [getattr(curve, of)]
    )
    print(lines(HEADINGS, rows), end="")
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(drawn(found))


if __name__ == "__main__":
    main()
