"""The report of a shot as one HTML page: pictures and curves of each patch under one scrubber over the frames.

The page loads nothing, from anywhere: its policy allows the one style, the one script, and images within it. All that
is shown of the first frame is in the markup, so that the page reads without its script and prints.
"""

from __future__ import annotations

import base64
import hashlib
import io
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from string import Template

import numpy as np
from PIL import Image

from skinslide.picture.plots import Chart, charts, svg
from skinslide.problems import Problem
from skinslide.shot.report import BakeReport, PatchReport, milliseconds_text, stretch_text, time_text

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

    report                 its problems are listed
    facts                  of the shot as a whole, as they are to be shown
    time_codes_per_second  of the stage: how fast it plays
    Raises ValueError where a strip has no frames, or pictures that are not one PNG or JPEG a frame.
    """
    for strip in strips:
        _check(strip)
    if not (math.isfinite(time_codes_per_second) and time_codes_per_second > 0):
        raise ValueError(f"{time_codes_per_second} time codes per second: a page cannot be played at that")
    timeline = _Timeline.of(strips)
    style, script = _packaged("page.css"), _packaged("page.js")
    data = {
        "frames": timeline.frames,
        "labels": timeline.labels,
        "positions": [timeline.positions(strip.patch) for strip in strips],
        "timeCodesPerSecond": time_codes_per_second,
    }
    return _filled(
        "page.html",
        title=_text(title),
        style=style,
        style_hash=_policy_hash(style),
        script=script,
        script_hash=_policy_hash(script),
        facts=_pairs(facts, "facts"),
        summary=_summary(strips, timeline),
        problems=_problems(report.problems, timeline),
        player=_player(timeline, list(dict.fromkeys(view for strip in strips for view in strip.pictures))),
        strips="".join(_strip(i, strip, timeline) for i, strip in enumerate(strips)),
        data=_json(data),
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
        return [time_text(frame) for frame in self.frames or [None]]

    def positions(self, patch: PatchReport) -> list[int]:
        """Where each frame of a patch is; nowhere, where it has but a default value."""
        place = {frame: i for i, frame in enumerate(self.frames)}
        return [place[frame] for frame in patch.frames if frame is not None]

    def jump(self, frame: float | None, shown: str | None = None) -> str:
        """A frame as text, which the script makes a button where the page has it."""
        text = _text(time_text(frame) if shown is None else shown)
        return f'<span data-jump="{self.frames.index(frame)}">{text}</span>' if frame in self.frames else text


# ---- Text ----


def _packaged(name: str) -> str:
    return files("skinslide.picture").joinpath("templates", name).read_text("utf-8")


def _filled(template: str, **parts: object) -> str:
    """A template with its parts, which are markup."""
    return Template(_packaged(template)).substitute(parts)


def _text(text: str) -> str:
    """Text or an attribute's value. Bytes of file names that are no UTF-8 are shown by number."""
    return escape(text.encode("utf-8", "backslashreplace").decode())


def _path(prim: str) -> str:
    """A prim's path, which may be broken after a slash."""
    return _text(prim).replace("/", "/<wbr>")


def _json(value: object) -> str:
    """JSON that nothing in it can end the script element of."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _policy_hash(inlined: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(inlined.encode()).digest()).decode()}"


def _pairs(values: Mapping[str, str], kind: str) -> str:
    pairs = "".join(f"<div><dt>{_text(name)}</dt><dd>{_text(value)}</dd></div>" for name, value in values.items())
    return f'<dl class="{kind}">{pairs}</dl>' if pairs else ""


def _moment(frame: float | None) -> str:
    return "default value" if frame is None else f"frame {time_text(frame)}"


def _change(patch: PatchReport) -> str:
    return "" if patch.change is None else f"{100 * patch.change:+.0f} %".replace("-", "\N{MINUS SIGN}")


# ---- Tables ----


def _summary(strips: Sequence[Strip], timeline: _Timeline) -> str:
    """A row a patch: stretch at its worst frame, and the most of what else there is."""
    if not strips:
        return '<p class="summary">There is no patch.</p>'
    names = ("worst frame", "stretch before", "after", "change", "largest slide", "folded", "clamped", "ms a frame")
    headings = "".join(f'<th scope="col">{name}</th>' for name in names)
    rows = []
    for i, strip in enumerate(strips):
        cells = "".join(f"<td>{cell}</td>" for cell in _summary_cells(strip.patch, timeline))
        name = f'<a href="#patch-{i}">{_text(strip.patch.label)}</a> <span class="quiet">{_path(strip.prim)}</span>'
        rows.append(f'<tr><th scope="row" class="words">{name}</th>{cells}</tr>')
    return (
        '<div class="summary scroll"><table><thead><tr><th scope="col" class="words">patch</th>'
        f"{headings}</tr></thead><tbody>{''.join(rows)}</tbody></table></div>"
    )


def _summary_cells(patch: PatchReport, timeline: _Timeline) -> list[str]:
    worst = patch.results[patch.worst]
    return [
        timeline.jump(patch.frames[patch.worst]),
        stretch_text(worst.stretch_before),
        stretch_text(worst.stretch_after),
        _change(patch),
        f"{patch.column('largest_slide').max():.4g}",
        str(patch.column("folded_faces").max()),
        str(patch.column("clamped_vertices").max()),
        milliseconds_text(patch.milliseconds()["total"].mean()),
    ]


def _problems(problems: Sequence[Problem], timeline: _Timeline) -> str:
    if not problems:
        return '<p class="problems quiet">No problems.</p>'
    rows = []
    for problem in problems:
        frame = "" if problem.frame is None else timeline.jump(problem.frame)
        place = f'{_text(problem.patch or "")} <span class="quiet">{_path(problem.prim)}</span>'
        rows.append(
            f'<tr><td class="severity {problem.severity}">{problem.severity}</td><td class="words">{place}</td>'
            f'<td>{frame}</td><td class="words">{_text(problem.message)}</td></tr>'
        )
    headings = '<th scope="col"></th><th scope="col" class="words">where</th><th scope="col">frame</th>'
    return (
        f'<div class="problems scroll"><table><caption>Problems</caption><thead><tr>{headings}'
        f'<th scope="col" class="words">what</th></tr></thead><tbody>{"".join(rows)}</tbody></table></div>'
    )


def _numbers(patch: PatchReport, drawn: Sequence[Chart]) -> str:
    """A row a frame, with the values of every curve, in order; the script reads what it shows from here."""
    names = [quantity.name for chart in drawn for quantity in chart.quantities]
    columns = [quantity.texts for chart in drawn for quantity in chart.quantities]
    groups = "".join(
        f'<th scope="colgroup" colspan="{len(chart.quantities)}">{chart.title}, {chart.unit}</th>' for chart in drawn
    )
    headings = "".join(f'<th scope="col">{name}</th>' for name in ["frame", *names])
    rows = []
    for frame, *values in zip(patch.frames, *columns, strict=True):
        cells = "".join(f"<td>{value}</td>" for value in values)
        rows.append(f'<tr><th scope="row" data-moment="{_moment(frame)}">{time_text(frame)}</th>{cells}</tr>')
    return (
        '<details><summary>Every frame in numbers</summary><div class="scroll" tabindex="0"><table>'
        f"<thead><tr><td></td>{groups}</tr><tr>{headings}</tr></thead><tbody>{''.join(rows)}</tbody></table></div></details>"
    )


# ---- The player and the patches ----


def _player(timeline: _Timeline, views: Sequence[str]) -> str:
    """Shown by the script where there is something to play or to choose."""
    options = "".join(
        f'<label><input type="radio" name="view" value="{_text(view)}"{" checked" * (i == 0)}>{_text(view)}</label>'
        for i, view in enumerate(views)
    )
    return _filled(
        "player.html",
        last=len(timeline.labels) - 1,
        first=timeline.labels[0],
        still=" hidden" * (len(timeline.frames) < 2),
        alike=" hidden" * (len(views) < 2),
        options=options,
    )


def _strip(index: int, strip: Strip, timeline: _Timeline) -> str:
    patch, drawn = strip.patch, charts(strip.patch)
    frame, worst = patch.frames[patch.worst], patch.results[patch.worst]
    return _filled(
        "strip.html",
        index=index,
        name=_text(patch.label),
        prim=_path(strip.prim),
        before=stretch_text(worst.stretch_before),
        after=stretch_text(worst.stretch_after),
        change=_change(patch),
        worst=timeline.jump(frame, _moment(frame)),
        pictures="".join(_pictures(strip)),
        charts="".join(_charts(drawn, patch)),
        settings=_pairs(strip.settings, "settings"),
        numbers=_numbers(patch, drawn),
    )


def _pictures(strip: Strip) -> Iterator[str]:
    """A figure a view, with the first frame's picture in it, and the others beside it for the script."""
    moment = _moment(strip.patch.frames[0])
    for view, pictures in strip.pictures.items():
        first, *others = map(_data_uri, pictures)
        alt = _text(f"{strip.patch.label}, {view}, before and after side by side")
        yield (
            f'<figure class="picture" data-view="{_text(view)}"><figcaption><span>before</span><span>after</span>'
            f'<span class="shown">{_text(view)}, <span class="at">{moment}</span></span></figcaption>'
            f'<img src="{first}" alt="{alt}, {moment}" data-alt="{alt}">'
            f'<script type="application/json">{_json(others)}</script></figure>'
        )


def _charts(drawn: Sequence[Chart], patch: PatchReport) -> Iterator[str]:
    """A figure a chart, with the first frame's values; `data-columns` are those of the table of numbers."""
    column = 1
    for chart in drawn:
        columns = list(range(column, column + len(chart.quantities)))
        column += len(columns)
        legend = "".join(
            f'<div class="{quantity.style}"><dt>{quantity.name}</dt><dd>{quantity.texts[0]}</dd></div>'
            for quantity in chart.quantities
        )
        yield (
            f'<figure class="chart" data-columns="{columns}"><div class="title"><h3>{chart.title}</h3>'
            f'<span class="at quiet">{_moment(patch.frames[0])}</span></div><p class="quiet">{chart.unit}</p>'
            f'{svg(chart, patch.frames)}<dl class="legend">{legend}</dl></figure>'
        )


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


def _data_uri(picture: bytes) -> str:
    return f"data:{_media_type(picture)};base64,{base64.b64encode(picture).decode()}"


def compressed(pixels: np.ndarray) -> bytes:
    """A rendered picture for a page of many frames: some tenth of its PNG. Colours keep their full resolution.

    pixels  uint8 (height, width, 3)
    """
    image = Image.fromarray(pixels)
    image.thumbnail((_PICTURE_WIDTH, image.height))
    with io.BytesIO() as out:
        image.save(out, "JPEG", quality=90, subsampling=0)
        return out.getvalue()
