"""The layer a bake writes: `over`s with nothing but what was slid, put in place in one step or not at all."""

import os
import secrets
import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, Usd, UsdGeom

from skinslide.frames import UsageError
from skinslide.problems import StageError
from skinslide.slider import version

EXTENSIONS = (".usda", ".usdc", ".usd")
_UNSAVED_BYTES = 256 << 20  # a crate file takes what is saved out of memory


class OverLayer:
    """Collects values for attributes of a stage in a layer of overs, typed as the stage has them."""

    def __init__(self, layer: Sdf.Layer):
        self.layer = layer
        self._saves_in_parts = not layer.anonymous and not layer.realPath.endswith(".usda")
        self._unsaved = 0

    def set(self, attribute: Usd.Attribute, value: Any, time: Usd.TimeCode) -> None:
        """Authors a sample, or the default value where time is the default time."""
        spec = self._spec(attribute)
        if time.IsDefault():
            spec.default = value
        else:
            self.layer.SetTimeSample(spec.path, time.GetValue(), value)
        self._unsaved += 4 * getattr(value, "size", 0)
        if self._saves_in_parts and self._unsaved > _UNSAVED_BYTES:
            self.save()

    def block(self, attribute: Usd.Attribute) -> None:
        """Makes the attribute have no value."""
        self._spec(attribute).default = Sdf.ValueBlock()

    def save(self) -> None:
        if not self.layer.Save():
            raise OSError("USD could not save it")
        self._unsaved = 0

    def _spec(self, attribute: Usd.Attribute) -> Sdf.AttributeSpec:
        spec = self.layer.GetAttributeAtPath(attribute.GetPath())
        if spec:
            return spec
        over = Sdf.CreatePrimInLayer(self.layer, attribute.GetPrimPath())
        return Sdf.AttributeSpec(over, attribute.GetName(), attribute.GetTypeName(), attribute.GetVariability())


def check_output(output: Path, stage: Usd.Stage) -> None:
    """Raises UsageError for an output that cannot be, before any work is done."""
    if output.suffix not in EXTENSIONS:
        raise UsageError(f"output {output}: the name must end in {', '.join(EXTENSIONS)}")
    if output.is_dir():
        raise UsageError(f"output {output}: is a folder")
    folder = output.resolve().parent
    if not folder.is_dir():
        raise UsageError(f"output {output}: the folder {folder} does not exist")
    if not os.access(folder, os.W_OK | os.X_OK) or (output.exists() and not os.access(output, os.W_OK)):
        raise UsageError(f"output {output}: is not writable")
    for layer in stage.GetUsedLayers():
        if layer.realPath and output.exists() and os.path.samefile(output, layer.realPath):
            raise UsageError(f"output {output}: the stage reads this layer; name another, or bake without it")


@contextmanager
def layer_in_place(output: Path, stage: Usd.Stage) -> Iterator[OverLayer]:
    """A layer that becomes `output` when the block ends. An exception or a signal leaves `output` as it was."""
    output = output.resolve()
    partial = output.with_name(f".{output.stem}.{secrets.token_hex(4)}{output.suffix}")
    with _signals_as_exceptions():
        try:
            partial.touch(exist_ok=False)
            if output.exists():
                shutil.copymode(output, partial)
            overs = OverLayer(Sdf.Layer.CreateNew(str(partial)))
            yield overs
            _describe(overs.layer, stage)
            overs.save()
            os.replace(partial, output)
        except (OSError, Tf.ErrorException) as error:
            raise StageError(f"output {output}: {_reason(error)}") from error
        finally:
            partial.unlink(missing_ok=True)


def author_on_stage(overs: OverLayer, stage: Usd.Stage) -> None:
    """Copies every value into the stage's edit target, through the target's time offset."""
    paths: list[Sdf.Path] = []
    overs.layer.Traverse(Sdf.Path.absoluteRootPath, paths.append)
    for path in filter(Sdf.Path.IsPropertyPath, paths):
        attribute = stage.GetAttributeAtPath(path)
        for time in overs.layer.ListTimeSamplesForPath(path):
            attribute.Set(overs.layer.QueryTimeSample(path, time), time)
        default = overs.layer.GetAttributeAtPath(path).default
        if isinstance(default, Sdf.ValueBlock):
            attribute.Block()
        elif default is not None:
            attribute.Set(default)


def _describe(layer: Sdf.Layer, stage: Usd.Stage) -> None:
    """Gives the layer the stage's clock and units, so that it reads the same alone and sublayered."""
    layer.comment = f"Slid by skinslide {version()}. Sublayer this above the cache."
    layer.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
    layer.framesPerSecond = stage.GetFramesPerSecond()
    if stage.HasAuthoredTimeCodeRange():
        layer.startTimeCode, layer.endTimeCode = stage.GetStartTimeCode(), stage.GetEndTimeCode()
    root = layer.pseudoRoot
    root.SetInfo(UsdGeom.Tokens.upAxis, UsdGeom.GetStageUpAxis(stage))
    root.SetInfo(UsdGeom.Tokens.metersPerUnit, UsdGeom.GetStageMetersPerUnit(stage))
    names = [prim.name for prim in layer.rootPrims]
    wanted = stage.GetDefaultPrim().GetName() if stage.HasDefaultPrim() else None
    if names:
        layer.defaultPrim = wanted if wanted in names else names[0]


@contextmanager
def _signals_as_exceptions() -> Iterator[None]:
    """Lets `finally` run when the farm ends the process: SIGTERM and SIGHUP become SystemExit."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _frame: Any) -> None:
        raise SystemExit(128 + number)

    numbers = [number for number in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(number) is signal.SIG_DFL]
    for number in numbers:
        signal.signal(number, leave)
    try:
        yield
    finally:
        for number in numbers:
            signal.signal(number, signal.SIG_DFL)


def _reason(error: Exception) -> str:
    """USD says everything again for each block it could not write."""
    return error.args[0].commentary if isinstance(error, Tf.ErrorException) else str(error)
