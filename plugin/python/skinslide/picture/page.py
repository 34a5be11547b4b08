"""The report of a shot as one HTML page: pictures and curves of each patch under one scrubber over the frames.

The page loads nothing, from anywhere: its policy allows the one style, the one script, and images within it. It opens
at the frame where sliding removes most stretch. All that is shown of it is in the markup, so that the page reads
without its script and prints.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from skinslide.picture.embedded import kept, media_type
from skinslide.picture.rendering import render
from skinslide.shot.report import BakeReport, PatchReport, time_text


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
        kept=kept(strips, samples),
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


def _check(strip: Strip) -> None:
    where = f"{strip.prim}: patch {strip.patch.label}"
    frames = strip.patch.frames
    if not frames:
        raise ValueError(f"{where}: no frames")
    for view, pictures in strip.pictures.items():
        if len(pictures) != len(frames):
            raise ValueError(f"{where}: {len(pictures)} pictures of {view} for {len(frames)} frames")
        for frame, picture in zip(frames, pictures, strict=True):
            if media_type(picture) is None:
                raise ValueError(f"{where}: frame {time_text(frame)}: the picture of {view} is not a PNG, JPEG or WebP")
