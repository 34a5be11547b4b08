"""Pictures within a page: as small as a page of many needs them, and those for which there is room."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from skinslide.picture.page import Strip

_SIGNATURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg", b"RIFF": "image/webp"}
_PAGE_BYTES = 6_400_000  # that all pictures are to have, which take a third more as text
_FULL_BYTES = 7_200_000  # over which, with the numbers, some frames are left out
_ROW_BYTES = 300  # of the numbers of a frame, at three quarters, as the pictures
_LEAST_BYTES, _MOST_BYTES = 3_000, 150_000  # of a picture
# Widths in pixels, of two columns, qualities, and how many bytes they come to, as shares of those of the first.
_SIZES = (
    (1600, 84, 1.0),
    (1280, 78, 0.55),
    (1280, 62, 0.4),
    (1120, 52, 0.3),
    (960, 46, 0.22),
    (800, 40, 0.16),
    (640, 34, 0.12),
    (480, 32, 0.08),
    (360, 28, 0.05),
)
_FILM, _FILM_WIDTH = 16, 112  # frames on a film, at most; pixels that one is wide


def bytes_of_each(count: int) -> int:
    """How many a picture may have, of as many as a page is to have, for the page to be sent about."""
    return max(_LEAST_BYTES, min(_MOST_BYTES, _PAGE_BYTES // max(count, 1)))


def compressed(pixels: np.ndarray, most: int = _MOST_BYTES, columns: int = 2) -> bytes:
    """A rendered picture, uint8 (height, width, 3), for a page of many: so wide and good as `most` bytes allow.

    One of more columns is so much wider, since the page shows one at a time.
    """
    image, at = Image.fromarray(pixels), 0
    made = _encoded(image, at, columns)
    while len(made) > most and at + 1 < len(_SIZES):
        fitting = [i for i, (*_, share) in enumerate(_SIZES) if share / _SIZES[at][2] * len(made) <= most]
        at = max(at + 1, min(fitting, default=len(_SIZES) - 1))
        made = _encoded(image, at, columns)
    return made


def _encoded(image: Image.Image, size: int, columns: int) -> bytes:
    width, quality, _ = _SIZES[size]
    width = width * columns // 2
    scaled = image.resize((width, max(1, round(image.height * width / image.width)))) if image.width > width else image
    with io.BytesIO() as out:
        scaled.save(out, "WEBP", quality=quality, method=3)
        return out.getvalue()


def kept(strips: Sequence[Strip], samples: Sequence[int]) -> list[np.ndarray]:
    """Of which frames a strip's pictures are on the page, (frames,): all, or as many as fit, evenly over the shot.

    The first is, that at which the page opens, and the worst of each patch.
    """
    total = sum(len(picture) for strip in strips for pictures in strip.pictures.values() for picture in pictures)
    room = _FULL_BYTES - _ROW_BYTES * sum(len(strip.patch.frames) for strip in strips)
    share, found = min(1.0, max(room, 0) / max(total, 1)), list[np.ndarray]()
    for strip, sample in zip(strips, samples, strict=True):
        count = len(strip.patch.frames)
        chosen = np.isin(np.arange(count), np.linspace(0, count - 1, max(1, int(share * count))).round())
        chosen[[sample, strip.patch.worst]] = True
        found.append(chosen)
    return found


def film(strip: Strip) -> list[tuple[float, bytes]]:
    """Frames over all the shot, and what each looks like: the last column of the first view, small."""
    spread = np.linspace(0, len(strip.patch.frames) - 1, _FILM).round().astype(int)
    shown = sorted(set(spread.tolist()))
    pictures = next(iter(strip.pictures.values()), ())
    frames = [(i, frame) for i in shown for frame in [strip.patch.frames[i]] if frame is not None]
    return [(frame, _small(pictures[i], len(strip.columns))) for i, frame in frames if pictures and len(frames) > 1]


def _small(picture: bytes, columns: int) -> bytes:
    with Image.open(io.BytesIO(picture)) as image, io.BytesIO() as out:
        last = image.convert("RGB").crop((image.width - image.width // columns, 0, image.width, image.height))
        last.thumbnail((_FILM_WIDTH, _FILM_WIDTH))
        last.save(out, "WEBP", quality=50)
        return out.getvalue()


def others(pictures: Sequence[bytes], but: int, kept: np.ndarray) -> list[str | int | None]:
    """Every picture for the script, but one that is in the markup; of those left out, which is shown instead."""
    before = np.maximum.accumulate(np.where(kept, np.arange(len(kept)), 0)).tolist()
    return [None if i == but else uri(pictures[i]) if kept[i] else before[i] for i in range(len(pictures))]


def uri(picture: bytes) -> str:
    return f"data:{media_type(picture)};base64,{base64.b64encode(picture).decode()}"


def media_type(picture: bytes) -> str | None:
    return next((kind for signature, kind in _SIGNATURES.items() if picture.startswith(signature)), None)
