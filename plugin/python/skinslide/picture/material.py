"""The base colour texture of a mesh's material, which pictures may show in place of a chequer."""

from __future__ import annotations

import io
from collections import deque
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image
from pxr import Ar, Sdf, Usd

from skinslide.arrays.images import FIRST_TILE
from skinslide.problems import Fault
from skinslide.stage.seldom import usd_shade
from skinslide.stage.values import FIRST, layer_of

if TYPE_CHECKING:
    from pxr import UsdShade

_INPUTS = ("diffuseColor", "baseColor", "base_color")  # of UsdPreviewSurface, and of what others make of it
_LARGEST = 2048  # texels along a side: a picture shows no more


def base_colour(prim: Usd.Prim) -> dict[int, np.ndarray]:
    """The tiles of the texture by their numbers, uint8 (height, width, 4). Raises Fault where there is none to show."""
    material = usd_shade().MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    if not material:
        raise Fault("has no material, whose texture could be shown")
    surface = material.ComputeSurfaceSource()[0]
    found = next((file for name in _INPUTS if surface for file in _files(surface.GetInput(name))), None)
    if found is None:
        raise Fault(f"its material {material.GetPath()} has no texture of a base colour")
    return {number: _pixels(path) for number, path in _tiles(found)}


def _files(input_: UsdShade.Input) -> Iterator[Usd.Attribute]:
    """The attributes of files that feed an input, the nearest first."""
    shade, waiting, seen = usd_shade(), deque([input_] if input_ else []), set[Sdf.Path]()
    while waiting:
        for attribute in shade.Utils.GetValueProducingAttributes(waiting.popleft()):
            shader = shade.Shader(attribute.GetPrim())
            if not shader or shader.GetPath() in seen:
                continue
            seen.add(shader.GetPath())
            file = shader.GetInput("file")
            if file:
                yield from shade.Utils.GetValueProducingAttributes(file)
            else:
                waiting.extend(shader.GetInputs())


def _tiles(file: Usd.Attribute) -> list[tuple[int, str]]:
    asset = file.Get(FIRST)
    if not isinstance(asset, Sdf.AssetPath) or not asset.path:
        raise Fault(f"{file.GetPath()} names no file")
    udims = usd_shade().UdimUtils
    if udims.IsUdimIdentifier(asset.path):
        found = udims.ResolveUdimTilePaths(asset.path, layer_of(file, FIRST))
        tiles = [(int(number), str(path)) for path, number in found]
    else:
        tiles = [(FIRST_TILE, asset.resolvedPath)] if asset.resolvedPath else []
    if not tiles:
        raise Fault(f"{file.GetPath()}: there is no file {asset.path}")
    return tiles


def _pixels(path: str) -> np.ndarray:
    opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    if not opened:
        raise Fault(f"{path}: USD opens no such file")
    try:
        with opened, Image.open(io.BytesIO(opened.GetBuffer())) as image:
            whole = image.convert("RGBA")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise Fault(f"{path} is not a picture that can be read: {' '.join(str(error).split())}") from error
    whole.thumbnail((_LARGEST, _LARGEST))
    return np.array(whole)
