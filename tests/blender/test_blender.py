"""The extension: each test inside Blender, by name; what it shows against a bake of what it exports; its zip."""

from __future__ import annotations

import ast
import subprocess
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdGeom

import skinslide
from repository import ROOT

INSIDE = Path(__file__).parent / "inside"


def names() -> list[str]:
    """The tests inside, as far as they can be told without running them."""
    return [
        f"{path.stem}.{node.name}"
        for path in sorted(INSIDE.glob("test_*.py"))
        for node in ast.parse(path.read_text()).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    ]


@pytest.mark.parametrize("name", names())
def test_inside(name, results):
    own = {case: wrong for case, wrong in results.items() if case.partition("[")[0] == name}
    assert own, f"{name} did not run"
    assert not any(own.values()), "\n".join(own.values())


@pytest.mark.parametrize("rule", ["unit", "even", "relaxed", "world", "map"])
def test_what_is_shown_is_what_is_baked(rule, results, blender, tmp_path):
    """The same bytes, at each frame: the live object in Blender, and a bake of the stage that it exports."""
    setup = blender.out / f"{rule}.skinslide"
    report = skinslide.bake_to_file(setup, tmp_path / "slid.usda")
    assert report.meshes
    slid = Usd.Stage.Open(str(tmp_path / "slid.usda"))
    cache = Usd.Stage.Open(str(blender.out / f"{rule}.usdc"))
    (mesh,) = [prim for prim in slid.TraverseAll() if prim.HasAttribute("points")]
    for frame in (1001, 1002, 1003):
        baked = np.array(mesh.GetAttribute("points").Get(frame))
        cached = np.array(UsdGeom.Mesh.Get(cache, mesh.GetPath()).GetPointsAttr().Get(frame))
        assert baked.tobytes() == np.load(blender.out / f"{rule}.{frame}.npy").tobytes()
        assert (frame == 1001) == np.array_equal(baked, cached)


def test_lengths_in_the_world_count(results, blender):
    assert (blender.out / "world.1003.npy").read_bytes() != (blender.out / "even.1003.npy").read_bytes()


def test_paint_survives_blenders_own_exporter(results, blender):
    """Without any set-up beside it the cache has the paint, and check says so where Blender has changed its names."""
    stage = Usd.Stage.Open(str(blender.out / "even.usdc"))
    (mesh,) = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    skinslide.SkinSlideAPI.Apply(mesh, "arm:elbow_L")
    notes = [each.message for each in skinslide.check(stage).problems if each.severity == "note"]
    for what, kind in (("weight", "float[]"), ("patch", "bool[]")):
        kept = mesh.HasAttribute(f"primvars:skinSlide:arm:elbow_L:{what}")
        assert kept or f"{what} comes from primvars:skinSlide_arm_elbow_L_{what}, {kind}" in notes


def test_the_picture_shows_the_slid_skin(results, blender):
    """Cold where nothing is stretched, hot where it is: several of the colours of the scale, on most of the picture."""
    picture = np.asarray(Image.open(blender.out / "slid.png").convert("RGB")).astype(int)
    red, blue = picture[..., 0], picture[..., 2]
    seen = np.ptp(picture, axis=2) > 20
    assert seen.mean() > 0.3
    assert (red - blue > 40).sum() > 100 and (blue - red > 20).sum() > 100


def test_blender_takes_the_manifest(extension, blender):
    """By the checks of Blender's own tool for extensions."""
    (tool,) = (blender.python.parent.parent / "lib").glob(
        "python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"
    )
    done = subprocess.run([blender.python, tool, "validate", extension], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_zip_has_what_blender_lacks(environment, extension):
    with zipfile.ZipFile(extension) as archive:
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
        assert {Path(wheel).name.split("-")[0] for wheel in manifest["wheels"]} == {"skinslide", "cffi"}
        assert {f"wheels/{Path(wheel).name}" for wheel in manifest["wheels"]} <= set(archive.namelist())
        assert manifest["version"] == skinslide.__version__
        assert not [name for name in archive.namelist() if "build.py" in name]
        tag = "cp{}{}".format(*environment.number)
        assert all(tag in wheel for wheel in manifest["wheels"])


def test_no_operator_reads_rules_itself():
    """Tokens are the core's: no module of the extension spells one of a rule, but that of new patches."""
    rules = ("unit", "fast", "relaxed", "even")
    for path in sorted((ROOT / "plugin" / "blender").glob("*.py")):
        spelt = [node.value for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Constant)]
        found = [value for value in spelt if value in rules]
        assert found == (["even"] if path.name == "patches.py" else []), path


@pytest.mark.parametrize("name", ["reading.py", "usd.py", "joining.py"])
def test_what_works_apart_knows_nothing_of_blender(name):
    """Blender's data may be touched by its main thread alone."""
    tree = ast.parse((ROOT / "plugin" / "blender" / name).read_text())
    imported = [each.name for node in ast.walk(tree) if isinstance(node, ast.Import) for each in node.names]
    within = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level]
    assert "bpy" not in imported and set(within) <= {"reading", "usd"}
