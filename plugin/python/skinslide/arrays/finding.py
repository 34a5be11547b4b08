"""Which prims of a scene can be slid."""

from __future__ import annotations

from typing import NamedTuple

from skinslide._core import ffi, lib
from skinslide.arrays.calls import call_stage
from skinslide.arrays.fetched import PrimFacts
from skinslide.arrays.native import text, token_of


class PrimProblem(NamedTuple):
    """One thing to say about a prim."""

    severity: str  # error or warning
    patch: str | None
    message: str


class Finding(NamedTuple):
    """The patches of a prim, whether they can be slid, what there is to say of it, and whether UsdSkel moves it."""

    patches: list[str]
    slides: bool
    problems: list[PrimProblem]
    is_skinned: bool


def find(facts: PrimFacts) -> Finding:
    """Looks at a prim."""
    out = ffi.new("skinslide_stage_finding **")
    call_stage(lib.skinslide_stage_find, facts, out)
    found = ffi.gc(out[0], lib.skinslide_stage_finding_destroy)
    problems = [
        PrimProblem(token_of("severity", each.severity), text(each.patch) if each.patch else None, text(each.message))
        for each in (found.problems[i] for i in range(found.problem_count))
    ]
    patches = [text(found.patches[i]) for i in range(found.patch_count)]
    return Finding(patches, bool(found.slides), problems, bool(found.skinned_by))


def nothing_to_slide(where: str) -> str:
    """The sentence for a scene in which no mesh carries a patch."""
    error = ffi.new("skinslide_error *")
    lib.skinslide_stage_nothing(where.encode(errors="replace"), error)
    return text(error.message)
