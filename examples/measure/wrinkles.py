"""Draws wrinkles where skin is pressed together: the slid skin, and the same with a texture made from its strain.

usage: wrinkles.py PICTURE STAGE [CAMERA]
The frame is that at which skin is pressed together most. The strain maps, as `skinslide maps --strain` writes them,
have for each texel how much skin is pressed and in which direction. The texture is a sum of waves in four fixed
directions, each as high as the skin is pressed along it: ridges lie across the direction of pressing, and blend where
it turns. The picture is a JPEG or a PNG, by the ending of its name.
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Usd

from skinslide.arrays.canvas import Canvas, Viewport
from skinslide.arrays.images import Corners, draw_corner_map, draw_map
from skinslide.picture.lettering import BACKGROUND, columns, write_text
from skinslide.picture.series import Series, Skin
from skinslide.shot.diagnostics import MeshStrain
from skinslide.shot.options import PictureOptions
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

SIZE, TEXELS = (1280, 640), 2048
WAYS = np.pi * np.arange(4) / 4  # the directions of the waves in the texture, as angles
WAVES, DEPTH = 380.0, 1.3  # how many across the texture, and how steep they are
SMOOTH = 0.08  # skin that is pressed by less stays smooth
SKIN = np.array([0.78, 0.58, 0.47])


def strain_maps(mesh: PatchedMesh, slid: np.ndarray, st: np.ndarray) -> dict[str, np.ndarray]:
    """Texels of the first tile, from the top row on; 0 where there is no skin of a patch."""
    strain = MeshStrain(mesh).of(slid)
    faces = np.unique(np.concatenate([patch.faces for patch in mesh.patches])).astype(np.int32)
    corners = Corners(mesh.face_counts, mesh.face_indices, mesh.vertex_count, faces, st)
    found = {name: draw_map(corners, getattr(strain, name), TEXELS)[0] for name in ("largest", "smallest")}
    for name, values in zip(("cosine", "sine"), strain.direction.T, strict=True):
        found[name] = draw_corner_map(corners, np.ascontiguousarray(values), TEXELS)
    return found


def height(maps: dict[str, np.ndarray]) -> np.ndarray:
    """The height of the wrinkles by texel: for each direction a wave along it, as high as skin is pressed in it."""
    down, across = np.mgrid[0:TEXELS, 0:TEXELS] / TEXELS
    wobble = 0.9 * np.sin(40 * across + 23 * down) + 0.7 * np.sin(31 * down - 17 * across)
    total = np.zeros((TEXELS, TEXELS))
    for way in WAYS:
        share = (1 + maps["cosine"] * np.cos(2 * way) + maps["sine"] * np.sin(2 * way)) / 2
        squared = maps["smallest"] ** 2 + (maps["largest"] ** 2 - maps["smallest"] ** 2) * share
        pressed = np.where(maps["largest"] > 0, np.clip(1 - SMOOTH - np.sqrt(squared), 0, 0.6), 0)
        total += pressed * np.sin(2 * np.pi * WAVES * (across * np.cos(way) - down * np.sin(way)) + wobble)
    return total


def shaded(relief: np.ndarray) -> np.ndarray:
    """A texture with the relief lit from above: uint8 (texels, texels, 4)."""
    slope = TEXELS / (2 * np.pi * WAVES) * DEPTH * np.stack(np.gradient(relief))
    normal = np.stack([-slope[1], slope[0], np.ones_like(relief)]) / np.sqrt(1 + (slope**2).sum(axis=0))
    light = np.clip(np.einsum("i,ijk->jk", np.array([-0.35, 0.6, 0.72]), normal) / 0.72, 0.15, 1.5)
    colour = np.clip(255 * SKIN * np.minimum(light, 1.25)[..., None], 0, 255)
    return np.concatenate([colour, np.full_like(colour[..., :1], 255)], axis=2).astype(np.uint8)


def draw(path: Path, camera: str | None = None) -> np.ndarray:
    """The picture of a stage: uint8 (height, width, 3)."""
    mesh = read_meshes(Usd.Stage.Open(str(path)))[0][0]
    slider, strain = mesh.slider(), MeshStrain(mesh)
    times = [Usd.TimeCode(time) for time in mesh.sample_times()]
    slid = {time: slider.slide(mesh.points_at(time), mesh.controls_at(time)).points for time in times}
    worst = min(times, key=lambda time: np.sort(strain.of(slid[time]).smallest)[:50].mean())
    options = PictureOptions(views="chequer", camera=camera, follow=camera is None, size=SIZE)
    skin = Skin.of(mesh, slider.faces(0), None)
    series, canvas = Series.of(skin, slider, 0, options), Canvas(*SIZE)
    moment, texture = series.moment(worst), shaded(height(strain_maps(mesh, slid[worst], skin.st)))
    plain = shaded(np.zeros((TEXELS, TEXELS)))
    canvas.clear(BACKGROUND)
    places = columns(*SIZE, 2)
    for pixels, place in zip((plain, texture), places, strict=True):
        _draw_one(canvas, series, slid[worst], moment, place, pixels)
    picture = canvas.read()
    for title, place in zip(("slid", "slid, wrinkled by its strain"), places, strict=True):
        write_text(picture, [title], place)
    return picture[..., :3]


def _draw_one(canvas: Canvas, series: Series, points: np.ndarray, moment, place: Viewport, pixels: np.ndarray) -> None:
    canvas.draw(
        series.skin.tessellation,
        points,
        moment.camera,
        place,
        to_world=moment.to_world,
        double_sided=series.skin.double_sided,
        left_handed=series.skin.left_handed,
        texture={1001: pixels},
        line=0.01,
    )


def main() -> None:
    picture, path, *camera = sys.argv[1:]
    Image.fromarray(draw(Path(path), *camera)).save(picture, optimize=True, quality=88)
    print(f"{picture}: wrinkles where skin is pressed together")


if __name__ == "__main__":
    main()
