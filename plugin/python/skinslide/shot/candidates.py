"""The meshes of a stage on which nothing is set up yet, and what `setup` would take of each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from pxr import Usd, UsdGeom

from skinslide.problems import Fault, counted
from skinslide.stage.finding import find_slidable
from skinslide.stage.names import primvar_names
from skinslide.stage.skinning import Skinning
from skinslide.stage.values import count_of

_MOST_NAMES = 40  # in a line


@dataclass(frozen=True)
class Candidate:
    """A mesh on which a patch could be set up.

    Attributes:
        path: Of the prim.
        points: How many it has.
        faces: How many it has.
        skeleton: The path of the Skeleton by which UsdSkel skins it; empty: it does not.
        joints: Those of it that move points.
        subsets: The GeomSubsets of faces under it.
        primvars: Those that could choose faces.
    """

    path: str
    points: int
    faces: int
    skeleton: str
    joints: list[str]
    subsets: list[str]
    primvars: list[str]

    def lines(self) -> Iterator[str]:
        """The same for a terminal."""
        skinned = f", skinned by {self.skeleton}" if self.skeleton else ""
        yield f"{self.path}: {self.points} points, {counted(self.faces, 'face')}{skinned}, no patch; setup accepts"
        yield f"  --faces 0-{self.faces - 1}"
        for option, names in (("joint", self.joints), ("subset", self.subsets), ("primvar", self.primvars)):
            if names:
                more = f" and {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
                yield f"  --{option} {', '.join(names[:_MOST_NAMES])}{more}"


def find_candidates(stage: Usd.Stage, prim_paths: Sequence[str] | None) -> list[Candidate]:
    """Every mesh with faces that could be slid, of the stage or at and below some prims."""
    found = [_candidate(each.prim, each.is_skinned) for each in find_slidable(stage, prim_paths)]
    return [each for each in found if each.faces]


def _candidate(prim: Usd.Prim, is_skinned: bool) -> Candidate:
    mesh, skeleton, joints = UsdGeom.Mesh(prim), "", list[str]()
    with suppress(Fault):  # said once a patch is there
        skinning = Skinning(prim) if is_skinned else None
        skeleton = skinning.skeleton if skinning else ""
        joints = skinning.rig().names() if skinning else []
    subsets = [UsdGeom.Subset(child) for child in prim.GetChildren() if child.IsA(UsdGeom.Subset)]
    return Candidate(
        str(prim.GetPath()),
        count_of(mesh.GetPointsAttr()),
        count_of(mesh.GetFaceVertexCountsAttr()),
        skeleton,
        joints,
        [each.GetPrim().GetName() for each in subsets if each.GetElementTypeAttr().Get() == UsdGeom.Tokens.face],
        primvar_names(prim),
    )
