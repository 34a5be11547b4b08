"""Draws what each rule does to a patch: the cache, unit, and relaxed, side by side, chequered above false colours.

usage: rules.py PICTURE STAGE
At the frame where the cache has most stretch.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Usd

from skinslide.meshes import SlidMesh, read_meshes
from skinslide.options import VIEWS, PictureOptions
from skinslide.pictures import Canvas
from skinslide.series import Column, Series

RULES = ("unit", "relaxed")
SIZE = (1440, 560)
MOST_STRETCH = 0.5


def columns(mesh: SlidMesh, time: Usd.TimeCode) -> list[Column]:
    """The cache, and what each rule makes of it."""
    cached, found = mesh.points_at(time), []
    for rule in RULES:
        slider = mesh.build([replace(mesh.patches[0], rule=rule)])
        frame = slider.slide(cached, mesh.controls_at(time))
        result, by_vertex = frame.patches[0], slider.diagnose(cached, frame.points)
        if not found:
            found.append(Column("cache", cached, by_vertex.stretch_before, result.stretch_before))
        found.append(Column(rule, frame.points, by_vertex.stretch_after, result.stretch_after))
    return found


def draw(path: Path) -> np.ndarray:
    """The picture of a stage: uint8 (height, width, 3)."""
    stage = Usd.Stage.Open(str(path))
    mesh = read_meshes(stage)[0][0]
    slider = mesh.slider()
    times = [Usd.TimeCode(time) for time in mesh.sample_times()]
    worst = max(times, key=lambda time: slider.slide(mesh.points_at(time)).patches[0].stretch_before)
    options = PictureOptions.checked(None, VIEWS, None, True, SIZE, "png", None, None, MOST_STRETCH)
    series = Series.of(mesh, slider, 0, options, columns=1 + len(RULES))
    canvas, shown = Canvas(*SIZE), columns(mesh, worst)
    rows = [series.draw(canvas, view, series.moment(worst), shown, MOST_STRETCH) for view in VIEWS]
    return np.concatenate(rows)[..., :3]


def main() -> None:
    picture, path = map(Path, sys.argv[1:])
    Image.fromarray(draw(path)).save(picture, optimize=True)
    print(f"{picture}: the cache, unit and relaxed")


if __name__ == "__main__":
    main()
