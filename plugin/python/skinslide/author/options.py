"""What setup, paint and mirror are asked for: each option once, as shot/options.py has those of the other commands."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

from skinslide.problems import UsageError
from skinslide.shot import checks
from skinslide.shot.checks import Options, fault, option, or_none
from skinslide.shot.options import RULES

if TYPE_CHECKING:
    import numpy.typing as npt

    from skinslide.shot.frames import FramesLike
    from skinslide.stage.given import PrimLike

RULE = "even"  # of new patches
SKIN = "skin"  # what patches of whole characters are called
REACH = 0.75  # from a joint, in its length
HOLES = ("pinned", "free", "freeAll")
INTERPOLATIONS = ("auto", "linear", "meanValue", "limit")
DIRECTIONS = ("any", "along", "across")
AXES = ("x", "y", "z")

FACES = ("faces", "subset", "primvar", "joint", "whole")  # one of which says what faces a patch has
EDGES = ("edges", "subset", "primvar", "curve")  # one of which says what edges are painted

_RANGE = re.compile(r"(\d{1,18})(?:[-:](\d{1,18}))?", re.ASCII)


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


def _faces(_name: str, given: npt.ArrayLike | str) -> npt.ArrayLike | str:
    if isinstance(given, str):
        parse_faces(given)
    return given


@dataclass(frozen=True, kw_only=True)
class MeshOptions(Options):
    """What is set up."""

    prim: PrimLike | None = option(None, checks.anything, "--prim", required=True, metavar="PATH", help="the mesh")
    patch: str | None = option(
        None,
        or_none(checks.text),
        "--patch",
        required=True,
        metavar="NAME",
        help="the patch's name, such as elbow_L",
    )


@dataclass(frozen=True, kw_only=True)
class FaceOptions(Options):
    """Which faces a patch is made of."""

    prim: PrimLike | None = option(
        None,
        checks.anything,
        "--prim",
        metavar="PATH",
        help="the mesh; with --whole any prim, for the meshes at and below it (default: the whole stage)",
    )
    patch: str | None = option(
        None,
        or_none(checks.text),
        "--patch",
        metavar="NAME",
        help=f"the patch's name, such as elbow_L (default with --whole: {SKIN})",
    )
    faces: npt.ArrayLike | str | None = option(
        None,
        or_none(_faces),
        "--faces",
        python="Also an array of indices (n,), or a bool for each face of the mesh (F,)",
        metavar="SPEC",
        help="faces by index, such as 0-120,140; both ends count",
    )
    subset: str | None = option(
        None,
        or_none(checks.name("a GeomSubset")),
        "--subset",
        metavar="NAME",
        help="the faces of the GeomSubset NAME under the mesh",
    )
    primvar: str | None = option(
        None,
        or_none(checks.name("a primvar")),
        "--primvar",
        metavar="NAME",
        help="the faces where the primvar NAME is above 0: uniform, of the face; vertex, of all its points",
    )
    joint: Sequence[str] | str | None = option(
        None,
        or_none(checks.names("a joint")),
        "--joint",
        type=checks.words_text,
        metavar="NAME[,NAME]",
        help="the faces of a skinned mesh whose weights mix a joint with its parent or children",
    )
    whole: bool = option(
        False,
        checks.truth,
        "--whole",
        action="store_true",
        help="on every mesh that is rendered, the faces whose edges ever stretch enough to be seen, and enough skin "
        "around them to give: nothing need be painted",
    )
    reach: float | None = option(
        None,
        or_none(checks.positive),
        "--reach",
        type=float,
        metavar="X",
        help="for --joint: how far from it, in lengths of the joint, which is the distance to its children or, without "
        f"any, to its parent (default: {REACH:g})",
    )
    mirror: bool = option(
        False,
        checks.truth,
        "--mirror",
        action="store_true",
        help="for --joint: also the other side, found by the names of joints and patch",
    )
    frames: FramesLike | None = option(
        None,
        or_none(checks.named_frames),
        "--frames",
        metavar="SPEC",
        help="for --whole: frames to look at, such as 1001:1024 (default: every sample)",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        self._needs_one_of(FACES)
        self._go_with(("reach", "mirror"), "joint")
        self._go_with(("frames",), "whole")
        if not self.whole and (self.prim is None or self.patch is None):
            raise fault(type(self), "{prim} and {patch} are needed, unless {whole} is asked for")

    @property
    def place(self) -> tuple[PrimLike, str]:
        """The mesh and the patch, without --whole."""
        assert self.prim is not None and self.patch is not None
        return self.prim, self.patch


@dataclass(frozen=True, kw_only=True)
class SettingOptions(Options):
    """What a patch has beside its faces. What is None is not authored, except for the rule of a new patch."""

    pin: Sequence[str] | str = option(
        (),
        checks.names("a pin"),
        "--pin",
        action="append",
        metavar="NAME",
        help="points that stay, such as lips, lids and nails: a GeomSubset, or a primvar that is above 0 there; may be "
        "given again. With --whole each mesh has those that it has",
    )
    weight: npt.ArrayLike | str | None = option(
        None,
        or_none(checks.weight),
        "--weight",
        type=checks.number_or_name,
        python="Also an array, one for each point (V,)",
        metavar="X",
        help="how far points slide, 0 to 1, or the name of a primvar of that",
    )
    rule: str | None = option(
        None,
        or_none(checks.one_of("rule", RULES)),
        "--rule",
        choices=RULES,
        help=f"where skin slides to (default of a new patch: {RULE})",
    )
    holes: str | None = option(
        None,
        or_none(checks.one_of("holes", HOLES)),
        "--holes",
        choices=HOLES,
        help="what happens at the rims of holes",
    )
    interpolation: str | None = option(
        None,
        or_none(checks.one_of("interpolation", INTERPOLATIONS)),
        "--interpolation",
        choices=INTERPOLATIONS,
        help="how a place within a face becomes a point on the deformed surface",
    )
    grow: float | None = option(
        None,
        or_none(checks.not_negative),
        "--grow",
        type=float,
        metavar="D",
        help="how far around its faces the patch grows, in the mesh's units",
    )


@dataclass(frozen=True, kw_only=True)
class SetupOptions(SettingOptions, FaceOptions):
    """What a patch is made of."""


class SetupKeywords(TypedDict, total=False):
    """The same as keywords of a function."""

    faces: npt.ArrayLike | str | None
    subset: str | None
    primvar: str | None
    joint: Sequence[str] | str | None
    whole: bool
    reach: float | None
    mirror: bool
    frames: FramesLike | None
    pin: Sequence[str] | str
    weight: npt.ArrayLike | str | None
    rule: str | None
    holes: str | None
    interpolation: str | None
    grow: float | None


@dataclass(frozen=True, kw_only=True)
class PaintOptions(MeshOptions):
    """Which edges get which force density."""

    value: float = option(
        None, checks.positive, "--value", type=float, required=True, metavar="X", help="the factor, above 0"
    )
    edges: npt.ArrayLike | None = option(
        None, checks.anything, "", help="point indices (k, 2), a pair for each edge of the mesh"
    )
    subset: str | None = option(
        None,
        or_none(checks.name("a GeomSubset")),
        "--subset",
        metavar="NAME",
        help="the edges of the GeomSubset NAME under the mesh, of elementType edge",
    )
    primvar: str | None = option(
        None,
        or_none(checks.name("a primvar")),
        "--primvar",
        metavar="NAME",
        help="edges with at least --threshold at both ends, by a vertex primvar",
    )
    curve: PrimLike | None = option(
        None,
        or_none(checks.path),
        "--curve",
        metavar="PATH",
        help="edges near a BasisCurves prim drawn on the mesh at rest: by its default points if it has any, else its "
        "first sample",
    )
    threshold: float = option(
        0.5, checks.finite, "--threshold", type=float, metavar="X", help="for --primvar (default: %(default)s)"
    )
    distance: float | None = option(
        None,
        or_none(checks.not_negative),
        "--within",
        type=float,
        metavar="D",
        help="for --curve: how far from it an edge's middle may be, in the mesh's units",
    )
    direction: str = option(
        DIRECTIONS[0],
        checks.one_of("direction", DIRECTIONS),
        "--direction",
        choices=DIRECTIONS,
        help="for --curve: edges at 45 degrees or less to it (along), at more (across), or any (default: %(default)s)",
    )
    clear: bool = option(
        False, checks.truth, "--clear", action="store_true", help="first remove what was painted by edge before"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        self._needs_one_of(EDGES)
        self._go_with(("distance", "direction"), "curve")
        if self.curve is not None and self.distance is None:
            raise fault(type(self), "{curve} needs {distance}, in the mesh's units")


class PaintKeywords(TypedDict, total=False):
    """The same as keywords of a function."""

    edges: npt.ArrayLike | None
    subset: str | None
    primvar: str | None
    curve: PrimLike | None
    threshold: float
    distance: float | None
    direction: str
    clear: bool


@dataclass(frozen=True, kw_only=True)
class MirrorOptions(MeshOptions):
    """Which patch is copied, and across which plane."""

    to: str | None = option(
        None,
        or_none(checks.text),
        "--to",
        metavar="NAME",
        help="the new patch's name (default: that of the other side, elbow_R for elbow_L)",
    )
    axis: str = option(
        AXES[0],
        checks.one_of("axis", AXES),
        "--axis",
        choices=AXES,
        help="the mesh is symmetric at rest about a plane across it (default: %(default)s)",
    )
    plane: float = option(
        0.0,
        checks.finite,
        "--plane",
        type=float,
        metavar="X",
        help="where on the axis the plane is, in the mesh's units (default: %(default)s)",
    )
    tolerance: float | None = option(
        None,
        or_none(checks.not_negative),
        "--tolerance",
        type=float,
        metavar="D",
        help="how far a mirror image may be from its counterpart or, where faces have none and the nearest are taken, "
        "from the mesh, in its units (default: 1e-4 of its largest extent)",
    )


class MirrorKeywords(TypedDict, total=False):
    """The same as keywords of a function."""

    to: str | None
    axis: str
    plane: float
    tolerance: float | None
