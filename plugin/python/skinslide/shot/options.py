"""What commands are asked for: each option once, with its default, its check, and its words on the command line.

An option's name is a keyword of the functions. What it holds has been checked before anything is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict

from skinslide.problems import UsageError
from skinslide.shot import checks
from skinslide.shot.checks import Options, option, or_none

if TYPE_CHECKING:
    from skinslide.arrays.lookup import Lookup
    from skinslide.shot.frames import AskedFrames, Chunk, FramesLike
    from skinslide.stage.given import PrimLike, PrimsLike

Names: TypeAlias = Sequence[str] | str | None
Prims: TypeAlias = "PrimsLike | None"
Frames: TypeAlias = "FramesLike | None"

VIEWS = ("chequer", "stretch", "density", "slide", "texture")
RULES = ("unit", "fast", "relaxed", "even")
QUEUES = ("openjd", "slurm")
FORMATS = ("png", "exr")


@dataclass(frozen=True)
class SlideOptions(Options):
    """What is slid, and how. The result depends neither on lookup nor on jobs."""

    prims: list[str] | None = option(
        None,
        or_none(checks.prims),
        "--prim",
        action="append",
        metavar="PATH",
        help="only the mesh at PATH and meshes below it; may be given again (default: every mesh with a patch). What "
        "USD cannot compose elsewhere, such as a missing payload, is then a warning instead of an error",
    )
    frames: AskedFrames = option(
        None,
        or_none(checks.frames),
        "--frames",
        metavar="SPEC",
        help="frames to take, such as 1001, 1001:1024, 1001-1024x2, -5:5x0.25, or several with commas; or authored, "
        "the samples of points and of animated controls (default: these, and the whole time codes between samples more "
        "than one apart; a mesh without samples has one frame, its default values)",
    )
    lookup: Lookup = option(
        "auto",
        checks.lookup,
        "--lookup",
        choices=("auto", "egl", "exact"),
        help="how the rules unit and fast look rest vertices up in a frame, with the same result: egl renders each "
        "face in its own colour, exact walks, auto is egl where EGL has a hardware device and exact elsewhere "
        "(default: %(default)s)",
    )
    jobs: int = option(
        1,
        checks.whole(1),
        "--jobs",
        type=checks.positive_text,
        metavar="N",
        help="frames to work on at once; the result is the same (default: one for each processor, here %(default)s)",
    )

    @property
    def named(self) -> list[float]:
        """The frames that are named."""
        return self.frames if isinstance(self.frames, list) else []

    @classmethod
    def of(cls, prims: Prims, frames: Frames, lookup: str | Lookup, jobs: int) -> SlideOptions:
        """Raises TypeError and UsageError for values that cannot be used."""
        given: tuple[Any, ...] = (prims, frames, lookup, jobs)
        return cls(*given)


@dataclass(frozen=True)
class LayerOptions(Options):
    """What a bake writes beside points, and how bad a patch may be before it fails; None sets no limit."""

    max_folded: int | None = option(
        None,
        or_none(checks.whole(0)),
        "--max-folded",
        type=checks.count_text,
        metavar="N",
        help="fail, and write nothing, if a patch has more than N faces turned over in its embedding at a frame",
    )
    max_clamped: int | None = option(
        None,
        or_none(checks.whole(0)),
        "--max-clamped",
        type=checks.count_text,
        metavar="N",
        help="fail, and write nothing, if a patch has more than N vertices looked up outside every face at a frame",
    )
    max_stretch: float | None = option(
        None,
        or_none(checks.not_negative),
        "--max-stretch",
        type=float,
        metavar="X",
        help="fail, and write nothing, if a patch has more stretch than X after sliding at a frame: the RMS of "
        "log(length / rest length) over its edges",
    )
    max_added_stretch: float | None = option(
        None,
        or_none(checks.not_negative),
        "--max-added-stretch",
        type=float,
        metavar="X",
        help="fail, and write nothing, if sliding adds more than X to the stretch of a patch at a frame",
    )
    max_roughness: float | None = option(
        None,
        or_none(checks.positive),
        "--max-roughness",
        type=float,
        metavar="X",
        help="fail, and write nothing, if a patch moves more than X times as roughly as its cache, by the largest "
        "second difference in time over the frames that are made, where neither counts as less than a hundredth of the "
        "patch's mean edge at rest",
    )
    share: bool = option(
        False,
        checks.truth,
        "--share",
        action="store_true",
        help="search at each frame for the least stretch that its pose allows, and report how much of what could be "
        "removed sliding removes; slow: seconds a frame for thousands of vertices",
    )
    diagnostics: bool = option(
        False,
        checks.truth,
        "--diagnostics",
        action="store_true",
        help="write primvars beside the points. By vertex: primvars:skinSlide:stretch, the RMS of log(length / rest "
        "length) over its edges after sliding; slide, how far it slid; largestStretch and smallestStretch, the "
        "principal stretches as lengths over lengths at rest; areaRatio, their product. By corner: stretchDirection, "
        "that of the largest in st, as the cosine and sine of twice its angle",
    )


@dataclass(frozen=True)
class ChunkOptions(Options):
    """How a bake makes one of several files of a shot."""

    chunk: Chunk | None = option(
        None,
        or_none(checks.chunk),
        "--chunk",
        metavar="K/N",
        help="bake the Kth of N parts of the frames, such as 3/8, as a task of a farm does; stitch joins them",
    )
    resume: bool = option(
        False,
        checks.truth,
        "--resume",
        action="store_true",
        help="bake nothing if the output is complete already, from the same frames, set-up, cache and options, by the "
        "same version",
    )


@dataclass(frozen=True)
class FarmOptions(Options):
    """How a job for a farm is made."""

    chunk: int = option(
        1,
        checks.whole(1),
        "--chunk",
        type=checks.positive_text,
        metavar="N",
        required=True,
        help="the most frames that a task bakes",
    )
    form: str = option(
        "openjd",
        checks.one_of("format", QUEUES),
        "--format",
        choices=QUEUES,
        help="openjd: an Open Job Description template, for openjd run and AWS Deadline Cloud; slurm: a script that "
        "submits an array of tasks and what follows it (default: %(default)s)",
    )


_WIDTH, _HEIGHT = 960, 1080  # pixels of a pose, where nobody says how many


@dataclass(frozen=True, kw_only=True)
class PictureOptions(Options):
    """What pictures are drawn."""

    patches: Names = option(
        None,
        or_none(checks.texts),
        "--patch",
        action="append",
        metavar="NAME",
        help="only this patch; may be given again (default: all)",
    )
    views: Sequence[str] | str = option(
        VIEWS[:2],
        checks.some_of("view", VIEWS),
        "--view",
        action="append",
        choices=VIEWS,
        help="chequer: by the texture coordinates; stretch: the RMS of log(length / rest length) around each point, in "
        "false colours; density: the painted force density; slide: how far each point slid, and from where; "
        "texture: the base colour texture of the mesh's material; may be given again (default: chequer and stretch)",
    )
    compare: Names = option(
        None,
        or_none(checks.some_of("rule", RULES)),
        "--compare",
        type=checks.words_text,
        metavar="RULE[,RULE]",
        help="show beside the cache what each of these rules makes of every patch, in place of the patch's own rule",
    )
    wire: bool = option(False, checks.truth, "--wire", action="store_true", help="draw the sides of the patch's faces")
    camera: PrimLike | None = option(
        None,
        or_none(checks.prim),
        "--camera",
        metavar="PATH",
        help="a Camera of the stage (default: one that sees the patch all through the shot, standing still, or moving "
        "along if the patch goes far)",
    )
    follow: bool = option(
        False, checks.truth, "--follow", action="store_true", help="point the camera at the patch anew in each frame"
    )
    size: tuple[int, int] = option(
        None,  # then by how many poses are side by side
        or_none(checks.picture_size),
        "--size",
        type=checks.size_text,
        metavar="WxH",
        help="pixels of a picture (default: 960x1080 for each of the poses side by side)",
    )
    form: str = option(
        "png",
        checks.one_of("format", FORMATS),
        "--format",
        choices=FORMATS,
        help="file format of the pictures; exr is in linear light (default: %(default)s)",
    )
    st: str | None = option(
        None,
        or_none(checks.coordinates),
        "--st",
        metavar="NAME",
        help="primvar with the texture coordinates of the chequer (default: st; on a mesh without it, rest points)",
    )
    squares: float | None = option(
        None,
        or_none(checks.positive),
        "--squares",
        type=float,
        metavar="N",
        help="squares of the chequer for each unit of st, or of length (default: 16 across the patch)",
    )
    stretch_scale: float = option(
        0.5,
        checks.positive,
        "--stretch-scale",
        old="--most-stretch",
        type=float,
        metavar="X",
        help="the stretch at the end of the scale of colours (default: %(default)s)",
    )

    def __post_init__(self) -> None:
        if self.camera is not None and self.follow:
            raise UsageError("a camera of the stage does not follow a patch: give one or the other")
        super().__post_init__()
        if self.size is None:
            object.__setattr__(self, "size", (_WIDTH * (1 + len(self.compare or ("after",))), _HEIGHT))


class PictureKeywords(TypedDict, total=False):
    """The same as keywords of a function."""

    patches: Names
    views: Sequence[str] | str
    compare: Names
    wire: bool
    camera: PrimLike | None
    follow: bool
    size: tuple[int, int]
    form: str
    st: str | None
    squares: float | None
    stretch_scale: float


@dataclass(frozen=True, kw_only=True)
class MapOptions(Options):
    """What maps are drawn."""

    patches: Names = option(
        None,
        or_none(checks.texts),
        "--patch",
        action="append",
        metavar="NAME",
        help="draw only the faces of patch NAME, though all slide; may be given again (default: every patch)",
    )
    size: int = option(
        1024,
        checks.map_size,
        "--map-size",
        old="--size",
        type=checks.positive_text,
        metavar="N",
        help="texels along each side, 1 to 16384 (default: %(default)s)",
    )
    st: str = option(
        "st",
        checks.coordinates,
        "--st",
        metavar="NAME",
        help="primvar with the texture coordinates that the maps are drawn in, and 4 texels beyond their borders; "
        "where faces overlap, as mirrored halves do, the later one in the mesh shows (default: %(default)s)",
    )
    strain: bool = option(
        False,
        checks.truth,
        "--strain",
        action="store_true",
        help="also write MESH.strain.FRAME.exr, of the slid skin, for wrinkles: channels largest and smallest, the "
        "principal stretches as lengths over lengths at rest; area, their product; direction.x and direction.y, the "
        "cosine and sine of twice the angle of the largest from s towards t",
    )


class MapKeywords(TypedDict, total=False):
    """The same as keywords of a function."""

    strain: bool
    patches: Names
    size: int
    st: str
