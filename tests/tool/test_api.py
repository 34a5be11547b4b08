"""SkinSlideAPI as pxr has schemas, and set-ups made through it in a stage's edit target."""

import inspect
import subprocess
import sys
import textwrap
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Tf, Usd, UsdGeom, Vt

import skinslide
import stages
from repository import ROOT
from skinslide import FrameSpecError, SkinSlideAPI, SkinSlideLiveAPI, SkinSlideMeshAPI, StageProblems, UsageError
from skinslide.arrays import geometry
from skinslide.arrays.schema import inputs
from skinslide.author import options
from skinslide.shot import options as shot_options
from skinslide.shot.frames import checked_frames
from skinslide.stage import schema
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH, PATCH

Types = Sdf.ValueTypeNames
FACES = stages.block(6, range(4), range(4))
OTHER = "/World/char/geo/other_GEO"


@pytest.fixture
def stage():
    """A cached mesh without a patch, in a layer of its own below the stage's root layer, which is the edit target."""
    cache = stages.new_stage()
    stages.add_mesh(cache, stages.grid())
    stage = Usd.Stage.CreateInMemory()
    for name in ("timeCodesPerSecond", "startTimeCode", "endTimeCode"):
        setattr(stage.GetRootLayer(), name, getattr(cache.GetRootLayer(), name))
    stage.GetRootLayer().subLayerPaths.append(cache.GetRootLayer().identifier)
    stage.below = cache
    return stage


@pytest.fixture
def prim(stage):
    return stage.GetPrimAtPath(MESH)


def text(stage: Usd.Stage) -> str:
    return stage.GetRootLayer().ExportToString()


def faces_of(stage: Usd.Stage) -> dict[str, list[int]]:
    (mesh,), _ = read_meshes(stage)
    return {patch.name: patch.faces.tolist() for patch in mesh.patches}


# ---- The schema ----


def test_apply_get_and_all(stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    assert patch and (patch.GetName(), patch.GetPrim(), patch.GetPath()) == (PATCH, prim, Sdf.Path(MESH))
    assert prim.GetAppliedSchemas() == [f"SkinSlideAPI:{PATCH}"]
    SkinSlideAPI.Apply(UsdGeom.Mesh(prim), "left:wrist")
    SkinSlideAPI.Apply(prim, PATCH)  # once more
    assert [each.GetName() for each in SkinSlideAPI.GetAll(prim)] == [PATCH, "left:wrist"]
    assert SkinSlideAPI.Get(stage, MESH, "left:wrist") and SkinSlideAPI(UsdGeom.Mesh(prim), PATCH)
    assert not SkinSlideAPI.Get(stage, MESH, "knee") and not SkinSlideAPI.Get(stage, "/World/gone", PATCH)
    assert repr(patch) == f"skinslide.SkinSlideAPI(Usd.Prim(<{MESH}>), '{PATCH}')"
    assert UsdGeom.PrimvarsAPI(patch).GetPrim() == prim  # as any schema of pxr's


@pytest.mark.parametrize("name", ["", "elbow L", "1st", "live", "restPoints:a", "envelope", "left:corners", None, 3])
def test_names_that_no_patch_can_have(name, stage, prim):
    can = SkinSlideAPI.CanApply(prim, name)
    assert not can and "cannot name a patch" in can.whyNot
    with pytest.raises(UsageError, match="cannot name a patch"):
        SkinSlideAPI.Apply(prim, name)
    assert not prim.GetAppliedSchemas()


def test_prims_that_can_have_no_patch(stage, prim):
    assert SkinSlideAPI.CanApply(prim, PATCH) and SkinSlideAPI.CanApply(prim, PATCH).whyNot == ""
    world = stage.GetPrimAtPath("/World")
    assert "applies to Mesh, which /World is not" in SkinSlideAPI.CanApply(world, PATCH).whyNot
    assert "invalid null prim" in SkinSlideAPI.CanApply(Usd.Prim(), PATCH).whyNot
    for given in (None, 3, MESH):
        message = f"SkinSlideAPI does not apply to {given!r}, which is not a Usd.Prim"
        assert SkinSlideAPI.CanApply(given, PATCH).whyNot == message
        with pytest.raises(UsageError, match=message):
            SkinSlideAPI.Apply(given, PATCH)
    stage.DefinePrim("/a").GetReferences().AddInternalReference("/World/char/geo")
    stage.GetPrimAtPath("/a").SetInstanceable(True)
    inside = stage.GetPrimAtPath("/a/skin_GEO")
    with pytest.raises(UsageError, match="which instances share"):
        SkinSlideAPI.Apply(inside, PATCH)


def test_a_stage_that_was_open_before_the_import():
    """USD's registry then never learns of the schema."""
    code = f"""
        from pxr import Usd, UsdGeom
        stage = Usd.Stage.CreateInMemory()
        mesh = UsdGeom.Mesh.Define(stage, "/mesh")
        mesh.CreateFaceVertexCountsAttr([4, 4])
        mesh.GetPrim().GetPropertyNames()
        import skinslide
        patch = skinslide.SkinSlideAPI.Apply(mesh, "{PATCH}")
        patch.SetFaces([1])
        patch.CreateHolesAttr("pinned", writeSparsely=True)
        patch.CreateEnvelopeAttr(0.5)
        assert patch and patch.GetEnvelopeAttr().Get() == 0.5 and list(patch.GetPatchPrimvar().Get()) == [False, True]
    """
    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=True)


SCHEMAS = Sdf.Layer.OpenAsAnonymous(str(ROOT / "schema" / "generatedSchema.usda"))
# Values of each type, as they are given and as USD has them.
VALUES = {
    "bool": (False, False),
    "float": (np.float32(0.5), 0.5),
    "int[]": (np.array([3, 1, 2, 4]), Vt.IntArray([3, 1, 2, 4])),
    "float[]": ([1, 2.5], Vt.FloatArray([1, 2.5])),
    "point3f[]": (np.ones((2, 3)), Vt.Vec3fArray([(1, 1, 1)] * 2)),
    "asset": ("./map.exr", Sdf.AssetPath("./map.exr")),
    "token": ("any", "any"),
}
APPLIED = {
    "SkinSlideAPI": lambda prim: SkinSlideAPI.Apply(prim, PATCH),
    "SkinSlideMeshAPI": SkinSlideMeshAPI.Apply,
    "SkinSlideLiveAPI": SkinSlideLiveAPI.Apply,
}


def declared():
    """The attributes of each schema, with the name that their methods have."""
    for prim in SCHEMAS.rootPrims:
        for spec in prim.attributes:
            name = spec.name.rpartition(":")[2]
            yield pytest.param(prim.name, spec, name[0].upper() + name[1:], id=f"{prim.name}.{name}")


@pytest.mark.parametrize(("api", "spec", "name"), list(declared()))
def test_every_attribute(api, spec, name, prim):
    applied = APPLIED[api](prim)
    get, create = getattr(applied, f"Get{name}Attr"), getattr(applied, f"Create{name}Attr")
    full = spec.name.replace("__INSTANCE_NAME__", PATCH)
    assert get().GetName() == full and not get().IsAuthored()
    create(writeSparsely=True)
    if spec.default is not None:
        create(spec.default, writeSparsely=True)
    assert not get().IsAuthored()
    given, value = [spec.allowedTokens[-1]] * 2 if spec.allowedTokens else VALUES[str(spec.typeName)]
    made = create(given)
    assert made == get() and made.IsAuthored() and not made.IsCustom()
    assert (made.GetTypeName(), made.GetVariability()) == (spec.typeName, spec.variability)
    assert made.Get() == value
    if spec.default is not None:
        assert create(spec.default, writeSparsely=True).Get() == spec.default


@pytest.mark.parametrize(
    ("method", "value", "message"),
    [
        ("CreateHolesAttr", "open", "holes is 'open'; it must be one of pinned, free, freeAll"),
        ("CreateHolesAttr", 1, "holes is 1; it must be one of"),
        ("CreateEnvelopeAttr", "half", "envelope is 'half'; it must be a number"),
        ("CreateCornersAttr", [0.5, 1, 2, 3], "corners: float64 values do not fit int32"),
        ("CreateCornersAttr", [[0, 1], [2, 3]], "corners: the shape is 2 x 2; it must be n"),
        ("CreateCornersAttr", [[0, 1], [2]], "corners: "),
        ("CreateCornersAttr", [0, 1, 2, -1], "corners[3] is -1; points are numbered from 0"),
        ("CreateCornersAttr", [0, 1, 2], "corners has 3 values; it must have 4"),
        ("CreateEdgesAttr", [2**40, 1], "edges: int64 values do not fit int32"),
        ("CreateEdgesAttr", [-1, 1], "edges[0] is -1; points are numbered from 0"),
        ("CreateEdgesAttr", [0, 1, 2], "edges has 3 values; it must hold pairs of point indices"),
        ("CreateEdgeForceDensitiesAttr", ["a"], "edgeForceDensities: "),
    ],
)
def test_values_of_another_kind(method, value, message, stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    before = text(stage)
    with pytest.raises(UsageError) as raised:
        getattr(patch, method)(value)
    assert message in str(raised.value) and text(stage) == before


def test_painted_primvars(prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    made = {
        "weight": patch.CreateWeightPrimvar("constant", [0.5]),
        "maxDistance": patch.CreateMaxDistancePrimvar(defaultValue=np.ones(49)),
        "forceDensity": patch.CreateForceDensityPrimvar("uniform", range(1, 37)),
        "hold": patch.CreateHoldPrimvar("constant", [2]),
        "patch": patch.CreatePatchPrimvar(defaultValue=np.arange(36) < 6),
    }
    assert set(made) == {each.name for group in ("patch", "controls") for each in inputs(group) if each.is_primvar}
    for name, primvar in made.items():
        assert primvar.GetName() == f"primvars:skinSlide:{PATCH}:{name}"
        assert getattr(patch, f"Get{name[0].upper()}{name[1:]}Primvar")().GetAttr() == primvar.GetAttr()
    expected = ["constant", "vertex", "uniform", "constant", "uniform"]
    assert [primvar.GetInterpolation() for primvar in made.values()] == expected
    assert list(made["forceDensity"].Get()) == list(range(1, 37)) and made["weight"].Get()[0] == 0.5
    with pytest.raises(UsageError, match="patch: int64 values do not fit bool"):
        patch.CreatePatchPrimvar(defaultValue=[1, 0])


def test_painted_values_are_not_those_of_older_indices(stage, prim):
    below = UsdGeom.PrimvarsAPI(stage.below.GetPrimAtPath(MESH)).CreatePrimvar(
        f"skinSlide:{PATCH}:weight", Types.FloatArray, "vertex"
    )
    below.Set([0.25, 0.75])
    below.SetIndices(Vt.IntArray([0, 1] * 24 + [0]))
    weight = SkinSlideAPI.Apply(prim, PATCH).CreateWeightPrimvar(defaultValue=np.linspace(0, 1, 49))
    assert not weight.IsIndexed() and weight.ComputeFlattened()[24] == 0.5


@pytest.mark.parametrize(
    "faces", [[8, 2, 2, 7], (2, 7, 8), np.array([2, 7, 8], np.uint8), np.isin(np.arange(36), [2, 7, 8])]
)
def test_faces(faces, stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    patch.SetFaces(faces)
    assert faces_of(stage) == {PATCH: [2, 7, 8]}
    chosen = patch.GetPatchPrimvar()
    assert chosen.GetInterpolation() == "uniform" and chosen.GetTypeName() == Types.BoolArray


def test_faces_take_the_place_of_all_before(stage, prim):
    """In place of samples and indices in the edit target, and of values below it."""
    stages.add_patch(UsdGeom.Mesh(stage.below.GetPrimAtPath(MESH)), [30])
    patch = SkinSlideAPI(prim, PATCH)
    older = patch.CreatePatchPrimvar("vertex", [True, False])
    older.SetIndices(Vt.IntArray([0] * 49))
    older.GetAttr().Set([False, True], FRAMES[0])
    patch.SetFaces(FACES)
    assert faces_of(stage) == {PATCH: FACES.tolist()}
    assert not patch.GetPatchPrimvar().GetTimeSamples()


@pytest.mark.parametrize(
    ("faces", "kind", "message"),
    [
        ([36], StageProblems, "there is no face 36: the mesh has 36 faces"),
        ([-1], StageProblems, "there is no face -1"),
        (np.ones(35, bool), StageProblems, "faces: 35 values for 36 faces"),
        ([0.5], UsageError, "faces are floats; they must be indices, or a bool for each face, such as mask > 0"),
        ([[1, 2]], UsageError, "faces: the shape is 1 x 2; it must be n"),
        ([[1], [2, 3]], UsageError, "faces: "),
        (3, UsageError, "faces: the shape is a single value; it must be n"),
    ],
)
def test_faces_that_are_none(faces, kind, message, stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    before = text(stage)
    with pytest.raises(kind) as raised:
        patch.SetFaces(faces)
    assert message in str(raised.value) and text(stage) == before


def test_edges(stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    patch.SetFaces(FACES)
    patch.CreateEdgeForceDensitiesAttr().Set([9.0], FRAMES[0])
    patch.SetEdges(np.array([[8, 9], [10, 9]]), [2, 3.5])
    (mesh,), _ = read_meshes(stage)
    controls = mesh.patches[0].controls
    assert controls.edges.tolist() == [[8, 9], [10, 9]] and controls.edge_density.tolist() == [2, 3.5]
    with pytest.raises(UsageError, match="force_densities: the shape is 1; it must be 2"):
        patch.SetEdges([[8, 9], [9, 10]], [1])
    before = text(stage)
    with pytest.raises(UsageError, match=r"edges\[2\] is -1; points are numbered from 0"):
        patch.SetEdges([[8, 9], [-1, 10]], [1, 2])
    assert text(stage) == before


def test_opinions_go_to_the_edit_target_and_with_it(stage, prim):
    """The session's, or a variant's: if the layer is cleared or taken away, they are gone."""
    session = Sdf.Layer.CreateAnonymous()
    stage.GetSessionLayer().subLayerPaths.append(session.identifier)
    before = text(stage)
    with Usd.EditContext(stage, session):
        SkinSlideAPI.Apply(prim, PATCH).SetFaces([1])
    assert text(stage) == before and SkinSlideAPI(prim, PATCH)
    session.Clear()
    assert not SkinSlideAPI(prim, PATCH)
    variants = stage.GetPrimAtPath("/World").GetVariantSets().AddVariantSet("skin")
    for name in ("plain", "sliding"):
        variants.AddVariant(name)
        variants.SetVariantSelection(name)
    with variants.GetVariantEditContext():
        skinslide.setup(stage, prim, PATCH, faces=[1, 2])
    assert SkinSlideAPI(prim, PATCH)
    variants.SetVariantSelection("plain")
    assert not SkinSlideAPI(prim, PATCH)


def test_usd_says_where_nothing_can_be_authored(stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    stage.GetRootLayer().SetPermissionToEdit(False)
    with pytest.raises(Tf.ErrorException):
        patch.CreateEnvelopeAttr(0.5)


# ---- Set-ups ----


@pytest.mark.parametrize("as_given", [lambda prim: prim, lambda prim: prim.GetPath(), UsdGeom.Mesh, lambda prim: MESH])
def test_setup_of_a_prim_however_it_is_given(as_given, stage, prim):
    report = skinslide.setup(stage, as_given(prim), PATCH, faces=FACES)
    assert faces_of(stage) == {PATCH: FACES.tolist()}
    assert not report.failed and [patch.name for patch in report.meshes[0].patches] == [PATCH]
    assert PATCH not in stage.below.GetRootLayer().ExportToString()


def build(folder) -> Usd.Stage:
    """A stage in a file, with what set-ups choose by."""
    cache = stages.new_stage()
    mesh = stages.add_mesh(cache, stages.grid(), rest="Pref")
    subset = UsdGeom.Subset.Define(cache, f"{MESH}/faces")
    subset.CreateElementTypeAttr("face")
    subset.CreateIndicesAttr(FACES.tolist())
    stages.set_primvar(mesh, "mask", Types.FloatArray, "vertex", [1.0] * 49)
    return Usd.Stage.Open(str(stages.save(cache, folder / "cache.usda")))


CHAINS = {
    "setup": [("setup", PATCH, dict(subset="faces"))],
    "setup and paint": [
        ("setup", PATCH, dict(faces=FACES)),
        ("paint", PATCH, dict(value=3, primvar="mask")),
        ("paint", PATCH, dict(value=2, edges=[[8, 9], [10, 9]])),
    ],
    "setup and mirror": [
        ("setup", PATCH, dict(faces="0-2,6-8")),
        ("mirror", PATCH, dict(tolerance=0.2)),
    ],
}


@pytest.mark.parametrize("chain", CHAINS.values(), ids=CHAINS.keys())
def test_a_layer_and_an_edit_target_get_the_same(chain, tmp_path):
    """Each function authors the same opinions as its variant that writes a file."""
    stage, output = build(tmp_path), tmp_path / "patches.usda"
    target = Sdf.Layer.CreateAnonymous(".usda")
    stage.GetSessionLayer().subLayerPaths.append(target.identifier)
    stage.SetEditTarget(stage.GetEditTargetForLocalLayer(target))
    clean = Usd.Stage.Open(stage.GetRootLayer().realPath, Usd.Stage.LoadAll)
    for name, patch, choice in chain:
        getattr(skinslide, name)(stage, MESH, patch, **choice)
        getattr(skinslide, f"{name}_to_file")(clean, output, MESH, patch, **choice)
    written = Sdf.Layer.FindOrOpen(str(output))
    assert written.GetPrimAtPath(MESH).properties
    for layer in (written, target):
        layer.pseudoRoot.ClearInfo("subLayers")
    bodies = [layer.ExportToString().partition('over "World"')[2] for layer in (written, target)]
    assert bodies[0] == bodies[1]


BAD = {
    "no such face": (skinslide.setup, dict(faces=[36]), "there is no face 36"),
    "pinched": (skinslide.setup, dict(faces=[1, 2, 6, 8, 12, 13, 14], rule="unit"), "touches itself"),
    "no such subset": (skinslide.setup, dict(subset="gone"), "no GeomSubset gone"),
    "paint no edge": (
        skinslide.paint,
        dict(value=2, edges=[[0, 8]]),
        "edges has 0-8, which is not an edge of the mesh",
    ),
    "paint off the patch": (skinslide.paint, dict(value=2, edges=[[47, 48]]), "edges chooses no edge of the patch"),
    "mirror": (skinslide.mirror, dict(axis="y"), "no mirror image"),
}


@pytest.mark.parametrize(("function", "choice", "message"), BAD.values(), ids=BAD.keys())
def test_what_fails_leaves_the_edit_target_as_it_was(function, choice, message, stage, prim):
    patch = SkinSlideAPI.Apply(prim, PATCH)
    patch.SetFaces(FACES)
    patch.CreateEnvelopeAttr().Set(0.5, FRAMES[0])
    before = text(stage)
    with pytest.raises(StageProblems, match=message):
        function(stage, prim, PATCH, **choice)
    assert text(stage) == before


def test_what_fails_leaves_no_prims_in_an_empty_edit_target(stage, prim):
    before = text(stage)
    with pytest.raises(StageProblems, match="touches itself"):
        skinslide.setup(stage, prim, PATCH, faces=[1, 2, 6, 8, 12, 13, 14], rule="unit")
    assert text(stage) == before and not prim.GetAppliedSchemas()


def test_a_stronger_opinion_is_told_of(stage, prim):
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        SkinSlideAPI(prim, PATCH).SetFaces([0, 1, 6, 7])
    report = skinslide.setup(stage, prim, PATCH, faces=FACES)
    (hidden,) = [problem for problem in report.problems if "is hidden by that in" in problem.message]
    assert hidden.severity == "warning" and f"primvars:skinSlide:{PATCH}:patch is hidden" in hidden.message


def test_a_set_up_changes_after_a_bake_into_the_same_layer(stage, prim):
    skinslide.setup(stage, prim, PATCH, faces=FACES)
    skinslide.bake(stage)
    first = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(FRAMES[2]))
    skinslide.paint(stage, prim, PATCH, 9, edges=[[8, 9], [15, 16]])
    assert np.array_equal(first, UsdGeom.Mesh(prim).GetPointsAttr().Get(FRAMES[2]))
    skinslide.bake(stage)
    assert not np.array_equal(first, UsdGeom.Mesh(prim).GetPointsAttr().Get(FRAMES[2]))


def test_a_stage_in_no_file_has_no_layer_on_it(stage, tmp_path):
    with pytest.raises(UsageError, match="is in no file; save it first"):
        skinslide.setup_to_file(stage, tmp_path / "patches.usda", MESH, PATCH, faces=FACES)
    assert not list(tmp_path.iterdir())


def test_an_edit_target_that_takes_nothing(stage, prim):
    stage.GetRootLayer().SetPermissionToEdit(False)
    with pytest.raises(UsageError, match="is not editable"):
        skinslide.setup(stage, prim, PATCH, faces=FACES)


def of_table(table):
    return {field.name: field.type for field in fields(table)}


@pytest.mark.parametrize(
    ("keywords", "table"),
    [
        (shot_options.PictureKeywords, shot_options.PictureOptions),
        (shot_options.MapKeywords, shot_options.MapOptions),
        (options.SetupKeywords, options.SetupOptions),
        (options.PaintKeywords, options.PaintOptions),
        (options.MirrorKeywords, options.MirrorOptions),
    ],
)
def test_keywords_are_the_options(keywords, table):
    """What type checkers know of **choice; a mesh, a patch and a value are arguments of their own."""
    told = {name: reference.__forward_arg__ for name, reference in keywords.__annotations__.items()}
    own = {} if table.__module__ == shot_options.__name__ else {"prim": ..., "patch": ..., "value": ...}
    assert told == {name: kind for name, kind in of_table(table).items() if name not in own}


@pytest.mark.parametrize(
    ("function", "table"),
    [
        (skinslide.setup, options.SetupOptions),
        (skinslide.setup_to_file, options.SetupOptions),
        (skinslide.paint, options.PaintOptions),
        (skinslide.paint_to_file, options.PaintOptions),
        (skinslide.mirror, options.MirrorOptions),
        (skinslide.mirror_to_file, options.MirrorOptions),
    ],
)
def test_a_signature_has_the_options(function, table):
    """With their defaults; the docstring has a line for each, in which keywords stand for flags."""
    parameters = inspect.signature(function).parameters
    for field in fields(table):
        keyword = parameters[field.name]
        assert keyword.kind != inspect.Parameter.KEYWORD_ONLY or keyword.default == field.default
        assert f"        {field.name}: " in function.__doc__
    assert "--" not in function.__doc__ and all(len(line) <= 120 for line in function.__doc__.splitlines())


@pytest.mark.parametrize("function", [skinslide.setup, skinslide.paint, skinslide.mirror, skinslide.setup_to_file])
def test_a_keyword_that_is_misspelt(function):
    """As in Python, but that what is like it is named."""
    with pytest.raises(TypeError, match=rf"^{function.__name__}\(\) takes no prm; there are prim, "):
        function(prm=MESH)


def test_words_of_the_schema_are_its_own():
    tokens = {"forceDensityRule": options.RULES, "holes": options.HOLES, "interpolation": options.INTERPOLATIONS}
    for name, words in tokens.items():
        assert tuple(schema.declared(name).allowedTokens) == words
    assert options.AXES == geometry.AXES


# ---- What is given ----


@pytest.mark.parametrize(
    ("given", "kind", "message"),
    [
        (dict(stage="a.usda"), TypeError, "stage is 'a.usda'; it must be a Usd.Stage"),
        (dict(prim=3), TypeError, "prim is 3; it must be a Usd.Prim, an Sdf.Path or a str"),
        (dict(prim=Usd.Prim()), UsageError, "prim is an invalid null prim"),
        (dict(prim="World"), UsageError, "prim 'World' is not the path of a prim"),
        (dict(prim="/World.points"), UsageError, "prim '/World.points' is not the path of a prim"),
    ],
)
def test_what_is_no_stage_and_no_prim(given, kind, message, stage, prim):
    with pytest.raises(kind) as raised:
        skinslide.setup(**{"stage": stage, "prim": prim, "patch": PATCH, "faces": FACES, **given})
    assert message in str(raised.value)


def test_what_is_no_path_of_a_stage(prim, tmp_path):
    with pytest.raises(TypeError, match=r"stage is 3; it must be a Usd\.Stage or a path"):
        skinslide.setup_to_file(3, tmp_path / "a.usda", prim, PATCH, faces=FACES)


def test_a_stage_is_a_stage_or_a_path(tmp_path):
    path = saved(tmp_path)
    from_path = skinslide.bake_to_file(path, tmp_path / "a.usda")
    from_stage = skinslide.bake_to_file(Usd.Stage.Open(str(path)), tmp_path / "b.usda")
    assert (tmp_path / "a.usda").read_bytes() == (tmp_path / "b.usda").read_bytes()
    assert from_path.frame_count == from_stage.frame_count == 2 * len(FRAMES)
    assert skinslide.check(Usd.Stage.Open(str(path))).meshes == skinslide.check(str(path)).meshes
    skinslide.maps(Usd.Stage.Open(str(path)), tmp_path / "maps", st="uv", frames=FRAMES[:1])
    assert list((tmp_path / "maps").iterdir())


@pytest.mark.parametrize(
    "call",
    [
        lambda given: skinslide.check(given),
        lambda given: skinslide.bake(given),
        lambda given: skinslide.bake_to_file(given, "a.usda"),
        lambda given: skinslide.preview(given, "pictures"),
        lambda given: skinslide.maps(given, "maps"),
        lambda given: skinslide.cache(given, "a.usda"),
        lambda given: skinslide.farm(given, "a.usda", chunk=2),
    ],
)
@pytest.mark.parametrize("given", [3, None, Sdf.Path("/World")])
def test_what_is_no_stage(call, given):
    with pytest.raises(TypeError, match=r"stage is .*; it must be a Usd\.Stage"):
        call(given)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda shot, given: skinslide.bake_to_file(shot, given), "output"),
        (lambda shot, given: skinslide.cache(shot, given), "output"),
        (lambda shot, given: skinslide.farm(shot, given, chunk=2), "output"),
        (lambda shot, given: skinslide.stitch([shot], given), "output"),
        (lambda shot, given: skinslide.setup_to_file(shot, given, MESH, PATCH, faces=FACES), "output"),
        (lambda shot, given: skinslide.maps(shot, given), "folder"),
        (lambda shot, given: skinslide.preview(shot, given if given is not None else 3), "folder"),
        (lambda shot, given: skinslide.preview(shot, html=given if given is not None else 3), "html"),
    ],
)
@pytest.mark.parametrize("given", [3, None, [Path("a.usda")]])
def test_what_is_no_output(call, name, given, tmp_path):
    with pytest.raises(UsageError, match=rf"^{name} is .*; it must be a path"):
        call(saved(tmp_path), given)


@pytest.mark.parametrize("also", [3, None, skinslide.Maps("maps"), [3], ["maps"]])
def test_what_is_no_product(also, tmp_path):
    path = saved(tmp_path)
    for call in (
        lambda: skinslide.bake_to_file(path, tmp_path / "out.usda", also=also),
        lambda: skinslide.bake(Usd.Stage.Open(str(path)), also=also),
    ):
        with pytest.raises(UsageError, match=r"^also is .*; it must be a sequence of Pictures and Maps"):
            call()


def saved(folder) -> Path:
    """A stage with two meshes, each with a patch."""
    stage = stages.new_stage()
    for path in (MESH, OTHER):
        mesh = stages.add_mesh(stage, stages.grid(), path)
        stages.set_primvar(mesh, "uv", Types.TexCoord2fArray, "vertex", [(0.5, 0.5)] * 49)
        stages.add_patch(mesh, FACES)
    return stages.save(stage, folder / "shot.usda")


PRIMS = {
    "a prim": lambda stage: stage.GetPrimAtPath(OTHER),
    "a mesh": lambda stage: UsdGeom.Mesh(stage.GetPrimAtPath(OTHER)),
    "a path": lambda stage: Sdf.Path(OTHER),
    "text": lambda stage: OTHER,
    "several": lambda stage: (stage.GetPrimAtPath(OTHER), Sdf.Path(OTHER)),
    "a generator": lambda stage: (prim for prim in stage.Traverse() if prim.GetPath() == OTHER),
}


@pytest.mark.parametrize("prims", PRIMS.values(), ids=PRIMS.keys())
def test_prims_of_a_shot(prims, tmp_path):
    stage = Usd.Stage.Open(str(saved(tmp_path)))
    report = skinslide.bake_to_file(stage, tmp_path / "out.usda", prims=prims(stage))
    assert [mesh.path for mesh in report.meshes] == [OTHER]
    assert [mesh.path for mesh in skinslide.check(stage, prims(stage)).meshes] == [OTHER]
    assert [mesh.path for mesh in skinslide.bake(stage, prims=prims(stage)).meshes] == [OTHER]


@pytest.mark.parametrize("prims", [3, [3], [None]])
def test_prims_that_are_none(prims, tmp_path):
    path = saved(tmp_path)
    with pytest.raises(TypeError, match=r"prims is .*; it must be a Usd\.Prim, an Sdf\.Path or a str"):
        skinslide.bake_to_file(path, tmp_path / "out.usda", prims=prims)
    with pytest.raises(UsageError, match="prims is an invalid null prim"):
        skinslide.check(path, Usd.Prim())
    with pytest.raises(UsageError, match="prims is empty; leave it out to take every prim"):
        skinslide.check(path, [])


@pytest.mark.parametrize(
    "frames", [[1002], (1002.0, 1002), [Usd.TimeCode(1002)], np.array([1002, 1002]), {1002: "a"}, "1002"]
)
def test_frames_however_they_are_given(frames):
    assert checked_frames(frames) == [1002]


@pytest.mark.parametrize("frames", [None, 1002, [None], Usd.TimeCode(1002), [Usd.TimeCode.Default()], np.array([])])
def test_frames_that_are_none(frames):
    with pytest.raises(FrameSpecError):
        checked_frames(frames)


def test_a_camera_is_a_prim_too(tmp_path):
    stage = Usd.Stage.Open(str(saved(tmp_path)))
    for camera in (stage.DefinePrim("/camera", "Camera"), Sdf.Path("/camera"), "/camera"):
        assert skinslide.Pictures("pictures", camera=camera).camera == "/camera"
    with pytest.raises(TypeError, match=r"camera is 3; it must be a Usd\.Prim"):
        skinslide.Pictures("pictures", camera=3)
