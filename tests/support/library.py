"""Functions of the core that the tool has no use for, on numpy arrays: what the file format and programs in C read."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from skinslide import Sample
from skinslide._core import ffi, lib
from skinslide.arrays.checks import as_array
from skinslide.arrays.images import Corners, layout_of
from skinslide.arrays.native import call, enum_value, new_array, text, token_of, writable
from skinslide.arrays.structs import Arguments


class Image(NamedTuple):
    """One channel of an image. The wraps say what is beyond the border along width and height."""

    pixels: np.ndarray  # (height, width) float32, from the top row on
    channel: str
    wrap_s: str = "clamp"
    wrap_t: str = "clamp"


def decode_exr(data: Any, channel: str = "") -> Image:
    """One channel of the OpenEXR file in `data`, by its name, PART.NAME, or "": as a map's is chosen."""
    out = ffi.new("skinslide_image **")
    buffer = ffi.from_buffer("uint8_t[]", data)
    call(lib.skinslide_exr_decode, buffer, len(buffer), channel.encode(), out)
    image = ffi.gc(out[0], lib.skinslide_image_destroy)
    shape = (image.height, image.width)
    pixels = np.frombuffer(ffi.buffer(image.pixels, 4 * shape[0] * shape[1]), np.float32).reshape(shape).copy()
    return Image(pixels, text(image.channel), token_of("wrap", image.wrap_s), token_of("wrap", image.wrap_t))


def sample_map(corners: Corners, images: Mapping[int, Image]) -> np.ndarray:
    """Values by vertex, float32 (V,): means over corners in the faces; 1 at vertices of none of them.

    Images are by the number of their tile; {0: image} covers every texture coordinate by its wraps.
    """
    native, values = Arguments(), np.empty(corners.vertex_count, np.float32)
    tiles = new_array("texture_tile", len(images))
    structs = new_array("image", len(images))
    for i, (number, image) in enumerate(images.items()):
        structs[i].pixels = native.pointer(image.pixels, np.float32, (-1, -1), f"tile {number}")
        structs[i].height, structs[i].width = image.pixels.shape
        structs[i].wrap_s, structs[i].wrap_t = (enum_value("wrap", wrap, "") for wrap in (image.wrap_s, image.wrap_t))
        tiles[i].image, tiles[i].number = ffi.addressof(structs, i), number
    call(lib.skinslide_texture_sample, layout_of(native, corners), tiles, len(images), writable("float[]", values))
    return values


def velocities(samples: Sequence[Sample], velocities: np.ndarray) -> np.ndarray:
    """The cache's velocities (V, 3), units per second, corrected by the rate of change over two samples."""
    return _rates(lib.skinslide_velocities, 2, samples, velocities, "velocities")


def accelerations(samples: Sequence[Sample], accelerations: np.ndarray) -> np.ndarray:
    """The cache's accelerations (V, 3), units per second squared, corrected by the second difference over three."""
    return _rates(lib.skinslide_accelerations, 3, samples, accelerations, "accelerations")


def _rates(function: Any, sample_count: int, samples: Sequence[Sample], rates: np.ndarray, what: str) -> np.ndarray:
    native = Arguments()
    vertex_count = len(samples[0].cached) if samples else 0
    given = native.samples(samples, sample_count, vertex_count, what)
    result = as_array(rates, np.float32, (vertex_count, 3), what).copy()
    call(function, vertex_count, given, writable("float[]", result))
    return result
