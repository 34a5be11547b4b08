"""What is worth knowing about a mesh and its patches before they are slid, but is no error: for checks and bakes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from pxr import Usd

from skinslide.arrays.records import PatchInfo
from skinslide.arrays.setups import PatchSetup
from skinslide.arrays.slider import Slider
from skinslide.problems import FrameProblem, Problem, SliderError, counted
from skinslide.stage.mesh import PatchedMesh


def advice(mesh: PatchedMesh, pieces: Sequence[PatchInfo], slider: Slider | None) -> Iterator[Problem]:
    """Warnings and notes, of the pieces of good patches; without a slider of them all, those that need none."""
    yield from _stuck(mesh.path, pieces)
    yield from _unread(mesh)
    yield from _described(mesh)
    yield from _overlaps(mesh)
    if slider:
        yield from _neighbours(mesh, slider)
    yield from _cache_problems(mesh)


def _by_name(pieces: Sequence[PatchInfo]) -> dict[str, list[PatchInfo]]:
    """The pieces of each patch."""
    found: dict[str, list[PatchInfo]] = {}
    for piece in pieces:
        found.setdefault(piece.name, []).append(piece)
    return found


def _stuck(mesh: str, every: Sequence[PatchInfo]) -> Iterator[Problem]:
    for name, pieces in _by_name(every).items():
        stuck = sum(not piece.free_count for piece in pieces)
        where = f"in {stuck} of its {len(pieces)} pieces " if len(pieces) > 1 else ""
        if stuck:
            message = f"nothing can slide {where}since every vertex is on a boundary"
            yield Problem("warning", mesh, name, None, message)


def _unread(mesh: PatchedMesh) -> Iterator[Problem]:
    for patch, animation in zip(mesh.patches, mesh.animation, strict=True):
        for name in animation.unread():
            message = f"{name} has no effect under the rule {patch.rule}"
            yield Problem("warning", mesh.path, patch.name, None, message)


def _described(mesh: PatchedMesh) -> Iterator[Problem]:
    for patch, animation in zip(mesh.patches, mesh.animation, strict=True):
        for note in animation.described():
            yield Problem("note", mesh.path, patch.name, None, note)


def _overlaps(mesh: PatchedMesh) -> Iterator[Problem]:
    taken = np.bincount(np.concatenate([patch.faces for patch in mesh.patches]))
    if taken.max(initial=0) < 2:
        return
    for a, b in _overlapping(mesh.patches, taken):
        shared = mesh.topology.vertices_of(a.faces) & mesh.topology.vertices_of(b.faces)
        vertices = counted(int(np.count_nonzero(shared)), "vertex, which takes", "vertices, which take")
        message = f"overlaps patch {b.name} in {vertices} the mean of both"
        yield Problem("note", mesh.path, a.name, None, message)


def _overlapping(patches: Sequence[PatchSetup], taken: np.ndarray) -> list[tuple[PatchSetup, PatchSetup]]:
    """Pairs that share a face, in order; by how many patches each face is taken."""
    takers: dict[int, list[int]] = {}
    for number, patch in enumerate(patches):
        for face in patch.faces[taken[patch.faces] > 1].tolist():
            takers.setdefault(face, []).append(number)
    pairs = {pair for several in set(map(tuple, takers.values())) for pair in combinations(several, 2)}
    return [(patches[a], patches[b]) for a, b in sorted(pairs)]


def _neighbours(mesh: PatchedMesh, slider: Slider) -> Iterator[Problem]:
    """Points that another mesh has in the same places: the gap there stays closed only if they stay."""
    try:
        points = mesh.points_at(Usd.TimeCode.EarliestTime())
        slider.check_points(points)
    except (FrameProblem, SliderError):
        return  # which is said of its frame
    for path, every in mesh.neighbours.meeting(mesh.prim) if mesh.neighbours else ():
        others = every[np.isfinite(every).all(axis=1)]
        found = {info: slider.neighbours(patch, points, others) for patch, info in enumerate(slider.patches)}
        for name, pieces in _by_name(slider.patches).items():
            held, loose = (sum(counts) for counts in zip(*(found[info] for info in pieces), strict=True))
            if held + loose == sum(info.vertex_count for info in pieces):
                continue  # a copy of the mesh, such as a proxy
            if held:
                points_meet = counted(held, "border point coincides", "border points coincide")
                stay = "stays" if held == 1 else "stay"
                message = f"{points_meet} with points of {path}, and {stay} with them"
                yield Problem("note", mesh.path, name, None, message)
            if loose:
                points_meet = counted(loose, "point that slides coincides", "points that slide coincide")
                message = f"{points_meet} with points of {path}, which do not follow"
                yield Problem("warning", mesh.path, name, None, message)


def _cache_problems(mesh: PatchedMesh) -> Iterator[Problem]:
    if not mesh.skinning and not mesh.points_times() and mesh.rest_source == "points (default)":
        message = "points have no samples and are themselves the rest points, so nothing slides"
        yield Problem("warning", mesh.path, None, None, message)
