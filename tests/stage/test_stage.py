"""Reading the composed stage: meshes, rest points, faces, controls and times. Composition itself is USD's."""

import numpy as np
import pytest
from pxr import Sdf, Ts, Usd, UsdGeom, Vt

import stages
from skinslide.arrays.values import merge_times
from skinslide.problems import FrameProblem, UsageError, errors
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH, PATCH

Types = Sdf.ValueTypeNames


def only_mesh(stage: Usd.Stage) -> PatchedMesh:
    meshes, problems = read_meshes(stage)
    assert not errors(problems), problems
    assert len(meshes) == 1
    return meshes[0]


def test_arrays_are_the_stage_s():
    shape = stages.grid()
    stage, _mesh = stages.patched_stage(shape, stages.annulus())
    read = only_mesh(stage)
    assert (read.path, read.vertex_count, read.left_handed) == (MESH, 49, False)
    np.testing.assert_array_equal(read.face_counts, shape.counts)
    np.testing.assert_array_equal(read.face_indices, shape.indices)
    np.testing.assert_array_equal(read.rest_points, shape.points)
    np.testing.assert_array_equal(read.patches[0].faces, stages.annulus())
    np.testing.assert_array_equal(read.points_at(Usd.TimeCode(FRAMES[1])), shape.moved(FRAMES[1]))
    assert read.points_at(Usd.TimeCode(FRAMES[1])).dtype == np.float32


def test_fallbacks_of_the_schema_are_the_set_up():
    stage, _mesh = stages.patched_stage()
    setup = only_mesh(stage).patches[0]
    assert (setup.boundary, setup.holes, setup.rule, setup.interpolation) == ("auto", "pinned", "unit", "auto")
    assert setup.corners is None
    assert setup.controls.envelope == 1 and setup.controls.weight is None and setup.controls.vertex_density is None


def test_left_handed():
    stage, mesh = stages.patched_stage()
    mesh.CreateOrientationAttr(UsdGeom.Tokens.leftHanded)
    assert only_mesh(stage).left_handed


def test_a_mesh_outlives_the_caller_s_stage():
    def read() -> PatchedMesh:
        stage, _mesh = stages.patched_stage()
        return only_mesh(stage)

    assert len(read().points_at(Usd.TimeCode(FRAMES[0]))) == 49


# ---- Rest ----


def test_rest_is_the_first_found():
    """Each source is put below one that wins over it, from the last to the first."""
    shape = stages.grid()
    stage, mesh = stages.patched_stage(shape)
    assert only_mesh(stage).rest_source == "points (default)"
    for height, name in enumerate(("__Pref", "Pref", "pref", "rest"), start=1):
        value = stages.vectors(shape.points + np.float32(height))
        stages.set_primvar(mesh, name, Types.Point3fArray, "vertex", value)
        read = only_mesh(stage)
        assert read.rest_source == f"primvars:{name}"
        np.testing.assert_array_equal(read.rest_points, np.array(value))
    attr = mesh.GetPrim().CreateAttribute("skinSlide:restPoints", Types.Point3fArray, False)
    attr.Set(stages.vectors(shape.points - 1))
    assert only_mesh(stage).rest_source == "skinSlide:restPoints"


def test_rest_may_be_indexed_sampled_or_double():
    shape = stages.grid()
    stage, mesh = stages.patched_stage(shape, rest="")
    order = np.arange(49)[::-1]
    value = Vt.Vec3dArray.FromNumpy(shape.points[order].astype(np.float64))
    stages.set_primvar(mesh, "Pref", Types.Double3Array, "vertex", value, time=7)
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar("Pref").SetIndices(Vt.IntArray.FromNumpy(order.astype(np.int32)))
    np.testing.assert_array_equal(only_mesh(stage).rest_points, shape.points)


# ---- Faces ----


@pytest.mark.parametrize(
    ("type_name", "values"),
    [
        (Types.BoolArray, [True] * 3 + [False] * 33),
        (Types.IntArray, [1, 7, 2] + [0] * 32 + [-1]),
        (Types.FloatArray, [1e-9, 1, 2] + [0.0] * 32 + [-1.0]),
    ],
)
def test_faces_by_face(type_name, values):
    stage, mesh = stages.patched_stage()
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:patch", type_name, "uniform", values)
    assert only_mesh(stage).patches[0].faces.tolist() == [0, 1, 2]


def test_faces_by_vertex_need_all_their_points():
    stage, mesh = stages.patched_stage()
    painted = [0.0] * 49
    for vertex in (0, 1, 2, 7, 8, 9, 14):  # the corners of faces 0 and 1, and one of face 6
        painted[vertex] = 0.5
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:patch", Types.FloatArray, "vertex", painted)
    assert only_mesh(stage).patches[0].faces.tolist() == [0, 1]


def test_faces_of_an_indexed_primvar():
    stage, mesh = stages.patched_stage()
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:patch", Types.BoolArray, "uniform", [False, True])
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar(f"skinSlide:{PATCH}:patch").SetIndices([1, 1] + [0] * 34)
    assert only_mesh(stage).patches[0].faces.tolist() == [0, 1]


def test_faces_of_a_subset_count_only_without_the_primvar():
    stage, mesh = stages.patched_stage(faces=np.array([0, 1]))
    subset = UsdGeom.Subset.Define(stage, f"{MESH}/{PATCH}")
    subset.CreateElementTypeAttr("face")
    subset.CreateIndicesAttr([9, 8])
    assert only_mesh(stage).patches[0].faces.tolist() == [0, 1]
    mesh.GetPrim().GetAttribute(f"primvars:skinSlide:{PATCH}:patch").Block()
    assert only_mesh(stage).patches[0].faces.tolist() == [8, 9]


def test_a_patch_s_name_may_have_namespaces():
    stage, mesh = stages.patched_stage()
    stages.add_patch(mesh, np.arange(6), "left:arm:elbow")
    stages.set_property(mesh, "envelope", 0.25, patch="left:arm:elbow")
    patches = {patch.name: patch for patch in only_mesh(stage).patches}
    assert patches["left:arm:elbow"].controls.envelope == 0.25
    assert patches[PATCH].controls.envelope == 1
    assert not read_meshes(stage)[1]


# ---- Controls ----


def test_density_by_interpolation():
    stage, mesh = stages.patched_stage()
    name = f"skinSlide:{PATCH}:forceDensity"
    for interpolation, count in (("vertex", 49), ("uniform", 36), ("constant", 1)):
        stages.set_primvar(mesh, name, Types.FloatArray, interpolation, [2.0] * count)
        controls = only_mesh(stage).patches[0].controls
        assert (controls.vertex_density is not None) == (interpolation == "vertex")
        assert (controls.face_density is not None) == (interpolation == "uniform")


def test_paint_off_the_patch_does_not_count():
    stage, mesh = stages.patched_stage(faces=np.array([0]))  # points 0, 1, 7, 8
    values = np.zeros(49, np.float32)
    values[[0, 1, 7, 8]] = 3
    stages.set_primvar(
        mesh, f"skinSlide:{PATCH}:forceDensity", Types.FloatArray, "vertex", Vt.FloatArray.FromNumpy(values)
    )
    values[48] = np.nan
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", Types.FloatArray, "vertex", Vt.FloatArray.FromNumpy(values))
    controls = only_mesh(stage).patches[0].controls
    assert controls.vertex_density[[0, 1, 7, 8]].tolist() == [3, 3, 3, 3]
    assert np.isfinite(controls.weight).all() and (controls.vertex_density > 0).all()


@pytest.mark.parametrize(("type_name", "value"), [(Types.Float, 0.5), (Types.FloatArray, [0.5])])
@pytest.mark.parametrize(("primvar", "argument"), [("weight", "weight"), ("maxDistance", "max_distance")])
def test_constants(primvar, argument, type_name, value):
    stage, mesh = stages.patched_stage()
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:{primvar}", type_name, "constant", value)
    assert getattr(only_mesh(stage).patches[0].controls, argument).tolist() == [0.5] * 49


def test_constants_are_inherited():
    stage, _mesh = stages.patched_stage()
    for name, value in (("weight", 0.25), ("forceDensity", -1.0)):
        primvar = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath("/World/char")).CreatePrimvar(
            f"skinSlide:{PATCH}:{name}", Types.Float, "constant"
        )
        primvar.Set(value)
    (problem,) = errors(read_meshes(stage)[1])
    assert "forceDensity[0] is -1" in problem.message
    primvar.Set(2.0)
    controls = only_mesh(stage).patches[0].controls
    assert controls.weight.tolist() == [0.25] * 49
    assert controls.vertex_density is None and controls.face_density is None  # only ratios matter


def test_edges_and_corners():
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "edges", [0, 1, 1, 2])
    stages.set_property(mesh, "edgeForceDensities", [2.0, 3.0])
    stages.set_property(mesh, "corners", [0, 6, 48, 42])
    setup = only_mesh(stage).patches[0]
    assert setup.controls.edges.tolist() == [[0, 1], [1, 2]]
    assert setup.controls.edge_density.tolist() == [2, 3]
    assert setup.corners.tolist() == [0, 6, 48, 42]


# ---- Time ----


def test_static_controls_come_with_the_set_up():
    stage, _mesh = stages.patched_stage()
    read = only_mesh(stage)
    assert read.controls_at(Usd.TimeCode(FRAMES[1])) is None
    assert read.sample_times() == read.points_times() == list(FRAMES)


def test_no_samples():
    stage, mesh = stages.patched_stage()
    for frame in FRAMES:
        mesh.GetPointsAttr().ClearAtTime(frame)
    assert only_mesh(stage).sample_times() == []


def test_animated_controls_add_their_samples():
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "envelope", 0.0, FRAMES[0])
    stages.set_property(mesh, "envelope", 1.0, FRAMES[0] + 0.5)
    for frame, weight in ((FRAMES[1], 0.0), (FRAMES[2] + 1, 1.0)):
        stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", Types.FloatArray, "vertex", [weight] * 49, frame)
    read = only_mesh(stage)
    assert read.sample_times() == [1001, 1001.5, 1002, 1003, 1004]
    assert read.points_times() == list(FRAMES)
    (controls,) = read.controls_at(Usd.TimeCode(1001.25))
    assert controls.envelope == 0.5
    (controls,) = read.controls_at(Usd.TimeCode(1003))
    np.testing.assert_allclose(controls.weight, 0.5)


def test_spline_envelope_adds_its_frames():
    stage, mesh = stages.patched_stage()
    spline = stages.linear_spline({999.5: 0.0, 1002.25: 1.0})
    mesh.GetPrim().GetAttribute(f"skinSlide:{PATCH}:envelope").SetSpline(spline)
    read = only_mesh(stage)
    # Whole frames of the shot only: an artist's knot may lie anywhere.
    assert read.sample_times() == [999.5, 1001, 1002, 1002.25, 1003]
    (controls,) = read.controls_at(Usd.TimeCode(1000.875))
    assert controls.envelope == pytest.approx(0.5, abs=1e-6)  # half way, in float


def test_a_spline_over_half_of_eternity():
    stage, mesh = stages.patched_stage()
    spline = Ts.Spline("float")
    for time in (-3e8, 3e8):
        knot = Ts.Knot("float")
        knot.SetTime(time)
        knot.SetValue(1.0)
        spline.SetKnot(knot)
    mesh.GetPrim().GetAttribute(f"skinSlide:{PATCH}:envelope").SetSpline(spline)
    read = only_mesh(stage)
    assert read.sample_times() == read.frame_times() == [-3e8, *FRAMES, 3e8]
    stage.SetEndTimeCode(1e12)
    with pytest.raises(UsageError, match=r"envelope is a spline over 299998999 frames"):
        read.sample_times()
    assert read.varies


def test_times_that_differ_by_noise_are_one():
    assert merge_times([3.0, 1.0, 1.0 + 4e-16, 2.0000001, 2.0]) == [1.0, 2.0000001, 3.0]


def test_layer_offset_and_payload(tmp_path):
    shape = stages.grid()
    cache, _mesh = stages.patched_stage(shape)
    stages.save(cache, tmp_path / "cache.usdc")
    (tmp_path / "shot.usda").write_text(
        '#usda 1.0\n(\n    timeCodesPerSecond = 24\n)\ndef Xform "shot" (\n'
        "    payload = @./cache.usdc@</World> (offset = -1000.1; scale = 2)\n)\n{\n}\n"
    )
    read = only_mesh(open_stage(tmp_path / "shot.usda"))
    assert read.path == "/shot/char/geo/skin_GEO"
    np.testing.assert_allclose(read.sample_times(), 2 * np.array(FRAMES) - 1000.1, atol=1e-9)
    for time, frame in zip(read.sample_times(), FRAMES, strict=True):
        np.testing.assert_array_equal(read.points_at(Usd.TimeCode(time)), shape.moved(frame))


def test_variant(tmp_path):
    stage, mesh = stages.patched_stage()
    variants = mesh.GetPrim().GetVariantSets().AddVariantSet("skin")
    for name, envelope in (("full", 1.0), ("half", 0.5)):
        variants.AddVariant(name)
        variants.SetVariantSelection(name)
        with variants.GetVariantEditContext():
            stages.set_property(mesh, "envelope", envelope)
    for name, envelope in (("full", 1.0), ("half", 0.5)):
        variants.SetVariantSelection(name)
        assert only_mesh(stage).patches[0].controls.envelope == envelope


def test_value_clips(tmp_path):
    stage, clips = stages.clipped_stage(tmp_path)
    stages.use_clip_template(clips)
    for name in ("shot.usda", "shot.skinslide"):
        (tmp_path / name).write_text(stage.GetRootLayer().ExportToString())
        read = only_mesh(open_stage(tmp_path / name))
        assert read.sample_times() == list(FRAMES)
        moved = stages.grid().moved(FRAMES[1])
        np.testing.assert_array_equal(read.points_at(Usd.TimeCode(FRAMES[1])), moved)


def test_frame_problem_names_the_frame():
    stage, mesh = stages.patched_stage()
    mesh.GetPointsAttr().Set(stages.vectors(np.zeros((3, 3))), FRAMES[1])
    with pytest.raises(FrameProblem, match=f"{MESH}: frame 1002: points has 3 values, but 49"):
        only_mesh(stage).points_at(Usd.TimeCode(FRAMES[1]))


# ---- Finding and opening ----


def test_prims_select_what_is_at_or_below():
    stage, _mesh = stages.patched_stage()
    other = stages.add_mesh(stage, stages.grid(), "/World/prop/geo/rope_GEO")
    stages.add_patch(other, stages.annulus(), "rope")

    def found(*paths: str) -> list[str]:
        return [mesh.path for mesh in read_meshes(stage, paths or None)[0]]

    assert found() == found("/World") == found("/World", MESH) == [MESH, "/World/prop/geo/rope_GEO"]
    assert found("/World/prop") == ["/World/prop/geo/rope_GEO"]
    for path in ("/World/gone", "rope_GEO", ""):
        (problem,) = errors(read_meshes(stage, [path])[1])
        assert problem.prim == path


def test_inactive_and_abstract_prims_are_passed_over():
    stage, _mesh = stages.patched_stage()
    other = stages.add_mesh(stage, stages.grid(), "/World/prop/rope_GEO")
    stages.add_patch(other, stages.annulus())
    stage.GetPrimAtPath("/World/prop").SetActive(False)
    assert only_mesh(stage).path == MESH


def test_skinslide_file_opens_as_its_text(tmp_path):
    cache, _mesh = stages.patched_stage()
    (tmp_path / "caches").mkdir()
    stages.save(cache, tmp_path / "caches" / "cache.usdc")
    path = tmp_path / "shot.skinslide"
    path.write_text("#usda 1.0\n(\n    subLayers = [@./caches/cache.usdc@]\n    timeCodesPerSecond = 24\n)\n")
    assert only_mesh(open_stage(path)).sample_times() == list(FRAMES)
    path.write_text('#usda 1.0\ndef "shot" (\n    references = @caches/cache.usdc@</World>\n)\n{\n}\n')
    assert only_mesh(open_stage(str(path))).path == "/shot/char/geo/skin_GEO"
