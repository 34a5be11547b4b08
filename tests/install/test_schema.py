"""SkinSlideAPI: what is committed is what usdGenSchema makes, and USD knows it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from pxr import Plug, Sdf, Usd, UsdGeom

import stages
from repository import ROOT
from skinslide._core import ffi, lib
from skinslide.arrays.schema import inputs
from skinslide.stage import schema

SCHEMA = ROOT / "schema"
GENERATED = ("generatedSchema.usda", "plugInfo.json")
FALLBACKS = {
    "envelope": 1.0,
    "boundary": "auto",
    "holes": "pinned",
    "forceDensityRule": "unit",
    "interpolation": "auto",
    "grow": 0.0,
    "stretchResponse": 1.0,
    "compressionResponse": 1.0,
    "corners": None,
    "edges": None,
    "edgeForceDensities": None,
    "forceDensityMap": None,
    "forceDensityMapChannel": None,
    "weightMap": None,
    "weightMapChannel": None,
    "holdMap": None,
    "holdMapChannel": None,
    "paintChannel": "none",
    "mapSt": "st",
}


def test_committed_files_are_what_the_generator_makes(tmp_path):
    for name in ("schema.usda", *GENERATED):
        shutil.copy(SCHEMA / name, tmp_path)
    (tmp_path / "generatedSchema.usda").unlink()
    command = [sys.executable, "-m", "pxr.Usd.usdGenSchema", "--quiet", "schema.usda", "."]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    for name in GENERATED:
        assert (tmp_path / name).read_text() == (SCHEMA / name).read_text(), f"run usdGenSchema in schema/: {name}"


def test_the_tables_of_the_core_are_what_the_schema_says(tmp_path):
    subprocess.run([sys.executable, SCHEMA / "tables.py", tmp_path / "schema.inc"], check=True)
    made, committed = tmp_path / "schema.inc", ROOT / "core" / "stage" / "schema.inc"
    assert made.read_text() == committed.read_text(), "run python tables.py in schema/"


def test_the_classes_for_python_are_what_the_schema_says(tmp_path):
    subprocess.run([sys.executable, SCHEMA / "methods.py", tmp_path / "api.py"], check=True)
    committed = ROOT / "plugin" / "python" / "skinslide" / "author" / "api.py"
    assert (tmp_path / "api.py").read_text() == committed.read_text(), "run python methods.py in schema/"


def read_by_the_core() -> dict[str, tuple[str, bool]]:
    """The type of each property that the core reads in the schema's namespace, and whether it may vary, by name."""
    found = {}
    for group in (
        lib.SKINSLIDE_STAGE_MESH,
        lib.SKINSLIDE_STAGE_PATCH,
        lib.SKINSLIDE_STAGE_CONTROLS,
        lib.SKINSLIDE_STAGE_LIVE,
    ):
        each = lib.skinslide_stage_next_input(group, ffi.NULL)
        while each:
            prefix, name, type_name = (ffi.string(text).decode() for text in (each.prefix, each.name, each.type_name))
            if prefix.startswith("skinSlide:"):
                of_patch = group in (lib.SKINSLIDE_STAGE_PATCH, lib.SKINSLIDE_STAGE_CONTROLS)
                varies = each.when == lib.SKINSLIDE_STAGE_ANIMATED
                found[f"{prefix}{'__INSTANCE_NAME__:' if of_patch else ''}{name}"] = type_name, varies
            each = lib.skinslide_stage_next_input(group, each)
    return found


def test_the_core_reads_what_the_schema_declares_and_nothing_else():
    layer = Sdf.Layer.FindOrOpen(str(SCHEMA / "generatedSchema.usda"))
    declared = [attribute for schema in layer.rootPrims for attribute in schema.attributes]
    assert read_by_the_core() == {
        each.name: (str(each.typeName), each.variability == Sdf.VariabilityVarying) for each in declared
    }


@pytest.mark.parametrize("schema", ["SkinSlideMeshAPI", "SkinSlideLiveAPI"])
def test_what_need_not_be_applied_may_be(schema):
    stage = stages.new_stage()
    mesh = UsdGeom.Mesh.Define(stage, "/World/mesh").GetPrim()
    assert mesh.CanApplyAPI(schema) and mesh.ApplyAPI(schema)
    definition = Usd.SchemaRegistry().FindAppliedAPIPrimDefinition(schema)
    assert definition.GetPropertyNames()
    for name in definition.GetPropertyNames():
        assert definition.GetPropertyDocumentation(name)
        assert not mesh.GetAttribute(name).HasAuthoredValue()


def test_installed_files_are_the_committed_ones():
    installed = Path(Plug.Registry().GetPluginWithName("skinslide").resourcePath)
    for name in GENERATED:
        assert (installed / name).read_text() == (SCHEMA / name).read_text()


def test_applies_to_meshes_only():
    stage = stages.new_stage()
    mesh = UsdGeom.Mesh.Define(stage, "/World/mesh").GetPrim()
    for patch in ("elbow_L", "left:elbow"):
        assert mesh.CanApplyAPI("SkinSlideAPI", patch)
        assert mesh.ApplyAPI("SkinSlideAPI", patch)
    assert schema.patch_names(mesh) == ["elbow_L", "left:elbow"]
    assert not stage.GetPrimAtPath("/World").CanApplyAPI("SkinSlideAPI", "elbow_L")


@pytest.mark.parametrize("patch", ["elbow_L", "left:elbow"])
def test_fallbacks(patch):
    stage = stages.new_stage()
    mesh = UsdGeom.Mesh.Define(stage, "/World/mesh").GetPrim()
    mesh.ApplyAPI("SkinSlideAPI", patch)
    all_inputs = [each for group in ("patch", "controls") for each in inputs(group) if not each.is_primvar]
    for name, fallback in FALLBACKS.items():
        attr = mesh.GetAttribute(f"skinSlide:{patch}:{name}")
        assert attr.IsDefined() and attr.Get() == fallback
        shown = next(each for each in all_inputs if each.name == name).fallback
        assert shown == (None if fallback is None else f"{fallback:g}" if isinstance(fallback, float) else fallback)


def test_every_property_is_documented():
    definition = Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("SkinSlideAPI")
    properties = definition.GetPropertyNames()
    assert len(properties) == len(FALLBACKS)
    for name in properties:
        assert definition.GetPropertyDocumentation(name)
    assert "primvars:skinSlide:NAME:patch" in definition.GetDocumentation()


def test_a_stage_opened_before_the_import_is_read_the_same():
    """USD's registry then never learns of the schema: names and fallbacks must not depend on it."""
    script = """
from pxr import Sdf, Usd, UsdGeom
stage = Usd.Stage.CreateInMemory()
mesh = UsdGeom.Mesh.Define(stage, "/mesh")
mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
mesh.CreateFaceVertexCountsAttr([4])
mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
mesh.GetPrim().AddAppliedSchema("SkinSlideAPI:elbow_L")
UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("skinSlide:elbow_L:patch", Sdf.ValueTypeNames.BoolArray, "uniform").Set([True])
from skinslide.stage.reading import read_meshes
(read,), problems = read_meshes(stage)
(patch,) = read.patches
assert not problems and patch.name == "elbow_L" and patch.controls.envelope == 1 and patch.holes == "pinned"
"""
    subprocess.run([sys.executable, "-c", script], check=True)
