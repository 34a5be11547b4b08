"""Opens a stage with its payloads; a `.skinslide` file as its text, so that its points are those of the cache."""

from __future__ import annotations

import errno
import math
import os
import posixpath
from pathlib import Path

from pxr import Ar, Sdf, Tf, Usd

from skinslide.arrays.schema import phrase
from skinslide.arrays.values import check_text
from skinslide.problems import PATH_TOO_LONG, Fault, StageError, usd_message
from skinslide.registration import registered
from skinslide.stage.seldom import usd_utils
from skinslide.stage.sources import EXTENSION, TEXT_ONLY, check_regular, not_opened, open_sources


def open_stage(path: str | Path) -> Usd.Stage:
    """Opens a stage with its payloads. A `.skinslide` file opens as its text, with the points of the cache."""
    path = str(path)
    try:
        check_regular(path)
        with Ar.ResolverContextBinder(Ar.GetResolver().CreateDefaultContextForAsset(path)):
            text = _text_of(Path(path)) if path.endswith(EXTENSION) else None
            root = text or Sdf.Layer.FindOrOpen(path)
            held = open_sources(root, path) if root else []  # until the stage has them
        stage = Usd.Stage.Open(_text_in_stage(text, path) if text else path)
        del held
        check_clocks(stage)
        return stage
    except (Tf.ErrorException, OSError, ValueError) as error:
        raise not_opened(path, why_not_opened(path, error)) from error


def _text_of(path: Path) -> Sdf.Layer:
    """The text of a `.skinslide` file as an anonymous layer that names the same files."""
    text = read_text_layer(path)
    anchor_assets(text, path)
    return text


def _text_in_stage(text: Sdf.Layer, path: str) -> Sdf.Layer:
    """The text as the layer of its file; where USD has no format for it, as it is."""
    return Sdf.Layer.FindOrOpen(path, TEXT_ONLY) if registered() else text


def check_clocks(stage: Usd.Stage) -> None:
    """Raises StageError for a layer whose time USD cannot scale to another's: it would look for samples for ever."""
    layers = [layer for layer in stage.GetUsedLayers() if layer != stage.GetSessionLayer()]  # which has the root's
    rates = {layer.timeCodesPerSecond for layer in layers}  # each nan is one of its own
    for layer in layers:
        rate = layer.timeCodesPerSecond
        if len(rates) > 1 and (rate == 0 or not math.isfinite(rate)):
            raise StageError(
                f"cannot read {layer.identifier}: timeCodesPerSecond is {rate:g}, and another layer's is not"
            )


def is_live(layer: Sdf.Layer) -> bool:
    """Whether a layer is a `.skinslide` file whose points are computed."""
    return layer.GetFileFormat().formatId == "skinslide" and layer.GetFileFormatArguments().get("live") != "0"


def why_not_opened(path: str, error: Exception) -> str:
    """The cause of an exception that opening a file raised."""
    if not path:
        return "the name is empty"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    if isinstance(error, Tf.ErrorException):
        if os.path.isdir(path):
            return "it is a folder"
        try:
            os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
        except OSError as fault:
            if fault.errno in (errno.EACCES, errno.ELOOP):  # of others, a resolver may know it under this name
                return fault.strerror or str(fault)
        if not Ar.GetResolver().Resolve(path):
            return PATH_TOO_LONG if os.path.exists(path) else phrase("no_file")
        return usd_message(error)
    return "it is not text"


def read_text_layer(path: Path) -> Sdf.Layer:
    """The USDA text of a file in an anonymous layer, as it stands."""
    text = path.read_text(encoding="utf-8")
    try:
        check_text(text)
    except Fault as fault:
        raise not_opened(path, f"it {fault}") from fault
    layer = Sdf.Layer.CreateAnonymous(f"{path.name}.usda")
    layer.ImportFromString(text)
    return layer


def anchor_assets(layer: Sdf.Layer, path: Path) -> None:
    """Makes the relative asset paths of a layer mean what they mean in the file at `path`."""
    resolver, anchor = Ar.GetResolver(), Ar.ResolvedPath(str(path.absolute()))

    def anchored(asset: str) -> str:
        # An expression is evaluated first and anchored by USD, or names a full path.
        return asset if not asset or asset.startswith("`") else resolver.CreateIdentifier(asset, anchor)

    usd_utils().ModifyAssetPaths(layer, anchored)
    layer.Traverse(Sdf.Path.absoluteRootPath, lambda at: _anchor_clip_template(layer, at, path.absolute().parent))


def _anchor_clip_template(layer: Sdf.Layer, at: Sdf.Path, folder: Path) -> None:
    """The template of value clips is a plain string, which UsdUtils passes over."""
    spec = layer.GetPrimAtPath(at) if at.IsPrimPath() else None
    if spec is None or not spec.HasInfo("clips"):
        return
    clips = dict(spec.GetInfo("clips"))
    for name, clip_set in clips.items():
        template = clip_set.get("templateAssetPath", "")
        if template.startswith("."):
            clips[name] = {**clip_set, "templateAssetPath": posixpath.normpath(folder.as_posix() + "/" + template)}
    spec.SetInfo("clips", clips)
