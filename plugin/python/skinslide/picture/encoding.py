"""Pictures as the bytes of files: of full size, and small ones for contact sheets."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from PIL import Image

from skinslide.arrays.images import encode_exr

THUMBNAIL = 480  # pixels wide

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_LEFT = 1  # PNG's filter by which a pixel is written as what it differs by from the one before
_FAST = 1  # of the levels of zlib


def srgb(light: np.ndarray) -> np.ndarray:
    """Linear light as bytes in sRGB."""
    light = np.clip(light, 0, 1)
    encoded = np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(255 * encoded).astype(np.uint8)


def displayed(pixels: np.ndarray) -> np.ndarray:
    """A picture (height, width, 4) in sRGB, uint8 (height, width, 3)."""
    if pixels.dtype == np.uint8:
        return np.asarray(Image.fromarray(pixels).convert("RGB"))  # four times as fast as numpy drops a channel
    return srgb(pixels[..., :3])


def exr(pixels: np.ndarray) -> bytes:
    """An OpenEXR file of float32 (height, width, 4)."""
    return encode_exr({name: np.ascontiguousarray(pixels[..., k]) for k, name in enumerate("RGB")})


def png(pixels: np.ndarray) -> bytes:
    """A PNG file of uint8 (height, width, 3).

    Every row has the same filter. Encoders choose one for each row, which takes longer than deflating what is drawn
    here and makes it hardly smaller.
    """
    height, width, _ = pixels.shape
    given, rows = pixels.reshape(height, -1), np.empty((height, 1 + 3 * width), np.uint8)
    rows[:, 0], rows[:, 1:4] = _LEFT, given[:, :3]
    np.subtract(given[:, 3:], given[:, :-3], out=rows[:, 4:])
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits of each of red, green and blue
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(rows.data, _FAST)), (b"IEND", b"")]
    return _SIGNATURE + b"".join(_chunk(kind, data) for kind, data in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(data, zlib.crc32(kind)))


def thumbnail(pixels: np.ndarray) -> bytes:
    """A picture, uint8 (height, width, 3), for a contact sheet, as a PNG file: of many patches there are thousands."""
    image = Image.fromarray(pixels)
    height = max(1, round(image.height * THUMBNAIL / image.width))
    small = image.resize((THUMBNAIL, height), Image.Resampling.BOX) if image.width > THUMBNAIL else image
    return png(np.asarray(small))
