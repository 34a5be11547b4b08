"""Every bad input gives an exit code and a message that names prim, patch, frame and element; the output stays."""

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

import stages
from skinslide.command.cli import main
from stages import FRAMES, MESH, PATCH

NAN, INFINITY = float("nan"), float("inf")
FACES, DENSITY, WEIGHT, FARTHEST = (
    f"skinSlide:{PATCH}:{name}" for name in ("patch", "forceDensity", "weight", "maxDistance")
)
Types = Sdf.ValueTypeNames


@dataclass
class Case:
    """A stage that is spoiled, and what must be said about it."""

    name: str
    spoil: Callable[[UsdGeom.Mesh], None]
    says: str
    patch: str | None = PATCH  # None: the mesh as a whole is to blame
    frame: str | None = None  # only there does it show: the bake fails with 1
    shape: Callable[[], stages.Shape] = stages.grid
    faces: Callable[[], np.ndarray] | None = None


def nothing(_mesh: UsdGeom.Mesh) -> None:
    """The shape is bad enough."""


def put(name: str, type_name: Sdf.ValueTypeName, interpolation: str, value, time=None):
    return lambda mesh: stages.set_primvar(mesh, name, type_name, interpolation, value, time)


def prop(name: str, value, time=None):
    return lambda mesh: stages.set_property(mesh, name, value, time)


def floats(count: int, index: int = 0, value: float = 1.0) -> Vt.FloatArray:
    """Ones, but for one."""
    values = [1.0] * count
    values[index] = value
    return Vt.FloatArray(values)


def painted(name: str, interpolation: str, values: Vt.FloatArray, time=None):
    return put(name, Types.FloatArray, interpolation, values, time)


def painted_at_one_frame(name: str, value: float):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        painted(name, "vertex", floats(49), FRAMES[0])(mesh)
        painted(name, "vertex", floats(49, 12, value), FRAMES[1])(mesh)

    return spoil


def subset(indices: list[int], element: str = "face"):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        mesh.GetPrim().RemoveProperty(f"primvars:{FACES}")
        child = UsdGeom.Subset.Define(mesh.GetPrim().GetStage(), f"{MESH}/{PATCH}")
        child.CreateElementTypeAttr(element)
        child.CreateIndicesAttr(indices)

    return spoil


def no_faces_anywhere(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPrim().RemoveProperty(f"primvars:{FACES}")


def child_that_is_no_subset(mesh: UsdGeom.Mesh) -> None:
    no_faces_anywhere(mesh)
    UsdGeom.Xform.Define(mesh.GetPrim().GetStage(), f"{MESH}/{PATCH}")


def bad_indices_of_primvar(mesh: UsdGeom.Mesh) -> None:
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar(FACES)
    primvar.Set([False, True])
    primvar.SetIndices([1] * 35 + [7])


def faces_that_change(mesh: UsdGeom.Mesh) -> None:
    put(FACES, Types.BoolArray, "uniform", Vt.BoolArray([True] * 36), FRAMES[0])(mesh)
    put(FACES, Types.BoolArray, "uniform", Vt.BoolArray([True] * 35 + [False]), FRAMES[2])(mesh)


def points_value(index: int, value: float, time=None):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        time_code = Usd.TimeCode.Default() if time is None else time
        points = np.array(mesh.GetPointsAttr().Get(time_code))
        points[index, 1] = value
        mesh.GetPointsAttr().Set(stages.vectors(points), time_code)

    return spoil


def authored_as(name: str, type_name: Sdf.ValueTypeName, value):
    """Scene description may hold what the schema does not declare, if written as text or through Sdf."""

    def spoil(mesh: UsdGeom.Mesh) -> None:
        spec = mesh.GetPrim().GetStage().GetRootLayer().GetPrimAtPath(MESH)
        if name in spec.properties:
            spec.RemoveProperty(spec.properties[name])
        Sdf.AttributeSpec(spec, name, type_name).default = value

    return spoil


def fewer_points(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPointsAttr().Set(stages.vectors(np.zeros((48, 3))), FRAMES[1])


def no_points(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPrim().RemoveProperty("points")


def blocked_rest(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPointsAttr().ClearDefault()


def rest_points(count: int):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        attr = mesh.GetPrim().CreateAttribute("skinSlide:restPoints", Types.Point3fArray, False)
        attr.Set(stages.vectors(np.zeros((count, 3))))

    return spoil


def topology_that_changes(mesh: UsdGeom.Mesh) -> None:
    attr = mesh.GetFaceVertexIndicesAttr()
    indices = list(attr.Get())
    attr.Set(indices, FRAMES[0])
    attr.Set([*indices[4:], *indices[:4]], FRAMES[1])


def indices_end_with(*last: int):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        attr = mesh.GetFaceVertexIndicesAttr()
        attr.Set([*list(attr.Get())[: -len(last)], *last])

    return spoil


def counts_end_with(count: int):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        attr = mesh.GetFaceVertexCountsAttr()
        attr.Set([*list(attr.Get())[:-1], count])

    return spoil


def edges(pairs: list[int], factors: list[float]):
    def spoil(mesh: UsdGeom.Mesh) -> None:
        stages.set_property(mesh, "edges", pairs)
        stages.set_property(mesh, "edgeForceDensities", factors)

    return spoil


def bound_to_skeleton(mesh: UsdGeom.Mesh) -> None:
    points = mesh.GetPointsAttr().Get()
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(points)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateJointIndicesPrimvar(False, 1).Set([0] * 49)


def in_point_instancer(mesh: UsdGeom.Mesh) -> None:
    instancer = UsdGeom.PointInstancer.Define(mesh.GetPrim().GetStage(), "/World/crowd")
    instancer.CreatePrototypesRel().SetTargets([mesh.GetPath().GetParentPath()])
    instancer.CreateProtoIndicesAttr([0])
    instancer.CreatePositionsAttr([Gf.Vec3f(0)])


def applied_without_name(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPrim().AddAppliedSchema("SkinSlideAPI")


def applied_with_colon(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPrim().AddAppliedSchema("SkinSlideAPI:")


def missing_payload(mesh: UsdGeom.Mesh) -> None:
    mesh.GetPrim().GetPayloads().AddPayload("./gone.usdc")


def triangle_of(*face: int) -> stages.Shape:
    return stages.from_faces([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), face])


CASES = [
    Case("type: envelope", authored_as(f"skinSlide:{PATCH}:envelope", Types.String, "x"), "envelope is 'x'"),
    Case("type: corners", authored_as(f"skinSlide:{PATCH}:corners", Types.Float, 1.0), "not an array of int"),
    Case("type: boundary", authored_as(f"skinSlide:{PATCH}:boundary", Types.Int, 1), "it must be one of auto"),
    Case("type: points", authored_as("points", Types.Int, 1), "points is not an array of points", None),
    Case("type: counts", authored_as("faceVertexCounts", Types.Float, 1.0), "not an array of int", None),
    Case("type: rest", put("rest", Types.StringArray, "vertex", ["x"]), "not an array of points", None),
    Case("faces: none chosen", put(FACES, Types.BoolArray, "uniform", [False] * 36), "has no faces"),
    Case("faces: nowhere", no_faces_anywhere, "nor a GeomSubset elbow_L"),
    Case(
        "faces: uniform length", put(FACES, Types.BoolArray, "uniform", [True] * 35), "35 values, but the mesh has 36"
    ),
    Case("faces: vertex length", put(FACES, Types.FloatArray, "vertex", [1.0] * 36), "36 values, but the mesh has 49"),
    Case("faces: type", put(FACES, Types.Color3fArray, "uniform", [Gf.Vec3f(1)] * 36), "is color3f[]"),
    Case("faces: interpolation", put(FACES, Types.BoolArray, "faceVarying", [True] * 144), "interpolation faceVarying"),
    Case("faces: no interpolation", put(FACES, Types.BoolArray, "constant", [True] * 36), "interpolation constant"),
    Case("faces: not a number", painted(FACES, "uniform", floats(36, 7, NAN)), "[7] is nan"),
    Case("faces: indexed badly", bad_indices_of_primvar, ":indices[35] is 7, but"),
    Case("faces: change", faces_that_change, "other faces at frame 1003"),
    Case("subset: points", subset([0, 1], "point"), "elementType point"),
    Case("subset: index", subset([0, 1, 36]), "has face 36, but the mesh has 36 faces"),
    Case("subset: empty", subset([]), "is empty"),
    Case("subset: another prim", child_that_is_no_subset, "is a Xform, not a GeomSubset"),
    Case("patch: closed", nothing, "boundary", shape=stages.box),
    Case("patch: three faces at an edge", nothing, "edge 0-1 has 3 faces", shape=stages.fin),
    Case("patch: pinched", nothing, "vertex 5", shape=lambda: stages.grid(3, 3), faces=stages.pinched),
    Case("patch: in one place", nothing, "in one place", shape=lambda: stages.grid(size=0)),
    Case("face: two vertices", nothing, "face 1 has 2 vertices", shape=lambda: triangle_of(0, 2)),
    Case("face: repeated vertex", nothing, "face 1 has vertex 2 more than once", shape=lambda: triangle_of(0, 2, 2, 3)),
    Case("mesh: index too large", indices_end_with(49), "face 35 has point 49, but the mesh has 49 points", None),
    Case("mesh: negative index", indices_end_with(-1), "face 35 has point -1", None),
    Case("mesh: counts", counts_end_with(5), "add up to 145, but faceVertexIndices has 144", None),
    Case("mesh: negative count", counts_end_with(-4), "face 35 has -4 vertices", None),
    Case("mesh: topology changes", topology_that_changes, "faceVertexIndices changes at frame 1002", None),
    Case("points: none", no_points, "points has no value", None),
    Case("points: another count", fewer_points, "48 values, but 49", None, "1002"),
    Case("points: nan at a frame", points_value(12, NAN, FRAMES[2]), "12", None, "1003"),
    Case("points: infinite at a frame", points_value(12, INFINITY, FRAMES[2]), "12", None, "1003"),
    Case("points: skinned live", bound_to_skeleton, "bake the skinning first", None),
    Case("rest: nan", points_value(12, NAN), "[12] is (", None),
    Case("rest: infinite", points_value(12, INFINITY), "[12] is (", None),
    Case(
        "rest: larger than a float",
        put("rest", Types.Double3Array, "vertex", [(1e300, 0, 0)] * 49),
        "[0] is (inf",
        None,
    ),
    Case("rest: by corner", put("rest", Types.Point3fArray, "faceVarying", [(0, 0, 0)] * 144), "faceVarying", None),
    Case("rest: length", rest_points(48), "skinSlide:restPoints has 48 values, but points has 49", None),
    Case("rest: nowhere", blocked_rest, "primvars:rest", None),
    Case("density: zero", painted(DENSITY, "vertex", floats(49, 12, 0)), "forceDensity[12] is 0"),
    Case("density: negative", painted(DENSITY, "uniform", floats(36, 12, -1)), "forceDensity[12] is -1"),
    Case("density: nan", painted(DENSITY, "vertex", floats(49, 12, NAN)), "forceDensity[12] is nan"),
    Case("density: infinite", painted(DENSITY, "vertex", floats(49, 12, INFINITY)), "forceDensity[12] is inf"),
    Case("density: constant zero", painted(DENSITY, "constant", floats(1, 0, 0)), "forceDensity[0] is 0"),
    Case("density: length", painted(DENSITY, "vertex", floats(48)), "48 values, but the mesh has 49 points"),
    Case("density: interpolation", painted(DENSITY, "faceVarying", floats(144)), "interpolation faceVarying"),
    Case("density: type", put(DENSITY, Types.IntArray, "vertex", [1] * 49), "is int[]"),
    Case("density: zero at a frame", painted_at_one_frame(DENSITY, 0.0), "forceDensity[12] is 0", frame="1002"),
    Case("max distance: nan", painted(FARTHEST, "vertex", floats(49, 12, NAN)), "maxDistance[12] is nan"),
    Case("max distance: below 0", painted(FARTHEST, "vertex", floats(49, 12, -1.0)), "is -1; it must be 0 or more"),
    Case("weight: nan", painted(WEIGHT, "vertex", floats(49, 12, NAN)), "weight[12] is nan"),
    Case("weight: length", painted(WEIGHT, "vertex", floats(50)), "50 values, but the mesh has 49 points"),
    Case("weight: interpolation", painted(WEIGHT, "uniform", floats(36)), "interpolation uniform"),
    Case("weight: nan at a frame", painted_at_one_frame(WEIGHT, NAN), "weight[12] is nan", frame="1002"),
    Case("envelope: nan", prop("envelope", NAN), "envelope is nan"),
    Case("edges: odd", edges([0, 1, 2], [1.0]), "3 values; it must hold pairs"),
    Case("edges: lengths", edges([0, 1, 1, 2], [1.0]), "1 values, but skinSlide:elbow_L:edges has 2 pairs"),
    Case("edges: factor", edges([0, 1, 1, 2], [1.0, 0.0]), "edgeForceDensities[1], for edge 1-2, is 0"),
    Case("edges: of no face", edges([0, 8], [2.0]), "0-8"),
    Case("edges: no such point", edges([0, 99], [2.0]), "0-99"),
    Case("corners: three", prop("corners", [0, 6, 48]), "has 3 values; it must have 4"),
    Case("corners: repeated", prop("corners", [0, 6, 48, 6]), "point 6 more than once"),
    Case("corners: inside", prop("corners", [0, 6, 48, 24]), "24"),
    Case("corners: no such point", prop("corners", [0, 6, 48, 49]), "corners[3] is 49"),
    Case("token: boundary", prop("boundary", "oval"), "'oval'; it must be one of auto, square, circle"),
    Case("token: holes", prop("holes", "open"), "'open'; it must be one of pinned, free"),
    Case("token: rule", prop("forceDensityRule", "slow"), "'slow'; it must be one of unit, fast, relaxed"),
    Case("token: interpolation", prop("interpolation", "cubic"), "'cubic'; it must be one of auto, linear"),
    Case("interpolation: limit", prop("interpolation", "limit"), "limit needs a mesh that is subdivided"),
    Case("prim: point instancer", in_point_instancer, "prototype of the point instancer /World/crowd", None),
    Case("prim: no patch name", applied_without_name, "applied without a patch's name", None),
    Case("prim: empty patch name", applied_with_colon, "applied without a patch's name", None),
    Case("payload: missing", missing_payload, "gone.usdc", None),
]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_bad_stage(case: Case, tmp_path, capfd):
    stage, mesh = stages.patched_stage(case.shape(), case.faces() if case.faces else None)
    case.spoil(mesh)
    path = stages.save(stage, tmp_path / "shot.usda")
    place = f"error: {MESH}" + (f": patch {case.patch}" if case.patch else "")

    assert main(["check", str(path)]) == 3
    said = capfd.readouterr().out.splitlines()
    assert any(line.startswith(place) and case.says in line for line in said), said

    output = tmp_path / "out.usda"
    output.write_text("what was there before")
    assert main(["bake", str(path), "-o", str(output), "--quiet", "--jobs", "1"]) == (1 if case.frame else 3)
    said = capfd.readouterr().err.splitlines()
    place += f": frame {case.frame}: " if case.frame else ""
    assert any(line.startswith(place) and case.says in line for line in said), said
    assert output.read_text() == "what was there before"
    assert sorted(each.name for each in tmp_path.iterdir()) == ["out.usda", "shot.usda"]


@pytest.mark.parametrize("name", [PATCH, "n" * 300, "\u00e9l\u00e8ve_" * 40])
def test_a_bad_piece_names_its_patch(name, tmp_path, capfd):
    stage, mesh = stages.patched_stage()
    pinched = np.array([1, 2, 6, 8, 12, 13, 14])
    stages.add_patch(mesh, np.append(pinched, stages.block(6, range(4, 6), range(4, 6))), name)
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda")), "--json"]) == 3
    (problem,) = [each for each in json.loads(capfd.readouterr().out)["problems"] if each["severity"] == "error"]
    assert problem["patch"] == name and problem["message"].startswith("piece 1 of 2: ")


def test_a_value_that_usd_cannot_read(tmp_path, capfd):
    """The numbers of a sample in a crate file are overwritten."""
    stage, mesh = stages.patched_stage(stages.grid(16, 16))
    path = stages.save(stage, tmp_path / "shot.usdc")
    sample = np.array(mesh.GetPointsAttr().Get(FRAMES[1])).tobytes()
    damaged = bytearray(path.read_bytes())
    at = damaged.index(sample)
    damaged[at - 8 : at] = b"\xff" * 8  # the count of points before them
    path.write_bytes(damaged)
    for command in (["check", str(path)], ["bake", str(path), "-o", str(tmp_path / "out.usda")]):
        assert main(command) == (3 if command[0] == "check" else 1)
        said = "".join(capfd.readouterr())
        assert f"error: {MESH}: frame 1002: points cannot be read: " in said and "Traceback" not in said


def test_every_bad_patch_is_named(tmp_path, capfd):
    stage, mesh = stages.patched_stage(stages.grid(3, 3), stages.pinched())
    stages.add_patch(mesh, None, "wrist_L")
    stages.add_patch(mesh, np.arange(9), "knee_L")
    stages.set_property(mesh, "corners", [0, 3, 15, 5], patch="knee_L")
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    said = capfd.readouterr().out
    for patch in (PATCH, "wrist_L", "knee_L"):
        assert f"error: {MESH}: patch {patch}: " in said


def test_instance_proxy_says_what_to_do(tmp_path, capfd):
    stage, mesh = stages.patched_stage()
    copy = stage.DefinePrim("/World/copy", "Xform")
    copy.GetReferences().AddInternalReference(mesh.GetPath().GetParentPath())
    copy.SetInstanceable(True)
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    assert "error: /World/copy/skin_GEO: " in (said := capfd.readouterr().out)
    assert "instanceable = false on /World/copy" in said


def test_over_without_a_cache_is_an_error(tmp_path, capfd):
    stage = stages.new_stage()
    stage.OverridePrim("/World/gone_GEO").AddAppliedSchema("SkinSlideAPI:elbow_L")
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    assert "error: /World/gone_GEO: is not defined" in capfd.readouterr().out


def test_wrong_prim_type(tmp_path, capfd):
    stage = stages.new_stage()
    stage.GetPrimAtPath("/World").AddAppliedSchema("SkinSlideAPI:elbow_L")
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    assert "error: /World: is a Xform; SkinSlideAPI applies to Mesh only" in capfd.readouterr().out


def test_nothing_to_slide_says_how_to_start(tmp_path, capfd):
    stage = stages.new_stage()
    stages.add_mesh(stage, stages.grid())
    assert main(["check", str(stages.save(stage, tmp_path / "shot.usda"))]) == 3
    assert "skinslide setup" in capfd.readouterr().out


@pytest.mark.parametrize(("name", "text"), [("gone.usda", None), ("text.usda", "words"), ("text.skinslide", "words")])
def test_stage_that_does_not_open(name, text, tmp_path, capfd):
    path = tmp_path / name
    if text:
        path.write_text(text)
    for command in (["check", str(path)], ["bake", str(path), "-o", str(tmp_path / "out.usda")]):
        assert main(command) == 1
        assert f"error: cannot open {path}: " in capfd.readouterr().err


def test_weight_out_of_range_is_clamped_and_told(tmp_path, capfd):
    stage, mesh = stages.patched_stage()
    painted(WEIGHT, "vertex", floats(49, 12, 1.5))(mesh)
    path = stages.save(stage, tmp_path / "shot.usda")
    assert main(["check", str(path)]) == 0
    assert f"warning: {MESH}: patch {PATCH}: weight of vertex 12 is 1.5" in capfd.readouterr().out
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda")]) == 0
    assert "outside 0..1" in capfd.readouterr().out


USAGE = {
    "frames: empty": ["--frames", ""],
    "frames: words": ["--frames", "all"],
    "frames: zero step": ["--frames", "1:9x0"],
    "lookup: no such device": ["--lookup", "egl", "--egl-device", "999"],
    "lookup: device of no number": ["--egl-device", "first"],
    "lookup: resolution above any device's": ["--lookup", "egl", "--egl-resolution", "1000000"],
    "lookup: unknown": ["--lookup", "guess"],
    "jobs: none": ["--jobs", "0"],
    "limit: negative": ["--max-folded", "-1"],
    "output: missing folder": ["-o", "gone/out.usda"],
    "output: extension": ["-o", "out.abc"],
    "output: input": ["-o", "shot.usda"],
    "output: folder": ["-o", "folder.usda"],
}


@pytest.mark.parametrize("arguments", USAGE.values(), ids=USAGE.keys())
def test_bad_usage(arguments, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    stage, _mesh = stages.patched_stage()
    path = stages.save(stage, tmp_path / "shot.usda")
    before = path.read_bytes()
    (tmp_path / "folder.usda").mkdir()
    output = [] if "-o" in arguments else ["-o", "out.usda"]
    assert main(["bake", "shot.usda", *output, *arguments]) == 2
    assert "error: " in capfd.readouterr().err
    assert path.read_bytes() == before
    assert sorted(each.name for each in tmp_path.iterdir()) == ["folder.usda", "shot.usda"]


def test_input_is_a_sublayer_of_the_stage(tmp_path, capfd):
    stage, _mesh = stages.patched_stage()
    cache = stages.save(stage, tmp_path / "cache.usda")
    (tmp_path / "shot.usda").write_text("#usda 1.0\n(\n    subLayers = [@./cache.usda@]\n)\n")
    before = cache.read_bytes()
    assert main(["bake", str(tmp_path / "shot.usda"), "-o", str(cache)]) == 2
    assert str(cache) in capfd.readouterr().err
    assert cache.read_bytes() == before


def test_read_only_folder(public_folder, capfd):
    stage, _mesh = stages.patched_stage()
    path = stages.save(stage, public_folder / "shot.usda")
    folder = public_folder / "locked"
    folder.mkdir(mode=0o555)
    with stages.as_nobody():
        assert main(["bake", str(path), "-o", str(folder / "out.usda")]) == 2
    assert "not writable" in capfd.readouterr().err
