"""Draws a character in the cache, with a painted patch under `unit`, and as `setup --whole` sets it up, side by side.

usage: gain.py PICTURE STAGE PAINTED[,PAINTED]
STAGE is what `setup --whole` wrote for the character. Each PAINTED is a stage of the same mesh with one patch, and has
a row for each view, of that patch at the frame of the character's cache at which it stretches most. The numbers are the
stretch of the patch's edges, the same edges in all columns. The picture is a JPEG or a PNG, by the ending of its name.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Usd

sys.path.insert(0, str(Path(__file__).resolve().parent))
from share import Skin as Edges

from skinslide.arrays.canvas import Canvas
from skinslide.arrays.setups import PatchSetup
from skinslide.picture.series import Column, Series, Skin
from skinslide.shot.options import PictureOptions
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

SIZE, COLUMNS = (1020, 300), 3
STRETCH_SCALE = 0.4


def first_mesh(path: str) -> PatchedMesh:
    return read_meshes(Usd.Stage.Open(path))[0][0]


def columns(mesh: PatchedMesh, painted: PatchSetup) -> tuple[Usd.TimeCode, list[Column]]:
    """The worst frame of a painted patch on a character, and the columns drawn of it there."""
    edges, own = Edges.of(mesh, painted.faces), mesh.slider()
    poses = {time: mesh.points_at(Usd.TimeCode(time)) for time in mesh.sample_times()}
    worst = max(poses, key=lambda time: edges.stretch(poses[time][edges.vertices].astype(float)))
    cached, controls = poses[worst], mesh.controls_at(Usd.TimeCode(worst))
    slid = {
        "cache": cached,
        "a painted patch, unit": mesh.build([replace(painted, rule="unit")]).slide(cached).points,
        "nothing painted, even": own.slide(cached, controls).points,
    }
    found = []
    for title, points in slid.items():
        by_vertex = own.diagnose(cached, points, controls).stretch_after
        found.append(Column(title, points, by_vertex, edges.stretch(points[edges.vertices].astype(float))))
    return Usd.TimeCode(worst), found


def draw(path: str, painted: Sequence[str]) -> np.ndarray:
    """The picture: uint8 (height, width, 3)."""
    mesh, canvas, rows = first_mesh(path), Canvas(*SIZE), []
    for each in painted:
        (patch,) = first_mesh(each).patches
        time, shown = columns(mesh, patch)
        slider = mesh.build([patch])
        for view in ("chequer", "stretch"):
            options = PictureOptions(views=view, follow=True, size=SIZE, stretch_scale=STRETCH_SCALE)
            series = Series.of(Skin.of(mesh, patch.faces, None), slider, 0, options, COLUMNS)
            rows.append(series.draw(canvas, view, series.moment(time), shown, STRETCH_SCALE))
    return np.concatenate(rows)[..., :3]


def main() -> None:
    picture, path, painted = sys.argv[1:]
    Image.fromarray(draw(path, painted.split(","))).save(picture, optimize=True, quality=88)
    print(f"{picture}: the cache, a painted patch, and nothing painted")


if __name__ == "__main__":
    main()
