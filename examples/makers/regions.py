"""Chooses the faces of a patch: geodesic disks and bands with clean boundaries.

`faces` is the mesh's (F, 4) corner table; a region is a bool mask (F,) over it.
"""

import heapq
from collections import defaultdict

import numpy as np


def geodesic(points: np.ndarray, faces: np.ndarray, seeds: np.ndarray) -> np.ndarray:
    """Distance (V,) of each point from the nearest seed point, over edges and diagonals of the faces."""
    links = defaultdict(list)
    pairs = np.vstack([faces[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (0, 2), (1, 3))])
    lengths = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    for (a, b), length in zip(pairs.tolist(), lengths.tolist(), strict=True):
        links[a].append((b, length))
        links[b].append((a, length))
    distance = [np.inf] * len(points)
    queue = [(0.0, int(seed)) for seed in seeds]
    while queue:
        far, at = heapq.heappop(queue)
        if far < distance[at]:
            distance[at] = far
            for other, length in links[at]:
                if far + length < distance[other]:
                    heapq.heappush(queue, (far + length, other))
    return np.array(distance)


def below(values: np.ndarray, faces: np.ndarray, limit: float) -> np.ndarray:
    """The region of faces whose corners' mean value is under `limit`; `values` is by point, (V,)."""
    return values[faces].mean(axis=1) < limit


def oval(
    points: np.ndarray, faces: np.ndarray, centre: int, axis: np.ndarray, half_width: float, slimness: float
) -> np.ndarray:
    """An oval around point `centre`: `half_width` across the direction `axis` (3,), `slimness` times that along it.

    Distances are geodesic, over points that are squeezed together along `axis`. The region has no holes and no pinches.
    """
    along = (points - points[centre]) @ axis
    drawn = points - (1 - 1 / slimness) * along[:, None] * axis
    region = below(geodesic(drawn, faces, [centre]), faces, half_width)
    return tidy(faces, region, face_at(faces, centre))


def face_at(faces: np.ndarray, point: int) -> int:
    """The first face that has `point` as a corner."""
    return int((faces == point).any(axis=1).argmax())


def neighbours(faces: np.ndarray) -> np.ndarray:
    """The face across each corner's edge to the next corner, (F, 4); -1 where there is none."""
    start, end = faces, np.roll(faces, -1, axis=1)
    size = int(faces.max()) + 1
    ahead, back = (start.astype(np.int64) * size + end).ravel(), (end.astype(np.int64) * size + start).ravel()
    order = np.argsort(ahead)
    slot = np.minimum(np.searchsorted(ahead, back, sorter=order), len(ahead) - 1)
    found = order[slot]
    return np.where(ahead[found] == back, found // 4, -1).reshape(faces.shape)


def component(across: np.ndarray, region: np.ndarray, start: int) -> np.ndarray:
    """The part of `region` that face `start` reaches over edges; `across` is from `neighbours`."""
    reached, front = np.zeros(len(region), dtype=bool), [start]
    reached[start] = True
    while front:
        steps = np.unique(across[front])
        front = [f for f in steps if f >= 0 and region[f] and not reached[f]]
        reached[front] = True
    return reached


def tidy(faces: np.ndarray, region: np.ndarray, start: int, outside: np.ndarray | None = None) -> np.ndarray:
    """The part of `region` around face `start`, with a smoothed boundary, small holes filled and pinches opened.

    outside  bool (F,), faces that stay out, so that the holes they make are kept; None: the region has no holes
    """
    across = neighbours(faces)
    outside = np.zeros(len(faces), dtype=bool) if outside is None else outside
    region = component(across, smooth(across, region & ~outside) & ~outside, start)
    region = fill(across, region, outside)
    while (pinched := pinches(faces, region)).size:
        region = region | (np.isin(faces, pinched).any(axis=1) & ~outside)
        region = fill(across, region, outside)
    return region


def smooth(across: np.ndarray, region: np.ndarray, rounds: int = 4) -> np.ndarray:
    """`region` without teeth: a face joins or leaves it as three or more of its neighbours do."""
    for _ in range(rounds):
        votes = (region[across] & (across >= 0)).sum(axis=1)
        region = np.where(votes >= 3, True, np.where(votes <= 1, False, region))
    return region


def fill(across: np.ndarray, region: np.ndarray, outside: np.ndarray) -> np.ndarray:
    """`region` with every hole filled that has no face of `outside`. The largest piece left out is not a hole."""
    pieces, left = [], ~region
    while left.any():
        pieces.append(component(across, ~region, int(np.flatnonzero(left)[0])))
        left = left & ~pieces[-1]
    pieces.sort(key=np.count_nonzero)
    filled = region.copy()
    for piece in pieces[:-1]:
        if not (piece & outside).any():
            filled |= piece
    return filled


def rim(faces: np.ndarray, region: np.ndarray) -> np.ndarray:
    """The boundary's directed edges (K, 2): sides of the region's faces that no other face of it shares."""
    inside = faces[region]
    sides = np.stack([inside, np.roll(inside, -1, axis=1)], axis=2)
    return sides[neighbours(inside) < 0]


def pinches(faces: np.ndarray, region: np.ndarray) -> np.ndarray:
    """The point ids at which the boundary touches itself."""
    points, counts = np.unique(rim(faces, region)[:, 0], return_counts=True)
    return points[counts > 1]


def loops(faces: np.ndarray, region: np.ndarray) -> list[list[int]]:
    """The boundary's loops of point ids, most points first, each with the region on its left."""
    follow = dict(rim(faces, region).tolist())
    found = []
    while follow:
        at, loop = next(iter(follow)), []
        while at in follow:
            loop.append(at)
            at = follow.pop(at)
        found.append(loop)
    return sorted(found, key=len, reverse=True)


def feather(points: np.ndarray, faces: np.ndarray, region: np.ndarray, width: float) -> np.ndarray:
    """A weight (V,) that is 0 outside and on the boundary and rises smoothly to 1 at `width` inside it."""
    share = np.clip(geodesic(points, faces, rim(faces, region)[:, 0]) / width, 0, 1)
    inside = np.isin(np.arange(len(points)), faces[region])
    return np.where(inside, share * share * (3 - 2 * share), 0.0)
