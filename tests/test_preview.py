"""Pictures of a shot: what is on them, where they go, and what cannot be drawn."""

import importlib.util
import io
import json
import math
import os
import subprocess
import sys
import textwrap
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Gf, Sdf, Ts, Usd, UsdGeom, Vt
from scipy import ndimage

import skinslide
import stages
from skinslide.cli import main
from skinslide.images import decode_exr
from stages import FRAMES, PATCH

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
SIZE = (480, 270)
NAME = f"skin_GEO.{PATCH}"


def sheet(columns=24, faces=None, st=True):
    """A flat sheet that is stretched in its plane, so that every square of it can be seen; its middle is the patch."""
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


@pytest.fixture
def shot(tmp_path):
    return stages.save(sheet()[0], tmp_path / "shot.usda")


def draw(stage, folder, **options):
    options = {"size": SIZE, "views": "chequer", "squares": 16, **options}
    return skinslide.preview(stage if isinstance(stage, Usd.Stage) else str(stage), folder, **options)


def picture(folder, view="chequer", frame="1003", name=NAME):
    with Image.open(folder / f"{name}.{view}.{frame}.png") as image:
        return np.array(image)


def halves(pixels):
    """Before and after, without the titles that stand in their corners."""
    width = pixels.shape[1] // 2
    clear = slice(pixels.shape[0] // 5, -pixels.shape[0] // 5)
    return pixels[clear, :width].astype(int), pixels[clear, width:].astype(int)


def contrast(pixels):
    return int(np.ptp(pixels, axis=(0, 1)).max())


def projected(stage, vertices, points, size):
    """Where points are on one half of a picture by the camera that the tool finds: by hand, with USD's own matrices."""
    from skinslide.cameras import ShotCamera
    from skinslide.meshes import read_meshes

    mesh = read_meshes(stage)[0][0]
    camera = ShotCamera(mesh, mesh.patches[0].faces, size[0] / 2 / size[1]).camera(Usd.TimeCode(FRAMES[-1]))
    matrix = Gf.Matrix4d(camera.to_camera) * Gf.Matrix4d(camera.to_screen)
    seen = np.array([matrix.Transform(Gf.Vec3d(*map(float, points[vertex])))[:2] for vertex in vertices])
    return (seen * [0.5, -0.5] + 0.5) * [size[0] / 2, size[1]]


# ---- What is drawn ----


def test_files_are_named_by_mesh_patch_view_and_frame(shot, tmp_path):
    report = draw(shot, tmp_path / "out" / "deep", views=("chequer", "stretch"), frames="1001-1003x0.5")
    names = {f"{NAME}.{view}.{frame}.png" for view in ("chequer", "stretch") for frame in
             ("1001", "1001_5", "1002", "1002_5", "1003")}  # fmt: skip
    made = {path.name for path in (tmp_path / "out" / "deep").iterdir()}
    assert made == {*names, "contact_sheet.1001-1003.png"} == {os.path.basename(file) for file in report.files}
    for view in ("chequer", "stretch"):
        assert picture(tmp_path / "out" / "deep", view, "1001_5").shape == (SIZE[1], SIZE[0], 3)


def test_at_rest_both_halves_are_the_same(shot, tmp_path):
    draw(shot, tmp_path, frames="1001")
    before, after = halves(picture(tmp_path, frame="1001"))
    assert contrast(before) > 100
    assert np.mean(before != after) < 1e-3  # rounding by where on the canvas an edge is


def test_only_the_patch_changes(tmp_path):
    """Pixels that differ lie within the projection of the patch, and far from all of it stays."""
    stage, mesh = sheet()
    draw(stage, tmp_path)
    changed = np.abs(np.subtract(*halves(picture(tmp_path)))).sum(axis=2) > 8
    points = np.array(mesh.GetPointsAttr().Get(FRAMES[-1]))
    patch = np.flatnonzero((np.abs(np.array(mesh.GetPointsAttr().Get())[:, :2]) <= 0.375 + 1e-6).all(axis=1))
    corners = projected(stage, patch, points, SIZE) - [0, SIZE[1] // 5]
    low, high = corners.min(axis=0), corners.max(axis=0)
    rows, columns = np.nonzero(changed)
    assert len(rows) > 200
    assert columns.min() >= low[0] - 1 and columns.max() <= high[0] + 1
    assert rows.min() >= low[1] - 1 and rows.max() <= high[1] + 1


def cell_areas(half):
    """Areas of the chequer's whole cells in the patch, which is drawn with more contrast than what is outside."""
    light, dark = half.min(axis=2) > 140, half.max(axis=2) < 90
    height, width = light.shape
    areas = []
    for cells in (light, dark):
        labels, count = ndimage.label(ndimage.binary_erosion(cells))
        for number, box in enumerate(ndimage.find_objects(labels), start=1):
            whole = box[0].start > 1 and box[1].start > 1 and box[0].stop < height - 1 and box[1].stop < width - 1
            areas += [np.count_nonzero(labels[box] == number)] if whole else []
        assert count
    return np.array([area for area in areas if area > 20])


def test_cells_of_the_chequer_become_more_alike(tmp_path):
    stage, _mesh = sheet()
    draw(stage, tmp_path, size=(1920, 1080), squares=24)
    before, after = (cell_areas(half) for half in halves(picture(tmp_path)))
    assert len(before) > 30 and len(after) > 30
    spread = [np.std(areas) / np.mean(areas) for areas in (before, after)]
    assert spread[1] < 0.8 * spread[0]


def test_stretch_is_shown_by_colour(tmp_path):
    """The frame at rest has one colour in all of the patch, that of no stretch; a stretched one has many."""
    stage, _mesh = sheet()
    draw(stage, tmp_path, views="stretch", most_stretch=0.2)
    middles = [
        half[20:-20, 60:-60] for frame in ("1001", "1003") for half in halves(picture(tmp_path, "stretch", frame))
    ]
    hues = [np.ptp(middle[..., 0] - middle[..., 2]) for middle in middles]
    assert max(hues[:2]) < 10 and min(hues[2:]) > 60


def test_a_subdivided_mesh_is_drawn_as_its_limit_surface(tmp_path):
    """A cube's limit surface is well inside the cube: fewer pixels are drawn of it."""
    drawn = []
    for scheme in ("none", "catmullClark"):
        stage, mesh = stages.patched_stage(stages.box(), np.array([1]))
        mesh.GetSubdivisionSchemeAttr().Set(scheme)
        (tmp_path / scheme).mkdir()
        draw(stage, tmp_path / scheme, frames="1001")
        before, _after = halves(picture(tmp_path / scheme, frame="1001"))
        drawn.append(np.count_nonzero(np.abs(before - before[0, 0]).sum(axis=2) > 6))
    assert 0 < drawn[1] < 0.9 * drawn[0]


def test_pieces_and_meshes_of_one_name_have_pictures_of_their_own(tmp_path):
    stage, _mesh = stages.patched_stage(faces=stages.two_pieces())
    other = stages.add_mesh(stage, stages.grid(), "/World/other/geo/skin_GEO")
    stages.add_patch(other, stages.grid().all_faces)
    report = draw(stage, tmp_path, frames="1002")
    names = {os.path.basename(file) for file in report.files}
    assert {"char.geo.skin_GEO.elbow_L.1.chequer.1002.png", "char.geo.skin_GEO.elbow_L.2.chequer.1002.png",
            "other.geo.skin_GEO.elbow_L.chequer.1002.png", "contact_sheet.1002.png"} == names  # fmt: skip


def test_a_cache_without_samples_has_one_picture(tmp_path):
    stage, mesh = sheet()
    for frame in FRAMES:
        mesh.GetPointsAttr().ClearAtTime(frame)
    report = draw(stage, tmp_path)
    assert [os.path.basename(file) for file in report.files] == [f"{NAME}.chequer.png", "contact_sheet.png"]


def test_what_is_kept_for_a_sheet_is_small(shot, tmp_path, monkeypatch):
    """Of each patch and view some pictures are kept to the end: in far less than their pixels would take."""
    kept = []
    module = sys.modules["skinslide.preview"]  # skinslide.preview is the function
    monkeypatch.setattr(module, "contact_sheets", lambda strips: kept.extend(strips) or [])
    draw(shot, tmp_path, views=("chequer", "stretch"))
    assert [len(strip) for strip in kept] == [len(FRAMES)] * 2
    assert sum(len(file) for strip in kept for file in strip) < 0.25 * 6 * 3 * SIZE[0] * SIZE[1]


def test_a_contact_sheet_has_a_row_of_each_view(shot, tmp_path):
    """Thumbnails are as wide as these pictures: each stands there as it is."""
    draw(shot, tmp_path, views=("chequer", "stretch"))
    with Image.open(tmp_path / "contact_sheet.png") as image:
        found = np.array(image)
    (width, height), margin = SIZE, 12
    for row, view in enumerate(("chequer", "stretch")):
        for column, frame in enumerate(("1001", "1002", "1003")):
            top, left = margin + row * (height + margin), margin + column * (width + margin)
            part = found[top : top + height, left : left + width]
            np.testing.assert_array_equal(part, picture(tmp_path, view, frame))


def test_a_spline_without_knots_is_no_sample(tmp_path):
    """It might vary, for all that USD says, but gives no frame: a bake and maps have one value, pictures one frame."""
    stage, mesh = sheet()
    mesh.GetPointsAttr().Set(mesh.GetPointsAttr().Get(1003.0))
    for frame in FRAMES:
        mesh.GetPointsAttr().ClearAtTime(frame)
    mesh.GetPrim().GetAttribute(f"skinSlide:{PATCH}:envelope").SetSpline(Ts.Spline("float"))
    shot = stages.save(stage, tmp_path / "shot.usda")
    for report in (
        draw(shot, tmp_path / "out"),
        skinslide.maps(shot, tmp_path / "out", size=16),
        skinslide.bake_to_file(shot, tmp_path / "slid.usda"),
    ):
        assert report.meshes[0].patches[0].frames == [None]


def test_pictures_do_not_depend_on_their_neighbours(shot, tmp_path):
    for folder, options in {"all": {"jobs": 3}, "one": {"jobs": 1}, "alone": {"frames": "1003"}}.items():
        draw(shot, tmp_path / folder, views=("chequer", "stretch"), **options)
    for view in ("chequer", "stretch"):
        files = [(tmp_path / folder / f"{NAME}.{view}.1003.png").read_bytes() for folder in ("all", "one", "alone")]
        assert len(set(files)) == 1


@pytest.mark.parametrize("size", [(2, 1), (2, 2), (3, 3), (100, 4), (101, 7), (16384, 2), (2, 2000)])
def test_pictures_of_any_size(size, shot, tmp_path):
    report = draw(shot, tmp_path, size=size, views=("chequer", "stretch"), frames="1002", html=tmp_path / "page.html")
    assert report.pictures == 2 and picture(tmp_path, "stretch", "1002").shape == (size[1], size[0], 3)


def test_exr_is_the_same_picture_in_linear_light(shot, tmp_path):
    """A level of sRGB is at most 0.6 % of full light, half floats are finer, and the edges of cells blend otherwise."""
    draw(shot, tmp_path, frames="1003")
    draw(shot, tmp_path, frames="1003", form="exr")
    data = (tmp_path / f"{NAME}.chequer.1003.exr").read_bytes()
    linear = np.stack([decode_exr(data, channel).pixels for channel in "RGB"], axis=2)
    encoded = picture(tmp_path) / 255
    decoded = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    off = np.abs(halves(decoded * 1000)[0] - halves(linear * 1000)[0]).max(axis=2)
    assert np.median(off) <= 6 and np.mean(off > 12) < 0.12


def test_nothing_else_is_written(shot, tmp_path):
    stage = skinslide.preview  # the function, on an open stage
    opened = Usd.Stage.Open(str(shot))
    before = opened.GetRootLayer().ExportToString(), shot.read_bytes()
    stage(opened, tmp_path / "out", size=SIZE, frames="1003")
    assert (opened.GetRootLayer().ExportToString(), shot.read_bytes()) == before
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".png"}


def load(path: Path):
    spec = importlib.util.spec_from_file_location(f"loaded_{path.parent.name}_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["elbow", "sleeve", "face"])
def test_the_examples_pictures_are_as_made(name, tmp_path):
    """Those beside the examples are what run.sh makes: JPEG is off by some levels, another device at some edges."""
    chosen = (["unit"], ["chequer"]) if name == "elbow" else (["unit", "relaxed"], ["chequer", "stretch"])
    stage = load(EXAMPLES / name / "make.py").make(tmp_path)
    drawn = load(EXAMPLES / "pictures.py").draw(stage, *chosen).astype(int)
    with Image.open(EXAMPLES / f"{name}.jpg") as image:
        kept = np.array(image).astype(int)
    assert kept.shape == drawn.shape
    assert np.abs(kept - drawn).mean() < 3


# ---- From where ----


def test_a_camera_of_the_stage_is_used(tmp_path):
    """A camera that looks past the mesh sees nothing of it; one that looks at it does; its animation counts."""
    stage, _mesh = sheet()
    camera = UsdGeom.Camera.Define(stage, "/World/cam")
    translate = camera.AddTranslateOp()
    translate.Set((0, 0, 2), 1001)
    translate.Set((50, 0, 2), 1003)
    camera.CreateFocalLengthAttr(35)
    draw(stage, tmp_path, camera="/World/cam")
    seen = [contrast(halves(picture(tmp_path, frame=frame))[0]) for frame in ("1001", "1003")]
    assert seen[0] > 100 and seen[1] == 0


@pytest.mark.parametrize("size", [(400, 300), (800, 300), (300, 400)])
def test_a_camera_shows_its_own_view_in_every_picture(size, tmp_path):
    """A sheet as wide and high as the camera's view is seen to its edges, on the shorter side of each half."""
    stage, _mesh = sheet()
    own = Gf.Camera(Gf.Matrix4d().SetTranslate((0, 0, 10)))
    own.SetOrthographicFromAspectRatioAndSize(1.0, 1.0, Gf.Camera.FOVHorizontal)
    UsdGeom.Camera.Define(stage, "/World/cam").SetFromCamera(own, Usd.TimeCode.Default())
    draw(stage, tmp_path, camera="/World/cam", size=size, frames="1001")
    left = picture(tmp_path, frame="1001")[:, : size[0] // 2].astype(int)
    drawn = np.abs(left - [59, 59, 63]).sum(axis=2) > 12  # the background
    side = min(size[0] // 2, size[1])
    across = np.count_nonzero(drawn[size[1] // 2]), np.count_nonzero(drawn[:, size[0] // 4])  # past the titles
    assert max(abs(count - side) for count in across) <= 3


def test_following_frames_the_patch_anew(tmp_path):
    """A mesh that flies away stays in the middle of the picture."""
    stage, mesh = sheet()
    UsdGeom.Xformable(mesh).AddTranslateOp().Set((30, 0, 0), 1003)
    UsdGeom.Xformable(mesh).GetOrderedXformOps()[0].Set((0, 0, 0), 1001)
    draw(stage, tmp_path, follow=True)
    follow = [contrast(halves(picture(tmp_path, frame=frame))[0]) for frame in ("1001", "1003")]
    draw(stage, tmp_path / "still")
    still = np.mean(np.abs(np.diff(halves(picture(tmp_path / "still", frame="1001"))[0], axis=1)))
    moved = np.mean(np.abs(np.diff(halves(picture(tmp_path, frame="1001"))[0], axis=1)))
    assert min(follow) > 100 and moved > 2 * still


def test_the_camera_does_not_depend_on_the_frames_drawn(shot, tmp_path):
    draw(shot, tmp_path / "a", frames="1001-1002")
    draw(shot, tmp_path / "b", frames="1002")
    name = f"{NAME}.chequer.1002.png"
    assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def camera_stage(**values):
    """A sheet, and a camera that looks at it, with some attributes of its own."""
    stage, _mesh = sheet()
    camera = UsdGeom.Camera.Define(stage, "/World/cam")
    camera.AddTransformOp().Set(values.pop("transform", Gf.Matrix4d().SetTranslate((0, 0, 2))))
    for name, value in values.items():
        camera.GetPrim().GetAttribute(name).Set(value)
    return stage


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"horizontalAperture": 0.0}, "horizontalAperture is 0; it must be above 0"),
        ({"verticalAperture": -20.0}, "verticalAperture is -20; it must be above 0"),
        ({"horizontalAperture": math.nan}, "horizontalAperture is nan; it must be above 0"),
        ({"verticalAperture": math.inf, "projection": "orthographic"}, "verticalAperture is inf; it must be above 0"),
        ({"focalLength": 0.0}, "focalLength is 0; it must be above 0"),
        ({"focalLength": math.nan}, "focalLength is nan; it must be above 0"),
        ({"clippingRange": Gf.Vec2f(0, 100)}, "clippingRange is (0, 100); it must ascend, from above 0"),
        ({"clippingRange": Gf.Vec2f(100, 1)}, "clippingRange is (100, 1); it must ascend, from above 0"),
        ({"clippingRange": Gf.Vec2f(1, 1), "projection": "orthographic"}, "clippingRange is (1, 1); it must ascend"),
        ({"clippingRange": Gf.Vec2f(1, math.inf)}, "clippingRange is (1, inf); it must ascend"),
        ({"transform": Gf.Matrix4d(math.nan)}, "its transform to the world has no inverse"),
        ({"transform": Gf.Matrix4d().SetScale((1, 1, 0))}, "its transform to the world has no inverse"),
    ],
)  # fmt: skip
def test_a_camera_that_sees_nothing(values, message, tmp_path, capfd):
    path = str(stages.save(camera_stage(**values), tmp_path / "shot.usda"))
    words = ["--camera", "/World/cam", "--size", "64x32", "--frames", "1002"]
    assert main(["preview", path, "-o", str(tmp_path / "out"), *words]) == 3
    where = f"error: {stages.MESH}: patch {PATCH}: frame 1002: camera /World/cam: "
    assert capfd.readouterr().err.startswith(where + message)
    assert not (tmp_path / "out").exists()


def test_an_orthographic_camera_may_see_what_is_behind_it(tmp_path):
    stage = camera_stage(projection="orthographic", clippingRange=Gf.Vec2f(-10, 10))
    draw(stage, tmp_path, camera="/World/cam", frames="1001")
    assert contrast(halves(picture(tmp_path, frame="1001"))[0]) > 100


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (Gf.Matrix4d(math.nan), "its transform to the world is not finite"),
        (Gf.Matrix4d(0), "no camera can have the faces in sight"),
    ],
)
@pytest.mark.parametrize("frame", [None, 1001.0, 1003.0])
def test_a_mesh_that_is_nowhere(frame, matrix, message, tmp_path, capfd):
    """At all, or at a frame, which the message names."""
    stage, mesh = sheet()
    transform = UsdGeom.Xformable(mesh).AddTransformOp()
    if frame is None:
        transform.Set(matrix)
    else:
        transform.Set(Gf.Matrix4d(1), 1002.0)
        transform.Set(matrix, frame)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    words = ["--size", "64x32", *([] if frame is None else ["--follow"])]
    assert main(["preview", path, "-o", str(tmp_path / "out"), *words]) == (3 if frame is None else 1)
    said = capfd.readouterr().err
    assert f"error: {stages.MESH}: " in said and message in said
    assert frame is None or f": frame {frame:g}: " in said


def test_a_pose_that_no_camera_of_a_shot_can_have(tmp_path, capfd):
    stage, mesh = sheet()
    points = np.array(mesh.GetPointsAttr().Get(1003.0))
    points[5] = np.nan
    mesh.GetPointsAttr().Set(stages.vectors(points), 1003.0)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x32"]) == 3
    assert f"error: {stages.MESH}: frame 1003: points: vertex 5 is not finite" in capfd.readouterr().err


def test_a_mesh_that_is_nowhere_at_a_frame_of_the_shot(tmp_path, capfd):
    """The camera of a shot is framed by all of it."""
    stage, mesh = sheet()
    transform = UsdGeom.Xformable(mesh).AddTransformOp()
    transform.Set(Gf.Matrix4d(1), 1002.0)
    transform.Set(Gf.Matrix4d(math.nan), 1003.0)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x32", "--frames", "1001"]) == 3
    assert f"error: {stages.MESH}: frame 1003: its transform to the world is not finite" in capfd.readouterr().err


# ---- What the chequer follows ----


def test_without_st_the_chequer_is_at_rest_in_space(tmp_path):
    stage, _mesh = sheet(st=False)
    draw(stage, tmp_path, squares=16)
    before, after = halves(picture(tmp_path))
    assert contrast(before) > 100 and not np.array_equal(before, after)


def test_a_named_primvar_must_be_there(tmp_path, capfd):
    stage, _mesh = sheet()
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--st", "uv2", "--size", "64x64"]) == 3
    assert f"{stages.MESH}: patch {PATCH}: there is no primvars:uv2" in capfd.readouterr().err
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


@pytest.mark.parametrize("extent", [1e-42, 3e38])
def test_texture_coordinates_of_any_extent(extent, tmp_path):
    """As far as floats go, the chequer of a patch has squares that a figure may have."""
    stage, mesh = sheet(st=False)
    corners = np.repeat(np.sign(stages.grid(24, 24).points[stages.grid(24, 24).indices][:, :1]) * extent, 2, axis=1)
    kind = Sdf.ValueTypeNames.TexCoord2fArray
    stages.set_primvar(mesh, "st", kind, "faceVarying", Vt.Vec2fArray.FromNumpy(corners.astype(np.float32)))
    with warnings.catch_warnings(action="error"):
        assert draw(stage, tmp_path, frames="1002", squares=None).pictures == 1


@pytest.mark.parametrize("name", ["st", "uv2"])
@pytest.mark.parametrize("fault", ["short", "index", "nan"])
def test_bad_texture_coordinates(fault, name, tmp_path, capfd):
    stage, mesh = sheet(st=False)
    add_st(mesh, stages.grid(24, 24), name)
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar(name)
    values = np.array(primvar.Get())
    if fault == "short":
        primvar.Set(Vt.Vec2fArray.FromNumpy(values[:-1]))
    elif fault == "nan":
        values[7] = np.nan
        primvar.Set(Vt.Vec2fArray.FromNumpy(values))
    else:
        primvar.SetIndices(Vt.IntArray.FromNumpy(np.full(len(values), len(values), np.int32)))
    words = [] if name == "st" else ["--st", name]
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x64", *words]) == 3
    said = capfd.readouterr().err
    assert f"error: {stages.MESH}: patch {PATCH}: primvars:{name}" in said
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


# ---- What cannot be ----


def test_the_command_reports(shot, tmp_path, capfd):
    out = str(tmp_path / "out")
    assert main(["preview", str(shot), "-o", out, "--frames", "1003", "--size", "64x32", "--json", "--quiet"]) == 0
    told = json.loads(capfd.readouterr().out)
    assert sorted(os.listdir(out)) == sorted(os.path.basename(file) for file in told["files"])
    assert told["device"] and told["meshes"][0]["patches"][0]["frames"][0]["frame"] == 1003


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--camera", "/World/char", "--follow"], "does not follow"),
        (["--size", "0x10"], "width is 0"),
        (["--size", "20000x20000"], "20000 by 20000 pixels"),
        (["--size", "ten"], "not a size such as 1920x1080"),
        (["--squares", "-1"], "squares is -1"),
        (["--squares", "1e39"], "squares is 1e+39"),
        (["--most-stretch", "nan"], "most_stretch is nan"),
        (["--most-stretch", "1e-38"], "most_stretch is 1e-38"),
        (["--view", "wire"], "invalid choice"),
        (["--st", ""], "st: the name of the primvar with texture coordinates is empty"),
    ],
)
def test_usage(words, message, shot, tmp_path, capfd):
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), *words]) == 2
    assert message in capfd.readouterr().err
    assert not (tmp_path / "out").exists() or not list((tmp_path / "out").iterdir())


@pytest.mark.parametrize("rate", [0.0, -24.0, math.nan])
def test_a_stage_that_cannot_be_played_has_no_page(rate, tmp_path, capfd):
    stage, _mesh = sheet()
    stage.SetTimeCodesPerSecond(rate)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    words = ["--size", "64x32", "--frames", "1002", "-o", str(tmp_path / "out")]
    assert main(["preview", path, *words, "--html", str(tmp_path / "page.html")]) == 3
    assert f"error: the stage has {rate:g} time codes per second" in capfd.readouterr().err
    assert not (tmp_path / "out").exists() and not (tmp_path / "page.html").exists()
    assert main(["preview", path, *words]) == 0


@pytest.mark.parametrize("size", [None, 64, (64, 32, 3), "64x32"])
def test_what_is_no_size(size, shot, tmp_path):
    with pytest.raises(skinslide.UsageError, match=r"size is .*; it must be a width and a height"):
        draw(shot, tmp_path / "out", size=size)


def test_a_camera_by_a_path_of_usd(tmp_path):
    draw(camera_stage(), tmp_path, camera=Sdf.Path("/World/cam"), frames="1001")
    assert contrast(halves(picture(tmp_path, frame="1001"))[0]) > 100


def test_no_views(shot, tmp_path):
    with pytest.raises(skinslide.UsageError, match="views: there are none"):
        draw(shot, tmp_path / "out", views=[])


def test_neither_folder_nor_page(shot, capfd):
    assert main(["preview", str(shot)]) == 2
    assert "no folder for pictures (-o) and no page (--html)" in capfd.readouterr().err


def test_a_page_that_cannot_be(shot, tmp_path, capfd):
    for page in (tmp_path / "page.txt", tmp_path / "none" / "page.html", shot.with_suffix(".html") / "page.html"):
        assert main(["preview", str(shot), "--html", str(page), "--size", "64x32"]) == 2
        assert f"output {page}: " in capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--camera", "/World/none"], f"{stages.MESH}: patch {PATCH}: camera /World/none: there is no such prim"),
        (["--camera", "World"], f"patch {PATCH}: camera World: there is no such prim"),
        (["--camera", "/World/char"], f"patch {PATCH}: camera /World/char: is a Xform, no Camera"),
        (["--patch", "knee"], f"patch knee: no mesh has it; there are {PATCH}"),
    ],
)
def test_what_the_stage_lacks(words, message, shot, tmp_path, capfd):
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), *words]) == 3
    assert message in capfd.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be(shot, tmp_path, capfd):
    (tmp_path / "file").write_text("")
    for folder, code in ((tmp_path / "file", 2), (tmp_path / "file" / "below", 2), ("/proc/none", 1)):
        assert main(["preview", str(shot), "-o", str(folder)]) == code
        assert f"output {folder}: " in capfd.readouterr().err


def test_a_folder_without_a_name(shot, tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for words in (["preview", "--size", "64x32"], ["maps", "--size", "8"]):
        assert main([*words, str(shot), "-o", ""]) == 2
        assert capfd.readouterr().err == "error: output: the name of the folder is empty\n"
    assert os.listdir(tmp_path) == [shot.name]


def test_a_link_to_a_folder_that_is_not_there_yet(shot, tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "disk" / "pictures")
    draw(shot, tmp_path / "link", frames="1003")
    assert picture(tmp_path / "disk" / "pictures").shape == (SIZE[1], SIZE[0], 3)


def test_a_page_in_the_folder_of_the_pictures(shot, tmp_path):
    """Which is made for both."""
    draw(shot, tmp_path / "out", frames="1003", html=tmp_path / "out" / "page.html")
    assert sorted(os.listdir(tmp_path / "out")) == ["contact_sheet.1003.png", "page.html", f"{NAME}.chequer.1003.png"]


def test_a_name_that_is_too_long(tmp_path, capfd):
    """For a file of a folder that is not there yet."""
    stage, _mesh = sheet()
    path = f"{stages.MESH}{'x' * 250}"
    other = stages.add_mesh(stage, stages.grid(), path)
    stages.add_patch(other, stages.grid().all_faces)
    add_st(other, stages.grid())
    shot, out = str(stages.save(stage, tmp_path / "shot.usda")), tmp_path / "out"
    for words in (["preview", "--size", "64x32"], ["maps", "--size", "8"]):
        assert main([*words, shot, "-o", str(out)]) == 2
        said = capfd.readouterr().err
        assert said.startswith(f"error: output {out / Path(path).name}.") and said.endswith("the name is too long\n")
    assert not out.exists()


def test_an_unwritable_folder(public_folder, capfd):
    path = str(stages.save(sheet()[0], public_folder / "shot.usda"))
    closed = public_folder / "closed"
    closed.mkdir(mode=0o555)
    with stages.as_nobody():
        assert main(["preview", path, "-o", str(closed)]) == 2
    assert f"output {closed}: is not writable" in capfd.readouterr().err


def test_a_patch_that_cannot_be_followed(tmp_path, capfd):
    """At a frame where all of it is in one place."""
    stage, mesh = sheet()
    scale = UsdGeom.Xformable(mesh).AddScaleOp()
    scale.Set((1, 1, 1), 1002)
    scale.Set((0, 0, 0), 1003)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x32", "--follow"]) == 1
    assert f"error: {stages.MESH}: patch {PATCH}: frame 1003: no camera can have" in capfd.readouterr().err
    assert (tmp_path / "out" / f"{NAME}.chequer.1002.png").exists()


@pytest.mark.parametrize("name", [f"{NAME}.stretch.1003.png", "contact_sheet.png"])
def test_a_folder_in_the_way_of_a_picture(name, shot, tmp_path, capfd):
    """Known before a frame is slid."""
    (tmp_path / "out" / name).mkdir(parents=True)
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), "--size", "64x32"]) == 2
    assert f"output {tmp_path / 'out' / name}: is a folder" in capfd.readouterr().err
    assert os.listdir(tmp_path / "out") == [name]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-o", "out"], "; every file in out is whole"),
        (["-o", "out", "--html", "page.html"], "; every file in out is whole"),
        (["--html", "page.html"], "; nothing was written"),
    ],
)
def test_an_interrupted_command_says_what_it_left(words, said, shot, tmp_path, capfd, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("skinslide.meshpictures.work_ahead", interrupt)
    assert main(["preview", str(shot), "--size", "64x32", *words]) == 130
    assert capfd.readouterr().err == f"error: interrupted{said}\n"
    assert not list(tmp_path.glob("**/.*")) and not (tmp_path / "page.html").exists()


def test_a_bad_frame_leaves_the_others_whole(tmp_path, capfd):
    stage, mesh = sheet()
    points = np.array(mesh.GetPointsAttr().Get(1003.0))
    points[5] = np.nan
    mesh.GetPointsAttr().Set(stages.vectors(points), 1003.0)
    out = tmp_path / "out"
    camera = UsdGeom.Camera.Define(stage, "/World/cam")
    camera.AddTranslateOp().Set((0, 0, 2))
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(out), "--size", "64x32", "--camera", "/World/cam"]) == 1
    assert f"{stages.MESH}: frame 1003: " in capfd.readouterr().err
    for file in out.iterdir():
        Image.open(io.BytesIO(file.read_bytes())).load()


@pytest.mark.parametrize(
    ("option", "place", "said"),
    [("-o", "out", "; every file in {} is whole"), ("--html", "page.html", "; nothing was written")],
)
def test_an_ended_command_says_what_there_is(option, place, said, tmp_path, shot):
    program = """
        import os, signal, sys
        from skinslide import cli, progress
        progress._lines = lambda: lambda done, total: os.kill(os.getpid(), signal.SIGTERM)
        sys.exit(cli.main(["preview", sys.argv[1], sys.argv[2], sys.argv[3], "--size", "64x32"]))
    """
    output = tmp_path / place
    command = [sys.executable, "-c", textwrap.dedent(program), str(shot), option, str(output)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 143
    assert done.stderr.endswith(f"ended by a signal{said.format(output)}\n")
    assert not output.is_file()


def test_a_fault_of_the_mesh_is_said_once(tmp_path):
    """And at which frame, though it is a camera of the whole shot that meets it, of either patch."""
    stage, mesh = sheet()
    stages.add_patch(mesh, stages.block(24, range(3, 6), range(3, 6)), "other")
    points = np.array(mesh.GetPointsAttr().Get(1003.0))
    points[5] = np.nan
    mesh.GetPointsAttr().Set(stages.vectors(points), 1003.0)
    with pytest.raises(skinslide.StageProblems) as raised:
        draw(stage, tmp_path / "out")
    assert str(raised.value) == f"error: {stages.MESH}: frame 1003: points: vertex 5 is not finite: (nan, nan, nan)"


def test_no_egl(shot, tmp_path):
    """A machine whose EGL has no vendor at all."""
    empty = tmp_path / "vendors"
    empty.mkdir()
    environment = {**os.environ, "__EGL_VENDOR_LIBRARY_DIRS": str(empty)}
    command = [sys.executable, "-m", "skinslide", "preview", str(shot), "-o", str(tmp_path / "out")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "no EGL device with OpenGL ES 3" in done.stderr
    assert not (tmp_path / "out").exists()
