"""Pictures of a shot: what is on them, and where they go."""

import os
import warnings

import numpy as np
import pytest
from PIL import Image
from pxr import Sdf, Ts, Usd, UsdGeom, UsdShade, Vt
from scipy import ndimage

import skinslide
import stages
from library import decode_exr
from repository import EXAMPLES, load
from sheets import NAME, SIZE, add_st, contrast, draw, halves, picture, projected, sheet
from skinslide.command.cli import main
from skinslide.picture.material import base_colour
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
    draw(stage, tmp_path, views="stretch", stretch_scale=0.2)
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


def assert_kept(name, drawn):
    """A picture beside the examples is what run.sh makes: JPEG is off by some levels, another device at some edges."""
    with Image.open(EXAMPLES / f"{name}.jpg") as image:
        kept = np.array(image).astype(int)
    assert kept.shape == drawn.shape
    assert np.abs(kept - drawn).mean() < 3


@pytest.mark.parametrize("name", ["sleeve", "face"])
def test_the_examples_pictures_are_as_made(name, example_stage):
    drawn = load("measure/pictures.py").draw(example_stage(name), ["unit", "relaxed"], ["chequer", "stretch"])
    assert_kept(name, drawn)


def test_the_picture_of_what_is_gained_is_as_made(example_stage, tmp_path):
    """And tells of less stretch from column to column, of the same edges."""
    gain, stage = load("measure/gain.py"), tmp_path / "stage.usda"
    skinslide.setup_to_file(example_stage("body"), stage, whole=True)
    painted = [str(example_stage(name)) for name in ("elbow", "face")]
    assert_kept("gain", gain.draw(str(stage), painted))
    mesh = gain.first_mesh(str(stage))
    for each in painted:
        _, columns = gain.columns(mesh, gain.first_mesh(each).patches[0])
        cache, unit, even = (column.measure for column in columns)
        assert even < 0.85 * cache and even < 0.9 * unit and unit < cache


def test_the_picture_of_wrinkles_is_as_made(example_stage, tmp_path):
    """And differs from the smooth one where skin is pressed together, alone."""
    stage = tmp_path / "stage.usda"
    skinslide.setup_to_file(example_stage("fingers"), stage, whole=True)
    drawn = load("measure/wrinkles.py").draw(stage)
    assert_kept("wrinkles", drawn)
    smooth, wrinkled = (half[80:].astype(int) for half in np.split(drawn, 2, axis=1))
    changed = np.abs(smooth - wrinkled).sum(axis=2) > 20
    assert 0.005 < changed.mean() < 0.2


# ---- Other views, and other rules ----


def hue(pixels):
    """The mean colour of the middle of a picture, less its grey."""
    middle = pixels[20:-20, 60:-60].reshape(-1, 3).mean(axis=0)
    return middle - middle.mean()


def test_density_is_shown_by_colour(tmp_path):
    """Little is blue, much is red, as painted; nothing painted lies between, and neither depends on the frame."""
    found = {}
    for density in (None, 0.1, 10.0):
        stage, mesh = sheet()
        if density:
            name, floats = f"skinSlide:{PATCH}:forceDensity", Sdf.ValueTypeNames.FloatArray
            every = np.full(len(mesh.GetPointsAttr().Get()), density, np.float32)
            stages.set_primvar(mesh, name, floats, "vertex", Vt.FloatArray.FromNumpy(every))
        draw(stage, tmp_path / str(density), views="density", frames="1001,1003")
        first, last = (halves(picture(tmp_path / str(density), "density", frame))[0] for frame in ("1001", "1003"))
        found[density] = hue(first)
        assert np.abs(hue(first) - hue(last)).max() < 3
    assert found[0.1][2] > 30 and found[10.0][0] > 30 and found[None][1] > 30


def test_edges_that_are_painted_are_lines_of_their_colour(tmp_path):
    """Along them and no others, in both poses, by the scale of the faces; no other view has them."""
    stage, mesh = sheet()
    points = np.array(mesh.GetPointsAttr().Get())
    middle = np.argmin(np.linalg.norm(points, axis=1))
    right = np.argmin(np.linalg.norm(points - points[middle] - [1 / 24, 0, 0], axis=1))
    views = ("density", "stretch")
    draw(stage, tmp_path / "none", views=views, frames="1001")
    patch = skinslide.SkinSlideAPI(mesh, PATCH)
    patch.CreateEdgesAttr([middle, right])
    for density in (16, 1 / 16):
        patch.CreateEdgeForceDensitiesAttr([density])
        draw(stage, tmp_path / str(density), views=views, frames="1001")
        plain, painted = (picture(tmp_path / folder, "density", "1001") for folder in ("none", str(density)))
        for before, after in zip(halves(plain), halves(painted), strict=True):
            red, _, blue = np.moveaxis(after, 2, 0).astype(int)
            line = (red - blue > 100) if density > 1 else (blue - red > 40)
            line &= np.abs(after.astype(int) - before).sum(axis=2) > 60
            rows, columns = np.nonzero(line)
            assert len(rows) > 5 and np.ptp(columns) > np.ptp(rows)
        assert np.array_equal(*(picture(tmp_path / folder, "stretch", "1001") for folder in ("none", str(density))))


def test_slides_are_shown_by_colour_and_by_ways(tmp_path):
    """Before there are none; after there are, and lines on them, which at rest are none either."""
    stage, _mesh = sheet()
    draw(stage, tmp_path, views="slide")
    still, still_slid = halves(picture(tmp_path, "slide", "1001"))
    before, after = halves(picture(tmp_path, "slide", "1003"))
    assert max(np.abs(hue(each) - hue(still)).max() for each in (still_slid, before)) < 2
    assert np.abs(hue(after) - hue(still)).max() > 10
    white = [np.count_nonzero(each.min(axis=2) > 200) for each in (before, after)]
    assert white[0] == 0 and white[1] > 100


def test_pins_are_dots(tmp_path):
    stage, mesh = sheet()
    weight = np.ones(len(mesh.GetPointsAttr().Get()), np.float32)
    draw(stage, tmp_path / "none", views="slide", frames="1001")
    weight[np.argmin(np.linalg.norm(np.array(mesh.GetPointsAttr().Get()), axis=1))] = 0
    name, floats = f"skinSlide:{PATCH}:weight", Sdf.ValueTypeNames.FloatArray
    stages.set_primvar(mesh, name, floats, "vertex", Vt.FloatArray.FromNumpy(weight))
    draw(stage, tmp_path / "one", views="slide", frames="1001")
    pixels = [halves(picture(tmp_path / folder, "slide", "1001"))[0] for folder in ("none", "one")]
    rows, columns = np.nonzero(np.abs(pixels[1] - pixels[0]).sum(axis=2) > 60)
    assert 4 < len(rows) < 60 and np.ptp(rows) < 10 and np.ptp(columns) < 10


def test_the_sides_of_faces_are_drawn_where_they_are_wanted(tmp_path):
    stage, _mesh = sheet()
    found = []
    for wire in (False, True):
        draw(stage, tmp_path / str(wire), views="stretch", frames="1001", wire=wire)
        before, _ = halves(picture(tmp_path / str(wire), "stretch", "1001"))
        found.append(np.abs(np.diff(before[40], axis=0)).sum())
    assert found[1] > 2 * found[0]


def test_what_hides_a_patch_is_a_shadow(tmp_path):
    """A sheet of the same mesh in front of all of it: the patch is seen through it."""
    shape = stages.grid(8, 8)
    shape.points[:, 2] = 0
    pictures = []
    for covered in (False, True):
        cover = shape.points + np.array([0, 0, 0.3] if covered else [9, 0, 0])
        both = stages.Shape(
            np.concatenate([shape.points, cover]),
            np.concatenate([shape.counts] * 2),
            np.concatenate([shape.indices, shape.indices + len(shape.points)]),
        )
        stage, mesh = stages.patched_stage(both, stages.block(8, range(2, 6), range(2, 6)))
        for frame in FRAMES:
            mesh.GetPointsAttr().Set(stages.vectors(both.points), frame)
        draw(stage, tmp_path / str(covered), frames="1001", squares=8)
        pictures.append(halves(picture(tmp_path / str(covered), frame="1001"))[0])
    middle = [each[40:-40, 100:-100] for each in pictures]
    assert contrast(middle[1]) > 0.7 * contrast(middle[0]) and not np.array_equal(*middle)


def test_rules_are_compared_side_by_side(tmp_path):
    """Each column is what its rule makes of the patch; the report is of the patch as it is set up."""
    stage, mesh = sheet()
    mesh.GetPrim().CreateAttribute(f"skinSlide:{PATCH}:forceDensityRule", Sdf.ValueTypeNames.Token).Set("fast")
    report = draw(
        stage, tmp_path / "rules", compare=("unit", "relaxed"), size=(720, 270), views="stretch", frames="1003"
    )
    pixels = picture(tmp_path / "rules", "stretch", "1003")
    columns = [pixels[50:-50, i * 240 : (i + 1) * 240].astype(int) for i in range(3)]
    for i, rule in enumerate(("unit", "relaxed"), start=1):
        mesh.GetPrim().GetAttribute(f"skinSlide:{PATCH}:forceDensityRule").Set(rule)
        draw(stage, tmp_path / rule, size=(480, 270), views="stretch", frames="1003")
        before, after = (
            half[:, :] for half in np.split(picture(tmp_path / rule, "stretch", "1003")[50:-50], 2, axis=1)
        )
        assert np.abs(columns[0] - before).mean() < 1 and np.abs(columns[i] - after).mean() < 1
    assert report.meshes[0].patches[0].results[0].relax_steps == 0


def test_the_page_has_the_stretch_that_each_rule_leaves(tmp_path):
    stage, mesh = sheet()
    html = tmp_path / "page.html"
    skinslide.preview(stage, html=html, compare=("unit", "relaxed"), size=(96, 32), views="stretch")
    for rule in ("unit", "relaxed"):
        mesh.GetPrim().CreateAttribute(f"skinSlide:{PATCH}:forceDensityRule", Sdf.ValueTypeNames.Token).Set(rule)
        patch = skinslide.bake(stage, frames="authored").meshes[0].patches[0]
        left = f"{patch.results[patch.worst].stretch_after:.4f}"
        assert f'<span class="quiet">{rule}</span> <span class="after">{left}</span>' in html.read_text()


def test_poses_side_by_side_are_as_large_as_two(tmp_path):
    stage, _mesh = sheet()
    for number, compare in enumerate((None, ("unit", "even", "relaxed"))):
        skinslide.preview(stage, tmp_path / str(number), compare=compare, views="stretch", frames="1003")
    sizes = [picture(tmp_path / str(number), "stretch", "1003").shape[:2] for number in range(2)]
    assert sizes == [(1080, 1920), (1080, 3840)]


def test_a_rule_that_cannot_slide_a_patch_is_named(tmp_path, capfd):
    stage, _mesh = stages.patched_stage(stages.box(), np.arange(6))
    stage.GetPrimAtPath(stages.MESH).GetAttribute(f"skinSlide:{PATCH}:forceDensityRule").Set("even")
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    words = ["--compare", "even,unit", "--size", "64x32"]
    assert main(["preview", path, "-o", str(tmp_path / "out"), *words]) == 3
    assert f"error: {stages.MESH}: under the rule unit: " in capfd.readouterr().err


def textured(stage, mesh, tmp_path, file):
    """A material of a texture, on a mesh."""
    material = UsdShade.Material.Define(stage, "/World/look")
    surface, reader = (UsdShade.Shader.Define(stage, f"/World/look/{name}") for name in ("surface", "texture"))
    surface.CreateIdAttr("UsdPreviewSurface"), reader.CreateIdAttr("UsdUVTexture")
    reader.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(str(tmp_path / file))
    colour = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    colour.ConnectToSource(reader.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
    material.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", Sdf.ValueTypeNames.Token))
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


@pytest.mark.parametrize("udim", [False, True])
def test_the_texture_of_the_mesh_is_shown(udim, tmp_path):
    """Red above green, as in the file; with UDIM in the first tile."""
    stage, mesh = sheet()
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:4, :, 0] = pixels[4:, :, 1] = 255
    Image.fromarray(pixels).save(tmp_path / ("skin.1001.png" if udim else "skin.png"))
    textured(stage, mesh, tmp_path, "skin.<UDIM>.png" if udim else "skin.png")
    draw(stage, tmp_path / "out", views="texture", frames="1001")
    before, after = halves(picture(tmp_path / "out", "texture", "1001"))
    for half in (before, after):
        upper, lower = half[10:40, 100:-100].mean(axis=(0, 1)), half[-40:-10, 100:-100].mean(axis=(0, 1))
        assert upper[0] > 200 > 60 > upper[1] and lower[1] > 200 > 60 > lower[0]


@pytest.mark.parametrize(
    ("file", "message"),
    [
        (None, "has no material, whose texture could be shown"),
        ("none.png", "/World/look/texture.inputs:file: there is no file"),
        ("shot.usda", "is not a picture that can be read"),
    ],
)
def test_textures_that_cannot_be_shown(file, message, tmp_path, capfd):
    stage, mesh = sheet()
    if file:
        textured(stage, mesh, tmp_path, file)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--view", "texture", "--size", "64x32"]) == 3
    said = capfd.readouterr().err
    assert f"error: {stages.MESH}: patch {PATCH}: " in said and message in said


def test_a_material_of_many_ways_is_gone_through_once(tmp_path):
    """Each of its shaders has two inputs, both of which the next feeds; the last has the texture."""
    stage, mesh = sheet()
    Image.fromarray(np.full((8, 8, 3), (255, 0, 0), np.uint8)).save(tmp_path / "skin.png")
    textured(stage, mesh, tmp_path, "skin.png")
    after, kind = UsdShade.Shader.Get(stage, "/World/look/texture"), Sdf.ValueTypeNames.Color3f
    for number in range(40):
        mix = UsdShade.Shader.Define(stage, f"/World/look/mix{number}")
        for name in ("fg", "bg"):
            mix.CreateInput(name, kind).ConnectToSource(after.GetOutput("rgb" if number == 0 else "out"))
        mix.CreateOutput("out", kind)
        after = mix
    UsdShade.Shader.Get(stage, "/World/look/surface").GetInput("diffuseColor").ConnectToSource(after.GetOutput("out"))
    assert base_colour(mesh.GetPrim())[1001].reshape(-1, 4).tolist() == [[255, 0, 0, 255]] * 64


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
