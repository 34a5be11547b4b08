"""Maps written: texels by hand, dilation, tiles, names, paint that comes back, and everything that is refused."""

import json
import math
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

import skinslide
import stages
from library import decode_exr
from skinslide import FrameProblem, StageError, StageProblems, UsageError, maps
from skinslide.arrays.images import Corners, draw_map
from skinslide.command.cli import main
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from skinslide.write.folder import frame_label
from stages import FRAMES, MESH, PATCH

Types = Sdf.ValueTypeNames
KINDS = ("stretchBefore", "stretchAfter", "slide", "forceDensity")


def set_st(mesh: UsdGeom.Mesh, st: np.ndarray, interpolation: str = "vertex", time: float | None = None) -> None:
    value = [Gf.Vec2f(*pair) for pair in np.asarray(st, np.float64).tolist()]
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, interpolation, value, time)


def sheet_st(shape: stages.Shape | None = None, low: float = 0.1, high: float = 0.9) -> np.ndarray:
    shape = stages.grid() if shape is None else shape
    return low + (high - low) * (shape.points[:, :2].astype(np.float64) + 0.5)


def charted(faces: np.ndarray | None = None, **st: float) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A sheet with a patch, and st by vertex."""
    stage, mesh = stages.patched_stage(faces=faces)
    set_st(mesh, sheet_st(**st))
    return stage, mesh


def read(path: Path) -> np.ndarray:
    return decode_exr(path.read_bytes()).pixels


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture
def shot(tmp_path):
    return stages.save(charted()[0], tmp_path / "shot.usda")


# ---- Texels by hand ----


def two_quads() -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """Two unit quads side by side, at frame 2 the right one e times as wide. All are on the boundary: nothing slides.

    In a texture of 32 x 32 they are 8 texels wide and 16 high, with (8, 8) at their lower left.
    """
    shape = stages.from_faces([(x, y, 0) for y in (0, 1) for x in (0, 1, 2)], [(0, 1, 4, 3), (1, 2, 5, 4)])
    stage = stages.new_stage()
    mesh = stages.add_mesh(stage, shape, frames=[])
    stages.add_patch(mesh, shape.all_faces)
    wide = shape.points.copy()
    wide[[2, 5], 0] = 1 + math.e
    mesh.GetPointsAttr().Set(stages.vectors(shape.points), 1)
    mesh.GetPointsAttr().Set(stages.vectors(wide), 2)
    set_st(mesh, [(s / 32, t / 32) for t in (8, 24) for s in (8, 16, 24)])
    return stage, mesh


# Left to right: a vertex has the sides (0, 0), (0, 0, 1), (1, 0) of log length.
BY_HAND = (0, math.sqrt(1 / 3), math.sqrt(1 / 2))


def test_the_strain_of_two_quads(tmp_path, capsys):
    """One file of five channels: of the right quad the largest is e, along s, so that twice its angle is 0."""
    path = stages.save(two_quads()[0], tmp_path / "shot.usda")
    words = ["--size", "32", "--strain", "--frames", "2", "--json", "--quiet"]
    assert main(["maps", str(path), "-o", str(tmp_path / "maps"), *words]) == 0
    told = json.loads(capsys.readouterr().out)["maps"]
    assert [each["kind"] for each in told] == [*KINDS, "strain"]
    file = tmp_path / "maps" / "skin_GEO.strain.0002.exr"
    channels = {name: decode_exr(file.read_bytes(), name).pixels for name in ("largest", "smallest", "area")}
    way = [decode_exr(file.read_bytes(), f"direction.{axis}").pixels for axis in "xy"]
    ends = (1, math.sqrt((1 + math.e**2) / 2), math.e)  # in the middle the mean of both tensors
    row = np.interp(np.arange(8, 24) + 0.5, (8, 16, 24), ends)
    for name, expected in (("largest", row), ("area", row), ("smallest", np.ones(16))):
        np.testing.assert_allclose(channels[name][8:24, 8:24], np.tile(expected, (16, 1)), atol=2e-6)
    np.testing.assert_allclose(way[0][8:24, 17:24], 1, atol=1e-6)
    np.testing.assert_allclose(way[1][8:24, 17:24], 0, atol=1e-6)
    assert told[-1]["lowest"] == 1 and told[-1]["highest"] == pytest.approx(math.e)


def test_a_known_stretch(tmp_path):
    maps(stages.save(two_quads()[0], tmp_path / "shot.usda"), tmp_path / "maps", size=32)
    for kind in ("stretchBefore", "stretchAfter"):
        texels = read(tmp_path / "maps" / f"skin_GEO.{kind}.0002.exr")
        # The same in every row, and linear between the vertices: at texel centres by numpy. Of float arithmetic.
        row = np.interp(np.arange(8, 24) + 0.5, (8, 16, 24), BY_HAND)
        np.testing.assert_allclose(texels[8:24, 8:24], np.tile(row, (16, 1)), atol=1e-6)
    assert not read(tmp_path / "maps" / "skin_GEO.slide.0002.exr").any()
    covered = np.zeros((32, 32))
    covered[4:28, 4:28] = 1
    assert (read(tmp_path / "maps" / "skin_GEO.forceDensity.0002.exr") == covered).all()


def test_rest_gives_zeros_bit_for_bit(tmp_path, shot):
    maps(shot, tmp_path / "maps", frames=[FRAMES[0]], size=64)
    for kind in KINDS[:3]:
        assert read(tmp_path / "maps" / f"skin_GEO.{kind}.1001.exr").tobytes() == bytes(4 * 64 * 64)


def test_four_texels_past_the_chart_and_no_further(tmp_path):
    maps(stages.save(two_quads()[0], tmp_path / "shot.usda"), tmp_path / "maps", size=32, frames=[2])
    texels = read(tmp_path / "maps" / "skin_GEO.stretchAfter.0002.exr")
    outside = np.ones((32, 32), bool)
    outside[4:28, 4:28] = False
    assert not texels[outside].any()
    # Along the right border of the chart, away from its corners, every ring has the mean of three equal texels.
    assert (texels[12:20, 24:28] > 0.65).all() and np.ptp(texels[12:20, 24:28], axis=0).max() < 1e-6
    np.testing.assert_allclose(texels[16, 24:28], texels[16, 23], rtol=1e-6)


def test_a_slid_sheet_against_numpy(tmp_path):
    """Values at vertices from the bake's primvars; texels by inverting the sheet's st, which is a regular grid."""
    stage, _mesh = charted()
    shot = stages.save(stage, tmp_path / "shot.usda")
    maps(shot, tmp_path / "maps", size=100, frames=[1003])
    skinslide.bake_to_file(shot, tmp_path / "slid.usdc", diagnostics=True)
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "slid.usdc"))
    for kind, name in (("slide", "slide"), ("stretchAfter", "stretch")):
        values = np.array(layer.QueryTimeSample(f"{MESH}.primvars:skinSlide:{name}", 1003.0)).reshape(7, 7)
        texels = read(tmp_path / "maps" / f"skin_GEO.{kind}.1003.exr")[::-1]
        centre = np.arange(10, 90) + 0.5
        x, y = np.meshgrid((centre / 100 - 0.1) / 0.8 * 6, (centre / 100 - 0.1) / 0.8 * 6)
        i, j = np.minimum(x.astype(int), 5), np.minimum(y.astype(int), 5)
        u, v = x - i, y - j
        low, right, top, left = values[j, i], values[j, i + 1], values[j + 1, i + 1], values[j + 1, i]
        below = low + u * (right - low) + v * (top - right)  # the fan's triangle 0 1 2
        above = low + v * (left - low) + u * (top - left)  # and 0 2 3
        expected = np.where(u >= v, below, above)
        # st are floats: 1e-5 texels, over cells of 13.
        np.testing.assert_allclose(texels[10:90, 10:90], expected, atol=3e-6)


def test_files_as_others_read_them(tmp_path, shot):
    maps(shot, tmp_path / "maps", size=32, frames=[1002])
    path = tmp_path / "maps" / "skin_GEO.stretchAfter.1002.exr"
    file = OpenEXR.File(str(path))
    assert list(file.channels()) == ["Y"] and file.channels()["Y"].pixels.dtype == np.float32
    assert file.header()["wrapmodes"] == "clamp"
    np.testing.assert_array_equal(file.channels()["Y"].pixels, read(path))


def test_the_later_face_wins(tmp_path):
    """Both quads are in one place, as mirrored halves are."""
    stage, mesh = two_quads()
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:forceDensity", Types.FloatArray, "uniform", [1.0, 5.0])
    square = [(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)]
    set_st(mesh, square * 2, "faceVarying")
    maps(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "maps", size=32, frames=[1])
    texels = read(tmp_path / "maps" / "skin_GEO.forceDensity.0001.exr")
    # Of the second quad: 3 on the shared side's mean with others, 5 on its own.
    assert texels[16, 22] > 4.5 and texels[16, 9] > 3


# ---- Tiles ----


def test_udim_tiles(tmp_path):
    """The left quad in tile 1001, the right in 1012; a tile has its number where it is the only one, too."""
    stage, mesh = two_quads()
    square = np.array([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)])
    set_st(mesh, np.concatenate([square, square + 1]), "faceVarying")
    shot = stages.save(stage, tmp_path / "shot.usda")
    report = maps(shot, tmp_path / "maps", size=32, frames=[2])
    assert sorted(files(tmp_path / "maps")) == sorted(
        f"skin_GEO.{kind}.{tile}.0002.exr" for kind in KINDS for tile in (1001, 1012)
    )
    assert {written.tile for written in report.maps} == {1001, 1012}
    left, right = (read(tmp_path / "maps" / f"skin_GEO.stretchAfter.{tile}.0002.exr") for tile in (1001, 1012))
    middle = np.arange(8, 24) + 0.5
    np.testing.assert_allclose(left[16, 8:24], np.interp(middle, (8, 24), BY_HAND[:2]), atol=1e-6)
    np.testing.assert_allclose(right[16, 8:24], np.interp(middle, (8, 24), BY_HAND[1:]), atol=1e-6)
    set_st(mesh, np.concatenate([square, square]) + 1, "faceVarying")
    maps(stages.save(stage, shot), tmp_path / "other", size=32, frames=[2])
    assert sorted(files(tmp_path / "other")) == sorted(f"skin_GEO.{kind}.1012.0002.exr" for kind in KINDS)


# ---- Painted, written, read back ----


def fine_sheet(charts: str) -> tuple[Usd.Stage, UsdGeom.Mesh, np.ndarray]:
    """A finer sheet painted smoothly, in one chart, in two with a seam, or in two tiles."""
    shape = stages.grid(24, 24)
    stage, mesh = stages.patched_stage(shape)
    x, y = shape.points[:, 0], shape.points[:, 1]
    paint = np.exp(np.sin(5 * x) + np.cos(4 * y)).astype(np.float32)
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:forceDensity", Types.FloatArray, "vertex", paint.tolist())
    st = sheet_st(shape)[shape.indices]
    right = np.repeat(np.arange(len(shape.counts)) % 24 >= 12, 4)
    if charts == "seam":
        st = np.where(right[:, None], [[0.55, 0.05]] + 0.4 * st, [[0.05, 0.5]] + 0.4 * st)
    elif charts == "udim":
        st = st + np.where(right[:, None], [[1.0, 0.0]], 0)
    set_st(mesh, st, "faceVarying")
    return stage, mesh, paint


@pytest.mark.parametrize("charts", ["one", "seam", "udim"])
def test_painting_by_a_written_map_gives_the_densities_back(charts, tmp_path):
    stage, mesh, paint = fine_sheet(charts)
    shot = stages.save(stage, tmp_path / "shot.usda")
    maps(shot, tmp_path / "maps", size=512, frames=[1001])
    (slid,), _ = read_meshes(open_stage(shot))
    drawn = slid.slider().diagnose(slid.rest_points, slid.rest_points).force_density
    mesh.GetPrim().RemoveProperty(f"primvars:skinSlide:{PATCH}:forceDensity")
    tile = "<UDIM>." if charts == "udim" else ""
    stages.set_property(mesh, "forceDensityMap", Sdf.AssetPath(f"./maps/skin_GEO.forceDensity.{tile}1001.exr"))
    (slid,), problems = read_meshes(open_stage(stages.save(stage, tmp_path / "mapped.usda")))
    found = slid.patches[0].controls.vertex_density
    assert problems == []
    # At a border dilated texels are constant: off by what values change in at most a texel, as is a bend inside.
    texels_an_edge = 0.8 * 512 / 24 * (0.4 if charts == "seam" else 1)
    change = max(np.abs(np.diff(np.log(paint.reshape(25, 25)), axis=axis)).max() for axis in (0, 1))  # over an edge
    np.testing.assert_allclose(found, drawn, rtol=change / texels_an_edge)
    assert change / texels_an_edge < 0.05
    # What is drawn is a mean over edges, each the mean of its ends: at the border half an edge from the paint itself.
    np.testing.assert_allclose(found, paint, rtol=change / 2 + change / texels_an_edge)


# ---- Names ----


@pytest.mark.parametrize(
    ("frame", "label"),
    [
        (1001.0, "1001"),
        (7.0, "0007"),
        (0.0, "0000"),
        (-0.0, "0000"),
        (-7.0, "-0007"),
        (1001.25, "1001_25"),
        (-0.5, "-0000_5"),
        (0.5, "0000_5"),
        (123456.0, "123456"),
        (1012.0000000001, "1012"),
        (2.9999999999, "0003"),
        (0.000001, "0000_000001"),
        (1e300, "1e+300"),
    ],
)
def test_frame_labels(frame, label):
    assert frame_label(frame) == label


def test_no_two_frames_have_one_label():
    dice = np.random.default_rng(1)
    frames = np.unique(np.round(np.concatenate([dice.uniform(-2, 2, 4000), dice.uniform(-2000, 2000, 4000)]), 4))
    assert len({frame_label(frame) for frame in frames.tolist()}) == len(frames)


def test_frames_negative_and_between(tmp_path, shot):
    maps(shot, tmp_path / "maps", size=8, frames="-1:1x0.5")
    labels = ("-0001", "-0000_5", "0000", "0000_5", "0001")
    assert sorted(files(tmp_path / "maps")) == sorted(
        f"skin_GEO.{kind}.{label}.exr" for kind in KINDS for label in labels
    )
    with pytest.raises(UsageError, match=r"frames 1\.0 and 1\.00000001 are too near"):
        maps(shot, tmp_path / "other", size=8, frames=[1, 1.00000001])
    assert not (tmp_path / "other").exists()


def test_names_of_meshes(tmp_path):
    """Unique ends of paths, which do not depend on what else is asked for; a mesh without samples has no frame."""
    stage = stages.new_stage()
    paths = ("/World/hero/geo/body_GEO", "/World/twin/geo/body_GEO", "/World/hero/geo/hand_GEO", "/body_GEO")
    for path in paths:
        mesh = stages.add_mesh(stage, stages.grid(), path, frames=FRAMES if path != paths[2] else [])
        stages.add_patch(mesh, stages.grid().all_faces)
        set_st(mesh, sheet_st())
    shot = stages.save(stage, tmp_path / "shot.usda")
    maps(shot, tmp_path / "all", size=8, frames=[1002])
    names = {name.split(".slide")[0]: name for name in files(tmp_path / "all") if ".slide" in name}
    assert names == {
        "hero.geo.body_GEO": "hero.geo.body_GEO.slide.1002.exr",
        "twin.geo.body_GEO": "twin.geo.body_GEO.slide.1002.exr",
        "hand_GEO": "hand_GEO.slide.exr",
        "body_GEO": "body_GEO.slide.1002.exr",
    }
    maps(shot, tmp_path / "one", size=8, frames=[1002], prims="/World/twin")
    assert sorted(files(tmp_path / "one")) == sorted(f"twin.geo.body_GEO.{kind}.1002.exr" for kind in KINDS)
    assert all(files(tmp_path / "all")[name] == data for name, data in files(tmp_path / "one").items())


def test_frames_alone_or_together_on_any_number_of_threads(tmp_path, shot):
    maps(shot, tmp_path / "together", size=64, jobs=3)
    for frame in FRAMES:
        maps(shot, tmp_path / "alone", size=64, frames=[frame])
    assert len(files(tmp_path / "together")) == 12
    assert files(tmp_path / "alone") == files(tmp_path / "together")


# ---- Which patches ----


def test_patches_by_name(tmp_path):
    """Two patches that share a column: of the one that is asked for the faces, its edges, and its paint; both slide."""
    left, right = stages.block(6, range(0, 3), range(6)), stages.block(6, range(2, 6), range(6))
    stage, mesh = charted(left)
    stages.add_patch(mesh, right, "other")
    for name, value in ((PATCH, 2.0), ("other", 4.0)):
        stages.set_primvar(mesh, f"skinSlide:{name}:forceDensity", Types.FloatArray, "vertex", [value] * 49)
    shot = stages.save(stage, tmp_path / "shot.usda")
    for folder, patches in (("both", None), ("left", PATCH), ("right", ["other"])):
        maps(shot, tmp_path / folder, size=60, frames=[1003], patches=patches)
    density = {name: read(tmp_path / name / "skin_GEO.forceDensity.1003.exr") for name in ("both", "left", "right")}
    row = {name: texels[30] for name, texels in density.items()}
    assert (row["left"][8:28] == 2).all() and (row["right"][26:52] == 4).all()
    assert row["left"][40] == 0 and row["right"][15] == 0
    assert row["both"][12] == 2 and row["both"][48] == 4 and (row["both"][23:29] == 3).all()
    slides = [read(tmp_path / name / "skin_GEO.slide.1003.exr") for name in ("both", "left")]
    np.testing.assert_array_equal(slides[0][14:46, 8:28], slides[1][14:46, 8:28])
    with pytest.raises(StageProblems, match=f"patch elbow: no mesh has it; there are {PATCH} and other"):
        maps(shot, tmp_path / "none", patches=["other", "elbow"])
    with pytest.raises(UsageError, match="no names"):
        maps(shot, tmp_path / "none", patches=[])
    assert not (tmp_path / "none").exists()


def test_meshes_without_the_patch_are_passed_over(tmp_path):
    stage, _mesh = charted()
    other = stages.add_mesh(stage, stages.grid(), "/World/prop/rope_GEO")  # has no st
    stages.add_patch(other, stages.annulus(), "rope")
    shot = stages.save(stage, tmp_path / "shot.usda")
    assert {written.prim for written in maps(shot, tmp_path / "maps", size=8, patches=PATCH).maps} == {MESH}
    with pytest.raises(StageProblems, match="error: /World/prop/rope_GEO: has no primvars:st"):
        maps(shot, tmp_path / "none")
    assert not (tmp_path / "none").exists()


def test_faces_without_a_texel_are_told(tmp_path, shot):
    (problem,) = maps(shot, tmp_path / "maps", size=4).problems
    assert (problem.severity, problem.prim, problem.frame) == ("warning", MESH, None)
    assert "faces are so small or thin that no texel's centre is in them" in problem.message
    assert maps(shot, tmp_path / "maps", size=64).problems == []


# ---- The command ----


def test_command(tmp_path, shot, capfd):
    folder = tmp_path / "deep" / "maps"
    assert main(["maps", str(shot), "-o", str(folder), "--frames", "1002-1003", "--size", "16", "--jobs", "2"]) == 0
    out, err = capfd.readouterr()
    assert (
        out.splitlines()[-1] == f"{folder}: 8 maps of 16 x 16 texels written" and f"{MESH}: slide: 2 maps, 0 to" in out
    )
    assert "2 of 2 frames" in err
    assert main(["maps", str(shot), "-o", str(folder), "--frames", "1003", "--size", "16", "--json", "--quiet"]) == 0
    out, err = capfd.readouterr()
    said = json.loads(out)
    assert err == "" and (said["stage"], said["folder"]) == (str(shot), str(folder))
    assert [each["kind"] for each in said["maps"]] == list(KINDS) and said["meshes"][0]["frames"] == [1003.0]
    slide = said["maps"][2]
    assert (slide["file"], slide["frame"], slide["tile"]) == (str(folder / "skin_GEO.slide.1003.exr"), 1003.0, None)
    assert slide["lowest"] == 0 and slide["highest"] == pytest.approx(
        said["meshes"][0]["patches"][0]["max"]["largest_slide"], rel=1e-5
    )
    assert main(["maps", str(shot), "-o", str(folder), "--frames=-5", "--map-size", "16", "--quiet"]) == 0
    out, err = capfd.readouterr()
    assert out == "" and "beyond the samples" in err and (folder / "skin_GEO.slide.-0005.exr").is_file()


def test_another_primvar(tmp_path, capfd):
    stage, mesh = charted()
    value = [Gf.Vec2f(*pair) for pair in sheet_st(low=0.6).tolist()]
    stages.set_primvar(mesh, "uv2", Types.Float2Array, "varying", value)
    shot = stages.save(stage, tmp_path / "shot.usda")
    assert main(["maps", str(shot), "-o", str(tmp_path / "m"), "--st", "uv2", "--size", "32", "--quiet"]) == 0
    texels = read(tmp_path / "m" / "skin_GEO.forceDensity.1001.exr")
    assert texels[8, 24] == 1 and texels[24, 8] == 0
    assert main(["maps", str(shot), "-o", str(tmp_path / "m"), "--st", ""]) == 2
    assert "texture coordinates is empty" in capfd.readouterr().err


def test_a_stage_that_is_open(tmp_path):
    stage, _mesh = charted()
    before = stage.GetRootLayer().ExportToString()
    maps(stage, tmp_path / "open", size=16)
    maps(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "saved", size=16)
    assert files(tmp_path / "open") == files(tmp_path / "saved")
    assert stage.GetRootLayer().ExportToString() == before


# ---- Bad texture coordinates ----


def with_st(spoil) -> Usd.Stage:
    stage, mesh = charted()
    spoil(mesh)
    return stage


def short(mesh):
    set_st(mesh, sheet_st()[:-1])


def uniform(mesh):
    set_st(mesh, [(0.5, 0.5)] * 36, "uniform")


def indexed_out_of_range(mesh):
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st").SetIndices([49] * 49)


def not_finite(mesh):
    st = sheet_st()
    st[24] = np.nan
    set_st(mesh, st)


def negative(mesh):
    set_st(mesh, sheet_st() - 0.5)


def triples(mesh):
    stages.set_primvar(mesh, "st", Types.Float3Array, "vertex", [Gf.Vec3f(0)] * 49)


def gone(mesh):
    mesh.GetPrim().RemoveProperty("primvars:st")


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (gone, f"{MESH}: has no primvars:st, in which its maps would be drawn"),
        (short, f"{MESH}: primvars:st has 48 values, but the mesh has 49 points"),
        (uniform, f"{MESH}: primvars:st has interpolation uniform; a map needs"),
        (triples, f"{MESH}: primvars:st is float3\\[\\]; a map needs pairs of floats"),
        (indexed_out_of_range, f"{MESH}: primvars:st:indices\\[0\\] is 49, but primvars:st has 49 values"),
        (not_finite, f"{MESH}: patch {PATCH}: primvars:st: face 14 has st \\(-?nan, -?nan\\)"),
        (negative, f"{MESH}: patch {PATCH}: primvars:st: face 0 has st \\(-0.4, -0.4\\), which is in no UDIM tile"),
    ],
)
def test_bad_texture_coordinates(spoil, says, tmp_path, capfd):
    shot = stages.save(with_st(spoil), tmp_path / "shot.usda")
    with pytest.raises(StageProblems, match=says):
        maps(shot, tmp_path / "maps")
    assert main(["maps", str(shot), "-o", str(tmp_path / "maps"), "--json"]) == 3
    assert json.loads(capfd.readouterr().out)["problems"][0]["prim"] == MESH
    assert not (tmp_path / "maps").exists()


def test_texture_coordinates_that_go_bad(tmp_path):
    """Animated: the frames before are whole, of the bad one there is nothing."""
    stage, mesh = charted()
    for frame, shift in zip(FRAMES, (0, 0.05, -0.5), strict=True):
        set_st(mesh, sheet_st() + shift, time=frame)
    shot = stages.save(stage, tmp_path / "shot.usda")
    with pytest.raises(FrameProblem, match=f"{MESH}: patch {PATCH}: frame 1003: primvars:st: face 0 has st"):
        maps(shot, tmp_path / "maps", size=32, jobs=3)
    assert sorted(files(tmp_path / "maps")) == sorted(
        f"skin_GEO.{kind}.{frame}.exr" for kind in KINDS for frame in (1001, 1002)
    )
    moved = [read(tmp_path / "maps" / f"skin_GEO.forceDensity.{frame}.exr") for frame in (1001, 1002)]
    assert (moved[0] != moved[1]).any()


def test_texture_coordinates_that_move_over_a_mesh_that_does_not(tmp_path):
    """The mesh has one map, by the first coordinates."""
    stage = stages.new_stage()
    mesh = stages.add_mesh(stage, stages.grid(), frames=[])
    stages.add_patch(mesh, stages.grid().all_faces)
    for frame, shift in zip(FRAMES, (0, 0.05, 0.1), strict=True):
        value = [Gf.Vec2f(*pair) for pair in (sheet_st() + shift).tolist()]
        stages.set_primvar(mesh, "moving", Types.TexCoord2fArray, "vertex", value, frame)
    maps(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "maps", size=20, st="moving")
    assert sorted(files(tmp_path / "maps")) == sorted(f"skin_GEO.{kind}.exr" for kind in KINDS)
    maps(stages.save(charted()[0], tmp_path / "still.usda"), tmp_path / "still", size=20, frames=[1001])
    names = ("maps/skin_GEO.forceDensity.exr", "still/skin_GEO.forceDensity.1001.exr")
    np.testing.assert_array_equal(*(read(tmp_path / name) for name in names))


def test_a_bad_frame(tmp_path):
    stage, mesh = charted()
    mesh.GetPointsAttr().Set(stages.vectors(np.full((49, 3), np.nan)), FRAMES[1])
    shot = stages.save(stage, tmp_path / "shot.usda")
    with pytest.raises(FrameProblem, match=f"{MESH}: frame 1002: points: vertex 0 is not finite"):
        maps(shot, tmp_path / "maps", size=32, jobs=2)
    assert sorted(files(tmp_path / "maps")) == sorted(f"skin_GEO.{kind}.1001.exr" for kind in KINDS)


# ---- Bad folders and files ----


def test_folders_that_cannot_be(tmp_path, shot, capfd):
    (tmp_path / "file").write_text("old")
    (tmp_path / "loop").symlink_to("loop")
    cases = {
        tmp_path / "file": "is not a folder",
        tmp_path / "file" / "below": f"{tmp_path / 'file'} is not a folder",
        tmp_path / ("x" * 300): "File name too long",
        tmp_path / "loop": "",
    }
    for folder, says in cases.items():
        with pytest.raises(UsageError, match=f"output {folder}: .*{says}"):
            maps(shot, folder)
        assert main(["maps", str(shot), "-o", str(folder)]) == 2
        assert str(folder) in capfd.readouterr().err
    assert (tmp_path / "file").read_text() == "old"


def test_folders_that_may_not_be_written(tmp_path):
    stage, _mesh = charted()
    (tmp_path / "locked").mkdir(mode=0o555)
    for folder in (tmp_path, *list(tmp_path.parents)[:2]):
        folder.chmod(0o755)
    with stages.as_nobody():
        for folder in (tmp_path / "locked", tmp_path / "locked" / "below"):
            with pytest.raises(UsageError, match=f"output {folder}: .*is not writable"):
                maps(stage, folder)
    assert not list((tmp_path / "locked").iterdir())


def test_a_file_that_cannot_be_replaced(tmp_path, shot):
    (tmp_path / "maps" / "skin_GEO.forceDensity.1003.exr").mkdir(parents=True)
    with pytest.raises(UsageError, match=r"skin_GEO\.forceDensity\.1003\.exr: is a folder"):
        maps(shot, tmp_path / "maps", size=8)
    assert len(list((tmp_path / "maps").iterdir())) == 1


@pytest.mark.parametrize("tile", ["", "<UDIM>."])
def test_maps_that_the_stage_reads_are_never_written(tile, tmp_path):
    """However they are reached: here through a link, and at a frame other than the first."""
    stage, mesh = charted(high=1.5 if tile else 0.9)
    shot = stages.save(stage, tmp_path / "shot.usda")
    maps(shot, tmp_path / "maps", size=64, frames=[1002])
    (tmp_path / "link").symlink_to("maps")
    asset = Sdf.AssetPath(f"./link/skin_GEO.forceDensity.{tile}1002.exr")
    stages.set_property(mesh, "forceDensityMap", asset, time=FRAMES[0])
    stages.save(stage, shot)
    before = files(tmp_path / "maps")
    with pytest.raises(UsageError, match=r"skin_GEO.forceDensity\..*1002.exr: the stage reads this file"):
        maps(shot, tmp_path / "maps", size=64)
    assert files(tmp_path / "maps") == before
    maps(shot, tmp_path / "other", size=64)


def test_maps_that_a_resolver_finds_are_never_written(tmp_path):
    stage, mesh = charted()
    shot, library = stages.save(stage, tmp_path / "shot.usda"), tmp_path / "library" / "maps"
    maps(shot, library, size=16, frames=[1002])
    stages.set_property(mesh, "weightMap", Sdf.AssetPath("maps/skin_GEO.slide.1002.exr"))
    before = files(library)
    program = """
        import sys, skinslide
        from pxr import Ar
        Ar.DefaultResolver.SetDefaultSearchPath([sys.argv[1]])
        skinslide.maps(sys.argv[2], sys.argv[3], size=16)
    """
    arguments = [str(tmp_path / "library"), str(stages.save(stage, tmp_path / "mapped.usda")), str(library)]
    command = [sys.executable, "-c", textwrap.dedent(program), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert f"output {library / 'skin_GEO.slide.1002.exr'}: the stage reads this file" in done.stderr
    assert files(library) == before


def test_a_stage_in_the_way(tmp_path):
    """A layer lies under the name of a map, as a link."""
    shot = stages.save(charted()[0], tmp_path / "shot.usda")
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "skin_GEO.slide.1002.exr").hardlink_to(shot)
    before = shot.read_bytes()
    with pytest.raises(UsageError, match=r"skin_GEO\.slide\.1002\.exr: the stage reads this file"):
        maps(shot, tmp_path / "maps", size=8)
    assert shot.read_bytes() == before


def test_no_device_is_asked_for(tmp_path, shot):
    """Where EGL finds nothing the same bytes are drawn, whatever device is named for a lookup that needs none."""
    maps(shot, tmp_path / "here", size=64)
    command = [sys.executable, "-m", "skinslide", "maps", str(shot), "-o", str(tmp_path / "there"), "--size", "64"]
    command += ["--lookup", "exact", "--egl-device", "999"]
    nothing = {"__EGL_VENDOR_LIBRARY_DIRS": str(tmp_path), "LIBGL_DRIVERS_PATH": str(tmp_path)}
    done = subprocess.run(command, env=os.environ | nothing, capture_output=True, check=False)
    assert done.returncode == 0
    assert files(tmp_path / "there") == files(tmp_path / "here")


def test_texels_by_barycentric_coordinates_in_numpy():
    """Triangles at random, each alone: covered where all three weights are positive, and with their sum of values."""
    dice = np.random.default_rng(7)
    y, x = (np.mgrid[:48, :48] + 0.5)[:, ::-1]
    for _ in range(50):
        st, values = dice.uniform(0, 1, (3, 2)).astype(np.float32), dice.uniform(-1, 1, 3).astype(np.float32)
        corners = Corners(np.array([3, 4]), np.array([0, 1, 2, 3, 4, 5, 6]), 7, np.array([1, 0]), np.zeros((7, 2)))
        corners.st[:3], corners.st[3:] = st, [(0, 0), (1, 0), (1, 1), (0, 1)]
        texels, missed = draw_map(corners, np.concatenate([values, [9] * 4]), 48)
        (ax, ay), (bx, by), (cx, cy) = st.astype(np.float64) * 48
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        at_b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        at_c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        inside = (at_b > 0) & (at_c > 0) & (at_b + at_c < 1)
        expected = np.where(inside, (1 - at_b - at_c) * values[0] + at_b * values[1] + at_c * values[2], 9)
        np.testing.assert_allclose(texels, expected, atol=1e-6)
        assert missed == (not inside.any())


@pytest.mark.parametrize(
    ("size", "says"),
    [
        (0, "size is 0; it must be at least 1"),
        (16385, "size is 16385; it must be at most 16384"),
        (10**12, "size is 1000000000000"),
        (1.5, "size is 1.5"),
    ],
)
def test_sizes(size, says, tmp_path, shot):
    with pytest.raises(UsageError, match=says):
        maps(shot, tmp_path / "maps", size=size)
    assert not (tmp_path / "maps").exists()


def test_a_full_disk_leaves_no_part_of_a_file(tmp_path, shot):
    """A limit on the size of files stands in for the disk."""
    maps(shot, tmp_path / "maps", size=8)
    before = files(tmp_path / "maps")
    code = """
        import resource, signal, sys, skinslide
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
        try:
            skinslide.maps(sys.argv[1], sys.argv[2], size=256, frames=[1003])
        except skinslide.StageError as error:
            print(error, file=sys.stderr)
            sys.exit(1)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(shot), str(tmp_path / "maps")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and done.stderr.startswith(
        f"output {tmp_path / 'maps' / 'skin_GEO.stretchBefore.1003.exr'}"
    )
    assert files(tmp_path / "maps") == before


def test_a_folder_that_goes_away(tmp_path, shot):
    """If the folder goes away between frames it is made again; if its place is taken, that is reported."""

    def replace(done: int, _total: int) -> None:
        if done == 1:
            os.rename(tmp_path / "maps", tmp_path / "moved")
            (tmp_path / "maps").write_text("in the way")

    with pytest.raises(StageError, match=f"output {tmp_path / 'maps'}: .*File exists"):
        maps(shot, tmp_path / "maps", size=8, progress=replace)
    assert len(files(tmp_path / "moved")) == 4


@pytest.mark.parametrize(("number", "code", "word"), [("SIGINT", 130, "interrupted"), ("SIGTERM", 143, "ended")])
def test_an_ended_command_leaves_whole_files(number, code, word, tmp_path, shot):
    program = f"""
        import os, signal, sys
        from skinslide.command import cli, progress
        def end(done, total):
            os.kill(os.getpid(), signal.{number})
        progress._lines = lambda: end
        sys.exit(cli.main(["maps", sys.argv[1], "-o", sys.argv[2], "--size", "64", "--jobs", "2"]))
    """
    command = [sys.executable, "-c", textwrap.dedent(program), str(shot), str(tmp_path / "maps")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == code and word in done.stderr
    assert done.stderr.endswith(f"; every file in {tmp_path / 'maps'} is whole\n")
    assert sorted(files(tmp_path / "maps")) == sorted(f"skin_GEO.{kind}.1001.exr" for kind in KINDS)
    assert all(decode_exr(data).pixels.shape == (64, 64) for data in files(tmp_path / "maps").values())
