"""What the command `skinslide` understands: its commands and their options."""

from __future__ import annotations

import argparse
import os
import re
from typing import TYPE_CHECKING, NoReturn

from skinslide.command.outcome import EXIT_CODES, tell
from skinslide.problems import UsageError
from skinslide.shot.options import FORMATS, VIEWS

if TYPE_CHECKING:
    from skinslide.arrays.native import Lookup

_DEVICE_VARIABLE = "SKINSLIDE_EGL_DEVICE"


def parse(words: list[str]) -> argparse.Namespace:
    """The arguments of a command; raises UsageError, and SystemExit after --help and --version."""
    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError as error:
            raise UsageError(f"argument {word!r}: is not UTF-8") from error
    joined: list[str] = []
    for word in words:
        # argparse takes -5:5 for an option, but not in --frames=-5:5.
        if joined and joined[-1] == "--frames" and re.match("-[0-9.]", word):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return _parser().parse_args(joined)


def lookup_of(arguments: argparse.Namespace) -> Lookup:
    """How a command is to look up; the environment may name a device."""
    from skinslide.arrays.native import Lookup

    device, named = arguments.egl_device, os.environ.get(_DEVICE_VARIABLE)
    if device is None and named:
        try:
            device = _count(named)
        except argparse.ArgumentTypeError as bad:
            raise UsageError(f"{_DEVICE_VARIABLE}: {bad}") from bad
    return Lookup(arguments.lookup, device, arguments.egl_resolution)


class _Parser(argparse.ArgumentParser):
    """Raises UsageError where argparse would exit, so that --json has a document then too."""

    def error(self, message: str) -> NoReturn:
        tell(self.format_usage().rstrip())
        raise UsageError(message)


class _Version(argparse.Action):
    """As argparse's own, but the library that knows it is loaded only when it is asked."""

    def __call__(self, *_arguments: object) -> NoReturn:
        import skinslide

        print(f"skinslide {skinslide.__version__}")
        raise SystemExit(0)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="skinslide",
        description="Lets the skin of a cached character slide over its deformed shape instead of sticking to it.",
        epilog=EXIT_CODES,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    _add_bake(_add_command(commands, "bake", "slide every frame and write a layer of corrected points"))
    _add_check(_add_command(commands, "check", "say what would be slid, and every problem"))
    _add_preview(_add_command(commands, "preview", "draw pictures of every patch, before and after sliding"))
    _add_maps(_add_command(commands, "maps", "draw stretch, slide and force density in texture coordinates"))
    _add_setup(_add_command(commands, "setup", "write a layer that makes a patch of some faces of a mesh"))
    _add_paint(_add_command(commands, "paint", "write a layer that gives edges of a patch a force density"))
    _add_mirror(_add_command(commands, "mirror", "write a layer that copies a patch to a mesh's other side"))
    _add_stitch(_add_command(commands, "stitch", "put chunks of frames, baked apart, into one layer"))
    return parser


def _add_command(commands, name: str, summary: str) -> argparse.ArgumentParser:
    description = summary[0].upper() + summary[1:] + "."
    return commands.add_parser(name, help=summary, description=description, epilog=EXIT_CODES)


def _add_stage(command: argparse.ArgumentParser) -> None:
    stage_help = "the stage: .usd, .usda, .usdc, .usdz or .skinslide; never written"
    command.add_argument("stage", metavar="STAGE", help=stage_help)


def _add_prims(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--prim",
        action="append",
        metavar="PATH",
        help="only the mesh at PATH and meshes below it; may be given again (default: every mesh with a patch). What "
        "USD cannot compose elsewhere, such as a missing payload, is then a warning and no error",
    )


def _add_lookup(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--lookup",
        default="auto",
        choices=("auto", "egl", "exact"),
        help="how rest vertices are looked up in a frame; the result is the same: egl renders a colour a face, exact "
        "walks, auto is egl where EGL has a hardware device and exact elsewhere (default: auto)",
    )
    command.add_argument(
        "--egl-device",
        type=_count,
        metavar="N",
        help=f"the one of EGL's devices to use (default: {_DEVICE_VARIABLE} in the environment, else the first that "
        "works, hardware before software)",
    )
    command.add_argument(
        "--egl-resolution",
        type=_positive,
        default=0,
        metavar="N",
        help="texels along a side of the texture of faces (default: by the patch, 256 to 4096)",
    )


def _add_frames(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--frames",
        metavar="SPEC",
        help="frames to take, such as 1001, 1001:1024, 1001-1024x2, -5:5x0.25, or several with commas "
        "(default: the authored samples of points and of animated controls; a mesh without any has one default value)",
    )


def _add_jobs(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--jobs",
        type=_positive,
        default=_processors(),
        metavar="N",
        help="frames in hand at once; the result is the same (default: the processors, here %(default)s)",
    )


def _add_printing(command: argparse.ArgumentParser) -> None:
    command.add_argument("--quiet", action="store_true", help="print nothing but errors")
    command.add_argument("--json", action="store_true", help="print the report as one JSON document on stdout")


def _add_bake(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    command.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="OUT",
        help="layer of overs to write, to be sublayered above the cache: .usda, .usdc or .usd. "
        "Replaced in one step at the end, so a bake that fails or is killed leaves it as it was; one killed outright "
        "leaves a partial file beside it, which the next bake of OUT removes when it is a day old",
    )
    _add_prims(command)
    _add_frames(command)
    _add_lookup(command)
    _add_jobs(command)
    limits = {"folded": "faces turned over in its embedding", "clamped": "vertices looked up outside every face"}
    for option, what in limits.items():
        command.add_argument(
            f"--max-{option}",
            type=_count,
            metavar="N",
            help=f"fail, and write nothing, where a patch has more than N {what} at a frame",
        )
    command.add_argument(
        "--diagnostics",
        action="store_true",
        help="write two primvars by vertex beside the points: primvars:skinSlide:stretch, the RMS of log(length / rest "
        "length) over the edges of patches at the vertex, slid; and primvars:skinSlide:slide, how far it slid",
    )
    _add_printing(command)


def _add_check(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_prims(command)
    _add_lookup(command)
    command.add_argument("--json", action="store_true", help="print the report as one JSON document on stdout")


def _add_preview(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    command.add_argument(
        "-o",
        "--output",
        dest="folder",
        metavar="DIR",
        help="folder for MESH.PATCH.VIEW.FRAME.png (MESH.PATCH.PIECE.VIEW.FRAME.png where a patch falls into pieces) "
        "and contact_sheet.png (with --frames contact_sheet.FIRST-LAST.png), made where it is missing; each file is "
        "replaced in one step. This, --html, or both",
    )
    command.add_argument(
        "--html",
        metavar="FILE",
        help="a page of all pictures, to be scrubbed through, with curves of stretch, slides, folds and time and the "
        "settings used: one file, which loads no other",
    )
    _add_prims(command)
    command.add_argument(
        "--patch", action="append", metavar="NAME", help="only this patch; may be given again (default: all)"
    )
    _add_frames(command)
    command.add_argument(
        "--view",
        action="append",
        choices=VIEWS,
        help="chequer: on the texture coordinates; stretch: the RMS of log(length / rest length) around each point, in "
        "false colours; may be given again (default: both)",
    )
    command.add_argument(
        "--camera",
        metavar="PATH",
        help="a Camera of the stage (default: one that stands still and has the patch in sight all through the shot)",
    )
    command.add_argument("--follow", action="store_true", help="frame the patch anew in each frame")
    command.add_argument("--size", type=_size, default=(1920, 1080), metavar="WxH", help="pixels (default: 1920x1080)")
    command.add_argument("--format", default="png", choices=FORMATS, help="of the pictures; exr is linear light")
    command.add_argument(
        "--st",
        metavar="NAME",
        help="the primvar that the chequer follows (default: st, and on a mesh without it places at rest)",
    )
    command.add_argument(
        "--squares",
        type=float,
        metavar="N",
        help="of the chequer, for each unit of it (default: 16 across the patch)",
    )
    command.add_argument(
        "--most-stretch",
        type=float,
        default=0.5,
        metavar="X",
        help="what the end of the scale of colours stands for (default: 0.5)",
    )
    _add_lookup(command)
    _add_jobs(command)
    _add_printing(command)


def _add_maps(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    command.add_argument(
        "-o",
        "--output",
        dest="folder",
        required=True,
        metavar="DIR",
        help="folder for the maps, made where it is missing: MESH.KIND.FRAME.exr, or MESH.KIND.TILE.FRAME.exr where "
        "faces reach beyond the first tile of a UDIM. KIND is stretchBefore and stretchAfter (the RMS of log(length / "
        "rest length) over the edges at a point), slide (distance, in the mesh's units) and forceDensity (as painted). "
        "One channel, Y. A map is replaced in one step, so one that fails or is killed leaves it as it was",
    )
    _add_prims(command)
    command.add_argument(
        "--patch",
        action="append",
        metavar="NAME",
        help="draw the faces of patch NAME only, though all slide; may be given again (default: every patch)",
    )
    _add_frames(command)
    command.add_argument(
        "--size", type=_positive, default=1024, metavar="N", help="texels along each side, 1 to 16384 (default: 1024)"
    )
    command.add_argument(
        "--st",
        default="st",
        metavar="NAME",
        help="the primvar with texture coordinates, in which the maps are drawn and carried on for 4 texels beyond; "
        "where faces overlap in it, as with mirrored halves, the later in the mesh is seen (default: st)",
    )
    _add_lookup(command)
    _add_jobs(command)
    _add_printing(command)


def _add_layer(command: argparse.ArgumentParser) -> None:
    """What the commands that write a set-up have."""
    _add_stage(command)
    command.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="X.skinslide",
        help="layer to write: .skinslide, .usda, .usdc or .usd. It sublayers STAGE by a relative path. "
        "If it exists and sublayers STAGE this is written into it, and it keeps everything else but comments in its "
        "text; any other existing file is an error",
    )
    command.add_argument("--prim", required=True, metavar="PATH", help="the mesh")
    command.add_argument("--patch", required=True, metavar="NAME", help="the patch's name, such as elbow_L")
    command.add_argument("--force", action="store_true", help="replace whatever exists at the output")


def _add_setup(command: argparse.ArgumentParser) -> None:
    _add_layer(command)
    faces = command.add_mutually_exclusive_group(required=True)
    faces.add_argument("--faces", metavar="SPEC", help="faces by index, such as 0-120,140; both ends count")
    faces.add_argument("--subset", metavar="NAME", help="the faces of the GeomSubset NAME under the mesh")
    faces.add_argument(
        "--primvar",
        metavar="NAME",
        help="the faces where the primvar NAME is above 0, by face (uniform) or on all points (vertex)",
    )


def _add_paint(command: argparse.ArgumentParser) -> None:
    _add_layer(command)
    command.add_argument("--value", type=float, required=True, metavar="X", help="the factor, above 0")
    edges = command.add_mutually_exclusive_group(required=True)
    edges.add_argument("--subset", metavar="NAME", help="the edges of the GeomSubset NAME, of elementType edge")
    edges.add_argument("--primvar", metavar="NAME", help="edges with at least --threshold at both ends")
    edges.add_argument("--curve", metavar="PATH", help="edges near a BasisCurves prim drawn on the mesh at rest")
    command.add_argument("--threshold", type=float, default=0.5, metavar="X", help="for --primvar (default: 0.5)")
    command.add_argument(
        "--within", type=float, metavar="D", help="for --curve: edges whose middle is no farther, in the mesh's units"
    )
    command.add_argument(
        "--direction",
        default="any",
        choices=("any", "along", "across"),
        help="for --curve: edges at 45 degrees or less to it (along), at more (across), or any (default)",
    )
    command.add_argument("--clear", action="store_true", help="forget what was painted by edge before")


def _add_mirror(command: argparse.ArgumentParser) -> None:
    _add_layer(command)
    command.add_argument("--to", metavar="NAME", help="the new patch's name (default: elbow_R for elbow_L)")
    command.add_argument(
        "--axis",
        default="x",
        choices=("x", "y", "z"),
        help="the mesh is symmetric about a plane across it (default: x)",
    )
    command.add_argument("--plane", type=float, default=0.0, metavar="X", help="where the plane is (default: 0)")
    command.add_argument(
        "--tolerance",
        type=float,
        metavar="D",
        help="how far a point may be from its counterpart's mirror image (default: 1e-4 of the mesh's largest extent)",
    )


def _add_stitch(command: argparse.ArgumentParser) -> None:
    command.add_argument("chunks", nargs="+", metavar="CHUNK", help="layers that bake wrote, each with other --frames")
    command.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="OUT",
        help="layer of overs to write, with all that one bake of all the frames has; replaced in one step at the end",
    )


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,9})[xX](\d{1,9})", text, re.ASCII)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is not a size such as 1920x1080")
    return int(found[1]), int(found[2])


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _count(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 0 or more")
    return int(text)


def _positive(text: str) -> int:
    if _count(text) < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return int(text)
