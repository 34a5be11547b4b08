"""Patches that nobody painted: the meshes of a stage that move, and the faces that a patch needs where they stretch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.geometry import least_stretch, mask_stretched, note_stretch
from skinslide.arrays.limit import limit_faces
from skinslide.problems import Fault, FrameProblem, Problem, SliderError, counted
from skinslide.shot.plan import beyond
from skinslide.stage.finding import is_skinned, prims_at, slidable
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_moving
from skinslide.stage.taking import take_subdivision
from skinslide.stage.values import FIRST

_BY_SURFACE = (None, "auto", "limit")
PURPOSES = (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


class Moving(NamedTuple):
    """A mesh whose points move, or are not at rest in the single pose that there is."""

    prim: Usd.Prim
    pose: PatchedMesh | None  # as it was read, where it has a single pose


def moving_meshes(stage: Usd.Stage, prims: Sequence[str] | None) -> tuple[list[Moving], list[Problem]]:
    """The meshes at and below prims, or on the stage, that are rendered and whose points move.

    Those that can be slid where they are, and an error for each of the others.
    """
    meshes = [prim for prim in prims_at(stage, prims) if prim.IsA(UsdGeom.Mesh) and prim.IsDefined()]
    moving = [each for prim in meshes if _is_rendered(prim) and _has_faces(prim) if (each := _moving(prim))]
    found, problems = slidable(stage, [each.prim for each in moving])
    paths = {mesh.prim.GetPath() for mesh in found}
    own = [each for each in moving if each.prim.GetPath() in paths]
    return own, [replace(each, severity="error") for each in problems]


def _moving(prim: Usd.Prim) -> Moving | None:
    if UsdGeom.Mesh(prim).GetPointsAttr().ValueMightBeTimeVarying() or is_skinned(prim):
        return Moving(prim, None)
    with suppress(Fault, FrameProblem):  # without rest, for one, it is a mesh that stays
        mesh = read_moving(prim)
        if not np.array_equal(mesh.points_at(FIRST), mesh.rest_points, equal_nan=True):
            return Moving(prim, mesh)
    return None


def _has_faces(prim: Usd.Prim) -> bool:
    return bool(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(FIRST))


def _is_rendered(prim: Usd.Prim) -> bool:
    return UsdGeom.Imageable(prim).ComputePurpose() in PURPOSES


def needed_faces(
    moving: Sequence[Moving], frames: Sequence[float] | None, interpolation: str | None
) -> tuple[dict[str, np.ndarray], list[Problem], list[Problem]]:
    """The faces of which each mesh needs a patch, by the frames given or every sample.

    Args:
        moving: Meshes.
        frames: Those to look at; None: every sample.
        interpolation: Of the patches; None: as the schema has it.

    Returns:
        Of each mesh that needs one, by its path, whether a patch needs each face, bool (F,); notes of the others and of
        faces that cannot be had, and warnings of frames beyond samples; an error for each mesh that cannot be looked
        at, or of which no such face can be had.
    """
    found, notes, wrong = dict[str, np.ndarray](), list[Problem](), list[Problem]()
    for prim, pose in moving:
        path = str(prim.GetPath())
        try:
            mesh = pose or read_moving(prim)
            faces = _stretched_faces(mesh, frames)
        except Fault as fault:
            wrong.append(Problem("error", path, None, None, str(fault)))
            continue
        except FrameProblem as bad:
            wrong.append(bad.problem)
            continue
        notes += beyond(mesh, frames or ())
        if not faces.any():
            notes.append(_without_patch("note", path, None, never("no edge")))
            continue
        missing = _without_surface(mesh, faces) if interpolation in _BY_SURFACE else np.zeros_like(faces)
        kept = faces & ~missing
        if kept.any():
            found[path] = kept
            notes += [Problem("note", path, None, None, _without(missing))] if missing.any() else []
        else:
            wrong.append(Problem("error", path, None, None, _without(missing)))
    return found, notes, wrong


def _without_surface(mesh: PatchedMesh, faces: np.ndarray) -> np.ndarray:
    """Which of the faces, bool (F,), have no limit surface, where the mesh has one."""
    with suppress(SliderError):  # what is wrong with it a check says
        subdivision = None if take_subdivision(mesh.prim, mesh.meaning) else mesh.meaning.subdivision()
        if subdivision:
            return faces & ~limit_faces(mesh.face_counts, mesh.face_indices, subdivision)
    return np.zeros_like(faces)


def _without(missing: np.ndarray) -> str:
    faces = np.flatnonzero(missing)
    found = counted(len(faces), "face without limit surface is", "faces without limit surface are")
    return f"{found} left out, face {faces[0]} the first; with --interpolation linear none is"


def left_out(wrong: Iterable[Problem]) -> Iterator[Problem]:
    """Warnings of meshes that get no patch: of each the first of its errors."""
    firsts: dict[str, Problem] = {}
    for each in wrong:
        firsts.setdefault(each.prim, each)
    for each in firsts.values():
        yield _without_patch("warning", each.prim, each.frame, each.message)


def _without_patch(severity: str, path: str, frame: float | None, why: str) -> Problem:
    return Problem(severity, path, None, frame, f"has no patch: {why}")


def never(what: str) -> str:
    return f"{what} ever stretches by over {least_stretch():.0%}"


def _stretched_faces(mesh: PatchedMesh, frames: Sequence[float] | None) -> np.ndarray:
    """Whether a patch needs each face, bool (F,). Raises Fault, and FrameProblem for points that cannot be used."""
    counts, indices, rest = mesh.face_counts, mesh.face_indices, mesh.rest_points
    stretch = np.zeros(len(indices), np.float32)
    times = map(Usd.TimeCode, mesh.points_times() if frames is None else frames)
    for time in list(times) or [Usd.TimeCode.Default()]:
        try:
            note_stretch(counts, indices, rest, mesh.points_at(time), stretch)
        except SliderError as error:
            raise FrameProblem(mesh.problem(str(error), time)) from error
    return mask_stretched(counts, indices, rest, stretch)
