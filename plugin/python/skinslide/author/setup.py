"""Makes a patch of some faces of a mesh."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TypedDict, Unpack

import numpy as np
import numpy.typing as npt
from pxr import Usd

from skinslide.arrays.meaning import MeshMeaning
from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import edited
from skinslide.author.layer import author_layer
from skinslide.problems import UsageError
from skinslide.shot.check import CheckReport
from skinslide.stage.given import PrimLike, StageLike, StrPath, check_face, given_faces, given_primvar, given_subset
from skinslide.stage.patch import primvar_faces, subset_faces

_RANGE = re.compile(r"(\d{1,18})(?:[-:](\d{1,18}))?", re.ASCII)


class FaceChoice(TypedDict, total=False):
    """The keywords of `setup`."""

    faces: npt.ArrayLike | str | None
    subset: str | None
    primvar: str | None


def setup(
    stage: Usd.Stage,
    prim: PrimLike,
    patch: str,
    *,
    faces: npt.ArrayLike | str | None = None,
    subset: str | None = None,
    primvar: str | None = None,
) -> CheckReport:
    """Makes a patch of some faces of a mesh, in the stage's edit target; one that is there has other faces then.

    One of faces, subset and primvar says which faces.

    Args:
        stage: The stage.
        prim: The mesh.
        patch: The patch's name, such as elbow_L.
        faces: Indices (n,), a bool for each face of the mesh (F,), or a spec such as "0-120,140".
        subset: The name of a GeomSubset under the mesh.
        primvar: The name of a primvar of the mesh, read as the primvar of a patch is.

    Returns:
        What `check` says of the mesh.

    Raises:
        TypeError: Something else than a stage or a prim.
        UsageError: Arguments that cannot be, or an edit target that takes nothing.
        StageProblems: The patch could not be slid. Nothing is authored then.
    """
    if sum(source is not None for source in (faces, subset, primvar)) != 1:
        raise UsageError("one of faces, subset and primvar is needed")
    with edited(stage, prim, patch) as mesh:
        applied = SkinSlideAPI.Apply(mesh.prim, patch)
        chosen: np.ndarray | None = None
        if isinstance(faces, str):
            chosen = _expand(parse_faces(faces), mesh.topology.face_count)
        elif faces is not None:
            chosen = given_faces("faces", faces, mesh.topology.face_count)
        elif subset is not None:
            chosen = _of_subset(applied, subset, mesh.meaning)
        elif primvar is not None:
            chosen = _of_primvar(applied, primvar, mesh.meaning)
        if chosen is not None:
            applied.SetFaces(chosen)
        return mesh.checked()


def setup_to_file(
    stage: StageLike,
    output: StrPath,
    prim: PrimLike,
    patch: str,
    *,
    force: bool = False,
    **choice: Unpack[FaceChoice],
) -> CheckReport:
    """Makes a patch as `setup` does, in a layer that sublayers the stage.

    Args:
        stage: The stage, or its path; never written.
        output: The layer: .skinslide, .usda, .usdc or .usd, written whole or not at all. One that sits on the stage
            already gains the patch.
        prim: The mesh.
        patch: The patch's name, such as elbow_L.
        force: Replaces any layer at `output`, where without it one that does not sit on the stage is an error.
        **choice: As for `setup`.

    Returns:
        What `check` says of the mesh.

    Raises:
        TypeError: Something else than a stage or a prim.
        UsageError: Arguments that cannot be.
        StageError: The stage cannot be opened, or the layer not be written.
        StageProblems: The patch could not be slid. Nothing is written then.
    """
    report = author_layer(stage, output, force, lambda layered: setup(layered, prim, patch, **choice))
    return replace(report, stage=str(output))


def parse_faces(spec: str) -> list[tuple[int, int]]:
    """The ranges, first and last face, of a comma list of faces and ranges that include both ends: 0-120,140."""
    ranges = []
    for part in spec.split(","):
        match = _RANGE.fullmatch(part.strip())
        if not match:
            raise UsageError(f"faces {spec[:40]!r}: {part[:40]!r} is neither a face nor a range such as 0-120")
        first, last = int(match[1]), int(match[2] or match[1])
        if last < first:
            raise UsageError(f"faces {spec!r}: {part!r} runs backwards")
        ranges.append((first, last))
    return ranges


def _expand(ranges: list[tuple[int, int]], face_count: int) -> np.ndarray:
    for _, last in ranges:
        check_face(last, face_count)
    return np.unique(np.concatenate([np.arange(first, last + 1) for first, last in ranges]))


def _of_subset(patch: SkinSlideAPI, subset: str, mesh: MeshMeaning) -> np.ndarray | None:
    """The faces of a GeomSubset; None where the patch finds them by itself."""
    found, own = subset_faces(given_subset(patch.GetPrim(), subset), mesh), patch.GetPatchPrimvar()
    return None if subset == patch.GetName() and not (own and own.HasAuthoredValue()) else found


def _of_primvar(patch: SkinSlideAPI, primvar: str, mesh: MeshMeaning) -> np.ndarray | None:
    """The faces that a primvar chooses; None where it is the patch's own."""
    source, own = given_primvar(patch.GetPrim(), primvar), patch.GetPatchPrimvar()
    found = primvar_faces(source, mesh)
    return None if own and source.GetName() == own.GetName() else found
