"""What is on a picture beside the skin, titles and the scale of its colours; and contact sheets."""

from __future__ import annotations

import contextlib
import functools
import io
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from skinslide.arrays.canvas import Viewport, false_colour
from skinslide.picture.encoding import png, srgb

BACKGROUND = (0.045, 0.045, 0.052)  # linear light

_TEXT, _SHADE = (244, 241, 236, 255), (18, 18, 22, 150)
_GAP = 0.6  # of a line's height, around text


def columns(width: int, height: int, count: int) -> list[Viewport]:
    """Equal parts of a picture, side by side."""
    edges = [round(i * width / count) for i in range(count + 1)]
    return [Viewport(left, 0, right - left, height) for left, right in pairwise(edges)]


def font_of(height: int) -> ImageFont.FreeTypeFont:
    """The font of a picture of that height."""
    return next(_fonts(max(9, round(height / 42))))


# Files by which machines have fonts of more letters than Pillow's own: of Europe, then of all.
_OTHER_FONTS = (
    "DejaVuSans.ttf",
    "NotoSansCJK-Regular.ttc",
    "DroidSansFallbackFull.ttf",
    "VL-Gothic-Regular.ttf",
    "ipag.ttf",
    "Hiragino Sans GB.ttc",
    "msgothic.ttc",
)
_NO_LETTER = "\uffff"  # every font draws it as what it has not


def _fonts(size: float) -> Iterator[ImageFont.FreeTypeFont]:
    """Pillow's own font, which is the same everywhere, and those of the others that this machine has."""
    own = ImageFont.load_default(size)
    assert isinstance(own, ImageFont.FreeTypeFont)  # as Pillow's wheels have it
    yield own
    for file in _OTHER_FONTS:
        with contextlib.suppress(OSError):
            yield ImageFont.truetype(file, size)


def _glyph(font: ImageFont.FreeTypeFont, letter: str) -> tuple[tuple[int, int], bytes]:
    mask = font.getmask(letter)
    return mask.size, bytes(mask)


def _drawable(font: ImageFont.FreeTypeFont, line: str) -> str:
    """A line in which letters that a font lacks are escaped as Python escapes them."""
    missing = _glyph(font, _NO_LETTER)
    lost = {letter for letter in set(line) if not letter.isspace() and _glyph(font, letter) == missing}
    return "".join(letter.encode("unicode_escape").decode() if letter in lost else letter for letter in line)


@functools.lru_cache(maxsize=256)
def _lettered(line: str, size: float) -> tuple[str, ImageFont.FreeTypeFont]:
    """A line, and the first font that has all its letters; else Pillow's own, with the others escaped."""
    for font in _fonts(size):
        if _drawable(font, line) == line:
            return line, font
    own = next(_fonts(size))
    return _drawable(own, line), own


def write_text(pixels: np.ndarray, lines: Sequence[str], place: Viewport, *, at_foot: bool = False) -> None:
    """Writes lines on a dark ground into the upper or lower left corner of a part of a picture."""
    font = font_of(place.height)
    pad = round(font.size * _GAP)
    lettered = [_lettered(line, font.size) for line in lines]
    boxes = [own.getbbox(line) for line, own in lettered]
    wide = math.ceil(max((box[2] for box in boxes), default=0)) + 2 * pad
    step = round(font.size * 1.35)
    card = Image.new("RGBA", (wide, step * len(lines) + pad), _SHADE)
    draw = ImageDraw.Draw(card)
    for number, (line, own) in enumerate(lettered):
        draw.text((pad, pad // 2 + number * step), line, _TEXT, own)
    _lay(pixels, np.array(card), place, place.height - card.height if at_foot else 0)


def write_scale(pixels: np.ndarray, title: str, ticks: tuple[str, str, str], place: Viewport) -> None:
    """Draws the scale of colours, with the values at its ends and its middle, in the lower left corner of a part."""
    font = font_of(place.height)
    pad, wide, tall = round(font.size * _GAP), max(2, round(place.height * 0.34)), round(font.size * 0.7)
    top = pad // 4 + sum(font.getmetrics())  # of the colours: below the title's descenders
    card = Image.new("RGBA", (wide + 4 * pad, top + tall + round(font.size * 2)), _SHADE)
    draw = ImageDraw.Draw(card)
    for x in range(wide):
        colour = tuple(srgb(np.array(false_colour(x / (wide - 1)))).tolist())
        draw.line([(2 * pad + x, top), (2 * pad + x, top + tall)], (*colour, 255))
    for share, anchor, tick in zip((0.0, 0.5, 1.0), ("la", "ma", "ra"), ticks, strict=True):
        draw.text((2 * pad + share * wide, top + 0.3 * pad + tall), tick, _TEXT, font, anchor=anchor)
    draw.text((2 * pad, pad // 4), title, _TEXT, font)
    _lay(pixels, np.array(card), place, place.height - card.height)


def _lay(pixels: np.ndarray, card: np.ndarray, place: Viewport, top: int) -> None:
    """Lays a card over a part of a picture, in the picture's own colours; what is beyond its edges is cut off."""
    part = pixels[pixels.shape[0] - place.y - place.height :, place.x : place.x + place.width, :3]
    part = part[max(top, 0) :][: card.shape[0], : card.shape[1]]
    card = card[: part.shape[0], : part.shape[1]]
    alpha = card[..., 3:] / 255
    if pixels.dtype == np.uint8:
        part[...] = np.rint(part * (1 - alpha) + card[..., :3] * alpha).astype(np.uint8)
    else:
        part[...] = part * (1 - alpha) + _decoded(card[..., :3]) * alpha


def _decoded(encoded: np.ndarray) -> np.ndarray:
    share = encoded / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4).astype(np.float32)


# ---- Contact sheets ----

_TALLEST = 16384  # pixels of a sheet
_IN_A_ROW, _MARGIN = 4, 12


def contact_sheets(strips: Sequence[Sequence[bytes]]) -> Iterator[bytes]:
    """Thumbnails as PNG files: a strip begins a row; more than one file where they would be too tall."""
    rows = [strip[i : i + _IN_A_ROW] for strip in strips for i in range(0, len(strip), _IN_A_ROW)]
    tallest = max((_size(file)[1] for row in rows for file in row), default=1) + _MARGIN
    most = max(1, (_TALLEST - _MARGIN) // tallest)
    return (_sheet(rows[i : i + most]) for i in range(0, len(rows), most))


def _sheet(rows: Sequence[Sequence[bytes]]) -> bytes:
    wide = max(sum(_size(file)[0] + _MARGIN for file in row) for row in rows)
    tall = [max(_size(file)[1] for file in row) + _MARGIN for row in rows]
    sheet = Image.new("RGB", (wide + _MARGIN, sum(tall) + _MARGIN), (28, 28, 32))
    top = _MARGIN
    for row, height in zip(rows, tall, strict=True):
        left = _MARGIN
        for file in row:
            with Image.open(io.BytesIO(file)) as image:
                sheet.paste(image, (left, top))
                left += image.width + _MARGIN
        top += height
    return png(np.asarray(sheet))


def _size(file: bytes) -> tuple[int, int]:
    """Width and height, from its header."""
    return Image.open(io.BytesIO(file)).size
