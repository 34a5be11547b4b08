"""A `.skinslide` file, opened, is a layer whose points are those of the bake, computed when they are asked for."""

import gc
import os
import random
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdUtils, UsdValidation

import skinslide
from layers import (
    HEAD,
    LIBRARY,
    baked,
    cache_bytes,
    make,
    most_at_once,
    open_mesh,
    points,
    said,
    same,
    samples,
    solve_count,
    write,
)
from repository import ROOT
from stages import (
    FRAMES,
    MESH,
    add_mesh,
    add_patch,
    grid,
    patched_stage,
    save,
    set_property,
    vectors,
)


@pytest.fixture
def path(tmp_path):
    return make(tmp_path)


@pytest.fixture
def expected(path, tmp_path):
    return samples(baked(path, tmp_path), "points")


def bends(expected: dict) -> bool:
    """Whether anything slid at all, so that a test of equal points says something."""
    return not np.array_equal(expected[1002.0], grid().moved(1002))


# ---- Lazy ----


def test_nothing_is_solved_before_it_is_asked_for(path):
    before = solve_count()
    _stage, mesh = open_mesh(path)
    attr = mesh.GetPointsAttr()
    assert solve_count() - before == 0
    assert attr.GetTimeSamples() == list(FRAMES)
    assert attr.GetNumTimeSamples() == 3
    assert attr.GetBracketingTimeSamples(1001.5) == (1001.0, 1002.0)
    assert attr.ValueMightBeTimeVarying() and attr.HasAuthoredValue()
    assert attr.GetTypeName() == Sdf.ValueTypeNames.Point3fArray
    assert solve_count() - before == 0
    attr.Get(1002)
    assert solve_count() - before == 1
    attr.Get(1002)
    mesh.GetExtentAttr().Get(1002)
    assert solve_count() - before == 1
    # Both sides are needed, and one of them is known.
    attr.Get(1002.5)
    assert solve_count() - before == 2


def test_between_two_samples_both_are_solved(path):
    _stage, mesh = open_mesh(path)
    before = solve_count()
    mesh.GetPointsAttr().Get(1001.5)
    assert solve_count() - before == 2


def test_listing_and_typing_through_the_layer_solves_nothing(path):
    layer = Sdf.Layer.FindOrOpen(str(path))
    before, at = solve_count(), f"{MESH}.points"
    spec = layer.GetAttributeAtPath(at)
    assert spec.HasInfo("timeSamples") and "timeSamples" in spec.ListInfoKeys()
    assert layer.ListAllTimeSamples() == list(FRAMES)
    assert layer.GetNumTimeSamplesForPath(at) == 3
    assert layer.GetBracketingTimeSamplesForPath(at, 900) == (True, 1001.0, 1001.0)
    assert layer.GetBracketingTimeSamplesForPath(at, 2000) == (True, 1003.0, 1003.0)
    assert layer.GetBracketingTimeSamplesForPath(at, 1002) == (True, 1002.0, 1002.0)
    assert layer.QueryTimeSample(at, 1001.5) is None
    assert solve_count() == before


# ---- What it holds, beside the bytes of a bake, which tests/stage compares ----


def test_a_cache_without_samples_gives_a_default(tmp_path):
    stage, mesh = patched_stage(grid(), rest="rest")
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(vectors(grid().moved(1003)))
    save(stage, tmp_path / "cache.usda")
    path = write(tmp_path / "x.skinslide")
    layer = baked(path, tmp_path)
    bake = np.array(layer.GetAttributeAtPath(f"{MESH}.points").default)
    before = solve_count()
    stage, mesh = open_mesh(path)
    assert solve_count() == before
    assert np.asarray(mesh.GetPointsAttr().Get()).tobytes() == bake.tobytes()
    assert not np.array_equal(bake, grid().moved(1003))
    assert mesh.GetPointsAttr().GetTimeSamples() == []


def test_points_in_the_text_itself(tmp_path):
    stage, _mesh = patched_stage(grid())
    path = save(stage, tmp_path / "cache.usda").rename(tmp_path / "x.skinslide")
    expected = samples(baked(path, tmp_path), "points")
    assert bends(expected) and same(samples(Sdf.Layer.FindOrOpen(str(path)), "points"), expected)


def test_other_opinions_are_the_texts_own(path):
    layer, text = Sdf.Layer.FindOrOpen(str(path)), Sdf.Layer.CreateAnonymous(".usda")
    text.ImportFromString(path.read_text())
    assert layer.subLayerPaths == text.subLayerPaths
    assert layer.pseudoRoot.GetInfo("metersPerUnit") == 0.01
    assert [prop.name for prop in layer.GetPrimAtPath(MESH).properties] == ["points", "extent"]
    assert not layer.permissionToEdit


# ---- Ways to bring it in ----


def shot(folder: Path, text: str) -> Path:
    (folder / "shot.usda").write_text(f"#usda 1.0\n{text}")
    return folder / "shot.usda"


@pytest.mark.parametrize(
    "text",
    [
        "(subLayers = [@./x.skinslide@])",
        'def "World" (references = @./x.skinslide@) {}',
        'def "World" (payload = @./x.skinslide@) {}',
        'def "World" (variants = { string skin = "slid" }; add variantSets = "skin") '
        '{\nvariantSet "skin" = {\n"slid" (payload = @./x.skinslide@) {}\n"stuck" (payload = @./cache.usda@) {}\n}\n}',
    ],
)
def test_composed_into_a_shot(tmp_path, expected, text):
    _stage, mesh = open_mesh(shot(tmp_path, text))
    assert bends(expected)
    assert same({time: points(mesh, time) for time in mesh.GetPointsAttr().GetTimeSamples()}, expected)


def test_a_variant_of_the_shot_chooses(tmp_path, expected):
    text = (
        'def "World" (variants = { string skin = "stuck" }; add variantSets = "skin") '
        '{\nvariantSet "skin" = {\n"slid" (payload = @./x.skinslide@) {}\n"stuck" (payload = @./cache.usda@) {}\n}\n}'
    )
    stage, mesh = open_mesh(shot(tmp_path, text))
    assert np.array_equal(points(mesh, 1002), grid().moved(1002))
    stage.GetPrimAtPath("/World").GetVariantSet("skin").SetVariantSelection("slid")
    assert points(mesh, 1002).tobytes() == expected[1002.0].tobytes()


def test_a_payload_is_moved_and_scaled_in_time(tmp_path, expected):
    text = 'def "World" (payload = @./x.skinslide@ (offset = 10; scale = 2)) {}'
    _stage, mesh = open_mesh(shot(tmp_path, text))
    assert mesh.GetPointsAttr().GetTimeSamples() == [2012.0, 2014.0, 2016.0]
    assert points(mesh, 2014).tobytes() == expected[1002.0].tobytes()


def test_the_cache_is_moved_and_scaled_in_time(tmp_path):
    stage, _ = patched_stage(grid())
    save(stage, tmp_path / "cache.usda")
    path = tmp_path / "x.skinslide"
    path.write_text(
        f'#usda 1.0\n({HEAD})\ndef "World" (references = @./cache.usda@ (offset = 0.1; scale = 0.3)) {{}}\n'
    )
    bake = samples(baked(path, tmp_path), "points")
    assert same(samples(Sdf.Layer.FindOrOpen(str(path)), "points"), bake) and len(bake) == 3


def test_a_source_of_another_rate(tmp_path):
    """Without a rate of its own the file takes that of its source, so its samples stay where they are."""
    stage, _ = patched_stage(grid())
    stage.SetTimeCodesPerSecond(30)
    save(stage, tmp_path / "cache.usda")
    path = write(tmp_path / "x.skinslide", head='defaultPrim = "World"')
    stage, mesh = open_mesh(path)
    assert stage.GetTimeCodesPerSecond() == 30
    bake = baked(path, tmp_path)
    assert bake.timeCodesPerSecond == 30
    assert same(samples(bake, "points"), samples(stage.GetRootLayer(), "points"))
    _slower, mesh = open_mesh(shot(tmp_path, "(timeCodesPerSecond = 24; subLayers = [@./x.skinslide@])"))
    assert mesh.GetPointsAttr().GetTimeSamples() == pytest.approx([frame * 24 / 30 for frame in FRAMES])


def test_absolute_and_package_sources(tmp_path, expected):
    absolute = write(tmp_path / "absolute.skinslide", cache=str(tmp_path / "cache.usda"))
    assert same(samples(Sdf.Layer.FindOrOpen(str(absolute)), "points"), expected)
    assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "cache.usda"), str(tmp_path / "cache.usdz"))
    packed = write(tmp_path / "packed.skinslide", cache="./cache.usdz")
    assert same(samples(Sdf.Layer.FindOrOpen(str(packed)), "points"), expected)


def test_an_asset_path_by_expression(tmp_path, expected):
    head = f'{HEAD}; expressionVariables = {{ string CACHE = "cache" }}'
    path = write(tmp_path / "by.skinslide", head=head, cache='`"./${CACHE}.usda"`')
    assert same(samples(Sdf.Layer.FindOrOpen(str(path)), "points"), expected)


def test_exported_it_is_a_layer_like_any_other(path, tmp_path, expected):
    layer = Sdf.Layer.FindOrOpen(str(path))
    assert "points.timeSamples" in layer.ExportToString()
    for name in ("out.usda", "out.usdc"):
        assert layer.Export(str(tmp_path / name))
        assert same(samples(Sdf.Layer.FindOrOpen(str(tmp_path / name)), "points"), expected)


def test_set_up_by_the_tool_it_opens_as_it_is(tmp_path):
    stage = patched_stage(grid())[0]
    cache, path = save(stage, tmp_path / "cache.usda"), tmp_path / "made.skinslide"
    skinslide.setup_to_file(cache, path, MESH, "more", faces="0-20")
    expected = samples(baked(path, tmp_path), "points")
    assert bends(expected) and same(samples(Sdf.Layer.FindOrOpen(str(path)), "points"), expected)


def test_validation_is_clean(path):
    stage, _ = open_mesh(path)
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    problems = UsdValidation.ValidationContext(validators).Validate(stage)
    assert [problem.GetMessage() for problem in problems] == []


def test_a_stage_with_a_live_file_is_not_slid_twice(path, tmp_path):
    stage, _ = open_mesh(shot(tmp_path, "(subLayers = [@./x.skinslide@])"))
    report = skinslide.check(stage)
    assert any("is slid already, by" in problem.message for problem in report.problems)
    assert report.meshes == []


def test_a_file_above_another_passes_its_points_on(path, tmp_path, expected):
    with said() as messages:
        above = write(tmp_path / "above.skinslide", cache="./x.skinslide")
        _stage, mesh = open_mesh(above)
        assert points(mesh, 1002).tobytes() == expected[1002.0].tobytes()
    assert any("is slid already, by" in message for message in messages)


# ---- Live ----


def payload(folder: Path, *live: str) -> Path:
    return shot(folder, f'def "World" (payload = @./x.skinslide@) {{\n{chr(10).join(live)}\n}}')


def test_live_attributes_become_arguments(tmp_path):
    make(tmp_path, lambda mesh: set_property(mesh, "envelope", 0.5))
    (tmp_path / "quarter").mkdir()
    quarter = make(tmp_path / "quarter", lambda mesh: set_property(mesh, "envelope", 0.25))
    _stage, mesh = open_mesh(payload(tmp_path, "uniform float skinSlide:live:envelope = 0.5"))
    assert points(mesh, 1002).tobytes() == samples(baked(quarter, tmp_path), "points")[1002.0].tobytes()


def test_editing_live_attributes_recomputes(tmp_path, expected):
    stage, mesh = open_mesh(payload(tmp_path))
    prim = stage.GetPrimAtPath("/World")
    assert points(mesh, 1003).tobytes() == expected[1003.0].tobytes()
    envelope = prim.CreateAttribute("skinSlide:live:envelope", Sdf.ValueTypeNames.Float, False, Sdf.VariabilityUniform)
    envelope.Set(0.0)
    assert np.array_equal(points(mesh, 1003), grid().moved(1003))
    envelope.Set(0.5)
    half = points(mesh, 1003)
    assert not np.array_equal(half, expected[1003.0]) and not np.array_equal(half, grid().moved(1003))
    envelope.Block()
    assert points(mesh, 1003).tobytes() == expected[1003.0].tobytes()
    token = prim.CreateAttribute(
        "skinSlide:live:interpolation", Sdf.ValueTypeNames.Token, False, Sdf.VariabilityUniform
    )
    token.Set("meanValue")
    assert not np.array_equal(points(mesh, 1003), expected[1003.0])
    lookup = prim.CreateAttribute("skinSlide:live:lookup", Sdf.ValueTypeNames.Token, False, Sdf.VariabilityUniform)
    token.Set("linear")
    lookup.Set("exact")
    assert points(mesh, 1003).tobytes() == expected[1003.0].tobytes()


def test_editing_anything_else_does_not(tmp_path, path):
    stage, mesh = open_mesh(payload(tmp_path))
    before = points(mesh, 1003), solve_count()
    stage.GetPrimAtPath("/World").CreateAttribute("skinSlide:other", Sdf.ValueTypeNames.Float).Set(0.5)
    UsdGeom.Xformable(stage.GetPrimAtPath("/World")).AddTranslateOp().Set((1, 2, 3))
    assert points(mesh, 1003).tobytes() == before[0].tobytes()
    assert solve_count() == before[1]


@pytest.mark.parametrize(
    ("live", "said_of_it"),
    [
        (
            'uniform token skinSlide:live:interpolation = "a b&c:d=%41@"',
            "skinSlide:live:interpolation is 'a b&c:d=%41@'",
        ),
        ("uniform float skinSlide:live:envelope = inf", "skinSlide:live:envelope is inf"),
        ('uniform token skinSlide:live:lookup = "quick"', "it must be one of auto, egl, exact"),
    ],
)
def test_live_values_that_cannot_be_used_are_said_and_left_out(tmp_path, expected, live, said_of_it):
    with said() as messages:
        _stage, mesh = open_mesh(payload(tmp_path, live))
        assert points(mesh, 1002).tobytes() == expected[1002.0].tobytes()
    assert any(said_of_it in message for message in messages)


# ---- Reload, muting, several stages ----


def test_reload_picks_up_a_change_of_the_source(tmp_path, path):
    stage, mesh = open_mesh(path)
    first = points(mesh, 1003)
    cache = Sdf.Layer.FindOrOpen(str(tmp_path / "cache.usda"))
    cache.GetAttributeAtPath(f"{MESH}.points")
    changed = patched_stage(grid())
    changed[1].GetPointsAttr().Set(vectors(grid().moved(1007)), 1003)
    changed[1].GetPointsAttr().Set(vectors(grid().moved(1008)), 1004)
    save(changed[0], tmp_path / "new.usda")
    cache_text = (tmp_path / "new.usda").read_text()
    (tmp_path / "cache.usda").write_text(cache_text)
    stage.Reload()
    assert mesh.GetPointsAttr().GetTimeSamples() == [1001.0, 1002.0, 1003.0, 1004.0]
    assert not np.array_equal(points(mesh, 1003), first)
    fresh = tmp_path / "fresh"
    fresh.mkdir()
    (fresh / "cache.usda").write_text(cache_text)
    bake = baked(write(fresh / "x.skinslide"), fresh)
    assert same(samples(stage.GetRootLayer(), "points"), samples(bake, "points"))


def test_reload_picks_up_a_change_of_a_source_of_the_source(tmp_path):
    make(tmp_path)
    (tmp_path / "between.usda").write_text("#usda 1.0\n(subLayers = [@./cache.usda@])")
    path = write(tmp_path / "x.skinslide", cache="./between.usda")
    layer = Sdf.Layer.FindOrOpen(str(path))
    dependencies = {Path(name).name for name in layer.GetExternalAssetDependencies()}
    assert dependencies == {"cache.usda", "between.usda"}
    edited = Sdf.Layer.FindOrOpen(str(tmp_path / "cache.usda"))
    edited.SetTimeSample(f"{MESH}.points", 1009, vectors(grid().moved(1003)))
    edited.Save()
    assert layer.Reload()
    assert 1009.0 in layer.ListTimeSamplesForPath(f"{MESH}.points")


def test_muting_the_file_leaves_the_cache(path):
    stage = Usd.Stage.Open(str(path))
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().subLayerPaths[:] = [str(path), str(path.parent / "cache.usda")]
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH))
    assert not np.array_equal(points(mesh, 1003), grid().moved(1003))
    stage.MuteLayer(str(path))
    assert np.array_equal(points(mesh, 1003), grid().moved(1003))
    stage.UnmuteLayer(str(path))
    assert not np.array_equal(points(mesh, 1003), grid().moved(1003))


def test_two_stages_share_a_layer_and_its_frames(path, expected):
    first, second = open_mesh(path), open_mesh(path)
    before = solve_count()
    for _, mesh in (first, second):
        assert points(mesh, 1002).tobytes() == expected[1002.0].tobytes()
    assert solve_count() - before == 1


def test_a_closed_layer_gives_its_memory_back(path):
    gc.collect()
    before = cache_bytes()
    stage, mesh = open_mesh(path)
    points(mesh, 1002), points(mesh, 1003)
    assert cache_bytes() - before >= 2 * 49 * 12
    del mesh, stage
    gc.collect()
    assert cache_bytes() == before


def test_the_cache_is_bounded(path):
    script = (
        "import sys; sys.path.insert(0, 'tests/support'); from layers import *; "
        f"stage, mesh = open_mesh({str(path)!r}); [points(mesh, 1002) for _ in range(3)]; "
        "assert solve_count() == 3 and cache_bytes() == 0"
    )
    run_python(script, SKINSLIDE_CACHE_MB="0")


# ---- Threads ----


def big(folder: Path, columns: int) -> Path:
    """A mesh whose frames take long enough to meet."""
    stage, _ = patched_stage(grid(columns, columns))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(MESH))
    for frame in range(1004, 1011):
        mesh.GetPointsAttr().Set(vectors(grid(columns, columns).moved(frame / 4 + 751)), frame)
    save(stage, folder / "cache.usda")
    return write(folder / "x.skinslide")


def test_eight_threads_read_random_frames(tmp_path):
    path = big(tmp_path, 12)
    expected = samples(baked(path, tmp_path), "points")
    before = solve_count()
    _stage, mesh = open_mesh(path)

    def read(seed: int) -> bool:
        order = random.Random(seed).choices(sorted(expected), k=40)
        return all(points(mesh, time).tobytes() == expected[time].tobytes() for time in order)

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(read, range(8)))
    assert solve_count() - before <= len(expected)


def test_many_files_open_at_once_in_one_stage(tmp_path, expected):
    """Stages open payloads on several threads: each reads files and composes, some of them the same ones."""
    lines = []
    for number in range(16):
        write(tmp_path / f"x{number % 6}.skinslide")
        lines.append(
            f'def "c{number}" (payload = @./x{number % 6}.skinslide@) '
            f"{{\nuniform float skinSlide:live:envelope = {1 - number % 2}\n}}"
        )
    script = (
        "import skinslide, sys; from pxr import Usd; "
        f"stage = Usd.Stage.Open({str(shot(tmp_path, chr(10).join(lines)))!r}); "
        "assert all(len(stage.GetAttributeAtPath(f'/c{i}/char/geo/skin_GEO.points').GetTimeSamples()) == 3 "
        "for i in range(16))"
    )
    for _ in range(3):
        run_python(script)


def test_two_frames_are_solved_at_the_same_time(tmp_path):
    _stage, mesh = open_mesh(big(tmp_path, 80))
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda time: points(mesh, time), sorted(mesh.GetPointsAttr().GetTimeSamples())))
    assert most_at_once() >= 2


# ---- Without the format ----


def run_python(script: str, **environment: str) -> subprocess.CompletedProcess:
    done = subprocess.run(
        [sys.executable, "-c", script],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done


def test_another_usd_leaves_the_format_out_and_the_bake_working(path, tmp_path, expected):
    script = (
        "from pxr import Usd; Usd.GetVersion = lambda: (0, 99, 1); import skinslide; import skinslide.shot.bake; "
        f"skinslide.bake_to_file({str(path)!r}, {str(tmp_path / 'other.usdc')!r})"
    )
    done = run_python(script)
    assert done.stderr.count("was built for USD 0.26.8, but this is USD 0.99.1") == 1
    assert same(samples(Sdf.Layer.FindOrOpen(str(tmp_path / "other.usdc")), "points"), expected)


def test_the_plug_in_names_no_library_of_usd():
    """Its name has a hash that differs from wheel to wheel."""
    dynamic = subprocess.run(["readelf", "-d", LIBRARY], capture_output=True, text=True, check=True).stdout
    needed = [line for line in dynamic.splitlines() if "NEEDED" in line]
    assert any("libskinslide.so" in line for line in needed)
    assert not any("usd" in line or "tbb" in line or "python" in line for line in needed)


def test_the_plug_in_is_found_by_its_path(path):
    """As by a host; the symbols of the wheel's library are made visible as importing skinslide does."""
    script = (
        "import ctypes, glob, os, pxr; from pxr import Sdf, Tf; "
        "root = os.path.dirname(os.path.dirname(pxr.__file__)); "
        "[ctypes.CDLL(name, ctypes.RTLD_GLOBAL) for name in glob.glob(root + '/usd_core.libs/libusd_ms-*')]; "
        f"layer = Sdf.Layer.FindOrOpen({str(path)!r}); "
        f"assert layer.GetNumTimeSamplesForPath({MESH + '.points'!r}) == 3; "
        "from pxr import Usd; assert Usd.SchemaRegistry().FindAppliedAPIPrimDefinition('SkinSlideAPI')"
    )
    run_python(script, PXR_PLUGINPATH_NAME=skinslide.plugin_dir())


def test_two_meshes_and_two_patches(tmp_path):
    stage, mesh = patched_stage(grid())
    add_patch(mesh, np.arange(12), "other")
    other = add_mesh(stage, grid(5, 4), "/World/char/geo/other_GEO")
    add_patch(other, np.arange(20))
    save(stage, tmp_path / "cache.usda")
    path = write(tmp_path / "x.skinslide")
    bake, flat = baked(path, tmp_path), open_mesh(path)[0].Flatten()
    for attribute in (f"{MESH}.points", "/World/char/geo/other_GEO.points"):
        for time in FRAMES:
            a, b = (np.asarray(layer.QueryTimeSample(attribute, time)) for layer in (bake, flat))
            assert a.tobytes() == b.tobytes()
