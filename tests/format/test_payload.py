"""A shot that payloads a live layer keeps its character where skinslide is not."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest
from pxr import Usd, UsdGeom

import stages
from skinslide import bake_to_file, setup_to_file
from skinslide.command.cli import main
from stages import FRAMES, MESH, PATCH


@pytest.fixture
def cache(tmp_path):
    stage = stages.new_stage()
    stages.add_mesh(stage, stages.grid())
    return stages.save(stage, tmp_path / "cache.usda")


@pytest.fixture
def payload(cache, tmp_path):
    words = ["setup", cache, "-o", tmp_path / "patches.skinslide", "--prim", MESH, "--patch", PATCH, "--faces", "0-35"]
    assert main([*map(str, words), "--payload", str(tmp_path / "payload.usda")]) == 0
    return tmp_path / "payload.usda"


def points(stage: Usd.Stage) -> list[bytes]:
    attribute = UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr()
    return [np.array(attribute.Get(frame)).tobytes() for frame in FRAMES]


def test_it_is_live_with_skinslide(payload, tmp_path):
    bake_to_file(tmp_path / "patches.skinslide", tmp_path / "slid.usda")
    assert "@./patches.skinslide@" in payload.read_text() and "@./cache.usda@" in payload.read_text()
    assert points(Usd.Stage.Open(str(payload))) == points(Usd.Stage.Open(str(tmp_path / "slid.usda")))


def test_it_is_the_cache_without(payload, cache):
    """In a shot that references it; only USD is imported."""
    shot = payload.with_name("shot.usda")
    shot.write_text('#usda 1.0\n(timeCodesPerSecond = 24)\ndef "hero" (references = @payload.usda@</World>)\n{\n}\n')
    code = f"""
        import sys
        import numpy as np
        from pxr import Usd, UsdGeom
        stage = Usd.Stage.Open({str(shot)!r})
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/hero{MESH.removeprefix("/World")}"))
        for frame in {FRAMES}:
            print(np.array(mesh.GetPointsAttr().Get(frame)).tobytes().hex())
        assert "skinslide" not in sys.modules
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert list(map(bytes.fromhex, done.stdout.split())) == points(Usd.Stage.Open(str(cache)))
    assert "Could not open asset" in done.stderr and "patches.skinslide" in done.stderr


def test_more_patches_leave_it_as_it_is(payload, cache, tmp_path):
    before = payload.read_text()
    more = ["setup", cache, "-o", tmp_path / "patches.skinslide", "--prim", MESH, "--patch", "more", "--faces", "0-3"]
    assert main([*map(str, more), "--payload", str(payload)]) == 0
    assert payload.read_text() == before


@pytest.mark.parametrize(
    ("output", "file", "says"),
    [
        ("patches.usda", "payload.usda", "its name must end in .skinslide"),
        ("patches.skinslide", "payload.skinslide", "must end in .usda, .usdc, .usd"),
        ("patches.skinslide", "cache.usda", "the stage reads this file"),
        ("patches.skinslide", "other.usda", "exists and says something else; --force replaces it"),
        ("patches.skinslide", "words.usda", "exists and says something else; --force replaces it"),
    ],
)
def test_payloads_that_cannot_be(output, file, says, cache, tmp_path, capfd):
    (tmp_path / "other.usda").write_text('#usda 1.0\ndef "shot"\n{\n}\n')
    (tmp_path / "words.usda").write_text("words")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    words = ["setup", cache, "-o", tmp_path / output, "--prim", MESH, "--patch", PATCH, "--faces", "0-35"]
    assert main([*map(str, words), "--payload", str(tmp_path / file)]) == 2
    assert says in capfd.readouterr().err
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_stage_without_a_default_prim(cache, tmp_path):
    cache.write_text(cache.read_text().replace('defaultPrim = "World"', ""))
    with pytest.raises(ValueError, match="names no default prim"):
        setup_to_file(cache, tmp_path / "a.skinslide", MESH, PATCH, faces="0-35", payload=tmp_path / "payload.usda")
