"""The command `skinslide`: arguments in, exit code out. 0 done, 1 failed, 2 usage, 3 the stage has problems."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Callable, Sequence
from importlib import import_module

from skinslide.command.arguments import lookup_of, parse
from skinslide.command.outcome import DONE, PROBLEMS, as_json, expected, failed, prepare_streams, say
from skinslide.problems import UsageError
from skinslide.shot.options import VIEWS

Result = tuple[str, int]  # what to print on stdout, and the exit code


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; every expected fault is a message on stderr and an exit code."""
    prepare_streams()
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        arguments = parse(words)
    except UsageError as bad:
        return failed(bad, json="--json" in words)
    except SystemExit as done:  # after --help and --version
        return done.code if isinstance(done.code, int) else DONE
    before = _state(arguments)
    try:
        import_module(f"skinslide.{_MODULES[arguments.command]}")  # uninterrupted, as USD must be while it loads
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})  # blocked by start.py
        return say(*_RUN[arguments.command](arguments))
    except expected() as error:
        return failed(error, getattr(arguments, "json", False), _outcome(arguments, before))


def _file(arguments: argparse.Namespace) -> str | None:
    """The one file that a command writes, beside those in its folder; None where it writes none."""
    return getattr(arguments, "output", None) or getattr(arguments, "html", None)


def _state(arguments: argparse.Namespace) -> tuple | None:
    """Tells whether there is another file at the output than before."""
    file = _file(arguments)
    try:
        found = os.stat(file) if file else None
    except (OSError, ValueError):  # there is nothing yet
        found = None
    if found is None:
        return None
    return found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size


def _outcome(arguments: argparse.Namespace, before: tuple | None) -> str:
    """What became of the files, for where that is in question."""
    file = _file(arguments)
    if file and _state(arguments) != before:
        return f" after {file} was written"
    if getattr(arguments, "folder", None):
        return f"; every file in {arguments.folder} is whole"
    return "; nothing was written" if file else ""


def _bake(arguments: argparse.Namespace) -> Result:
    from skinslide.command.progress import reporter
    from skinslide.shot.bake import bake_to_file

    with reporter(quiet=arguments.quiet) as progress:
        report = bake_to_file(
            arguments.stage,
            arguments.output,
            prims=arguments.prim,
            frames=arguments.frames,
            lookup=lookup_of(arguments),
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
    from skinslide.shot.check import check

    report = check(arguments.stage, arguments.prim, lookup=lookup_of(arguments))
    return as_json(report.as_dict()) if arguments.json else report.text(), PROBLEMS if report.failed else DONE


def _preview(arguments: argparse.Namespace) -> Result:
    from skinslide.command.progress import reporter
    from skinslide.picture.preview import preview

    with reporter(quiet=arguments.quiet) as progress:
        report = preview(
            arguments.stage,
            arguments.folder,
            html=arguments.html,
            prims=arguments.prim,
            patches=arguments.patch,
            frames=arguments.frames,
            views=arguments.view or VIEWS,
            camera=arguments.camera,
            follow=arguments.follow,
            size=arguments.size,
            form=arguments.format,
            st=arguments.st,
            squares=arguments.squares,
            most_stretch=arguments.most_stretch,
            lookup=lookup_of(arguments),
            jobs=arguments.jobs,
            progress=progress,
        )
    if arguments.json:
        return as_json({"stage": arguments.stage, **report.as_dict()}), DONE
    written = "\n".join(f"{place}: written" for place in (arguments.folder, arguments.html) if place)
    return "" if arguments.quiet else f"{report.text()}\n{written}", DONE


def _maps(arguments: argparse.Namespace) -> Result:
    from skinslide.command.progress import reporter
    from skinslide.picture.maps import maps

    with reporter(quiet=arguments.quiet) as progress:
        report = maps(
            arguments.stage,
            arguments.folder,
            prims=arguments.prim,
            patches=arguments.patch,
            frames=arguments.frames,
            size=arguments.size,
            st=arguments.st,
            lookup=lookup_of(arguments),
            jobs=arguments.jobs,
            progress=progress,
        )
    if arguments.json:
        return as_json({"stage": arguments.stage, "folder": arguments.folder, **report.as_dict()}), DONE
    return "" if arguments.quiet else report.text(), DONE


def _setup(arguments: argparse.Namespace) -> Result:
    from skinslide.author.setup import setup

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


def _paint(arguments: argparse.Namespace) -> Result:
    from skinslide.author.paint import paint

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
    from skinslide.author.mirror import mirror

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


def _stitch(arguments: argparse.Namespace) -> Result:
    from skinslide.write.stitch import stitch

    return _written(stitch(arguments.chunks, arguments.output).text(), arguments), DONE


def _written(report: str, arguments: argparse.Namespace) -> str:
    return f"{report}\n{arguments.output}: written; sublayer it above the cache"


# Where the functions are that the commands call.
_MODULES = {
    "bake": "shot.bake",
    "check": "shot.check",
    "preview": "picture.preview",
    "maps": "picture.maps",
    "setup": "author.setup",
    "paint": "author.paint",
    "mirror": "author.mirror",
    "stitch": "write.stitch",
}
_RUN: dict[str, Callable[[argparse.Namespace], Result]] = {
    "bake": _bake,
    "check": _check,
    "preview": _preview,
    "maps": _maps,
    "setup": _setup,
    "paint": _paint,
    "mirror": _mirror,
    "stitch": _stitch,
}
