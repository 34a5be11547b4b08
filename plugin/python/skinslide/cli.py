"""The command `skinslide`: arguments in, exit code out. 0 done, 1 failed, 2 usage, 3 the stage has problems."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

from skinslide import __version__
from skinslide.frames import UsageError
from skinslide.outcome import DONE, EXIT_CODES, EXPECTED, PROBLEMS, as_json, failed, prepare_streams, say, tell
from skinslide.slider import Lookup

_DEVICE_VARIABLE = "SKINSLIDE_EGL_DEVICE"

Result = tuple[str, int]  # what to print on stdout, and the exit code


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; every expected fault is a message on stderr and an exit code."""
    prepare_streams()
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        arguments = _parse(words)
    except UsageError as bad:
        return failed(bad, json="--json" in words)
    except SystemExit as done:  # after --help and --version
        return done.code if isinstance(done.code, int) else DONE
    before = _state(arguments)
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # blocked at the start, by skinslide_command
        return say(*arguments.run(arguments))
    except EXPECTED as error:
        return failed(error, getattr(arguments, "json", False), _outcome(arguments, before))


class _Parser(argparse.ArgumentParser):
    """Raises UsageError where argparse would exit, so that --json has a document then too."""

    def error(self, message: str) -> NoReturn:
        tell(self.format_usage().rstrip())
        raise UsageError(message)


def _parse(words: list[str]) -> argparse.Namespace:
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


def _state(arguments: argparse.Namespace) -> tuple | None:
    """Tells whether there is another file at the output than before."""
    try:
        found = os.stat(arguments.output)
    except (AttributeError, OSError, ValueError):  # the command has no output, or there is nothing yet
        return None
    return found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size


def _outcome(arguments: argparse.Namespace, before: tuple | None) -> str:
    if hasattr(arguments, "folder"):
        return f"; every map in {arguments.folder} is whole"
    if not hasattr(arguments, "output"):
        return ""
    return "; nothing was written" if _state(arguments) == before else f" after {arguments.output} was written"


def _bake(arguments: argparse.Namespace) -> Result:
    from skinslide.bake import bake_to_file
    from skinslide.progress import reporter

    with reporter(quiet=arguments.quiet) as progress:
        report = bake_to_file(
            arguments.stage,
            arguments.output,
            prims=arguments.prim,
            frames=arguments.frames,
            lookup=_lookup(arguments),
            jobs=arguments.jobs,
            progress=progress,
            max_folded=arguments.max_folded,
            max_clamped=arguments.max_clamped,
            diagnostics=arguments.diagnostics,
        )
    if arguments.json:
        return as_json({"stage": arguments.stage, "output": arguments.output, **report.as_dict()}), DONE
    return "" if arguments.quiet else _written(report.text(), arguments), DONE


def _check(arguments: argparse.Namespace) -> Result:
    from skinslide.check import check

    report = check(arguments.stage, arguments.prim, lookup=_lookup(arguments))
    return as_json(report.as_dict()) if arguments.json else report.text(), PROBLEMS if report.failed else DONE


def _setup(arguments: argparse.Namespace) -> Result:
    from skinslide.setup import setup

    report = setup(
        arguments.stage,
        arguments.output,
        arguments.prim,
        arguments.patch,
        faces=arguments.faces,
        subset=arguments.subset,
        primvar=arguments.primvar,
        force=arguments.force,
    )
    return f"{report.text()}\n{arguments.output}: written", DONE


def _stitch(arguments: argparse.Namespace) -> Result:
    from skinslide.stitch import stitch

    return _written(stitch(arguments.chunks, arguments.output).text(), arguments), DONE


def _written(report: str, arguments: argparse.Namespace) -> str:
    return f"{report}\n{arguments.output}: written; sublayer it above the cache"


def _paint(arguments: argparse.Namespace) -> Result:
    from skinslide.paint import paint

    report = paint(
        arguments.stage,
        arguments.output,
        arguments.prim,
        arguments.patch,
        arguments.value,
        subset=arguments.subset,
        primvar=arguments.primvar,
        threshold=arguments.threshold,
        curve=arguments.curve,
        distance=arguments.within,
        direction=arguments.direction,
        clear=arguments.clear,
        force=arguments.force,
    )
    return f"{report.text()}\n{arguments.output}: written", DONE


def _mirror(arguments: argparse.Namespace) -> Result:
    from skinslide.mirror import mirror

    report = mirror(
        arguments.stage,
        arguments.output,
        arguments.prim,
        arguments.patch,
        to=arguments.to,
        axis=arguments.axis,
        plane=arguments.plane,
        tolerance=arguments.tolerance,
        force=arguments.force,
    )
    return f"{report.text()}\n{arguments.output}: written", DONE


def _maps(arguments: argparse.Namespace) -> Result:
    from skinslide.maps import maps
    from skinslide.progress import reporter

    with reporter(quiet=arguments.quiet) as progress:
        report = maps(
            arguments.stage,
            arguments.folder,
            prims=arguments.prim,
            patches=arguments.patch,
            frames=arguments.frames,
            size=arguments.size,
            st=arguments.st,
            lookup=_lookup(arguments),
            jobs=arguments.jobs,
            progress=progress,
        )
    if arguments.json:
        return as_json({"stage": arguments.stage, "folder": arguments.folder, **report.as_dict()}), DONE
    return "" if arguments.quiet else report.text(), DONE


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="skinslide",
        description="Lets the skin of a cached character slide over its deformed shape instead of sticking to it.",
        epilog=EXIT_CODES,
    )
    parser.add_argument("--version", action="version", version=f"skinslide {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _add_bake(_add_command(commands, "bake", _bake, "slide every frame and write a layer of corrected points"))
    _add_check(_add_command(commands, "check", _check, "say what would be slid, and every problem"))
    _add_setup(_add_command(commands, "setup", _setup, "write a layer that makes a patch of some faces of a mesh"))
    _add_paint(_add_command(commands, "paint", _paint, "write a layer that gives edges of a patch a force density"))
    _add_mirror(_add_command(commands, "mirror", _mirror, "write a layer that copies a patch to a mesh's other side"))
    _add_maps(_add_command(commands, "maps", _maps, "draw stretch, slide and force density in texture coordinates"))
    _add_stitch(_add_command(commands, "stitch", _stitch, "put chunks of frames, baked apart, into one layer"))
    return parser


Run = Callable[[argparse.Namespace], Result]


def _add_command(commands, name: str, run: Run, summary: str) -> argparse.ArgumentParser:
    description = summary[0].upper() + summary[1:] + "."
    command = commands.add_parser(name, help=summary, description=description, epilog=EXIT_CODES)
    command.set_defaults(run=run)
    return command


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


def _lookup(arguments: argparse.Namespace) -> Lookup:
    device, named = arguments.egl_device, os.environ.get(_DEVICE_VARIABLE)
    if device is None and named:
        try:
            device = _count(named)
        except argparse.ArgumentTypeError as bad:
            raise UsageError(f"{_DEVICE_VARIABLE}: {bad}") from bad
    return Lookup(arguments.lookup, device, arguments.egl_resolution)


def _add_frames(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--frames",
        metavar="SPEC",
        help="frames to write, such as 1001, 1001:1024, 1001-1024x2, -5:5x0.25, or several with commas "
        "(default: the authored samples of points and of animated controls; a mesh without any has one default value)",
    )


def _add_jobs(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--jobs",
        type=_positive,
        default=_processors(),
        metavar="N",
        help="frames slid at once; the result is the same (default: the processors, here %(default)s)",
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


def _add_layer(command: argparse.ArgumentParser) -> None:
    """What the commands that write a set-up have."""
    _add_stage(command)
    command.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="X.skinslide",
        help="layer to write: .skinslide, .usda, .usdc or .usd. It sublayers STAGE by a relative path. "
        "If it exists and sublayers STAGE it gains the patch, or has it replaced, and keeps everything else "
        "but comments in its text; any other existing file is an error",
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


def _add_stitch(command: argparse.ArgumentParser) -> None:
    command.add_argument("chunks", nargs="+", metavar="CHUNK", help="layers that bake wrote, each with other --frames")
    command.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="OUT",
        help="layer of overs to write, the same as one bake of all the frames; replaced in one step at the end",
    )


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
