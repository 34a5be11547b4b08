"""The command `skinslide`: arguments in, exit code out. 0 done, 1 failed, 2 usage, 3 the stage has problems."""

from __future__ import annotations

import gc
import glob
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from skinslide.command.arguments import device_of_environment, parse
from skinslide.command.loading import loaded
from skinslide.command.outcome import (
    DONE,
    PROBLEMS,
    as_json,
    expected,
    failed,
    prepare_streams,
    print_error,
    print_result,
)
from skinslide.problems import UsageError, listed, one_line
from skinslide.shot.options import PictureOptions

if TYPE_CHECKING:
    from skinslide.shot.products import Product

Text = str | Iterator[str]  # or its pieces
Result = tuple[Text, int]  # what to print on stdout, and the exit code


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; every expected fault is a message on stderr and an exit code."""
    prepare_streams()
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        given = parse(words)
    except UsageError as bad:
        return failed(bad, json=any(map(_is_json, words)))
    except SystemExit as done:  # after --help and --version
        return done.code if isinstance(done.code, int) else DONE
    run, home, name = _COMMANDS[given.pop("command")]
    before, json = _state(given), given.get("json", False)
    try:
        function = loaded(home, name, opens_stage="stage" in given)  # uninterrupted, as USD must be while it loads
        gc.freeze()
        gc.enable()  # disabled by start.py
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # blocked by start.py
        result = run(function, **given)
        json = False  # a document that breaks off is not followed by another
        return print_result(*result)
    except expected() as error:
        return failed(error, json, _outcome(given, before), words)


def _is_json(word: str) -> bool:
    """Whether a word asks for JSON: --json, abbreviated as the parser allows, even with a value, which is an error."""
    return word.startswith("--js") and "--json".startswith(word.partition("=")[0])


# ---- What a command left behind ----

_BESIDE = (".openjd.json", ".slurm.sh", ".manifest.*.usda")  # jobs of farm, and what clips of stitch need


def _state(given: dict[str, Any]) -> dict[str, tuple[int, ...]]:
    """What changes when a file is replaced, for the files that a command writes outside its folders."""
    found: dict[str, tuple[int, ...]] = {}
    for file in _written_by(given):
        try:
            status = os.stat(file)
        except (OSError, ValueError):  # there is nothing yet
            continue
        found[file] = (status.st_dev, status.st_ino, status.st_mtime_ns, status.st_size)
    return found


def _written_by(given: dict[str, Any]) -> Iterator[str]:
    """The files that are named, and those beside the output that begin with its name."""
    yield from filter(None, (given.get("output"), given.get("html"), given.get("payload")))
    if given.get("output"):
        stem = glob.escape(os.path.splitext(given["output"])[0])
        with suppress(ValueError):  # a null character
            yield from (file for suffix in _BESIDE for file in glob.glob(stem + suffix))


def _outcome(given: dict[str, Any], before: dict[str, tuple[int, ...]]) -> str:
    """What became of the files, for when that is in doubt."""
    written = [file for file, state in _state(given).items() if before.get(file) != state]
    folders = [given[name] for name in ("folder", "pictures", "maps") if given.get(name)]
    if written:
        return f" after {listed(written)} {'were' if len(written) > 1 else 'was'} written"
    if folders:
        return f"; every file in {listed(folders)} is whole"
    return "; nothing was written" if given.get("output") or given.get("html") else ""


# ---- The commands: what each gives its function ----


def _bake(
    bake_to_file: Callable[..., Any],
    stage: str,
    output: str,
    *,
    pictures: str | None = None,
    html: str | None = None,
    maps: str | None = None,
    json: bool = False,
    quiet: bool = False,
    **options: Any,
) -> Result:
    also = _also(pictures, html, maps, options)
    report = _slide(bake_to_file, quiet, stage, output, also=also, **options)
    layer = _layer_there(output) if report.resumed else _layer_written(output, options.get("chunk"))
    written = [layer] if report.resumed else [*_written(pictures, html), layer]
    lines = [report.text(), *written]
    return _reported(report, {"stage": stage, "output": output}, lines, json, quiet), DONE


def _also(pictures: str | None, html: str | None, maps: str | None, options: dict[str, Any]) -> list[Product]:
    """Pictures and maps, with their options, which are removed. Raises UsageError for options that go with neither."""
    drawn = {each.name: options.pop(each.name) for each in fields(PictureOptions) if each.name in options}
    mapped = {name: drawn[name] for name in ("patches", "st") if name in drawn}
    size = {"size": options.pop("map_size")} if "map_size" in options else {}
    strain = {"strain": options.pop("strain")} if "strain" in options else {}
    products: list[Product] = []
    if pictures is not None or html is not None:
        from skinslide.picture.preview import Pictures

        products.append(Pictures(pictures, html, **drawn))
    elif drawn != mapped or (mapped and maps is None):
        raise UsageError("there are options of pictures, but no folder (--pictures) and no page (--html) for them")
    if maps is not None:
        from skinslide.picture.maps import Maps

        products.append(Maps(maps, **mapped, **size, **strain))
    elif size or strain:
        raise UsageError("there are options of maps, but no folder (--maps) for them")
    return products


def _check(check: Callable[..., Any], stage: str, *, json: bool = False, **options: Any) -> Result:
    report = _slide(check, not options.get("share"), stage, **options)
    return as_json(report.as_dict()) if json else report.text(), PROBLEMS if report.failed else DONE


def _preview(
    preview: Callable[..., Any],
    stage: str,
    *,
    folder: str | None = None,
    html: str | None = None,
    json: bool = False,
    quiet: bool = False,
    **options: Any,
) -> Result:
    report = _slide(preview, quiet, stage, folder, html=html, **options)
    return _reported(report, {"stage": stage}, [report.text(), *_written(folder, html)], json, quiet), DONE


def _maps(
    maps: Callable[..., Any], stage: str, folder: str, *, json: bool = False, quiet: bool = False, **options: Any
) -> Result:
    report = _slide(maps, quiet, stage, folder, **options)
    return _reported(report, {"stage": stage, "folder": folder}, [report.text()], json, quiet), DONE


def _cache(
    cache: Callable[..., Any], stage: str, output: str, *, json: bool = False, quiet: bool = False, **options: Any
) -> Result:
    report = _with_progress(cache, quiet, stage, output, **options)
    lines = [report.text(), _layer_written(output)]
    return _reported(report, {"stage": stage, "output": output}, lines, json, quiet), DONE


def _author(function: Callable[..., Any], stage: str, output: str, **options: Any) -> Result:
    report = function(stage, output, **options)
    lines = [report.text(lookup=False), *_written(output, options.get("payload"))]
    return "\n".join(lines), DONE


def _stitch(
    stitch: Callable[..., Any],
    chunks: list[str],
    output: str,
    *,
    json: bool = False,
    quiet: bool = False,
    **options: Any,
) -> Result:
    report = stitch(chunks, output, **options)
    lines = [report.text(), *_written(report.manifest), _layer_written(output)]
    return _reported(report, {"chunks": chunks, "output": output}, lines, json, quiet), DONE


def _farm(
    farm: Callable[..., Any], stage: str, output: str, *, json: bool = False, quiet: bool = False, **options: Any
) -> Result:
    report = farm(stage, output, **options)
    lines = [report.text(), *_written(report.job)]
    return _reported(report, {"stage": stage}, lines, json, quiet), DONE


def _report(
    report: Callable[..., Any], folder: str, *, output: str | None = None, json: bool = False, quiet: bool = False
) -> Result:
    made = report(folder, output)
    return _reported(made, {}, [made.text(), *_written(made.page)], json, quiet), DONE


def _reported(report: Any, named: dict[str, Any], lines: Sequence[str], json: bool, quiet: bool) -> Text:
    """What to print of a report: one document, lines, or only its warnings, which then go to stderr."""
    if json:
        return as_json({**named, **getattr(report, "document", report.as_dict)()})
    for problem in report.problems if quiet else ():
        if problem.severity == "warning":
            print_error(str(problem))
    return "" if quiet else "\n".join(filter(None, lines))


def _slide(function: Callable[..., Any], quiet: bool, *arguments: Any, **options: Any) -> Any:
    """Calls a function that slides, and shows its progress."""
    return _with_progress(function, quiet, *arguments, **_with_lookup(options))


def _with_progress(function: Callable[..., Any], quiet: bool, *arguments: Any, **options: Any) -> Any:
    """Calls a function that works on frames, and shows its progress."""
    from skinslide.command.progress import reporter

    with reporter(quiet=quiet) as progress:
        return function(*arguments, progress=progress, **options)


def _with_lookup(options: dict[str, Any]) -> dict[str, Any]:
    """Options with one Lookup in place of its parts; the environment may name the device."""
    from skinslide.arrays.lookup import Lookup

    method, resolution = options.pop("lookup", "auto"), options.pop("egl_resolution", 0)
    device = options.pop("egl_device", None)
    return {**options, "lookup": Lookup(method, device_of_environment() if device is None else device, resolution)}


def _written(*places: str | None) -> list[str]:
    return [one_line(f"{place}: written") for place in places if place]


def _layer_there(output: str) -> str:
    return one_line(f"{output}: is whole already, and was not baked again")


def _layer_written(output: str, chunk: str | None = None) -> str:
    if chunk:
        return one_line(f"{output}: written, part {chunk}; skinslide stitch joins it with the others")
    return one_line(f"{output}: written; sublayer it above the character")


# Each with the function that it calls: the module and the name.
_COMMANDS: dict[str, tuple[Callable[..., Result], str, str]] = {
    "bake": (_bake, "shot.bake", "bake_to_file"),
    "cache": (_cache, "shot.cache", "cache"),
    "check": (_check, "shot.check", "check"),
    "preview": (_preview, "picture.preview", "preview"),
    "maps": (_maps, "picture.maps", "maps"),
    "setup": (_author, "author.setup", "setup_to_file"),
    "paint": (_author, "author.paint", "paint_to_file"),
    "mirror": (_author, "author.mirror", "mirror_to_file"),
    "stitch": (_stitch, "shot.stitch", "stitch"),
    "farm": (_farm, "queues.farm", "farm"),
    "report": (_report, "picture.shots", "report"),
}
