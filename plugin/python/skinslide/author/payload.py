"""A layer that payloads a character: its set-up, live, and weaker than that its cache, which shows without skinslide.

USD skips those of a list of payloads that it cannot open, with a warning.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from pxr import Sdf, Tf, Usd

from skinslide.author.layer import EXTENSIONS, describe, in_the_way
from skinslide.problems import UsageError
from skinslide.stage.given import StageLike, StrPath, given_file, given_stage
from skinslide.stage.sources import EXTENSION
from skinslide.write.inputs import check_not_input
from skinslide.write.place import asset_path, check_output, given_output
from skinslide.write.replacing import replacing, saved, writing


class PayloadLayer:
    """The layer to write once the set-up is written. Raises UsageError for what cannot be used."""

    def __init__(self, stage: StageLike, setup: StrPath, output: StrPath, force: bool):
        self._output, live = given_output("payload", output), given_output("output", setup)
        below, opened = given_file(stage), given_stage(stage)
        if live.suffix != EXTENSION:
            raise UsageError(f"output {live}: its name must end in {EXTENSION} for its payload to be live")
        check_output(self._output, [each for each in EXTENSIONS if each != EXTENSION])
        check_not_input(self._output, opened, below)
        self._text = _layer(opened, live, below, self._output).ExportToString()
        if self._output.exists() and not force and not self._is_there():
            raise in_the_way(self._output, "says something else")

    def _is_there(self) -> bool:
        with suppress(Tf.ErrorException):  # no layer
            return bool(Sdf.Layer.OpenAsAnonymous(str(self._output)).ExportToString() == self._text)
        return False

    def write(self) -> None:
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.ImportFromString(self._text)
        with replacing(self._output) as partial, writing(self._output):
            saved(layer.Export(str(partial)))


def _layer(stage: Usd.Stage, live: Path, below: Path, output: Path) -> Sdf.Layer:
    prim = stage.GetDefaultPrim()
    if not prim:
        raise UsageError(f"{below} names no default prim, which a payload needs")
    layer = Sdf.Layer.CreateAnonymous(".usda")
    describe(layer, stage)
    spec = Sdf.PrimSpec(layer, prim.GetName(), Sdf.SpecifierDef)
    for file in (live, below):
        spec.payloadList.prependedItems.append(Sdf.Payload(asset_path(file, output)))
    return layer
