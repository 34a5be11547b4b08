"""Hands what a mesh of a stage has to the core, and finds what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.meaning import MeshMeaning
from skinslide.arrays.schema import Input, inputs
from skinslide.problems import Fault, noting
from skinslide.stage.skinned import SkinnedPoints
from skinslide.stage.skinning import Skinning
from skinslide.stage.values import FIRST, Source, take


def take_mesh(prim: Usd.Prim, skinning: Skinning | None = None) -> tuple[MeshMeaning, list[str]]:
    """The points, faces and rest points of a mesh, and what is wrong with them."""
    meaning, faults = MeshMeaning(), []
    points, *others = (source_of(prim, each, skinning) for each in inputs("mesh"))
    faults += take(meaning, [points])
    faults = faults or take(meaning, others)
    for each in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues():
        interpolation = each.GetAttr().GetMetadata("interpolation")
        meaning.offer(each.GetName(), str(each.GetTypeName()), interpolation)
    return meaning, faults


def take_space(prim: Usd.Prim, meaning: MeshMeaning) -> list[str]:
    """How the transforms above a mesh scale it, at each time at which they were authored. Returns what is wrong."""
    faults: list[str] = []
    above = (UsdGeom.Xformable(each) for each in _and_above(prim))
    times = sorted({time for each in above if each for time in each.GetTimeSamples()})
    with noting(faults):
        for time in [FIRST, *map(Usd.TimeCode, times)]:
            matrix = UsdGeom.XformCache(time).GetLocalToWorldTransform(prim)
            meaning.take_space(np.array(matrix), 0.0 if time.IsEarliestTime() else time.GetValue())
    return faults


def _and_above(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    while prim:
        yield prim
        prim = prim.GetParent()


def take_subdivision(prim: Usd.Prim, meaning: MeshMeaning) -> list[str]:
    """How the mesh is subdivided. Returns what is wrong."""
    return take(meaning, [Source(prim, each) for each in inputs("subdivision")])


def read_faces_of_mesh(prim: Usd.Prim) -> MeshMeaning:
    """A mesh with its points and faces, and with its rest points where they can be read. Raises Fault."""
    meaning, faults = take_mesh(prim)
    if not meaning.has_faces:
        raise Fault(faults[0])
    return meaning


def source_of(prim: Usd.Prim, wanted: Input, skinning: Skinning | None) -> Source:
    is_points = wanted.property() == UsdGeom.Tokens.points
    return SkinnedPoints(prim, wanted, skinning) if skinning and is_points else Source(prim, wanted)
