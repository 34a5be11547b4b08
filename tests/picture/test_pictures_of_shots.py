"""Pictures of a shot: what is on them, and where they go."""

import os
import warnings

import numpy as np
import pytest
from PIL import Image
from pxr import Sdf, Ts, Usd, UsdGeom, Vt
from scipy import ndimage

import skinslide
import stages
from repository import EXAMPLES, load
from sheets import NAME, SIZE, add_st, contrast, draw, halves, picture, projected, sheet
from skinslide.arrays.images import decode_exr
from skinslide.command.cli import main
from stages import FRAMES, PATCH

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
    monkeypatch.setattr("skinslide.picture.preview.contact_sheets", lambda strips: kept.extend(strips) or [])
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


@pytest.mark.parametrize("name", ["elbow", "sleeve", "face"])
def test_the_examples_pictures_are_as_made(name, example_stage):
    """Those beside the examples are what run.sh makes: JPEG is off by some levels, another device at some edges."""
    chosen = (["unit"], ["chequer"]) if name == "elbow" else (["unit", "relaxed"], ["chequer", "stretch"])
    stage = example_stage(name)
    drawn = load("measure/pictures.py").draw(stage, *chosen).astype(int)
    with Image.open(EXAMPLES / f"{name}.jpg") as image:
        kept = np.array(image).astype(int)
    assert kept.shape == drawn.shape
    assert np.abs(kept - drawn).mean() < 3


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
