"""The report of a shot as one HTML page: pictures and curves of each patch under one scrubber over the frames.

The page loads nothing, from anywhere: its policy allows the one style, the one script, and images within it. It opens
at the frame where sliding removes most stretch. All that is shown of it is in the markup, so that the page reads
without its script and prints.
"""

from __future__ import annotations

import base64
import hashlib
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from PIL import Image

from skinslide.picture.plots import charts
from skinslide.shot.report import BakeReport, PatchReport, milliseconds_text, roughness_text, stretch_text, time_text

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


@dataclass(frozen=True)
class Strip:
    """One patch of one mesh, frame by frame."""

    prim: str
    patch: PatchReport
    pictures: Mapping[str, Sequence[bytes]]  # by view: a PNG, JPEG or WebP a frame, with its columns side by side
    settings: Mapping[str, str]  # what was used, as it is to be shown
    columns: Sequence[str] = ("before", "after")  # of equal width
    files: Mapping[str, Sequence[str]] = field(
        default_factory=dict
    )  # by view: where a frame's full size is, from the page
    compared: Mapping[str, Sequence[float]] = field(
        default_factory=dict
    )  # by column but the first, where they are rules: the stretch left at each frame


def page(
    title: str,
    strips: Sequence[Strip],
    report: BakeReport,
    facts: Mapping[str, str],
    time_codes_per_second: float = 24.0,
) -> str:
    """The page, to be written as UTF-8. The same arguments give the same bytes.

    Args:
        title: Of the page.
        strips: What is shown.
        report: Its problems are listed.
        facts: Of the shot as a whole, as they are to be shown.
        time_codes_per_second: Of the stage: how fast it plays.

    Raises:
        ValueError: A strip has no frames, or pictures that are not one PNG, JPEG or WebP a frame.
    """
    for strip in strips:
        _check(strip)
    if not (math.isfinite(time_codes_per_second) and time_codes_per_second > 0):
        raise ValueError(f"{time_codes_per_second} time codes per second: a page cannot be played at that")
    timeline = _Timeline.of(strips)
    start = _start(strips, timeline)
    samples = [timeline.sample(strip.patch, start) for strip in strips]
    return render(
        "page.html",
        title=title,
        facts=facts,
        strips=strips,
        samples=samples,
        kept=_kept(strips, samples),
        start=start,
        problems=report.problems,
        timeline=timeline,
        views=list(dict.fromkeys(view for strip in strips for view in strip.pictures)),
        columns=list(dict.fromkeys(column for strip in strips for column in strip.columns[1:])),
        data={
            "frames": timeline.frames,
            "labels": timeline.labels,
            "start": start,
            "positions": [timeline.positions(strip.patch) for strip in strips],
            "timeCodesPerSecond": time_codes_per_second,
        },
    )


@dataclass(frozen=True)
class _Timeline:
    """Every frame that some patch has, ascending; none if all have only a default value."""

    frames: list[float]

    @classmethod
    def of(cls, strips: Sequence[Strip]) -> _Timeline:
        return cls(sorted({frame for strip in strips for frame in strip.patch.frames if frame is not None}))

    @property
    def labels(self) -> list[str]:
        return [time_text(frame) for frame in self.frames] or [time_text(None)]

    def positions(self, patch: PatchReport) -> list[int]:
        """The place of each frame of a patch; none if it has only a default value."""
        place = {frame: i for i, frame in enumerate(self.frames)}
        return [place[frame] for frame in patch.frames if frame is not None]

    def sample(self, patch: PatchReport, index: int) -> int:
        """Which of a patch's frames is shown at a frame: itself, else the last before it, else the first."""
        return max((i for i, position in enumerate(self.positions(patch)) if position <= index), default=0)


def _start(strips: Sequence[Strip], timeline: _Timeline) -> int:
    """The frame at which most stretch is removed from all patches together; at which they stretch most, if none is."""
    patches = [strip.patch for strip in strips]
    shown = [[patch.results[timeline.sample(patch, i)] for patch in patches] for i in range(len(timeline.frames))]
    gains = [sum(result.stretch_before - result.stretch_after for result in results) for results in shown]
    if max(gains, default=0.0) <= 0:
        gains = [sum(result.stretch_before for result in results) for results in shown]
    return int(np.argmax(gains)) if gains else 0


# ---- Templates ----


def render(name: str, **values: Any) -> str:
    """A page of a template, with the style of all pages and a script of its own name."""
    templates = _templates()
    style, script = _inlined(templates, "page.css"), _inlined(templates, name.replace(".html", ".js"))
    return templates.get_template(name).render(style=style, script=script, **values)


def _templates() -> Environment:
    """All that the templates are given is escaped text, except for the page's own style and script."""
    templates = Environment(
        loader=PackageLoader("skinslide.picture"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    templates.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "allow_nan": False}
    templates.globals["charts_of"] = charts
    templates.globals.update(film_of=_film, others=_others)
    templates.filters.update(
        change=_change,
        changed=_changed,
        digest=_digest,
        milliseconds=milliseconds_text,
        moment=_moment,
        path=_path,
        roughness=roughness_text,
        stretch=stretch_text,
        time=time_text,
        units=lambda number: f"{number:.2f}",
        uri=_uri,
    )
    return templates


def _inlined(templates: Environment, name: str) -> Markup:
    """The text of a file beside the templates, such as the style."""
    loader = templates.loader
    assert loader
    return Markup(loader.get_source(templates, name)[0])


def _shown(value: Any) -> Any:
    """Text in which bytes of file names that are not UTF-8 are shown as numbers."""
    plain = isinstance(value, str) and not isinstance(value, Markup)
    return value.encode("utf-8", "backslashreplace").decode() if plain else value


def _path(prim: str) -> Markup:
    """A prim's path, which may be broken after a slash."""
    return Markup("/<wbr>").join(map(_shown, prim.split("/")))


def _digest(inlined: str) -> str:
    """The digest by which a content security policy names a style or a script."""
    return f"sha256-{base64.b64encode(hashlib.sha256(inlined.encode()).digest()).decode()}"


def _moment(frame: float | None) -> str:
    return "default value" if frame is None else f"frame {time_text(frame)}"


def _change(change: float | None) -> str:
    return "" if change is None else f"{100 * change:+.0f} %".replace("-", "\N{MINUS SIGN}")


def _changed(after: float, before: float) -> str:
    return _change(after / before - 1 if before > 0 else None)


def _others(pictures: Sequence[bytes], but: int, kept: np.ndarray) -> list[str | int | None]:
    """Every picture for the script, but one that is in the markup; of those left out, which is shown instead."""
    before = np.maximum.accumulate(np.where(kept, np.arange(len(kept)), 0)).tolist()
    return [None if i == but else _uri(pictures[i]) if kept[i] else before[i] for i in range(len(pictures))]


def _uri(picture: bytes) -> str:
    return f"data:{_media_type(picture)};base64,{base64.b64encode(picture).decode()}"


# ---- Pictures ----


def _check(strip: Strip) -> None:
    where = f"{strip.prim}: patch {strip.patch.label}"
    frames = strip.patch.frames
    if not frames:
        raise ValueError(f"{where}: no frames")
    for view, pictures in strip.pictures.items():
        if len(pictures) != len(frames):
            raise ValueError(f"{where}: {len(pictures)} pictures of {view} for {len(frames)} frames")
        for frame, picture in zip(frames, pictures, strict=True):
            if _media_type(picture) is None:
                raise ValueError(f"{where}: frame {time_text(frame)}: the picture of {view} is not a PNG, JPEG or WebP")


def _media_type(picture: bytes) -> str | None:
    return next((kind for signature, kind in _SIGNATURES.items() if picture.startswith(signature)), None)


def _kept(strips: Sequence[Strip], samples: Sequence[int]) -> list[np.ndarray]:
    """Of which frames a strip's pictures are on the page, (frames,): all, or as many as fit, evenly over the shot.

    The first is, that at which the page opens, and the worst of each patch.
    """
    total = sum(len(picture) for strip in strips for pictures in strip.pictures.values() for picture in pictures)
    room = _FULL_BYTES - _ROW_BYTES * sum(len(strip.patch.frames) for strip in strips)
    share, found = min(1.0, max(room, 0) / max(total, 1)), list[np.ndarray]()
    for strip, sample in zip(strips, samples, strict=True):
        count = len(strip.patch.frames)
        kept = np.isin(np.arange(count), np.linspace(0, count - 1, max(1, int(share * count))).round())
        kept[[sample, strip.patch.worst]] = True
        found.append(kept)
    return found


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


def _film(strip: Strip) -> list[tuple[float, bytes]]:
    """Frames over all the shot, and what each looks like: the last column of the first view, small."""
    shown = np.unique(np.linspace(0, len(strip.patch.frames) - 1, _FILM).round().astype(int))
    pictures = next(iter(strip.pictures.values()), ())
    frames = [(i, frame) for i in shown for frame in [strip.patch.frames[i]] if frame is not None]
    return [(frame, _small(pictures[i], len(strip.columns))) for i, frame in frames if pictures and len(frames) > 1]


def _small(picture: bytes, columns: int) -> bytes:
    with Image.open(io.BytesIO(picture)) as image, io.BytesIO() as out:
        last = image.convert("RGB").crop((image.width - image.width // columns, 0, image.width, image.height))
        last.thumbnail((_FILM_WIDTH, _FILM_WIDTH))
        last.save(out, "WEBP", quality=50)
        return out.getvalue()
