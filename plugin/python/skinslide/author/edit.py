"""Authors a patch of a mesh in the edit target of its stage: whole and fit to be slid, or not at all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property

from pxr import Usd, UsdGeom

from skinslide.arrays.meaning import MeshMeaning
from skinslide.arrays.topology import Topology
from skinslide.problems import Fault, Problem, StageProblems, errors, in_place_of
from skinslide.shot.check import CheckReport, check
from skinslide.stage import schema
from skinslide.stage.given import PrimLike, given_path
from skinslide.stage.names import prim_of_type
from skinslide.stage.taking import read_faces_of_mesh
from skinslide.write.earlier import without_earlier_bake
from skinslide.write.target import check_target, hidden_by, whole_or_not_at_all


@dataclass(frozen=True)
class EditedMesh:
    """A mesh, and the patch that is authored."""

    prim: Usd.Prim
    meaning: MeshMeaning
    patch: str

    @cached_property
    def topology(self) -> Topology:
        return Topology.of(self.meaning)

    def check_patch(self, patch: str) -> None:
        """Raises Fault where the mesh has no patch of that name."""
        there = schema.patch_names(self.prim)
        if patch not in there:
            others = in_place_of(patch, there) if there else "skinslide setup makes one"
            raise Fault(f"there is no such patch on the mesh; {others}")

    def checked(self) -> CheckReport:
        """What `check` says of the mesh. Raises StageProblems where the patch cannot be slid."""
        return checked([self])

    def hidden(self) -> Iterator[Problem]:
        """Warnings of properties that an opinion stronger than the edit target's hides."""
        for each in self.prim.GetAuthoredProperties():
            stronger = hidden_by(each) if schema.is_of_patch(each.GetName(), self.patch) else None
            if stronger:
                message = f"{each.GetName()} is hidden by that in {stronger}, which is stronger"
                yield Problem("warning", str(self.prim.GetPath()), self.patch, None, message)


def checked(meshes: Sequence[EditedMesh]) -> CheckReport:
    """What `check` says of one or more meshes of a stage; of their other patches, errors become warnings.

    Raises StageProblems where a patch that was authored cannot be slid.
    """
    stage, paths = meshes[0].prim.GetStage(), [str(mesh.prim.GetPath()) for mesh in meshes]
    patches = {None, *(mesh.patch for mesh in meshes)}
    with without_earlier_bake(stage, paths):
        report = check(stage, paths)
    bad = [problem for problem in errors(report.problems) if problem.patch in patches]
    if bad:
        raise StageProblems(bad)
    hidden = (each for mesh in meshes for each in mesh.hidden())
    return replace(report, problems=[*map(_of_another, report.problems), *hidden])


def _of_another(problem: Problem) -> Problem:
    """A problem, where an error is of another patch, which was there before."""
    if problem.severity != "error":
        return problem
    return replace(problem, severity="warning", message=f"stops every bake of the mesh: {problem.message}")


@contextmanager
def edited(stage: Usd.Stage, prim: PrimLike, patch: str, source: str | None = None) -> Iterator[EditedMesh]:
    """The mesh, while the block authors its patch.

    Faults are reported for `source`, the patch that is read for it; None: for the patch itself. Raises TypeError,
    UsageError, and StageProblems, also in place of a Fault; nothing is authored then.
    """
    check_target(stage)
    path = given_path("prim", prim)
    try:
        with whole_or_not_at_all(stage, path, lambda name: schema.is_of_patch(name, patch)):
            mesh = prim_of_type(stage, str(path), UsdGeom.Mesh)
            yield EditedMesh(mesh, read_faces_of_mesh(mesh), patch)
    except Fault as fault:
        raise StageProblems([Problem("error", str(path), source or patch, None, str(fault))]) from fault
