"""The files that the textures of a patch are made of: found by the stage's asset resolver, and read."""

from __future__ import annotations

import os
from collections.abc import Iterator

from pxr import Ar, Sdf, Tf, Usd, UsdShade

from skinslide.arrays.meaning import ControlsMeaning, File, inputs, is_texture
from skinslide.stage.values import FIRST, Source, layer_of

_MAGIC = b"\x76\x2f\x31\x01"  # of OpenEXR
_START = 8  # bytes that tell OpenEXR whether a file is one: the magic number and the version


def give_files(controls: ControlsMeaning) -> None:
    """Gives every file that is asked for. Raises Fault."""
    while need := controls.need():
        controls.give(_file(controls, Ar.GetResolver().Resolve(need.path).GetPathString(), need.largest))


def texture_files(prim: Usd.Prim, patch: str) -> Iterator[str]:
    """The resolved files of every texture of a patch, at whatever time; those that are not there are passed over."""
    for attribute in (Source(prim, wanted, patch).attribute for wanted in filter(is_texture, inputs("controls"))):
        for time in [FIRST, *map(Usd.TimeCode, attribute.GetTimeSamples())] if attribute else []:
            asset = attribute.Get(time)
            if isinstance(asset, Sdf.AssetPath) and asset.path:
                yield from _all_files(attribute, time, asset)


def _all_files(attribute: Usd.Attribute, time: Usd.TimeCode, asset: Sdf.AssetPath) -> Iterator[str]:
    if UsdShade.UdimUtils.IsUdimIdentifier(asset.path):
        for path, _ in UsdShade.UdimUtils.ResolveUdimTilePaths(asset.path, layer_of(attribute, time)):
            yield str(path)
    elif asset.resolvedPath:
        yield asset.resolvedPath


def _file(controls: ControlsMeaning, path: str, largest: int) -> File:
    """A resolved file, which may lie in a package."""
    if not path or controls.holds(path):
        return File(path or None)
    if os.path.exists(path) and not os.path.isfile(path):
        return File(path)  # opening a pipe would wait for ever
    try:
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
        size = asset.GetSize() if asset else 0
        if not asset or size > largest:
            return File(path, size=size)
        with asset as opened:
            start = opened.Read(min(_START, size), 0) if size else b""
            # What is no image may be large, and is told by its start alone.
            content = opened.GetBuffer() or b"" if start.startswith(_MAGIC) else start
            return File(path, content, len(content))
    except (OSError, RuntimeError, Tf.ErrorException) as error:
        return File(path, reason=" ".join(str(error).split()))
