"""Makes a patch of some faces of a mesh, or one of every mesh that stretches."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import Unpack

import numpy as np
from pxr import Usd

from skinslide.arrays.meaning import MeshMeaning
from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import EditedMesh, checked, edited
from skinslide.author.joints import faces_at, read_rig
from skinslide.author.layer import author_layer
from skinslide.author.mirror import other_side
from skinslide.author.options import (
    REACH,
    SKIN,
    FaceOptions,
    SettingOptions,
    SetupKeywords,
    SetupOptions,
    parse_faces,
)
from skinslide.author.payload import PayloadLayer
from skinslide.author.settings import author_settings, has_pin, pin_names, with_pins_of
from skinslide.author.whole import left_out, moving_meshes, needed_faces, never
from skinslide.problems import Fault, Problem, StageProblems, in_place_of
from skinslide.shot.check import CheckReport
from skinslide.shot.checks import takes
from skinslide.shot.frames import checked_frames
from skinslide.stage import schema
from skinslide.stage.given import (
    PrimLike,
    StageLike,
    StrPath,
    check_face,
    given_faces,
    given_paths,
    given_primvar,
    given_subset,
)
from skinslide.stage.patch import primvar_faces, subset_faces
from skinslide.write.earlier import without_earlier_bake
from skinslide.write.target import check_target


@takes(SetupOptions)
def setup(
    stage: Usd.Stage, prim: PrimLike | None = None, patch: str | None = None, **choice: Unpack[SetupKeywords]
) -> CheckReport:
    """Makes a patch of some faces of a mesh in the stage's edit target, or gives an existing patch other faces.

    One of faces, subset, primvar, joint and whole says which faces. Of weight, rule, holes, interpolation and grow,
    those that are None are not authored, except for the rule of a new patch.

    Args:
        stage: The stage.
        prim: The mesh. With `whole` any prim, for the meshes at and below it, or None, for all of the stage.
        patch: The patch's name, such as elbow_L; with `whole` it may be None: skin.
        **choice: Its faces and settings.

    Returns:
        What `check` says of the meshes; errors of their other patches are warnings.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used, or the edit target takes no opinions.
        StageProblems: The patch could not be slid, or nothing that could be stretches. Nothing is authored then.
    """
    asked = SetupOptions(prim=prim, patch=patch, **choice)
    if asked.whole:
        return _setup_whole(stage, asked)
    if asked.joint is not None:
        return _setup_joints(stage, asked)
    with edited(stage, *asked.place) as mesh:
        _make(mesh, _faces(mesh, asked), asked)
        return mesh.checked()


def _faces(mesh: EditedMesh, asked: FaceOptions) -> np.ndarray | None:
    """Those of one mesh that are asked for; None where the patch finds them by itself."""
    own = SkinSlideAPI(mesh.prim, mesh.patch)
    if asked.subset is not None:
        return _of_subset(own, asked.subset, mesh.meaning)
    if asked.primvar is not None:
        return _of_primvar(own, asked.primvar, mesh.meaning)
    assert asked.faces is not None  # of several choices one is made
    if isinstance(asked.faces, str):
        return _expand(parse_faces(asked.faces), mesh.topology.face_count)
    return given_faces("faces", asked.faces, mesh.topology.face_count)


def _setup_whole(stage: Usd.Stage, asked: SetupOptions) -> CheckReport:
    """Makes one patch for each mesh that stretches and can be slid; all of them, or none."""
    check_target(stage)
    paths = None if asked.prim is None else given_paths("prim", asked.prim)
    with without_earlier_bake(stage, paths):
        moving, barred = moving_meshes(stage, paths)
        _check_pins([mesh.prim for mesh in moving], asked.pin)
        frames = None if asked.frames is None else checked_frames(asked.frames)
        faces, notes, wrong = needed_faces(moving, frames, asked.interpolation)
    wrong = [*barred, *wrong]
    while faces:
        try:
            report = _make_each(stage, faces, asked)
        except StageProblems as bad:
            own = [each for each in bad.problems if each.prim in faces]
            if not own:
                raise
            wrong += own
            for path in {each.prim for each in own}:
                del faces[path]
        else:
            return replace(report, problems=[*report.problems, *notes, *left_out(wrong)])
    message = never("no edge of any mesh") if moving else "no mesh is rendered and has points that move"
    raise StageProblems(wrong or [Problem("error", paths[0] if paths else "", None, None, message)])


def _make_each(stage: Usd.Stage, faces: dict[str, np.ndarray], asked: SetupOptions) -> CheckReport:
    """Makes the patch of some faces of each mesh, by its path. Raises StageProblems, with those of every mesh."""
    made, wrong = list[EditedMesh](), list[Problem]()
    patch = SKIN if asked.patch is None else asked.patch
    with ExitStack() as authoring:
        for path, chosen in faces.items():
            try:
                mesh = authoring.enter_context(edited(stage, path, patch))
                _make(mesh, chosen, with_pins_of(mesh.prim, asked))
                made.append(mesh)
            except StageProblems as bad:
                wrong += bad.problems
            except Fault as fault:
                wrong.append(Problem("error", path, patch, None, str(fault)))
        if wrong:
            raise StageProblems(wrong)
        return checked(made)


def _check_pins(meshes: Sequence[Usd.Prim], pins: Sequence[str]) -> None:
    for name in pins:
        if not any(has_pin(mesh, name) for mesh in meshes):
            there = in_place_of(name, sorted({each for mesh in meshes for each in pin_names(mesh)}))
            message = f"no mesh that moves has a GeomSubset or a primvar {name}; {there}"
            raise StageProblems([Problem("error", "", None, None, message)])


def _make(mesh: EditedMesh, faces: np.ndarray | None, asked: SettingOptions) -> None:
    """Authors the patch with these faces or, for None, with those that it finds by itself."""
    is_new = mesh.patch not in schema.patch_names(mesh.prim)
    applied = SkinSlideAPI.Apply(mesh.prim, mesh.patch)
    if faces is not None:
        applied.SetFaces(faces)
    author_settings(asked, applied, mesh, is_new=is_new)


def _setup_joints(stage: Usd.Stage, asked: SetupOptions) -> CheckReport:
    """Makes the patch of some joints and, if both sides are asked for, that of their counterparts; both, or none."""
    (prim, patch), reach = asked.place, REACH if asked.reach is None else asked.reach
    with ExitStack() as authoring:
        for across in (False, True) if asked.mirror else (False,):
            mesh = authoring.enter_context(edited(stage, prim, other_side(patch) if across else patch))
            rig = read_rig(mesh.prim)
            joints = [rig.across(rig.find(name)) if across else rig.find(name) for name in asked.joint or ()]
            _make(mesh, faces_at(rig, mesh.topology, joints, reach), asked)
        return mesh.checked()


@takes(SetupOptions)
def setup_to_file(
    stage: StageLike,
    output: StrPath,
    prim: PrimLike | None = None,
    patch: str | None = None,
    *,
    force: bool = False,
    payload: StrPath | None = None,
    **choice: Unpack[SetupKeywords],
) -> CheckReport:
    """Makes a patch as `setup` does, in a layer that sublayers the stage.

    Args:
        stage: The stage, or its path; never written.
        output: The layer: .skinslide, .usda, .usdc or .usd, written whole or not at all. One that sublayers the stage
            already gains the patch.
        prim: The mesh, as for `setup`.
        patch: The patch's name, as for `setup`.
        force: Replaces any layer at `output`; without it, one that does not sublayer the stage is an error.
        payload: Another layer to write, .usda, .usdc or .usd, which payloads the set-up and, where that cannot be
            opened without skinslide, the stage; None: none.
        **choice: As for `setup`.

    Returns:
        What `check` says of the meshes; errors of their other patches are warnings.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used.
        StageError: The stage cannot be opened, or the layer cannot be written.
        StageProblems: The patch could not be slid, or nothing that could be stretches. Nothing is written then.
    """
    also = None if payload is None else PayloadLayer(stage, output, payload, force)
    report = author_layer(stage, output, force, lambda layered: setup(layered, prim, patch, **choice))
    if also:
        also.write()
    return replace(report, stage=str(output))


def _expand(ranges: list[tuple[int, int]], face_count: int) -> np.ndarray:
    chosen = np.zeros(face_count, np.bool_)
    for first, last in ranges:
        check_face(last, face_count)
        chosen[first : last + 1] = True
    return np.flatnonzero(chosen)


def _of_subset(patch: SkinSlideAPI, subset: str, mesh: MeshMeaning) -> np.ndarray | None:
    """The faces of a GeomSubset; None where the patch finds them by itself."""
    found, own = subset_faces(given_subset(patch.GetPrim(), subset), mesh), patch.GetPatchPrimvar()
    return None if subset == patch.GetName() and not (own and own.HasAuthoredValue()) else found


def _of_primvar(patch: SkinSlideAPI, primvar: str, mesh: MeshMeaning) -> np.ndarray | None:
    """The faces that a primvar chooses; None where it is the patch's own."""
    source, own = given_primvar(patch.GetPrim(), primvar), patch.GetPatchPrimvar()
    found = primvar_faces(source, mesh)
    return None if own and source.GetName() == own.GetName() else found
