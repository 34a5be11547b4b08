"""The files that the textures of a patch are made of: found by the stage's asset resolver, and read."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack

from pxr import Ar, Sdf, Tf, Usd

from skinslide.arrays.apart import apart
from skinslide.arrays.fetched import File
from skinslide.arrays.meaning import ControlsMeaning
from skinslide.arrays.schema import inputs, is_texture
from skinslide.stage.seldom import usd_shade
from skinslide.stage.values import FIRST, Source, layer_of


def give_files(controls: ControlsMeaning) -> None:
    """Gives every file that is asked for. Raises Fault."""
    while need := controls.need():
        resolved = Ar.GetResolver().Resolve(need.path).GetPathString()
        with ExitStack() as closing:
            file = _file(controls, resolved, need.largest, closing)
            apart(_give, controls, file, closing.pop_all())


def _give(controls: ControlsMeaning, file: File, closing: ExitStack) -> None:
    """What is open stays so for as long as it is read, though a signal left nobody to wait for that."""
    with closing:
        controls.give(file)


def texture_files(prim: Usd.Prim, patch: str) -> Iterator[str]:
    """The resolved files of every texture of a patch, at whatever time; those that are not there are passed over."""
    for attribute in (Source(prim, wanted, patch).attribute for wanted in filter(is_texture, inputs("controls"))):
        for time in [FIRST, *map(Usd.TimeCode, attribute.GetTimeSamples())] if attribute else []:
            asset = attribute.Get(time)
            if isinstance(asset, Sdf.AssetPath) and asset.path:
                yield from _all_files(attribute, time, asset)


def _all_files(attribute: Usd.Attribute, time: Usd.TimeCode, asset: Sdf.AssetPath) -> Iterator[str]:
    udims = usd_shade().UdimUtils
    if udims.IsUdimIdentifier(asset.path):
        for path, _ in udims.ResolveUdimTilePaths(asset.path, layer_of(attribute, time)):
            yield str(path)
    elif asset.resolvedPath:
        yield asset.resolvedPath


def _file(controls: ControlsMeaning, path: str, largest: int, closing: ExitStack) -> File:
    """A resolved file, which may lie in a package."""
    try:
        return _opened(controls, path, largest, closing)
    except (OSError, RuntimeError, Tf.ErrorException) as error:
        return File(path, reason=" ".join(str(error).split()))


def _opened(controls: ControlsMeaning, path: str, largest: int, closing: ExitStack) -> File:
    if not path or controls.holds(path):
        return File(path or None)
    if os.path.isfile(path):
        descriptor = os.open(path, os.O_RDONLY)
        closing.callback(os.close, descriptor)
        return File(path, size=os.fstat(descriptor).st_size, descriptor=descriptor)
    if os.path.exists(path):
        return File(path)  # opening a pipe would wait for ever
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    size = asset.GetSize() if asset else 0
    if not asset or size > largest:
        return File(path, size=size)
    with asset as opened:
        return File(path, opened.GetBuffer() or b"", size)
