"""Reads the meshes of a stage: those with patches, and those that UsdSkel skins."""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Usd

from skinslide.problems import Fault, Problem
from skinslide.stage.finding import FoundMesh, find_meshes, find_skinned, is_skinned
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.neighbours import Neighbours
from skinslide.stage.patch import read_patches
from skinslide.stage.skinning import Skinning
from skinslide.stage.taking import take_mesh, take_space, take_subdivision


def read_meshes(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> tuple[list[PatchedMesh], list[Problem]]:
    """Every mesh with patches that can be read, and every problem found on the way.

    A mesh comes with those of its patches that are good: whoever wants all or none looks for errors among the problems.
    """
    found, problems = find_meshes(stage, prim_paths)
    neighbours = Neighbours(stage)
    meshes = [_read_mesh(each, neighbours, problems) for each in found]
    return [mesh for mesh in meshes if mesh is not None], problems


def _read_mesh(found: FoundMesh, neighbours: Neighbours, problems: list[Problem]) -> PatchedMesh | None:
    prim, path = found.prim, str(found.prim.GetPath())

    def add(faults: Sequence[str], patch: str | None = None) -> None:
        problems.extend(Problem("error", path, patch, None, fault) for fault in faults)

    try:
        skinning = Skinning(prim) if found.is_skinned else None
    except Fault as fault:
        add([str(fault)])
        return None
    meaning, faults = take_mesh(prim, skinning)
    faults += take_space(prim, meaning) if meaning.has_faces else []
    add(faults)
    if not meaning.has_faces:
        return None
    read = list(read_patches(prim, dict.fromkeys(found.patches), meaning, neighbours))
    for name, _, wrong in read:
        add(wrong, name)
    animation = [good for _, good, _ in read if good]
    if faults or not animation:
        return None
    faults = take_subdivision(prim, meaning) if any(each.needs_subdivision for each in animation) else []
    add(faults)
    if faults:
        return None
    mesh = PatchedMesh.of(prim, meaning, animation, skinning, neighbours)
    problems.extend(mesh.warnings())
    return mesh


def read_skinned(stage: Usd.Stage, prim_paths: Sequence[str] | None) -> tuple[list[PatchedMesh], list[Problem]]:
    """Every mesh that UsdSkel skins, without patches, and every problem found on the way."""
    found, problems = find_skinned(stage, prim_paths)
    meshes = [_read_skinned(each.prim, problems) for each in found]
    return [mesh for mesh in meshes if mesh is not None], problems


def _read_skinned(prim: Usd.Prim, problems: list[Problem]) -> PatchedMesh | None:
    try:
        return read_moving(prim)
    except Fault as fault:
        problems.append(Problem("error", str(prim.GetPath()), None, None, str(fault)))
        return None


def read_moving(prim: Usd.Prim) -> PatchedMesh:
    """A mesh as it moves, skinned where UsdSkel does so, without patches. Raises Fault."""
    skinning = Skinning(prim) if is_skinned(prim) else None
    meaning, faults = take_mesh(prim, skinning)
    if faults:
        raise Fault(faults[0])
    return PatchedMesh.of(prim, meaning, [], skinning)
