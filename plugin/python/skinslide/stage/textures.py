"""The maps of a patch: OpenEXR images, found by the stage's asset resolver and sampled at a primvar of the mesh."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from pxr import Ar, Sdf, Tf, Usd, UsdGeom, UsdShade

from skinslide.arrays.images import Corners, Image, decode_exr, map_tiles, sample_map
from skinslide.problems import Fault, SliderError
from skinslide.stage import schema
from skinslide.stage.coordinates import read_coordinates
from skinslide.stage.topology import Topology
from skinslide.stage.values import FIRST, Reading, primvar_sources

_LARGEST_FILE = 4 << 30  # bytes


@dataclass(frozen=True, eq=False)
class SampledTexture:
    """A map at one time."""

    name: str  # of the attribute, such as skinSlide:elbow_L:weightMap
    file: str  # resolved, with <UDIM> where it has tiles
    channel: str
    st: str  # the primvar it was sampled at
    sizes: dict[int, tuple[int, int]]  # width and height, by tile; 0 for the one of a map without
    values: np.ndarray  # (V,) float32, 1 at vertices off the patch


@dataclass(frozen=True)
class _Source:
    """Where a map is at one time."""

    name: str
    authored: str
    files: dict[int, str]  # resolved, by tile
    channel: str

    @property
    def is_udim(self) -> bool:
        return UsdShade.UdimUtils.IsUdimIdentifier(self.authored)


def read_texture(
    prim: Usd.Prim, patch: str, control: str, topology: Topology, faces: np.ndarray
) -> Reading[SampledTexture | None]:
    """The map of a control, forceDensity or weight, over time; None where there is none."""
    attr = schema.attribute(prim, patch, f"{control}Map")
    wanted = _word(prim, patch, "mapSt")
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar(wanted)
    last: dict[tuple[str, str], Image] = {}  # what the time before was sampled from

    def read(time: Usd.TimeCode) -> SampledTexture | None:
        source = _find(prim, patch, control, time)
        if source is None:
            return None
        if not primvar or not primvar.HasAuthoredValue():
            setting = schema.property_name(patch, "mapSt")
            raise Fault(f"has a map, but the mesh has no primvars:{wanted}; name one in {setting}")
        st = read_coordinates(primvar, time, topology)
        corners = Corners(topology.face_counts, topology.face_indices, topology.vertex_count, faces, st)
        try:
            return _sample(source, corners, primvar.GetPrimvarName(), last)
        except SliderError as error:
            raise Fault(f"{source.name}: {_shown(source)}: {error}") from error

    return Reading(read, [attr, *primvar_sources(primvar)])


def texture_files(prim: Usd.Prim, patch: str) -> Iterator[str]:
    """The resolved files of every map of a patch, at whatever time; those that are not there are passed over."""
    for control in ("weight", "forceDensity"):
        attr = schema.attribute(prim, patch, f"{control}Map")
        for time in [FIRST, *map(Usd.TimeCode, attr.GetTimeSamples())] if attr else []:
            with suppress(Fault):
                source = _find(prim, patch, control, time)
                yield from source.files.values() if source else ()


def _sample(source: _Source, corners: Corners, st: str, last: dict[tuple[str, str], Image]) -> SampledTexture:
    tiles = list(_tiles_needed(source, corners))
    used = {_key(source, tile): _read_image(source, tile, last) for tile in tiles}
    last.clear()
    last.update(used)
    images = {tile: used[_key(source, tile)] for tile in tiles}
    sizes = {tile: image.pixels.shape[::-1] for tile, image in images.items()}
    channel = images[tiles[0]].channel
    return SampledTexture(source.name, _shown(source), channel, st, sizes, sample_map(corners, images))


def _word(prim: Usd.Prim, patch: str, name: str) -> str:
    """A token or a string; "" where there is none."""
    found = schema.value(prim, patch, name, Usd.TimeCode.EarliestTime())
    if found is not None and not isinstance(found, str):
        raise Fault(f"{schema.property_name(patch, name)} is {found!r}; it must be a token")
    return found or ""


# ---- The file ----


def _find(prim: Usd.Prim, patch: str, control: str, time: Usd.TimeCode) -> _Source | None:
    name, attr = schema.property_name(patch, f"{control}Map"), schema.attribute(prim, patch, f"{control}Map")
    asset = attr.Get(time) if attr else None
    if asset is None:
        return None
    if not isinstance(asset, Sdf.AssetPath):
        raise Fault(f"{name} is {asset!r}; it must be an asset")
    if not asset.path:
        return None
    channel = _word(prim, patch, f"{control}MapChannel")
    if UsdShade.UdimUtils.IsUdimIdentifier(asset.path):
        layer = attr.GetPropertyStack(time)[0].layer
        found = UsdShade.UdimUtils.ResolveUdimTilePaths(asset.path, layer)
        files = {int(number): str(path) for path, number in found}
    else:
        files = {0: asset.resolvedPath} if asset.resolvedPath else {}
    if not files:
        raise Fault(f"{name}: {asset.path}: there is no such file")
    return _Source(name, asset.path, files, channel)


def _shown(source: _Source) -> str:
    """The resolved path, with <UDIM> in place of the number of a tile."""
    tile, path = min(source.files.items())
    return path if tile == 0 else "<UDIM>".join(path.rsplit(str(tile), 1))


def _tiles_needed(source: _Source, corners: Corners) -> Iterator[int]:
    if not source.is_udim:
        yield 0
        return
    needed = map_tiles(corners)
    for tile in np.unique(needed[needed > 0]).tolist():
        if tile not in source.files:
            missing = source.authored.replace("<UDIM>", str(tile))
            raise Fault(f"{source.name}: {missing}: there is no such file, and the patch has texture coordinates in it")
        yield tile


def _key(source: _Source, tile: int) -> tuple[str, str]:
    return source.files[tile], source.channel


def _read_image(source: _Source, tile: int, last: dict[tuple[str, str], Image]) -> Image:
    """The image of a tile; that of the time before where it is the same file."""
    key = _key(source, tile)
    if key in last:
        return last[key]
    try:
        return decode_exr(_read_bytes(source.name, key[0]), source.channel)
    except SliderError as error:
        raise Fault(f"{source.name}: {key[0]}: {error}") from error


def _read_bytes(name: str, path: str) -> bytes:
    """The bytes of a resolved asset, which may lie in a package."""
    try:
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
        size = asset.GetSize() if asset else 0
        if asset and size <= _LARGEST_FILE:
            with asset as opened:
                return bytes(opened.GetBuffer() or b"")
    except (OSError, RuntimeError, Tf.ErrorException) as error:
        raise Fault(f"{name}: {path}: cannot be read: {' '.join(str(error).split())}") from error
    reason = f"has {size} bytes; more than {_LARGEST_FILE} are refused" if asset else "cannot be read"
    raise Fault(f"{name}: {path}: {reason}")
