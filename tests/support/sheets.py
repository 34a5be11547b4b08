"""A flat sheet whose squares can all be seen, previews of it, and what they show."""

import numpy as np
from PIL import Image
from pxr import Gf, Sdf, Usd, Vt

import skinslide
import stages
from stages import FRAMES, PATCH

SIZE = (480, 270)
NAME = f"skin_GEO.{PATCH}"


def sheet(columns=24, faces=None, st=True):
    """A flat sheet that is stretched in its plane, so that all its squares can be seen. Its middle is the patch."""
    shape = stages.grid(columns, columns)
    shape.points[:, 2] = 0
    margin = range(3, columns - 3)
    stage, mesh = stages.patched_stage(shape, stages.block(columns, margin, margin) if faces is None else faces)
    for frame in FRAMES:
        moved = shape.points.copy()
        x, y = moved[:, 0], moved[:, 1]
        inside = np.maximum(0, 0.375**2 - x**2) * np.maximum(0, 0.375**2 - y**2) / 0.375**4
        moved[:, 0] += 0.08 * (frame - FRAMES[0]) * inside * (1 + x)
        mesh.GetPointsAttr().Set(stages.vectors(moved), frame)
    if st:
        add_st(mesh, shape)
    return stage, mesh


def add_st(mesh, shape, name="st"):
    corners = shape.points[shape.indices][:, :2] + 0.5
    stages.set_primvar(
        mesh,
        name,
        Sdf.ValueTypeNames.TexCoord2fArray,
        "faceVarying",
        Vt.Vec2fArray.FromNumpy(corners.astype(np.float32)),
    )


def draw(stage, folder, **options):
    options = {"size": SIZE, "views": "chequer", "squares": 16, **options}
    return skinslide.preview(stage if isinstance(stage, Usd.Stage) else str(stage), folder, **options)


def picture(folder, view="chequer", frame="1003", name=NAME):
    with Image.open(folder / f"{name}.{view}.{frame}.png") as image:
        return np.array(image)


def halves(pixels):
    """The halves before and after, without the titles in their corners."""
    width = pixels.shape[1] // 2
    clear = slice(pixels.shape[0] // 5, -pixels.shape[0] // 5)
    return pixels[clear, :width].astype(int), pixels[clear, width:].astype(int)


def contrast(pixels):
    return int(np.ptp(pixels, axis=(0, 1)).max())


def projected(stage, vertices, points, size):
    """Where points are on one half of a picture, with the tool's camera but by USD's own matrices."""
    from skinslide.picture.cameras import ShotCamera
    from skinslide.stage.reading import read_meshes

    mesh = read_meshes(stage)[0][0]
    camera = ShotCamera(mesh, mesh.patches[0].faces, size[0] / 2 / size[1]).camera(Usd.TimeCode(FRAMES[-1]))
    matrix = Gf.Matrix4d(camera.to_camera) * Gf.Matrix4d(camera.to_screen)
    seen = np.array([matrix.Transform(Gf.Vec3d(*map(float, points[vertex])))[:2] for vertex in vertices])
    return (seen * [0.5, -0.5] + 0.5) * [size[0] / 2, size[1]]
