"""The report of a shot as one HTML page: pictures and curves of each patch under one scrubber over the frames.

The page loads nothing, from anywhere: its policy allows the one style, the one script, and images within it. All that
is shown of the first frame is in the markup, so that the page reads without its script and prints.
"""

from __future__ import annotations

import base64
import hashlib
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from PIL import Image

from skinslide.picture.plots import charts
from skinslide.shot.report import BakeReport, PatchReport, milliseconds_text, roughness_text, stretch_text, time_text

_SIGNATURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
_PICTURE_WIDTH = 1920  # more than a page shows, unless on a screen of twice the pixels


@dataclass(frozen=True)
class Strip:
    """One patch of one mesh, frame by frame."""

    prim: str
    patch: PatchReport
    pictures: Mapping[str, Sequence[bytes]]  # by view: a PNG or JPEG a frame, before and after side by side
    settings: Mapping[str, str]  # what was used, as it is to be shown


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
        ValueError: A strip has no frames, or pictures that are not one PNG or JPEG a frame.
    """
    for strip in strips:
        _check(strip)
    if not (math.isfinite(time_codes_per_second) and time_codes_per_second > 0):
        raise ValueError(f"{time_codes_per_second} time codes per second: a page cannot be played at that")
    timeline, templates = _Timeline.of(strips), _templates()
    return templates.get_template("page.html").render(
        title=title,
        style=_inlined(templates, "page.css"),
        script=_inlined(templates, "page.js"),
        facts=facts,
        strips=strips,
        problems=report.problems,
        timeline=timeline,
        views=list(dict.fromkeys(view for strip in strips for view in strip.pictures)),
        data={
            "frames": timeline.frames,
            "labels": timeline.labels,
            "positions": [timeline.positions(strip.patch) for strip in strips],
            "timeCodesPerSecond": time_codes_per_second,
        },
    )


@dataclass(frozen=True)
class _Timeline:
    """Every frame that some patch has, ascending; none where all have but a default value."""

    frames: list[float]

    @classmethod
    def of(cls, strips: Sequence[Strip]) -> _Timeline:
        return cls(sorted({frame for strip in strips for frame in strip.patch.frames if frame is not None}))

    @property
    def labels(self) -> list[str]:
        return [time_text(frame) for frame in self.frames] or [time_text(None)]

    def positions(self, patch: PatchReport) -> list[int]:
        """Where each frame of a patch is; nowhere, where it has but a default value."""
        place = {frame: i for i, frame in enumerate(self.frames)}
        return [place[frame] for frame in patch.frames if frame is not None]


# ---- Templates ----


def _templates() -> Environment:
    """All that they are given is text, and escaped, but the page's own style and script."""
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
    templates.filters.update(
        change=_change,
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
    """A file of the page's own, as it stands."""
    loader = templates.loader
    assert loader
    return Markup(loader.get_source(templates, name)[0])


def _shown(value: Any) -> Any:
    """Bytes of file names that are no UTF-8 are shown by number."""
    plain = isinstance(value, str) and not isinstance(value, Markup)
    return value.encode("utf-8", "backslashreplace").decode() if plain else value


def _path(prim: str) -> Markup:
    """A prim's path, which may be broken after a slash."""
    return Markup("/<wbr>").join(map(_shown, prim.split("/")))


def _digest(inlined: str) -> str:
    """What a policy calls a style or a script."""
    return f"sha256-{base64.b64encode(hashlib.sha256(inlined.encode()).digest()).decode()}"


def _moment(frame: float | None) -> str:
    return "default value" if frame is None else f"frame {time_text(frame)}"


def _change(change: float | None) -> str:
    return "" if change is None else f"{100 * change:+.0f} %".replace("-", "\N{MINUS SIGN}")


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
                raise ValueError(f"{where}: frame {time_text(frame)}: the picture of {view} is neither PNG nor JPEG")


def _media_type(picture: bytes) -> str | None:
    return next((kind for signature, kind in _SIGNATURES.items() if picture.startswith(signature)), None)


def compressed(pixels: np.ndarray) -> bytes:
    """A rendered picture, uint8 (height, width, 3), for a page of many frames: some tenth of its PNG.

    Colours keep their full resolution.
    """
    image = Image.fromarray(pixels)
    image.thumbnail((_PICTURE_WIDTH, image.height))
    with io.BytesIO() as out:
        image.save(out, "JPEG", quality=90, subsampling=0)
        return out.getvalue()
