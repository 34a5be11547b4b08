"""What the command `skinslide` understands: its commands and their options."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import Field, fields
from typing import Any, NoReturn

from skinslide.command.outcome import DONE, EXIT_CODES, print_error, print_result
from skinslide.problems import UsageError, in_place_of
from skinslide.shot.checks import Options, count_text, described, positive_text
from skinslide.shot.options import ChunkOptions, FarmOptions, LayerOptions, MapOptions, PictureOptions, SlideOptions

_DEVICE_VARIABLE = "SKINSLIDE_EGL_DEVICE"
_TABLE = (
    "shape is that of the patch's faces, a disk, one with holes, or closed; stretch and slid are the RMS of log(edge "
    "length / rest length) over its edges, in the cache and slid, at the frame where the cache has most, and change is "
    "from one to the other; rough is how many times as roughly as its cache the skin moves, by the largest second "
    "difference in time (-: of frames more than one apart, or fewer than three); folded and clamped are the most faces "
    "turned over, and vertices looked up outside every face, at a frame; ms/frame is the mean time in the core, which "
    "--json has by stage"
)


def parse(words: list[str]) -> dict[str, Any]:
    """The command and the arguments that are given, as keywords of the function that it calls.

    Raises UsageError, and SystemExit after --help and --version.
    """
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
    return vars(_parser("".join(joined[:1])).parse_args(joined))


def device_of_environment() -> int | None:
    """The number of the EGL device that the environment names. Raises UsageError if that is no number."""
    named = os.environ.get(_DEVICE_VARIABLE)
    try:
        return count_text(named) if named else None
    except argparse.ArgumentTypeError as bad:
        raise UsageError(f"{_DEVICE_VARIABLE}: {bad}") from bad


class _Parser(argparse.ArgumentParser):
    """Raises UsageError where argparse would exit, so that --json prints a document then too.

    Options that are not given have no value: the functions have the defaults.
    """

    def __init__(self, **words: Any):
        super().__init__(**words, epilog=EXIT_CODES, argument_default=argparse.SUPPRESS)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """As argparse has it for a command; an option that is not one of its own is likely misspelt."""
        found, left = super().parse_known_args(args, namespace)
        for word in (each.partition("=")[0] for each in left if each.startswith("--")):
            shown = (each.option_strings for each in self._actions if each.help != argparse.SUPPRESS)
            flags = [flag for strings in shown for flag in strings if flag.startswith("--")]
            self.error(f"there is no option {word}; {in_place_of(word, flags)}")
        return found, left

    def print_help(self, _file: Any = None) -> NoReturn:
        raise SystemExit(print_result(self.format_help().rstrip("\n"), DONE))

    def error(self, message: str) -> NoReturn:
        for line in self.format_usage().splitlines():
            print_error(line)
        raise UsageError(message)


class _Version(argparse.Action):
    """Like argparse's own, but loads the library, which knows the version, only when asked."""

    def __call__(self, *_arguments: object) -> NoReturn:
        import skinslide

        raise SystemExit(print_result(f"skinslide {skinslide.__version__}", DONE))


def _parser(given: str) -> argparse.ArgumentParser:
    """Of a command alone, for the others' options take as long as some frames; of all where none is given."""
    parser = _Parser(
        prog="skinslide",
        description="Lets the skin of a cached character slide over its deformed shape instead of sticking to it. "
        "To begin: skinslide setup STAGE -o X.skinslide --whole, then skinslide bake X.skinslide -o OUT.",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (summary, add) in _COMMANDS.items():
        if name == given or given not in _COMMANDS:
            description = summary[0].upper() + summary[1:] + "."
            add(commands.add_parser(name, help=summary, description=description))
    return parser


def _add_stage(command: argparse.ArgumentParser) -> None:
    stage_help = "the stage: .usd, .usda, .usdc, .usdz or .skinslide; never written"
    command.add_argument("stage", metavar="STAGE", help=stage_help)


def _add_options(command: argparse._ActionsContainer, table: type[Options], *names: str) -> None:
    """Adds options of a table: those named, or all."""
    for each in fields(table):
        if (names and each.name not in names) or not each.metadata["flag"]:
            continue
        _add_option(command, each, each.name, *each.metadata["flags"])
        if each.name == "lookup":
            _add_device(command)


def _add_option(command: argparse._ActionsContainer, each: Field[Any], keyword: str, flag: str, *old: str) -> None:
    words, default = dict(each.metadata["words"]), each.default
    if keyword == "jobs":
        default = words["default"] = _processors()
    command.add_argument(flag, dest=keyword, **{**words, "help": described(each, default)})
    for other in old:
        command.add_argument(other, dest=keyword, **{**words, "help": argparse.SUPPRESS})


def _add_device(command: argparse._ActionsContainer) -> None:
    command.add_argument(
        "--egl-device",
        type=count_text,
        metavar="N",
        help=f"number of the EGL device to use (default: {_DEVICE_VARIABLE} in the environment, else the first that "
        "works, hardware before software)",
    )
    command.add_argument(
        "--egl-resolution",
        type=positive_text,
        metavar="N",
        help="texels along a side of the texture of faces (default: 256 to 4096, by the patch)",
    )


def _add_printing(command: argparse.ArgumentParser) -> None:
    command.add_argument("--quiet", action="store_true", help="print nothing but errors and warnings")
    _add_json(command)


def _add_table(command: argparse.ArgumentParser) -> None:
    """Adds nothing but what the table means that is printed in the end."""
    command.add_argument_group("the table, with a row for each patch", _TABLE)


def _add_json(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--json",
        action="store_true",
        help="print the report as one JSON document on stdout; numbers that are not finite are null",
    )


def _add_output(
    command: argparse.ArgumentParser, metavar: str, help_: str, *, dest: str = "output", required: bool = True
) -> None:
    command.add_argument("-o", "--output", dest=dest, required=required, metavar=metavar, help=help_)


def _add_page(command: argparse._ActionsContainer) -> None:
    command.add_argument(
        "--html",
        metavar="FILE",
        help="HTML page to write, in one file that loads no other: all pictures, to scrub through, curves of stretch, "
        "slides, folds and time, and the settings used",
    )


def _add_bake(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_output(
        command,
        "OUT",
        "layer of overs to write, to sublayer above the cache: .usda, .usdc or .usd. It is replaced in one step at "
        "the end, so that a bake that fails or is killed leaves it as it was; SIGKILL leaves partial files beside it, "
        "which the next bake of OUT removes once they are a day old",
    )
    _add_options(command, SlideOptions)
    _add_options(command, LayerOptions)
    _add_options(command, ChunkOptions)
    _add_printing(command)
    pictures = command.add_argument_group("pictures of the same frames, as preview draws them")
    pictures.add_argument("--pictures", metavar="DIR", help="folder for them, as preview -o")
    _add_page(pictures)
    _add_options(pictures, PictureOptions)
    maps = command.add_argument_group("maps of the same frames, as maps draws them, with --patch and --st")
    maps.add_argument("--maps", metavar="DIR", help="folder for them, as maps -o")
    size = MapOptions.__dataclass_fields__["size"]
    _add_option(maps, size, "map_size", size.metadata["flag"])  # whose old flag is that of the size of pictures
    _add_options(maps, MapOptions, "strain")
    _add_table(command)


def _add_check(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_options(command, SlideOptions, "prims", "lookup", "jobs")
    _add_options(command, LayerOptions, "share")
    _add_json(command)


def _add_preview(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_output(
        command,
        "DIR",
        "folder for MESH.PATCH.VIEW.FRAME.png (MESH.PATCH.PIECE.VIEW.FRAME.png if a patch falls into pieces) "
        "and contact_sheet.png (with --frames contact_sheet.FIRST-LAST.png), made if it is missing; each file is "
        "replaced in one step. Give this, --html, or both",
        dest="folder",
        required=False,
    )
    _add_page(command)
    _add_options(command, SlideOptions)
    _add_options(command, PictureOptions)
    _add_printing(command)
    _add_table(command)


def _add_maps(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_output(
        command,
        "DIR",
        "folder for the maps, made if it is missing: MESH.KIND.FRAME.exr, or MESH.KIND.TILE.FRAME.exr if faces reach "
        "beyond the first tile of a UDIM. KIND is stretchBefore and stretchAfter (the RMS of log(length / rest length) "
        "over the edges at a point), slide (distance, in the mesh's units) and forceDensity (as painted). Each has one "
        "channel, Y. A map is replaced in one step: a run that fails or is killed leaves no half of one",
        dest="folder",
    )
    _add_options(command, SlideOptions)
    _add_options(command, MapOptions)
    _add_printing(command)
    _add_table(command)


def _add_layer(command: argparse.ArgumentParser) -> None:
    """Adds what all commands that write a set-up have."""
    _add_stage(command)
    _add_output(
        command,
        "X.skinslide",
        "layer to write: .skinslide, .usda, .usdc or .usd. It sublayers STAGE by a relative path. If it exists and "
        "sublayers STAGE already, it keeps everything else that is in it, except comments; any other existing file is "
        "an error",
    )
    command.add_argument("--force", action="store_true", help="replace whatever exists at the output")


def _add_setup(command: argparse.ArgumentParser) -> None:
    from skinslide.author.options import FACES, SetupOptions

    _add_layer(command)
    command.add_argument(
        "--payload",
        metavar="FILE",
        help="also write FILE, .usda, .usdc or .usd, which payloads the .skinslide and, weaker, STAGE: without "
        "skinslide, where the first cannot be opened, the character shows as its cache has it",
    )
    _add_choice(command, SetupOptions, FACES)


def _add_paint(command: argparse.ArgumentParser) -> None:
    from skinslide.author.options import EDGES, PaintOptions

    _add_layer(command)
    _add_choice(command, PaintOptions, EDGES)


def _add_choice(command: argparse.ArgumentParser, table: type[Options], choices: Sequence[str]) -> None:
    """Adds options of a table, of which one of some choices must be given."""
    place = ("prim", "patch")
    _add_options(command, table, *place)
    _add_options(command.add_mutually_exclusive_group(required=True), table, *choices)
    _add_options(command, table, *(each.name for each in fields(table) if each.name not in (*place, *choices)))


def _add_mirror(command: argparse.ArgumentParser) -> None:
    from skinslide.author.options import MirrorOptions

    _add_layer(command)
    _add_options(command, MirrorOptions)


def _add_cache(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_output(
        command,
        "OUT",
        "layer of overs to write, .usda, .usdc or .usd, to sublayer above the character, whose meshes UsdSkel then no "
        "longer skins; replaced in one step at the end. Live layers slide it",
    )
    _add_options(command, SlideOptions, "prims", "frames")
    _add_printing(command)


def _add_stitch(command: argparse.ArgumentParser) -> None:
    command.add_argument("chunks", nargs="+", metavar="CHUNK", help="layers that bake wrote, each of other frames")
    _add_output(
        command,
        "OUT",
        "layer of overs to write, the same as one bake of all the frames; replaced in one step at the end",
    )
    command.add_argument(
        "--frames",
        metavar="SPEC",
        help="the frames that the chunks must have, no more and no fewer, such as 1001:1024 (default: those that "
        "--chunk split, else all of the shot between the first and the last)",
    )
    command.add_argument(
        "--clips",
        action="store_true",
        help="instead of copying samples, write value clips of the chunks, which must stay where they are, and "
        "OUT.manifest.DIGEST.usda",
    )
    _add_printing(command)


def _add_farm(command: argparse.ArgumentParser) -> None:
    _add_stage(command)
    _add_output(
        command,
        "OUT",
        "the layer that the job is to make, .usda, .usdc or .usd; the job is written beside it, as OUT.openjd.json or "
        "OUT.slurm.sh. Or the job itself, .json, .yaml or .sh; its layer then has the same name",
    )
    _add_options(command, FarmOptions)
    _add_options(command, SlideOptions, "prims", "frames")
    _add_options(command, LayerOptions, *(each.name for each in fields(LayerOptions) if each.name != "share"))
    command.add_argument("--pictures", metavar="DIR", help="folder for pictures, which one task draws at the end")
    _add_page(command)
    _add_printing(command)


def _add_report(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "folder",
        metavar="DIR",
        help="folder with what bake --json or preview --json printed for each shot, in files that end in .json, in it "
        "or below. A page beside such a file, of the same name or called report.html, is linked to",
    )
    _add_output(command, "FILE", "the page, .html (default: DIR/shots.html)", required=False)
    _add_printing(command)


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


# What each does, and what adds its arguments.
_COMMANDS: dict[str, tuple[str, Callable[[argparse.ArgumentParser], None]]] = {
    "setup": ("write a layer that makes a patch of some faces of a mesh", _add_setup),
    "paint": ("write a layer that gives edges of a patch a force density", _add_paint),
    "mirror": ("write a layer that copies a patch to a mesh's other side", _add_mirror),
    "check": ("say what would be slid, and list every problem", _add_check),
    "preview": ("draw pictures of every patch, before and after sliding", _add_preview),
    "bake": ("slide every frame and write a layer of corrected points", _add_bake),
    "maps": ("draw stretch, slide and force density in texture coordinates", _add_maps),
    "cache": ("write the points that UsdSkel skins to a layer, as samples", _add_cache),
    "stitch": ("join chunks of frames, baked separately, in one layer", _add_stitch),
    "farm": ("write a job that bakes chunks of frames on a farm and stitches them", _add_farm),
    "report": ("write one page of many shots, from what --json printed for each", _add_report),
}
