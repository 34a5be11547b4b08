"""What a `.skinslide` file says when it cannot be opened, or slid, and what it gives instead."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Tf, Usd, UsdGeom, Vt

import rigs
import skinslide
import stages
from layers import HEAD, make, open_mesh, points, refusal, said, solve_count, write
from stages import FRAMES, MESH, PATCH, fin, grid, patched_stage, save, vectors

FUZZER = Path(__file__).parent / "fuzz_fileformat.py"


# ---- Files that do not open ----


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"words", "is not USDA text"),
        (b"", "is not USDA text"),
        (b"PXR-USDC\x00\x08", "is not USDA text"),
        (b"#usda 1.0\n\x00def", "it holds a zero byte"),
        (b'#usda 1.0\ndef "World" {\n', "is not valid USDA text"),
        (b"#usda 1.0\n" + b'over "a" {\n' * 20000 + b"}\n" * 20000, "nests brackets more than 500 deep, in line 502"),
    ],
)
def test_what_is_not_usda_text_is_refused(tmp_path, content, message):
    path = tmp_path / "x.skinslide"
    path.write_bytes(content)
    refused = refusal(path)
    assert message in refused and str(path) in refused


@pytest.mark.parametrize("cut", [4, 60, 150, 220])
def test_truncated_text_is_refused(tmp_path, cut):
    path = make(tmp_path)
    path.write_text(path.read_text()[:cut])
    assert "x.skinslide" in refusal(path)


@pytest.mark.parametrize(
    "between", [[], ["a.usda"], ["a.usda", "b.usda"], ["other.skinslide"], ["a.usda", "other.skinslide"]]
)
def test_a_file_that_leads_back_to_itself_is_refused(tmp_path, between):
    chain = ["x.skinslide", *between]
    for name, following in zip(chain, [*chain[1:], chain[0]], strict=True):
        (tmp_path / name).write_text(f'#usda 1.0\ndef "World" (references = @./{following}@</World>) {{}}\n')
    # In a process of its own, since a test that hangs says nothing.
    script = f"import skinslide; from pxr import Usd; Usd.Stage.Open({str(tmp_path / 'x.skinslide')!r})"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "leads back to itself" in done.stderr


def run_python(script: str, timeout: int = 60, **environment: str) -> subprocess.CompletedProcess:
    """In a process of its own: a test that hangs says nothing."""
    return subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        timeout=timeout,
        env={**os.environ, **environment},
    )


def reference(path: Path, asset: str, head: str = "") -> Path:
    path.write_text(f'#usda 1.0\n({head})\ndef "World" (references = @{asset}@</World>) {{}}\n')
    return path


def cycle_by_variable_handed_down(folder: Path) -> None:
    reference(folder / "x.skinslide", "./a.usda")
    reference(folder / "a.usda", "./b.usda", 'expressionVariables = { string X = "x" }')
    reference(folder / "b.usda", '`"./${X}.skinslide"`')


def cycle_only_by_itself(folder: Path) -> None:
    """Composed in x, y leads to z; y by itself leads to x."""
    reference(folder / "x.skinslide", "./y.skinslide", 'expressionVariables = { string X = "z" }')
    reference(folder / "y.skinslide", '`"./${X}.skinslide"`', 'expressionVariables = { string X = "x" }')
    reference(folder / "z.skinslide", "./none.usda")


def cycle_by_search_path(folder: Path) -> None:
    (folder / "lib").mkdir()
    reference(folder / "x.skinslide", "./lib/a.usda")
    reference(folder / "lib" / "a.usda", "x.skinslide")


def cycle_by_link(folder: Path) -> None:
    (folder / "link").symlink_to(".")
    reference(folder / "x.skinslide", "./link/x.skinslide")


def cycle_by_variant(folder: Path) -> None:
    (folder / "x.skinslide").write_text(
        '#usda 1.0\ndef "World" (variants = { string v = "a" }; add variantSets = "v") '
        '{\nvariantSet "v" = {\n"a" {}\n"b" (references = @./x.skinslide@</World>) {}\n}\n}'
    )


@pytest.mark.parametrize(
    "lay",
    [cycle_by_variable_handed_down, cycle_only_by_itself, cycle_by_search_path, cycle_by_link, cycle_by_variant],
)
def test_a_hidden_cycle_is_refused(tmp_path, lay):
    lay(tmp_path)
    done = run_python(f"import skinslide; from pxr import Usd; Usd.Stage.Open({str(tmp_path / 'x.skinslide')!r})")
    assert done.returncode == 1
    assert "leads back to itself" in done.stderr and "variant that is not selected" in done.stderr


def test_a_reload_that_leads_back_is_refused(tmp_path):
    """By a source that is open, and was another one when it was read."""
    path = write(tmp_path / "x.skinslide", cache="./between.usda")
    (tmp_path / "between.usda").write_text("#usda 1.0\n")
    script = (
        "import os, skinslide; from pxr import Sdf; "
        f"layer = Sdf.Layer.FindOrOpen({str(path)!r}); between = {str(tmp_path / 'between.usda')!r}; "
        "open(between, 'w').write('#usda 1.0\\n(subLayers = [@./x.skinslide@])'); os.utime(between, (1, 1)); "
        "layer.Reload(force=True)"
    )
    done = run_python(script)
    assert done.returncode == 1 and "leads back to itself" in done.stderr


def pipe_as_sublayer(folder: Path, pipe: Path) -> Path:
    return write(folder / "x.skinslide", cache=str(pipe))


def pipe_below_a_source(folder: Path, pipe: Path) -> Path:
    reference(folder / "a.usda", f"./{pipe.name}")
    return write(folder / "x.skinslide", cache="./a.usda")


def pipe_in_a_variant(folder: Path, pipe: Path) -> Path:
    (folder / "x.skinslide").write_text(
        '#usda 1.0\ndef "World" (variants = { string v = "a" }; add variantSets = "v") '
        f'{{\nvariantSet "v" = {{\n"a" {{}}\n"b" (payload = @{pipe}@</World>) {{}}\n}}\n}}'
    )
    return folder / "x.skinslide"


def pipe_as_manifest(folder: Path, pipe: Path) -> Path:
    def with_clips(mesh):
        clips = Usd.ClipsAPI(mesh.GetPrim().GetStage().GetPrimAtPath("/World/char"))
        clips.SetClipPrimPath("/World/char")
        clips.SetClipManifestAssetPath(Sdf.AssetPath(str(pipe)))

    return make(folder, with_clips)


def pipe_as_clip(folder: Path, pipe: Path) -> Path:
    (folder / "x.skinslide").write_text(
        '#usda 1.0\ndef "World" (clips = {\ndictionary default = {\n'
        f'asset[] assetPaths = [@{pipe}@]\nstring primPath = "/World"\n}}\n}}) {{\n}}'
    )
    return folder / "x.skinslide"


def pipe_as_clip_of_a_template_below(folder: Path, pipe: Path) -> Path:
    os.link(pipe, folder / "clip.1.5.usda")
    (folder / "a.usda").write_text(
        '#usda 1.0\ndef "World" (clips = {\ndictionary default = {\n'
        'string templateAssetPath = "./clip.##.#.usda"\n}\n}) {\n}'
    )
    return write(folder / "x.skinslide", cache="./a.usda")


PIPED = [
    pipe_as_sublayer,
    pipe_below_a_source,
    pipe_in_a_variant,
    pipe_as_manifest,
    pipe_as_clip,
    pipe_as_clip_of_a_template_below,
]


@pytest.mark.parametrize("lay", PIPED)
def test_a_file_that_leads_to_a_pipe_is_refused(tmp_path, lay):
    """To open one is to wait for somebody who writes into it."""
    pipe = tmp_path / "pipe.usda"
    os.mkfifo(pipe)
    done = run_python(f"import skinslide; from pxr import Sdf; Sdf.Layer.FindOrOpen({str(lay(tmp_path, pipe))!r})")
    name = tmp_path / "clip.1.5.usda" if lay is pipe_as_clip_of_a_template_below else pipe
    assert done.returncode == 1 and f"x.skinslide leads to {name}, which is not a regular file" in done.stderr


def test_a_pipe_is_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe.skinslide")
    for path in (tmp_path / "pipe.skinslide", write(tmp_path / "x.skinslide", cache="./pipe.skinslide")):
        done = run_python(f"import skinslide; from pxr import Usd; Usd.Stage.Open({str(path)!r})")
        assert "pipe.skinslide is not a regular file" in done.stderr


def test_a_manifest_that_is_the_file_itself_is_refused(tmp_path):
    done = run_python(
        "import skinslide; from pxr import Sdf; "
        f"Sdf.Layer.FindOrOpen({str(pipe_as_manifest(tmp_path, tmp_path / 'x.skinslide'))!r})"
    )
    assert done.returncode == 1 and "x.skinslide leads back to itself" in done.stderr


def test_a_variable_that_leads_elsewhere_is_no_cycle(tmp_path):
    """By the layer's own variable b leads to x; what refers to it says otherwise."""
    save(patched_stage(grid())[0], tmp_path / "cache.usda")
    path = reference(
        tmp_path / "x.skinslide", "./b.usda", f'{HEAD}; expressionVariables = {{ string X = "cache.usda" }}'
    )
    reference(tmp_path / "b.usda", '`"./${X}"`', 'expressionVariables = { string X = "x.skinslide" }')
    _stage, mesh = open_mesh(path)
    assert mesh.GetPointsAttr().GetNumTimeSamples() == 3


def test_a_cycle_by_a_sublayer_or_an_expression_is_refused(tmp_path):
    assert "leads back to itself" in refusal(write(tmp_path / "x.skinslide", cache="./x.skinslide"))
    head = f'{HEAD}; expressionVariables = {{ string X = "y" }}'
    assert "leads back to itself" in refusal(write(tmp_path / "y.skinslide", head=head, cache='`"./${X}.skinslide"`'))


# ---- Files that open, and say what is wrong ----


def messages_of(path: Path) -> str:
    with said() as messages:
        stage, _ = open_mesh(path)
        assert stage
    return "\n".join(messages)


def test_a_source_that_is_not_there_is_named(tmp_path):
    path = write(tmp_path / "x.skinslide")
    assert str(tmp_path / "cache.usda") in messages_of(path)


def test_a_source_that_appears_is_picked_up(tmp_path):
    path = write(tmp_path / "x.skinslide")
    with said():
        stage = Usd.Stage.Open(str(path))
    save(patched_stage(grid())[0], tmp_path / "cache.usda")
    assert stage.GetRootLayer().Reload()
    assert stage.GetRootLayer().GetNumTimeSamplesForPath(f"{MESH}.points") == 3


# ---- Live ----


def shot(folder: Path, live: str) -> Path:
    make(folder)
    path = folder / "shot.usda"
    path.write_text(f'#usda 1.0\ndef "World" (payload = @./x.skinslide@) {{\n{live}\n}}')
    return path


@pytest.mark.parametrize(
    ("live", "message"),
    [
        ('string skinSlide:live:envelope = "half"', "skinSlide:live:envelope is 'half'; it must be a float"),
        ("float[] skinSlide:live:envelope = [0.5]", "skinSlide:live:envelope is [0.5]; it must be a float"),
        ("int skinSlide:live:interpolation = 1", "skinSlide:live:interpolation is '1'; it must be one of auto, linear"),
    ],
)
def test_a_live_attribute_of_a_wrong_type_is_said(tmp_path, live, message):
    assert message in messages_of(shot(tmp_path, live))


# ---- Importing too late ----


@pytest.mark.parametrize("early", [True, False])
def test_an_import_after_a_layer_was_opened_is_said(early):
    imports = ["import skinslide", "from pxr import Sdf; layer = Sdf.Layer.CreateAnonymous()"]
    done = run_python("; ".join(imports if early else imports[::-1]))
    assert done.returncode == 0
    assert done.stderr.count("Import skinslide first") == (0 if early else 1)


# ---- Frames that fail ----


def test_a_set_up_that_the_core_refuses_gives_the_cache(tmp_path):
    """A fin has an edge with three faces, which shows when the first frame is asked for."""
    stage, _ = patched_stage(fin())
    save(stage, tmp_path / "cache.usda")
    path = write(tmp_path / "x.skinslide")
    with said() as messages:
        stage, mesh = open_mesh(path)
        assert np.array_equal(points(mesh, 1002), fin().moved(1002))
        mesh.GetExtentAttr().Get(1002)
        points(mesh, 1003)
    assert [message for message in messages if "skinslide" in message] == [
        f"x.skinslide: {MESH}: frame 1002: patch {PATCH}: edge 0-1 has 3 faces; the points are those of the cache"
    ]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.full((49, 3), np.nan, np.float32), "points[0]"),
        (np.zeros((5, 3), np.float32), "points has 5 values, but 49 at first"),
    ],
)
def test_a_frame_that_fails_gives_the_cache_and_one_message(tmp_path, value, message):
    path = make(tmp_path, lambda mesh: mesh.GetPointsAttr().Set(vectors(value), 1002))
    with said() as messages:
        _stage, mesh = open_mesh(path)
        for _ in range(2):
            assert points(mesh, 1002).tobytes() == value.tobytes()
        mesh.GetExtentAttr().Get(1002)
        assert not np.array_equal(points(mesh, 1003), grid().moved(1003))
    ours = [each for each in messages if "skinslide" in each]
    assert len(ours) == 1 and ours[0].startswith(f"x.skinslide: {MESH}: frame 1002: ")
    assert "the points are those of the cache" in ours[0] and (
        "has 5" in ours[0] or "finite" in ours[0] or message in ours[0]
    )


def test_a_frame_that_fails_gives_indexed_values_whole(tmp_path):
    """Their indices are blocked at all times, and so apply at those that fail, too."""

    def edit(mesh):
        tangents = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("tangents", Sdf.ValueTypeNames.Vector3fArray, "vertex")
        tangents.Set(vectors(np.eye(3)))
        tangents.SetIndices(Vt.IntArray([2, 0] + [1] * 47))
        mesh.GetPointsAttr().Set(vectors(np.full((49, 3), np.nan)), 1002)

    _stage, mesh = open_mesh(make(tmp_path, edit))
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("tangents")
    assert not primvar.IsIndexed()
    assert np.array_equal(primvar.Get(1002), np.eye(3)[[2, 0] + [1] * 47])


def test_arguments_may_be_given_by_hand(tmp_path):
    path = make(tmp_path)
    layer = Sdf.Layer.FindOrOpen(str(path), {"envelope": "2e9", "live": "0"})
    assert not layer.GetAttributeAtPath(f"{MESH}.points")
    before = solve_count()
    with said():
        slid = Sdf.Layer.FindOrOpen(str(path), {"envelope": "7"}).QueryTimeSample(f"{MESH}.points", 1003)
    # An envelope above 1 counts as 1.
    assert np.array_equal(slid, Sdf.Layer.FindOrOpen(str(path)).QueryTimeSample(f"{MESH}.points", 1003))
    assert solve_count() - before == 2


def test_a_lookup_that_cannot_be_had_gives_the_cache_and_one_message(tmp_path, monkeypatch):
    monkeypatch.setenv("SKINSLIDE_EGL_DEVICE", "2147483000")
    layer = Sdf.Layer.FindOrOpen(str(make(tmp_path)), {"lookup": "egl"})
    with said() as messages:
        for frame in FRAMES[1:]:
            assert np.array_equal(layer.QueryTimeSample(f"{MESH}.points", frame), grid().moved(frame))
    assert len([message for message in messages if MESH in message]) == 1


def test_a_lookup_that_can_be_had_later_comes_too_late(tmp_path, monkeypatch):
    """A layer is slid at all frames, or at none."""
    layer = Sdf.Layer.FindOrOpen(str(make(tmp_path)), {"lookup": "egl"})
    monkeypatch.setenv("SKINSLIDE_EGL_DEVICE", "2147483000")
    for frame in FRAMES[1:]:
        assert np.array_equal(layer.QueryTimeSample(f"{MESH}.points", frame), grid().moved(frame))
        monkeypatch.delenv("SKINSLIDE_EGL_DEVICE", raising=False)


@pytest.mark.parametrize("value", ["abc", "99999999999", "-1", "1.5"])
def test_numbers_of_the_environment_that_are_none_are_said(tmp_path, value):
    script = (
        f"import skinslide; from pxr import Sdf; layer = Sdf.Layer.FindOrOpen({str(make(tmp_path))!r}); "
        f"[layer.QueryTimeSample({MESH + '.points'!r}, time) for time in (1002, 1003)]"
    )
    done = run_python(script, SKINSLIDE_CACHE_MB=value)
    assert done.returncode == 0
    assert done.stderr.count("SKINSLIDE_CACHE_MB") == 1 and "it counts as 512" in done.stderr
    done = run_python(script, SKINSLIDE_EGL_DEVICE=value)
    assert done.returncode == 0
    assert done.stderr.count("SKINSLIDE_EGL_DEVICE") == 1 and "the points are those of the cache" in done.stderr
    assert not run_python(script, SKINSLIDE_CACHE_MB="", SKINSLIDE_EGL_DEVICE="").stderr


def chain(folder: Path, length: int) -> Path:
    path = make(folder)
    for number in range(length):
        path = write(folder / f"c{number}.skinslide", cache=f"./{path.name}")
    return path


def test_each_file_of_a_chain_is_read_once(tmp_path):
    with said() as messages:
        stage, mesh = open_mesh(chain(tmp_path, 12))
        assert mesh.GetPointsAttr().GetNumTimeSamples() == 3
    assert sum("c0.skinslide:" in message for message in messages) == 1
    # A reload of the last one picks up a change of the first one's source.
    edited = Sdf.Layer.OpenAsAnonymous(str(tmp_path / "cache.usda"))
    edited.SetTimeSample(f"{MESH}.points", 1009, vectors(grid().moved(1003)))
    edited.Export(str(tmp_path / "cache.usda"))
    with said():
        assert stage.GetRootLayer().Reload()
    assert 1009.0 in mesh.GetPointsAttr().GetTimeSamples()


def test_a_chain_that_is_too_long_is_refused(tmp_path):
    with said() as messages:
        try:
            open_mesh(chain(tmp_path, 40))
        except (Tf.ErrorException, RuntimeError) as error:
            messages.append(str(error))
    assert "is reached through 32 .skinslide files" in "".join(messages)


def test_a_reload_keeps_unsaved_edits_of_a_source(tmp_path):
    path = make(tmp_path)
    layer, cache = (Sdf.Layer.FindOrOpen(str(each)) for each in (path, tmp_path / "cache.usda"))
    cache.SetTimeSample(f"{MESH}.points", 1009, vectors(grid().moved(1003)))
    path.write_text(path.read_text() + "\n")
    assert layer.Reload(force=True)
    assert cache.dirty and 1009.0 in layer.ListTimeSamplesForPath(f"{MESH}.points")


def test_threads_that_read_do_not_abort_an_exit(tmp_path):
    stage, _ = patched_stage(grid(60, 60))
    save(stage, tmp_path / "cache.usda")
    path = write(tmp_path / "x.skinslide")
    script = (
        "import skinslide, sys, threading, time; from pxr import Usd; "
        f"stage = Usd.Stage.Open({str(path)!r}); points = stage.GetAttributeAtPath({MESH + '.points'!r})\n"
        "def read():\n    while True: points.Get(1002); points.Get(1003)\n"
        "for _ in range(8): threading.Thread(target=read, daemon=True).start()\n"
        "time.sleep(0.15); sys.exit(3)"
    )
    for _ in range(4):
        assert run_python(script, SKINSLIDE_CACHE_MB="0").returncode == 3


def test_mutated_files_neither_crash_nor_hang(tmp_path):
    plugin = Path(skinslide.__file__).parent / "usd" / "skinslideFileFormat"
    done = subprocess.run(
        [sys.executable, FUZZER, plugin, tmp_path, "--count", "150"], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert "150 files" in done.stdout


def test_a_mesh_beside_it_that_is_skinned_is_named(tmp_path):
    """Where borders may slide: whether they meet it nobody knows here."""

    def edit(mesh):
        mesh.GetPrim().GetAttribute(f"skinSlide:{PATCH}:holes").Set("freeAll")
        mesh.GetPrim().GetAttribute(f"skinSlide:{PATCH}:forceDensityRule").Set("even")
        stage = mesh.GetPrim().GetStage()
        head = stages.add_mesh(stage, grid(centre=(1, 0, 0)), "/World/char/geo/head_GEO")
        rigs.skeleton(stage)
        rigs.bind(head)

    path = make(tmp_path, edit)
    with said() as messages:
        open_mesh(path)
    assert len(messages) == 1
    assert (
        f"{MESH}: whether borders meet /World/char/geo/head_GEO is not known here, since UsdSkel skins it; sublayer "
        "its points, which skinslide cache writes"
    ) in messages[0]
