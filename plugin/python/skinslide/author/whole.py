"""Patches that nobody painted: the meshes of a stage that move, and the faces that a patch needs where they stretch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.geometry import mask_stretched, note_stretch
from skinslide.problems import FrameProblem, Problem, SliderError
from skinslide.shot.plan import beyond
from skinslide.stage.finding import is_skinned, prims_at, slidable
from skinslide.stage.mesh import read_moving
from skinslide.stage.values import FIRST

PURPOSES = (UsdGeom.Tokens.default_, UsdGeom.Tokens.render)


def moving_meshes(stage: Usd.Stage, prims: Sequence[str] | None) -> tuple[list[Usd.Prim], list[Problem]]:
    """The meshes at and below prims, or on the stage, that are rendered and whose points move.

    Those that can be slid where they are, and why the others cannot.
    """
    meshes = [prim for prim in prims_at(stage, prims) if prim.IsA(UsdGeom.Mesh) and prim.IsDefined()]
    moving = [prim for prim in meshes if _moves(prim) and _has_faces(prim) and _is_rendered(prim)]
    found, problems = slidable(stage, moving)
    return [mesh.prim for mesh in found], problems


def _moves(prim: Usd.Prim) -> bool:
    return UsdGeom.Mesh(prim).GetPointsAttr().ValueMightBeTimeVarying() or is_skinned(prim)


def _has_faces(prim: Usd.Prim) -> bool:
    return bool(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get(FIRST))


def _is_rendered(prim: Usd.Prim) -> bool:
    return UsdGeom.Imageable(prim).ComputePurpose() in PURPOSES


def stretched_faces(prim: Usd.Prim, frames: Sequence[float] | None) -> tuple[np.ndarray, list[Problem]]:
    """Whether a patch needs each face, bool (F,), by the frames given or every sample; and warnings.

    There is a warning of frames beyond the samples. Raises Fault, and FrameProblem for points that cannot be used.
    """
    mesh = read_moving(prim)
    counts, indices, rest = mesh.face_counts, mesh.face_indices, mesh.rest_points
    stretch = np.zeros(len(indices), np.float32)
    times = map(Usd.TimeCode, mesh.points_times() if frames is None else frames)
    for time in list(times) or [Usd.TimeCode.Default()]:
        try:
            note_stretch(counts, indices, rest, mesh.points_at(time), stretch)
        except SliderError as error:
            raise FrameProblem(mesh.problem(str(error), time)) from error
    return mask_stretched(counts, indices, rest, stretch), list(beyond(mesh, frames or ()))
