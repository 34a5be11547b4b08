"""Draws a patch in the cache and slid by each of some rules, side by side, with a row for each view.

usage: pictures.py PICTURE STAGE RULE[,RULE] VIEW[,VIEW] [CAMERA]
The frame is that at which the cache has most stretch. CAMERA is a camera of the stage; without it, one that frames the
patch. The picture is a JPEG or a PNG, by the ending of its name.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Usd

from skinslide.arrays.canvas import Canvas
from skinslide.picture.series import Column, Series, Skin
from skinslide.shot.options import PictureOptions
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

COLUMN, HEIGHT = 480, 480
STRETCH_SCALE = 0.5


def columns(mesh: PatchedMesh, time: Usd.TimeCode, rules: Sequence[str]) -> list[Column]:
    """The cache, and the skin that each rule slides."""
    cached, controls, found = mesh.points_at(time), mesh.controls_at(time), []
    for rule in rules:
        slider = mesh.build([replace(mesh.patches[0], rule=rule)])
        frame = slider.slide(cached, controls)
        result, by_vertex = frame.patches[0], slider.diagnose(cached, frame.points, controls)
        if not found:
            found.append(Column("cache", cached, by_vertex.stretch_before, result.stretch_before))
        found.append(Column(rule, frame.points, by_vertex.stretch_after, result.stretch_after))
    return found


def draw(path: Path, rules: Sequence[str], views: Sequence[str], camera: str | None = None) -> np.ndarray:
    """The picture of a stage: uint8 (height, width, 3)."""
    stage = Usd.Stage.Open(str(path))
    mesh = read_meshes(stage)[0][0]
    slider, size = mesh.slider(), (COLUMN * (1 + len(rules)), HEIGHT)
    times = [Usd.TimeCode(time) for time in mesh.sample_times()]
    worst = max(times, key=lambda time: slider.slide(mesh.points_at(time)).patches[0].stretch_before)
    options = PictureOptions(views=views, camera=camera, follow=camera is None, size=size, stretch_scale=STRETCH_SCALE)
    series = Series.of(Skin.of(mesh, slider.faces(0), None), slider, 0, options, columns=1 + len(rules))
    canvas, shown = Canvas(*size), columns(mesh, worst, rules)
    rows = [series.draw(canvas, view, series.moment(worst), shown, STRETCH_SCALE) for view in views]
    return np.concatenate(rows)[..., :3]


def main() -> None:
    picture, path, rules, views, *camera = sys.argv[1:]
    drawn = draw(Path(path), rules.split(","), views.split(","), *(camera or [None]))
    Image.fromarray(drawn).save(picture, optimize=True, quality=88)
    print(f"{picture}: the cache, {', '.join(rules.split(','))}")


if __name__ == "__main__":
    main()
