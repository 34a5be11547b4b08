"""Maps of weight and force density: known images to known controls, where they are found, every bad one refused."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from pxr import Ar, Gf, Sdf, Usd, UsdGeom, UsdUtils

import layers
import stages
from library import Image, decode_exr, sample_map
from skinslide import check
from skinslide.arrays.images import Corners, encode_exr
from skinslide.command.cli import main
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH, PATCH

Types = Sdf.ValueTypeNames
RAMP = np.array([[0.5, 1.0], [1.5, 2.0]], np.float32)  # the top row first


def write(path: Path, pixels: np.ndarray = RAMP, channel: str = "R") -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(encode_exr({channel: np.asarray(pixels, np.float32)}))
    return path


def mapped_stage(faces: np.ndarray | None = None, scale: float = 1.0) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A sheet with st from 0 to `scale`, by vertex."""
    stage, mesh = stages.patched_stage(faces=faces)
    st = scale * (stages.grid().points[:, :2] + 0.5)
    value = [Gf.Vec2f(*pair) for pair in st.tolist()]
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, "vertex", value)
    return stage, mesh


def set_map(mesh: UsdGeom.Mesh, control: str, path: str, channel: str | None = None, time: float | None = None) -> None:
    stages.set_property(mesh, f"{control}Map", Sdf.AssetPath(path), time)
    if channel is not None:
        stages.set_property(mesh, f"{control}MapChannel", channel)


def controls_of(path: Path, time: float | None = None):
    """The controls of the only patch."""
    (mesh,), problems = read_meshes(open_stage(path))
    assert problems == []
    return mesh.animation[0].at() if time is None else mesh.animation[0].at(Usd.TimeCode(time))


def by_hand(scale: float = 1.0) -> np.ndarray:
    """RAMP at the sheet's st: 0.5 + s / 2 + 1 - t, with s and t from 0 to 1 between the centres of its texels."""
    s, t = np.clip(2 * scale * (stages.grid().points[:, :2].astype(np.float64).T + 0.5) - 0.5, 0, 1)
    return (0.5 + 0.5 * s + 1.0 * (1 - t)).astype(np.float32)


# ---- Known maps to known controls ----


def test_a_weight_map_by_hand(tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "weight", "./w.exr")
    write(tmp_path / "w.exr")
    weight = controls_of(stages.save(stage, tmp_path / "shot.usda")).weight
    np.testing.assert_allclose(weight, by_hand(), atol=1e-6)
    assert weight[0] == 1.5 and weight[6] == 2 and weight[42] == 0.5 and weight[48] == 1 and weight[24] == 1.25


def test_a_density_map_by_hand(tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "forceDensity", "./q.exr")
    write(tmp_path / "q.exr")
    controls = controls_of(stages.save(stage, tmp_path / "shot.usda"))
    np.testing.assert_allclose(controls.vertex_density, by_hand(), atol=1e-6)
    assert controls.face_density is None and controls.weight is None


@pytest.mark.parametrize(
    ("interpolation", "count", "by_vertex", "by_face"),
    [("vertex", 49, 3, None), ("constant", 1, 1, None), ("uniform", 36, 1, 3)],
)
def test_a_map_multiplies_painted_density(interpolation, count, by_vertex, by_face, tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "forceDensity", "./q.exr")
    write(tmp_path / "q.exr")
    name = f"skinSlide:{PATCH}:forceDensity"
    stages.set_primvar(mesh, name, Types.FloatArray, interpolation, [3.0] * count)
    controls = controls_of(stages.save(stage, tmp_path / "shot.usda"))
    np.testing.assert_allclose(controls.vertex_density, by_vertex * by_hand(), rtol=1e-6)
    assert by_face is None if controls.face_density is None else (controls.face_density == by_face).all()


def test_a_map_multiplies_painted_weight_and_is_clamped_and_counted(tmp_path, capsys):
    stage, mesh = mapped_stage()
    set_map(mesh, "weight", "./w.exr")
    write(tmp_path / "w.exr")
    paint = np.linspace(0, 1, 49).astype(np.float32)
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", Types.FloatArray, "vertex", paint.tolist())
    path = stages.save(stage, tmp_path / "shot.usda")
    weight = controls_of(path).weight
    np.testing.assert_allclose(weight, paint * by_hand(), rtol=1e-6)
    inside = np.arange(49).reshape(7, 7)[1:-1, 1:-1].ravel()
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda"), "--json"]) == 0
    assert f'"clamped_weights": {np.count_nonzero(weight[inside] > 1)}' in capsys.readouterr().out


def test_bakes_what_the_same_paint_bakes(tmp_path):
    """The map through the stage, against its values painted on the points."""
    texture = np.random.default_rng(5).uniform(0.1, 4, (32, 32))
    stage, mesh = mapped_stage()
    set_map(mesh, "forceDensity", "./q.exr")
    set_map(mesh, "weight", "./w.exr")
    write(tmp_path / "q.exr", texture)
    write(tmp_path / "w.exr", texture / 4)
    mapped = stages.save(stage, tmp_path / "mapped.usda")
    controls = controls_of(mapped)
    stage, mesh = mapped_stage()
    painted = {"weight": controls.weight, "forceDensity": controls.vertex_density}
    for name, values in painted.items():
        stages.set_primvar(mesh, f"skinSlide:{PATCH}:{name}", Types.FloatArray, "vertex", values.tolist())
    stages.save(stage, tmp_path / "painted.usda")
    points = []
    for name in ("mapped", "painted"):
        assert main(["bake", str(tmp_path / f"{name}.usda"), "-o", str(tmp_path / f"{name}.usdc"), "--quiet"]) == 0
        layer = Sdf.Layer.FindOrOpen(str(tmp_path / f"{name}.usdc"))
        points.append(np.array(layer.QueryTimeSample(f"{MESH}.points", FRAMES[2])))
    assert points[0].tobytes() == points[1].tobytes()


def test_a_map_may_be_animated(tmp_path):
    stage, mesh = mapped_stage()
    for frame, value in zip(FRAMES, (0.25, 0.5, 0.75), strict=True):
        set_map(mesh, "weight", f"./w.{frame:.0f}.exr", time=frame)
        write(tmp_path / f"w.{frame:.0f}.exr", np.full((3, 3), value))
    path = stages.save(stage, tmp_path / "shot.usda")
    for frame, value in zip(FRAMES, (0.25, 0.5, 0.75), strict=True):
        assert (controls_of(path, frame).weight == value).all()
    (tmp_path / "w.1002.exr").unlink()
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 1


def test_texture_coordinates_by_corner_indexed_and_by_another_name(tmp_path):
    """A seam down the middle of the sheet: its points take the mean of both sides, 0.5 and 1."""
    stage, mesh = mapped_stage()
    column = np.repeat(np.arange(36) % 6, 4)
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("uv2", Types.Float2Array, "faceVarying")
    primvar.Set([Gf.Vec2f(0.1, 0.9), Gf.Vec2f(0.9, 0.9)])
    primvar.SetIndices((column >= 3).astype(int).tolist())
    stages.set_property(mesh, "mapSt", "uv2")
    set_map(mesh, "weight", "./w.exr")
    write(tmp_path / "w.exr")
    weight = controls_of(stages.save(stage, tmp_path / "shot.usda")).weight.reshape(7, 7)
    assert (weight == [0.5, 0.5, 0.5, 0.75, 1, 1, 1]).all()


# ---- Tiles ----


def test_udim_tiles(tmp_path):
    """The sheet covers 2 x 2 tiles; a tile that it does not touch need not be good, nor there."""
    stage, mesh = mapped_stage(scale=2)
    set_map(mesh, "weight", "./tex/w.<UDIM>.exr")
    for tile, value in {1001: 0.1, 1002: 0.2, 1011: 0.3, 1012: 0.4}.items():
        write(tmp_path / "tex" / f"w.{tile}.exr", np.full((2, 2), value))
    (tmp_path / "tex" / "w.1003.exr").write_text("not an image")
    path = stages.save(stage, tmp_path / "shot.usda")
    weight = controls_of(path).weight.reshape(7, 7)
    np.testing.assert_allclose(weight[[0, 0, 6, 6], [0, 6, 0, 6]], [0.1, 0.2, 0.3, 0.4], rtol=1e-6)
    np.testing.assert_allclose(weight[[3, 0], [0, 3]], [0.2, 0.15], rtol=1e-6)  # on the borders, means of both
    text = check(path).text()
    assert f"{tmp_path}/tex/w.<UDIM>.exr, channel R, 2 x 2, tiles 1001, 1002, 1011, 1012" in text
    (tmp_path / "tex" / "w.1011.exr").unlink()
    assert main(["check", str(path)]) == 3


def test_a_missing_tile_off_the_patch_is_no_matter(tmp_path):
    stage, mesh = mapped_stage(stages.block(6, range(3), range(3)), scale=2)
    set_map(mesh, "weight", "./w.<UDIM>.exr")
    write(tmp_path / "w.1001.exr")
    weight = controls_of(stages.save(stage, tmp_path / "shot.usda")).weight
    assert weight[0] == 1.5 and weight[48] == 1


# ---- Where files are found ----


def test_relative_to_the_layer_that_names_it(tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "weight", "../tex/w.exr")
    set_map(mesh, "forceDensity", "../tex/q.<UDIM>.exr")
    (tmp_path / "char").mkdir()
    write(tmp_path / "tex" / "w.exr")
    write(tmp_path / "tex" / "q.1001.exr")
    stages.save(stage, tmp_path / "char" / "char.usda")
    shot = Sdf.Layer.CreateNew(str(tmp_path / "shot.usda"))
    shot.subLayerPaths = ["./char/char.usda"]
    shot.timeCodesPerSecond = 24
    shot.Save()
    report = check(tmp_path / "shot.usda")
    assert [each.file for each in report.meshes[0].maps] == [
        str(tmp_path / "tex" / "w.exr"),
        str(tmp_path / "tex" / "q.<UDIM>.exr"),
    ]
    assert not report.failed


def test_in_a_set_up_and_in_a_package(tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "weight", "./w.exr")
    write(tmp_path / "w.exr")
    path = stages.save(stage, tmp_path / "shot.usda")
    (tmp_path / "shot.skinslide").write_text(path.read_text())
    assert UsdUtils.CreateNewUsdzPackage(str(path), str(tmp_path / "shot.usdz"))
    wanted = controls_of(path).weight
    (tmp_path / "moved").mkdir()
    (tmp_path / "shot.usdz").rename(tmp_path / "moved" / "shot.usdz")
    for name in ("shot.skinslide", "moved/shot.usdz"):
        assert (controls_of(tmp_path / name).weight == wanted).all()


def test_check_names_the_maps(tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "weight", "./w.exr", "mask")
    write(tmp_path / "w.exr", np.ones((5, 7)), "mask")
    report = check(stages.save(stage, tmp_path / "shot.usda"))
    assert f"skinSlide:{PATCH}:weightMap: {tmp_path}/w.exr, channel mask, 7 x 5, at primvars:st" in report.text()
    (used,) = report.as_dict()["meshes"][0]["maps"]
    assert used["patch"] == PATCH and used["tiles"] == [0] and (used["width"], used["height"]) == (7, 5)


# ---- Images, against another implementation of OpenEXR ----

COMPRESSIONS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24")


@pytest.mark.parametrize("tiled", [False, True])
@pytest.mark.parametrize("dtype", [np.float16, np.float32])
@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_reads_what_the_cpp_library_writes(compression, dtype, tiled, tmp_path):
    pixels = (np.arange(37 * 53).reshape(37, 53) % 97 / 4).astype(dtype)
    header = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION"), "wrapmodes": "periodic,mirror"}
    header["type"] = OpenEXR.tiledimage if tiled else OpenEXR.scanlineimage
    if tiled:
        header["tiles"] = OpenEXR.TileDescription()
        header["tiles"].xSize = header["tiles"].ySize = 16
    path = tmp_path / "x.exr"
    OpenEXR.File(header, {"A": np.ones_like(pixels), "G": pixels + dtype(1), "R": pixels}).write(str(path))
    image = decode_exr(path.read_bytes())
    assert image.channel == "R" and (image.wrap_s, image.wrap_t) == ("periodic", "mirror")
    assert (image.pixels == pixels).all()
    assert (decode_exr(path.read_bytes(), "G").pixels == pixels + 1).all()


def test_reads_parts(tmp_path):
    parts = [OpenEXR.Part({}, {"R": np.full((4, 5), value, np.float32)}, name) for name, value in (("a", 1), ("b", 2))]
    OpenEXR.File(parts).write(str(tmp_path / "x.exr"))
    image = decode_exr((tmp_path / "x.exr").read_bytes(), "b.R")
    assert image.channel == "b.R" and (image.pixels == 2).all()


def test_the_cpp_library_reads_what_is_written(tmp_path):
    channels = {name: np.random.default_rng(9).normal(size=(23, 41)).astype(np.float32) for name in ("R", "stretch")}
    (tmp_path / "x.exr").write_bytes(encode_exr(channels, "mirror"))
    file = OpenEXR.File(str(tmp_path / "x.exr"), separate_channels=True)
    assert file.header()["wrapmodes"] == "mirror"
    for name, pixels in channels.items():
        assert (file.channels()[name].pixels == pixels).all()
        assert (decode_exr(encode_exr(channels), name).pixels == pixels).all()


def test_a_map_that_is_drawn_from_points_gives_them_back():
    """Round trip: values drawn at texels' centres, written, read and sampled there."""
    values = np.random.default_rng(2).uniform(size=(6, 6)).astype(np.float32)
    shape = stages.grid(5, 5)
    st = (np.stack(np.meshgrid(np.arange(6), 5 - np.arange(6)), axis=-1).reshape(-1, 2) + 0.5) / 6
    corners = Corners(shape.counts, shape.indices, 36, shape.all_faces, st.astype(np.float32)[shape.indices])
    image = decode_exr(encode_exr({"Y": values}))
    np.testing.assert_allclose(sample_map(corners, {0: image}), values.ravel(), atol=2e-6)


def test_wraps_of_the_file_count():
    shape = stages.from_faces([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    st = np.full((3, 2), (-0.25, 0.75), np.float32)
    corners = Corners(shape.counts, shape.indices, 3, shape.all_faces, st)
    expected = {"clamp": 0.5, "periodic": 1.0, "mirror": 0.5, "black": 0.0}
    assert {wrap: sample_map(corners, {0: Image(RAMP, "R", wrap, wrap)})[0] for wrap in expected} == expected


# ---- Live, in a .skinslide file ----


@pytest.fixture
def live(tmp_path):
    """A file with two maps: a UDIM that the cache's layer names, and one that the file itself animates."""
    stage, mesh = mapped_stage(scale=2)
    set_map(mesh, "forceDensity", "./tex/q.<UDIM>.exr")
    for tile in (1001, 1002, 1011, 1012):
        write(tmp_path / "char" / "tex" / f"q.{tile}.exr", np.random.default_rng(tile).uniform(0.2, 5, (16, 16)))
    stages.save(stage, tmp_path / "char" / "cache.usda")
    for frame in FRAMES:
        pixels = np.random.default_rng(int(frame)).uniform(0, 1, (4, 4))
        write(tmp_path / "w" / f"w.{frame:.0f}.exr", pixels, "mask")
    samples = ", ".join(f"{frame:.0f}: @./w/w.{frame:.0f}.exr@" for frame in FRAMES)
    over = f"asset skinSlide:{PATCH}:weightMap.timeSamples = {{ {samples} }}\n"
    over += f'uniform token skinSlide:{PATCH}:weightMapChannel = "mask"'
    return layers.write(tmp_path / "x.skinslide", cache="./char/cache.usda", over=over)


def test_a_live_file_is_its_bake(live, tmp_path):
    assert not check(live).failed
    expected = layers.samples(layers.baked(live, tmp_path), "points")
    _stage, mesh = layers.open_mesh(live)
    opened = {time: layers.points(mesh, time) for time in mesh.GetPointsAttr().GetTimeSamples()}
    assert layers.same(opened, expected)
    plain = layers.write(tmp_path / "plain.skinslide", cache="./char/cache.usda")
    assert not layers.same(layers.samples(layers.baked(plain, tmp_path, "plain.usdc"), "points"), expected)


def test_a_map_that_changes_is_read_again(tmp_path):
    stage, mesh = mapped_stage()
    set_map(mesh, "weight", "./w.exr")
    write(tmp_path / "w.exr", RAMP / 4)
    stages.save(stage, tmp_path / "cache.usda")
    opened, mesh = layers.open_mesh(layers.write(tmp_path / "x.skinslide"))
    assert str(tmp_path / "w.exr") in opened.GetRootLayer().GetExternalAssetDependencies()
    before = layers.points(mesh, FRAMES[2])
    os.utime(write(tmp_path / "w.exr", RAMP * 0), (2e9, 2e9))
    opened.Reload()
    assert not np.array_equal(layers.points(mesh, FRAMES[2]), before)
    assert np.array_equal(layers.points(mesh, FRAMES[2]), stages.grid().moved(FRAMES[2]))


# ---- What is no image, found out before it is read ----


def test_a_pipe_is_not_opened(tmp_path):
    stage, mesh = mapped_stage()
    os.mkfifo(tmp_path / "pipe.exr")
    set_map(mesh, "weight", "./pipe.exr")
    path = stages.save(stage, tmp_path / "shot.usda")
    command = [sys.executable, "-m", "skinslide", "check", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20)
    assert done.returncode == 3 and "pipe.exr: cannot be read" in done.stdout


def test_a_layer_does_not_open_a_pipe(tmp_path):
    stage, mesh = mapped_stage()
    os.mkfifo(tmp_path / "pipe.exr")
    set_map(mesh, "weight", "./pipe.exr")
    stages.save(stage, tmp_path / "cache.usda")
    script = "import sys, skinslide; from pxr import Sdf; Sdf.Layer.FindOrOpen(sys.argv[1])"
    command = [sys.executable, "-c", script, str(layers.write(tmp_path / "x.skinslide"))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20)
    assert done.returncode == 0 and "pipe.exr: cannot be read" in done.stderr


def test_a_large_file_that_is_no_image_is_told_by_its_start(tmp_path):
    """3 GB without a block on the disk: its content is never asked for."""
    stage, mesh = mapped_stage()
    (tmp_path / "sparse.exr").touch()
    os.truncate(tmp_path / "sparse.exr", 3 << 30)
    set_map(mesh, "weight", "./sparse.exr")
    path = stages.save(stage, tmp_path / "shot.usda")
    read: list[int] = []
    opened = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(str(path)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(opened), "GetBuffer", lambda asset: read.append(asset.GetSize()))
        problems = check(str(path)).problems
    assert read == []
    assert [problem.message for problem in problems if "sparse.exr: not an OpenEXR file" in problem.message]
