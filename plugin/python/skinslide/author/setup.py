"""Makes a patch of some faces of a mesh, or one of every mesh that stretches."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import TypedDict, Unpack

import numpy as np
import numpy.typing as npt
from pxr import Usd

from skinslide.arrays.meaning import MeshMeaning
from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import EditedMesh, checked, edited
from skinslide.author.joints import REACH, faces_at, read_rig
from skinslide.author.layer import author_layer
from skinslide.author.mirror import other_side
from skinslide.author.payload import PayloadLayer
from skinslide.author.settings import Settings, has_pin, pin_names
from skinslide.author.whole import left_out, moving_meshes, needed_faces, never
from skinslide.problems import Fault, Problem, StageProblems, UsageError, in_place_of
from skinslide.shot.check import CheckReport
from skinslide.shot.checks import positive, texts
from skinslide.shot.frames import FramesLike, checked_frames
from skinslide.stage import schema
from skinslide.stage.given import (
    PrimLike,
    StageLike,
    StrPath,
    check_face,
    given_faces,
    given_name,
    given_paths,
    given_primvar,
    given_subset,
)
from skinslide.stage.patch import primvar_faces, subset_faces
from skinslide.write.earlier import without_earlier_bake
from skinslide.write.target import check_target

_RANGE = re.compile(r"(\d{1,18})(?:[-:](\d{1,18}))?", re.ASCII)


class PatchChoice(TypedDict, total=False):
    """The keywords of `setup`."""

    faces: npt.ArrayLike | str | None
    subset: str | None
    primvar: str | None
    joint: Sequence[str] | str | None
    reach: float | None
    mirror: bool
    whole: bool
    frames: FramesLike | None
    pin: Sequence[str] | str
    weight: npt.ArrayLike | str | None
    rule: str | None
    holes: str | None
    interpolation: str | None
    grow: float | None


def setup(
    stage: Usd.Stage,
    prim: PrimLike | None = None,
    patch: str | None = None,
    *,
    faces: npt.ArrayLike | str | None = None,
    subset: str | None = None,
    primvar: str | None = None,
    joint: Sequence[str] | str | None = None,
    reach: float | None = None,
    mirror: bool = False,
    whole: bool = False,
    frames: FramesLike | None = None,
    pin: Sequence[str] | str = (),
    weight: npt.ArrayLike | str | None = None,
    rule: str | None = None,
    holes: str | None = None,
    interpolation: str | None = None,
    grow: float | None = None,
) -> CheckReport:
    """Makes a patch of some faces of a mesh in the stage's edit target, or gives an existing patch other faces.

    One of faces, subset, primvar, joint and whole says which faces. Of weight, rule, holes, interpolation and grow,
    those that are None are not authored, except for the rule of a new patch.

    Args:
        stage: The stage.
        prim: The mesh. With `whole` any prim, for the meshes at and below it, or None, for all of the stage.
        patch: The patch's name, such as elbow_L; with `whole` it may be None: skin.
        faces: Indices (n,), a bool for each face of the mesh (F,), or a spec such as "0-120,140".
        subset: The name of a GeomSubset under the mesh.
        primvar: The name of a primvar of the mesh, read as the primvar of a patch is.
        joint: Joints of the Skeleton that the mesh is bound to, by name: faces whose weights mix one of them with its
            parent or children.
        reach: How far from a joint, in lengths of the joint: that to its children or, without any, to its parent; None:
            0.75.
        mirror: With `joint`, also makes the patch of the other side, found by the names of joints and patch.
        whole: The faces whose edges ever stretch by over 2 %, and enough around them to give. Each mesh that is
            rendered, has such edges and can be slid gets one patch.
        frames: With `whole`, the frames to look at: a spec such as 1001:1024, or numbers; None: every sample.
        pin: Points that stay, such as lips, lids and nails, by the names of GeomSubsets under the mesh or primvars on
            it: their weight is 0. With `whole` each mesh has those that it has.
        weight: How far points slide, 0 to 1: a number, one for each point (V,), or the name of a primvar by point.
        rule: unit, fast, relaxed or even; None: even for a patch that is new.
        holes: pinned, free or freeAll.
        interpolation: auto, linear, meanValue or limit.
        grow: How far around its faces the patch grows, in the mesh's units.

    Returns:
        What `check` says of the meshes; errors of their other patches are warnings.

    Raises:
        TypeError: The stage or the prim is of another type.
        UsageError: The arguments cannot be used, or the edit target takes no opinions.
        StageProblems: The patch could not be slid, or nothing that could be stretches. Nothing is authored then.
    """
    if sum(source is not None for source in (faces, subset, primvar, joint)) + whole != 1:
        raise UsageError("one of faces, subset, primvar, joint and whole is needed")
    if joint is None and (reach is not None or mirror):
        raise UsageError("reach and mirror go with joint")
    settings = Settings(_names("pin", pin), weight, rule, holes, interpolation, grow)
    if whole:
        name, times = "skin" if patch is None else patch, None if frames is None else checked_frames(frames)
        return _setup_whole(stage, prim, name, times, settings)
    if prim is None or patch is None or frames is not None:
        raise UsageError("a prim and a patch are needed, and no frames, where whole is not asked for")
    if joint is not None:
        patches = [patch, other_side(patch)] if mirror else [patch]
        return _setup_joints(stage, prim, patches, _names("joint", joint), reach, settings)
    with edited(stage, prim, patch) as mesh:
        own, chosen = SkinSlideAPI(mesh.prim, patch), None
        if isinstance(faces, str):
            chosen = _expand(parse_faces(faces), mesh.topology.face_count)
        elif faces is not None:
            chosen = given_faces("faces", faces, mesh.topology.face_count)
        elif subset is not None:
            chosen = _of_subset(own, subset, mesh.meaning)
        elif primvar is not None:
            chosen = _of_primvar(own, primvar, mesh.meaning)
        _make(mesh, patch, chosen, settings)
        return mesh.checked()


def _names(argument: str, given: Sequence[str] | str) -> list[str]:
    return [given_name(f"a {argument}", name) for name in texts(argument, given)]


def _setup_whole(
    stage: Usd.Stage, prim: PrimLike | None, patch: str, frames: list[float] | None, settings: Settings
) -> CheckReport:
    """Makes one patch for each mesh that stretches and can be slid; all of them, or none."""
    check_target(stage)
    paths = None if prim is None else given_paths("prim", prim)
    with without_earlier_bake(stage, paths):
        moving, barred = moving_meshes(stage, paths)
        _check_pins([mesh.prim for mesh in moving], settings.pins)
        faces, said, wrong = needed_faces(moving, frames)
    wrong = [*barred, *wrong]
    while faces:
        try:
            report = _make_each(stage, faces, patch, settings)
        except StageProblems as bad:
            own = [each for each in bad.problems if each.prim in faces]
            if not own:
                raise
            wrong += own
            for path in {each.prim for each in own}:
                del faces[path]
        else:
            return replace(report, problems=[*report.problems, *said, *left_out(wrong)])
    message = never("no edge of any mesh") if moving else "no mesh is rendered and has points that move"
    raise StageProblems(wrong or [Problem("error", paths[0] if paths else "", None, None, message)])


def _make_each(stage: Usd.Stage, faces: dict[str, np.ndarray], patch: str, settings: Settings) -> CheckReport:
    """Makes the patch of some faces of each mesh, by its path. Raises StageProblems, with those of every mesh."""
    made, wrong = list[EditedMesh](), list[Problem]()
    with ExitStack() as authoring:
        for path, chosen in faces.items():
            try:
                mesh = authoring.enter_context(edited(stage, path, patch))
                _make(mesh, patch, chosen, settings.for_mesh(mesh.prim))
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


def _make(mesh: EditedMesh, patch: str, faces: np.ndarray | None, settings: Settings) -> None:
    """Authors the patch with these faces or, for None, with those that it finds by itself."""
    is_new = patch not in schema.patch_names(mesh.prim)
    applied = SkinSlideAPI.Apply(mesh.prim, patch)
    if faces is not None:
        applied.SetFaces(faces)
    settings.author(applied, mesh, is_new=is_new)


def _setup_joints(
    stage: Usd.Stage,
    prim: PrimLike,
    patches: Sequence[str],
    names: Sequence[str],
    reach: float | None,
    settings: Settings,
) -> CheckReport:
    """Makes the patch of some joints and, if a second is named, that of their counterparts; both, or none."""
    far = REACH if reach is None else positive("reach", reach)
    with ExitStack() as authoring:
        for number, patch in enumerate(patches):
            mesh = authoring.enter_context(edited(stage, prim, patch))
            rig = read_rig(mesh.prim)
            joints = [rig.across(rig.find(name)) if number else rig.find(name) for name in names]
            _make(mesh, patch, faces_at(rig, mesh.topology, joints, far), settings)
        return mesh.checked()


def setup_to_file(
    stage: StageLike,
    output: StrPath,
    prim: PrimLike | None = None,
    patch: str | None = None,
    *,
    force: bool = False,
    payload: StrPath | None = None,
    **choice: Unpack[PatchChoice],
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


def parse_faces(spec: str) -> list[tuple[int, int]]:
    """The ranges, first and last face, of a comma-separated list of faces and inclusive ranges: 0-120,140."""
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
