"""The files that a stage reads, none of which may be an output."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pxr import Tf, Usd

from skinslide.problems import UsageError
from skinslide.stage.given import StrPath
from skinslide.stage.seldom import usd_utils

if TYPE_CHECKING:
    from pxr import UsdUtils


def check_not_input(output: Path, stage: Usd.Stage, *others: StrPath) -> None:
    """Raises UsageError where the output is a file that the stage may read, in whatever variant and clip."""
    if output.exists():
        Inputs(stage, *others).refuse(output)


def check_not_read(output: Path, stage: Usd.Stage) -> None:
    """Raises UsageError where the output is a file that the stage has read so far."""
    _refuse(output, _read_so_far(stage))


class Inputs:
    """The files that a stage may read, in whatever variant and clip."""

    def __init__(self, stage: Usd.Stage, *others: StrPath):
        self._stage = stage
        self._known = _identities([*(os.fspath(other) for other in others), *_dependencies(stage)])

    def refuse(self, output: Path) -> None:
        """Raises UsageError where the output is one of them, or one that the stage has read so far."""
        _refuse(output, self._known | _read_so_far(self._stage))


def _read_so_far(stage: Usd.Stage) -> set[tuple[int, int]]:
    return _identities([layer.realPath for layer in stage.GetUsedLayers()])


def _refuse(output: Path, files: set[tuple[int, int]]) -> None:
    if files & _identities([str(output)]):
        raise UsageError(f"output {output}: the stage reads this file; name another, or open the stage without it")


def _identities(files: Sequence[str]) -> set[tuple[int, int]]:
    """Of those that are there: whatever they are called, and through links. What cannot be looked at cannot be read."""
    found = set()
    for file in files:
        with suppress(OSError, ValueError):
            status = os.stat(file)
            found.add((status.st_dev, status.st_ino))
    return found


def _dependencies(stage: Usd.Stage) -> list[str]:
    """Every file that the layers of a stage name, and those that these name in turn."""
    found, utils = list[str](), usd_utils()

    def collect(layer: Any, named: UsdUtils.DependencyInfo) -> UsdUtils.DependencyInfo:
        clips = "#" in named.assetPath and named.dependencies
        files = _clips(named) if clips else [named.assetPath, *named.dependencies]
        found.extend(layer.ComputeAbsolutePath(file) for file in files if file)
        return utils.DependencyInfo() if clips else named  # USD would look for a file of the template's name

    unsaid = utils.CoalescingDiagnosticDelegate()  # while it lives, USD's warnings of missing textures
    with suppress(Tf.ErrorException):  # what does not open is a problem of the stage, reported where it matters
        utils.ComputeAllDependencies(stage.GetRootLayer().identifier, collect)
    unsaid.TakeUncoalescedDiagnostics()
    return found


def _clips(template: UsdUtils.DependencyInfo) -> list[str]:
    """The files that a template of value clips stands for; USD gives those with anything in place of the number."""
    wanted = re.compile("-?[0-9]+".join(map(re.escape, re.split("#+", template.assetPath))))
    return [file for file in template.dependencies if wanted.fullmatch(file)]
