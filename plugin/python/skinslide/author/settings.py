"""What a new patch has beside its faces: its rule and other settings, and a weight, which is 0 where skin is pinned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from pxr import Usd, UsdGeom

from skinslide.author.api import SkinSlideAPI
from skinslide.author.edit import EditedMesh
from skinslide.author.options import RULE, SettingOptions
from skinslide.problems import Fault, in_place_of
from skinslide.stage import schema
from skinslide.stage.given import given_array, given_number, given_primvar
from skinslide.stage.names import primvar_names, subset_names
from skinslide.stage.patch import primvar_faces, subset_faces
from skinslide.stage.values import read_primvar


def with_pins_of(prim: Usd.Prim, asked: SettingOptions) -> SettingOptions:
    """What is asked for, with only those pins that a mesh has."""
    return replace(asked, pin=[name for name in asked.pin if has_pin(prim, name)])


def author_settings(asked: SettingOptions, patch: SkinSlideAPI, mesh: EditedMesh, *, is_new: bool) -> None:
    """Raises UsageError and Fault."""
    creates: list[tuple[Callable[..., Usd.Attribute], object]] = [
        (patch.CreateForceDensityRuleAttr, asked.rule or (RULE if is_new else None)),
        (patch.CreateHolesAttr, asked.holes),
        (patch.CreateInterpolationAttr, asked.interpolation),
        (patch.CreateGrowAttr, asked.grow),
    ]
    for create, value in creates:
        if value is not None:
            create(value)
    if asked.weight is not None or asked.pin:
        weight = _weight(asked.weight, mesh)
        for name in asked.pin:
            weight = np.where(_pinned(name, mesh), np.float32(0), weight)
        interpolation = UsdGeom.Tokens.vertex if weight.ndim else UsdGeom.Tokens.constant
        patch.CreateWeightPrimvar(interpolation, weight.reshape(-1))


def has_pin(prim: Usd.Prim, name: str) -> bool:
    """Whether a mesh has a GeomSubset or a primvar of a name."""
    return _subset(prim, name) is not None or bool(UsdGeom.PrimvarsAPI(prim).GetPrimvar(name))


def pin_names(prim: Usd.Prim) -> list[str]:
    """What a mesh has that could be pinned by."""
    return [*subset_names(prim), *primvar_names(prim)]


def _subset(prim: Usd.Prim, name: str) -> UsdGeom.Subset | None:
    child = schema.child(prim, name)
    return UsdGeom.Subset(child) if child and child.IsA(UsdGeom.Subset) else None


def _weight(given: npt.ArrayLike | str | None, mesh: EditedMesh) -> np.ndarray:
    """One for the patch, or one for each point (V,)."""
    if isinstance(given, str):
        return _painted(given_primvar(mesh.prim, given), mesh).astype(np.float32)
    if given is None or np.ndim(given) == 0:
        return np.array(1.0 if given is None else given_number("weight", given), np.float32)
    return given_array("weight", given, np.float32, (mesh.topology.vertex_count,))


def _painted(primvar: UsdGeom.Primvar, mesh: EditedMesh) -> np.ndarray:
    return mesh.meaning.painted(read_primvar(primvar))


def _pinned(name: str, mesh: EditedMesh) -> np.ndarray:
    """Which points (V,) a GeomSubset or a primvar chooses: those of its faces, or its own. Raises Fault."""
    subset = _subset(mesh.prim, name)
    if subset is not None:
        return mesh.topology.vertices_of(subset_faces(subset.GetPrim(), mesh.meaning))
    if not has_pin(mesh.prim, name):
        there = in_place_of(name, pin_names(mesh.prim))
        raise Fault(f"there is neither a GeomSubset {name} under the mesh nor a primvar {name} on it; {there}")
    primvar = given_primvar(mesh.prim, name)
    if primvar.GetInterpolation() == UsdGeom.Tokens.uniform:
        return mesh.topology.vertices_of(primvar_faces(primvar, mesh.meaning))
    return _painted(primvar, mesh) > 0
