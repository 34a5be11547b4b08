"""Values of a type that no schema has, as text files may hold them: named where they matter, and else passed by."""

import contextlib

import pytest
from pxr import Gf, Sdf, Usd

import rigs
import skinslide
import stages
from skinslide.problems import FrameProblem, StageError, StageProblems
from stages import FRAMES, MESH

OTHER = f"{MESH}_2"
REFUSALS = (StageProblems, FrameProblem, StageError)
WRONG = {
    "float": 1.5,
    "string": "x",
    "asset": Sdf.AssetPath("./x"),
    "string[]": ["x", "y", "z"],
    "float[]": [0.5, 1.5, 2.5],
    "matrix4d": Gf.Matrix4d(1),
    "matrix3d[]": [Gf.Matrix3d(1)] * 4,
}


def spoiled(stage: Usd.Stage, path: str, type_name: str, frames: tuple[float, ...] = ()) -> Usd.Stage:
    """The stage with an attribute of another type, with a default or with samples."""
    layer, path = Sdf.Layer.CreateAnonymous(".usda"), Sdf.Path(path)
    layer.TransferContent(stage.GetRootLayer())
    prim = Sdf.CreatePrimInLayer(layer, path.GetPrimPath())
    if path.name in prim.properties:
        prim.RemoveProperty(prim.properties[path.name])
    attribute = Sdf.AttributeSpec(prim, path.name, Sdf.ValueTypeNames.Find(type_name))
    python, value = attribute.typeName.type.pythonClass, WRONG[type_name]
    value = python(value) if attribute.typeName.isArray else value
    for frame in frames or (None,):
        if frame is None:
            attribute.default = value
        else:
            layer.SetTimeSample(attribute.path, frame, value)
    return Usd.Stage.Open(layer)


def ask_all(stage: Usd.Stage, output) -> None:
    """Whatever comes of it is an answer, or a refusal that names what is wrong."""
    skinslide.check(stage, lookup="exact")
    for ask in (
        lambda: skinslide.bake_to_file(stage, output / "out.usda", lookup="exact"),
        lambda: skinslide.cache(stage, output / "cache.usda"),
        lambda: skinslide.setup(stage, whole=True),
        lambda: skinslide.setup(stage, MESH, "some", faces="0-3"),
    ):
        with contextlib.suppress(*REFUSALS):
            ask()


@pytest.mark.parametrize("type_name", WRONG)
@pytest.mark.parametrize("name", ["points", "faceVertexCounts", "faceVertexIndices"])
def test_another_mesh_does_not_matter(name, type_name, tmp_path):
    """It is beside one that is slid, whose borders are held where others meet it."""
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "forceDensityRule", "even")
    stages.set_property(mesh, "holes", "freeAll")
    stages.add_mesh(stage, stages.grid(), OTHER)
    skinslide.bake_to_file(stage, tmp_path / "before.usda", lookup="exact")
    stage = spoiled(stage, f"{OTHER}.{name}", type_name)
    report = skinslide.check(stage, lookup="exact")
    assert not report.failed and [checked.path for checked in report.meshes] == [MESH]
    skinslide.bake_to_file(stage, tmp_path / "after.usda", lookup="exact")
    ask_all(stage, tmp_path)


@pytest.mark.parametrize("frames", [(), FRAMES])
@pytest.mark.parametrize("type_name", WRONG)
@pytest.mark.parametrize("name", ["points", "faceVertexCounts", "faceVertexIndices"])
def test_a_mesh_on_which_nothing_is_set_up(name, type_name, frames, tmp_path):
    stage, mesh = stages.patched_stage()
    mesh.GetPrim().RemoveAPI("SkinSlideAPI", stages.PATCH)
    ask_all(spoiled(stage, f"{MESH}.{name}", type_name, frames), tmp_path)


RIG = [
    *(f"{rigs.SKELETON}.{name}" for name in ("joints", "bindTransforms", "restTransforms")),
    *(f"{rigs.ANIMATION}.{name}" for name in ("joints", "translations", "rotations", "scales", "blendShapeWeights")),
    *(f"{MESH}.{name}" for name in ("points", "normals", "primvars:skel:jointIndices", "primvars:skel:jointWeights")),
    *(f"{MESH}.{name}" for name in ("skel:blendShapes", "skel:joints", "primvars:skel:geomBindTransform")),
    *(f"{MESH}/bulge.{name}" for name in ("offsets", "normalOffsets", "pointIndices", "inbetweens:half")),
]


@pytest.mark.parametrize("type_name", WRONG)
@pytest.mark.parametrize("path", RIG)
def test_a_rig_is_refused_or_slides(path, type_name, tmp_path):
    stage, mesh = rigs.skinned_stage()
    rigs.blend_shape(mesh)
    mesh.CreateNormalsAttr([(0, 0, 1)] * 49)
    ask_all(spoiled(stage, path, type_name), tmp_path)


def test_a_blend_shape_names_the_type(tmp_path):
    stage, mesh = rigs.skinned_stage()
    rigs.blend_shape(mesh)
    stage = spoiled(stage, f"{MESH}/bulge.offsets", "float[]")
    (problem,) = [each for each in skinslide.check(stage, lookup="exact").problems if each.severity == "error"]
    assert problem.message == f"offsets of {MESH}/bulge is of type FloatArray, not vector3f[]"
