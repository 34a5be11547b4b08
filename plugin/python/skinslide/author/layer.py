"""A layer that sublayers a stage and holds set-ups: made or extended, and put in place in one step."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from pxr import Sdf, Tf, Usd

from skinslide.problems import StageError, UsageError
from skinslide.stage.given import StageLike, StrPath, given_file, given_stage
from skinslide.stage.opening import read_text_layer
from skinslide.stage.sources import EXTENSION
from skinslide.write.inputs import check_not_input, check_not_read
from skinslide.write.place import asset_path, check_output, given_output
from skinslide.write.replacing import Changed, State, partial_name, replacing, saved, state, writing

Report = TypeVar("Report")
EXTENSIONS = (EXTENSION, ".usda", ".usdc", ".usd")
# Fields of a root layer that say what is in that layer, not how the stage is to be read.
OWN_FIELDS = {"subLayers", "subLayerOffsets", "primChildren", "comment", "documentation", "customLayerData"}


def author_layer(stage: StageLike, output: StrPath, force: bool, author: Callable[[Usd.Stage], Report]) -> Report:
    """Lets `author` author into a layer that sublayers a stage and becomes `output`; returns its report.

    That layer begins as what is at `output`, if that sublayers the stage, else as a new one. An exception leaves the
    output as it was. If another process has changed it meanwhile, all is done again on what is there then.
    Raises TypeError, UsageError, StageError.
    """
    path, output = given_file(stage), given_output("output", output)
    if path.suffix == EXTENSION:
        raise UsageError(f"{path} is a set-up itself; give the stage that it sits on, and it as output to add to it")
    check_output(output, EXTENSIONS)
    below = given_stage(stage)
    while True:
        before = state(output)
        layer = _starting_layer(below, path, output, force)
        authored = Usd.Stage.Open(layer)
        report = author(authored)
        check_not_read(output, authored)
        with suppress(Changed):
            _write(layer, output, before, force)
            return report


def _starting_layer(stage: Usd.Stage, path: Path, output: Path, force: bool) -> Sdf.Layer:
    check_not_input(output, stage, path)
    # Named as if beside the output, so that relative paths mean what they will mean there; never saved under that name.
    place = output.absolute().with_name(partial_name(output.with_suffix(".usda")))
    layer = Sdf.Layer.New(Sdf.FileFormat.FindById("usda"), str(place))
    if output.exists() and not force:
        layer.TransferContent(_existing_layer(output))
        sublayers = [Path(output.absolute().parent, each) for each in layer.subLayerPaths]
        if not any(each.exists() and each.samefile(path) for each in sublayers):
            raise in_the_way(output, f"does not sublayer {path}")
    else:
        describe(layer, stage)
        layer.subLayerPaths.append(asset_path(path, output))
    return layer


def _existing_layer(output: Path) -> Sdf.Layer:
    try:
        return read_text_layer(output) if output.suffix == EXTENSION else Sdf.Layer.OpenAsAnonymous(str(output))
    except (Tf.ErrorException, OSError, UnicodeDecodeError, StageError) as error:
        raise in_the_way(output, "is not a layer") from error


def in_the_way(output: Path, fault: str) -> UsageError:
    return UsageError(f"output {output}: exists and {fault}; --force replaces it")


def describe(layer: Sdf.Layer, stage: Usd.Stage) -> None:
    """Gives a layer that sublayers a stage the same units, time and default prim."""
    root = stage.GetRootLayer().pseudoRoot
    for field in set(root.ListInfoKeys()) - OWN_FIELDS:
        layer.pseudoRoot.SetInfo(field, root.GetInfo(field))
    # Without these a layer counts as 24, whatever it sublayers, and its sublayers' times are scaled to that.
    layer.timeCodesPerSecond, layer.framesPerSecond = stage.GetTimeCodesPerSecond(), stage.GetFramesPerSecond()


def _write(layer: Sdf.Layer, output: Path, before: State, force: bool) -> None:
    """Puts the layer in place in one step. Raises Changed if the output is not what it was before, unless forced."""
    with replacing(output, lambda: force or state(output) == before) as partial, writing(output):
        if partial.suffix == EXTENSION:
            partial.write_text(layer.ExportToString(), encoding="utf-8")
        else:
            saved(layer.Export(str(partial)))
