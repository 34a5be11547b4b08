"""One step of Catmull-Clark subdivision of a mesh of quads: a denser cage with the same limit surface."""

import numpy as np


def refined_faces(faces: np.ndarray) -> np.ndarray:
    """The four faces (4 F, 4) of each face: old points first, then one a side, then one a face."""
    side, sides = _sides(faces)
    old, count = int(faces.max()) + 1, len(sides)
    middle = old + count + np.arange(len(faces))
    quarters = [np.stack([faces[:, k], old + side[:, k], middle, old + side[:, k - 1]], axis=1) for k in range(4)]
    return np.stack(quarters, axis=1).reshape(-1, 4).astype(np.int32)


def refined(values: np.ndarray, faces: np.ndarray, *, smooth: bool = True) -> np.ndarray:
    """Values by point, (V, k), on the points of `refined_faces`.

    smooth  False: old points keep their values, and new ones take means, as texture coordinates do
    """
    values = values[: int(faces.max()) + 1].astype(np.float64)
    side, sides = _sides(faces)
    middles, halves = values[faces].mean(axis=1), values[sides].mean(axis=1)
    if not smooth:
        return np.concatenate([values, halves, middles])
    open_side = np.bincount(side.ravel(), minlength=len(sides)) == 1
    beside = _sums(side.ravel(), np.repeat(middles, 4, axis=0), len(sides))
    on_sides = np.where(open_side[:, None], halves, (2 * halves + beside) / 4)
    return np.concatenate([_smoothed(values, faces, sides, open_side, halves, middles), on_sides, middles])


def _smoothed(values, faces, sides, open_side, halves, middles) -> np.ndarray:
    """Old points, moved: (F + 2 E + (n - 3) P) / n inside, and on the boundary as a cubic curve."""
    count = len(values)
    valence = np.bincount(sides.ravel(), minlength=count)[:, None]
    around = _sums(faces.ravel(), np.repeat(middles, 4, axis=0), count)
    along = _sums(sides.ravel(), np.repeat(halves, 2, axis=0), count)
    inside = ((around + 2 * along) / valence + (valence - 3) * values) / valence
    ends = sides[open_side].ravel()
    edge = _sums(ends, np.repeat(halves[open_side], 2, axis=0), count) / 4 + values / 2
    return np.where(np.isin(np.arange(count), ends)[:, None], edge, inside)


def _sides(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The number of each corner's side to the next corner, (F, 4), and the points of each side, (E, 2)."""
    pairs = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    sides, number = np.unique(pairs, axis=0, return_inverse=True)
    return number.reshape(-1, 4), sides


def _sums(places: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    total = np.zeros((count, values.shape[1]))
    np.add.at(total, places, values)
    return total
