"""`paint` gives edges a force density: from a GeomSubset, a vertex primvar or a curve, on top of what was painted."""

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

import stages
from skinslide import Controls, PatchSetup, Slider, StageProblems, UsageError, paint_to_file, setup_to_file
from skinslide.arrays.topology import Topology
from skinslide.command.cli import main
from skinslide.stage.opening import open_stage
from skinslide.stage.reading import read_meshes
from stages import MESH, PATCH

CURVE = "/World/char/lines"
# The patch: the lower left 4 x 4 faces of the sheet of 6 x 6; vertices 0..4 of rows 0..4.
FACES = stages.block(6, range(4), range(4))


@pytest.fixture
def shot(tmp_path):
    """A stage with a patch, an edge subset, a painted primvar and a curve, in object units of the sheet: 1 a side."""
    stage, mesh = stages.patched_stage(faces=FACES)
    UsdGeom.Xformable(stage.GetPrimAtPath("/World/char")).AddTranslateOp().Set((5, 6, 7))
    UsdGeom.Xformable(mesh).AddScaleOp().Set((2, 2, 2))
    subset = UsdGeom.Subset.Define(stage, f"{MESH}/seam")
    subset.CreateElementTypeAttr("edge")
    subset.CreateIndicesAttr([8, 9, 9, 10, 10, 9, 10, 11, 47, 48])
    ramp = Vt.FloatArray.FromNumpy((np.arange(49) % 7).astype(np.float32))
    stages.set_primvar(mesh, "ramp", Sdf.ValueTypeNames.FloatArray, "vertex", ramp)
    curve = UsdGeom.BasisCurves.Define(stage, CURVE)
    curve.CreateTypeAttr("linear")
    curve.CreateCurveVertexCountsAttr([2])
    # Along row 2 of vertices, a little above it. It is not scaled as the mesh is: 2 of its units are 1 of the mesh's.
    row = stages.grid().points[14:21] * 2 + [0, 0, 0.02]
    curve.CreateCurveVertexCountsAttr([7])
    curve.CreatePointsAttr(stages.vectors(row))
    return stages.save(stage, tmp_path / "shot.usda")


def painted(path, patch: str = PATCH) -> dict[tuple[int, int], float]:
    """Edges and their factors, as a bake reads them."""
    (mesh,) = read_meshes(open_stage(path))[0]
    controls = next(each for each in mesh.patches if each.name == patch).controls
    if controls.edges is None:
        return {}
    return {tuple(edge): factor for edge, factor in zip(controls.edges.tolist(), controls.edge_density, strict=True)}


def edit(path, change) -> None:
    stage = Usd.Stage.Open(str(path))
    change(UsdGeom.Mesh(stage.GetPrimAtPath(MESH)))
    stage.GetRootLayer().Save()


# ---- What is chosen ----


@pytest.mark.parametrize("extension", ["skinslide", "usda", "usdc", "usd"])
def test_edges_of_a_subset(extension, shot, tmp_path):
    output = tmp_path / f"painted.{extension}"
    report = paint_to_file(shot, output, MESH, PATCH, 3, subset="seam")
    assert painted(output) == {(8, 9): 3, (9, 10): 3, (10, 11): 3}
    assert (report.painted, report.left_out, report.total) == (3, 1, 3)
    assert f"{PATCH}: 3 edges painted with 3, 1 left out that are not of the patch; 3 painted in all" in report.text()
    stage = open_stage(output)
    assert stage.GetRootLayer().subLayerPaths[0].endswith("/shot.usda")


def test_edges_between_painted_points(shot, tmp_path):
    """Both ends count: points of columns 3 and 4, in rows 0 to 4 of the patch."""
    output = tmp_path / "painted.usda"
    paint_to_file(shot, output, MESH, PATCH, 0.5, primvar="ramp", threshold=3)
    rows = [7 * row for row in range(5)]
    expected = [(row + 3, row + 4) for row in rows] + [(r + c, r + c + 7) for r in rows[:-1] for c in (3, 4)]
    assert painted(output) == dict.fromkeys(expected, 0.5)
    paint_to_file(shot, output, MESH, PATCH, 2, primvar="ramp", threshold=3.5, clear=True)
    assert set(painted(output)) == {(row + 4, row + 11) for row in rows[:-1]}


@pytest.mark.parametrize(
    ("distance", "direction", "expected"),
    [
        (0.02, "any", {(14, 15), (15, 16), (16, 17), (17, 18)}),
        (0.02, "along", {(14, 15), (15, 16), (16, 17), (17, 18)}),
        (0.1, "across", {(c, c + 7) for c in (*range(7, 12), *range(14, 19))}),
        (0.1, "along", {(14, 15), (15, 16), (16, 17), (17, 18)}),
    ],
)
def test_edges_near_a_curve(distance, direction, expected, shot, tmp_path):
    """A side of a quad is 1/6: edges across have their middles 1/12 from the curve, and more where the sheet bends."""
    paint_to_file(shot, tmp_path / "painted.usda", MESH, PATCH, 4, curve=CURVE, distance=distance, direction=direction)
    assert painted(tmp_path / "painted.usda") == dict.fromkeys(expected, 4)


def test_a_curve_that_moves_is_taken_at_rest(shot, tmp_path):
    """Its samples follow the character; its default is where it was drawn."""
    moving = open_stage(shot)
    points = UsdGeom.BasisCurves(moving.GetPrimAtPath(CURVE)).GetPointsAttr()
    for frame in stages.FRAMES:
        points.Set(stages.vectors(np.add(points.Get(), (0, 0, 3))), frame)
    stage = stages.save(moving, tmp_path / "moving.usda")
    for source in (shot, stage):
        paint_to_file(source, tmp_path / "painted.usda", MESH, PATCH, 4, curve=CURVE, distance=0.02, force=True)
        assert painted(tmp_path / "painted.usda") == dict.fromkeys([(14, 15), (15, 16), (16, 17), (17, 18)], 4)


def test_a_smooth_closed_curve(shot, tmp_path):
    """A circle, near enough, of Catmull-Rom segments about the point in the middle of the patch."""
    angles = np.arange(8) * np.pi / 4
    centre = stages.grid().points[16]
    circle = centre + np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1) / 6

    def draw(mesh):
        curve = UsdGeom.BasisCurves.Define(mesh.GetPrim().GetStage(), f"{MESH}/circle")
        curve.CreateTypeAttr("cubic")
        curve.CreateBasisAttr("catmullRom")
        curve.CreateWrapAttr("periodic")
        curve.CreateCurveVertexCountsAttr([8])
        curve.CreatePointsAttr(stages.vectors(circle))

    edit(shot, draw)
    ring = f"{MESH}/circle"
    paint_to_file(shot, tmp_path / "painted.usda", MESH, PATCH, 4, curve=ring, distance=0.06, direction="along")
    # The spokes from the middle cross the circle, and have their own middles 1/12 away.
    spokes = {(9, 16), (15, 16), (16, 17), (16, 23)}
    assert not spokes & set(painted(tmp_path / "painted.usda"))
    paint_to_file(shot, tmp_path / "across.usda", MESH, PATCH, 4, curve=ring, distance=0.09, direction="across")
    assert spokes <= set(painted(tmp_path / "across.usda"))


def test_edges_of_faces_by_hand():
    topology = Topology(np.array([3, 0, 4], np.int32), np.array([0, 1, 2, 2, 1, 3, 4], np.int32), 5)
    assert topology.edges_of(np.array([0])).tolist() == [[0, 1], [0, 2], [1, 2]]
    assert topology.edges_of(np.array([1, 2])).tolist() == [[1, 2], [1, 3], [2, 4], [3, 4]]
    assert len(topology.edges_of(np.arange(3))) == 6


# ---- On top of what is there ----


def test_paint_over_paint(shot, tmp_path):
    output = tmp_path / "painted.skinslide"
    paint_to_file(shot, output, MESH, PATCH, 3, subset="seam")
    report = paint_to_file(shot, output, MESH, PATCH, 0.5, curve=CURVE, distance=0.09, direction="across")
    assert painted(output)[(9, 10)] == 3 and painted(output)[(9, 16)] == 0.5 and report.total == 13
    paint_to_file(shot, output, MESH, PATCH, 2, subset="seam")
    assert painted(output)[(9, 10)] == 2 and painted(output)[(9, 16)] == 0.5
    paint_to_file(shot, output, MESH, PATCH, 7, subset="seam", clear=True)
    assert painted(output) == {(8, 9): 7, (9, 10): 7, (10, 11): 7}


def test_paint_of_the_stage_below_is_kept(shot, tmp_path):
    def change(mesh):
        stages.set_property(mesh, "edges", [9, 8, 16, 17])
        stages.set_property(mesh, "edgeForceDensities", [5.0, 6.0])

    edit(shot, change)
    paint_to_file(shot, tmp_path / "painted.usda", MESH, PATCH, 3, subset="seam")
    assert painted(tmp_path / "painted.usda") == {(16, 17): 6, (8, 9): 3, (9, 10): 3, (10, 11): 3}
    assert painted(shot) == {(9, 8): 5, (16, 17): 6}


def test_a_patch_that_setup_made(shot, tmp_path):
    """The layer of the set-up takes the paint."""
    output = tmp_path / "shot.skinslide"
    setup_to_file(shot, output, MESH, "wrist_L", faces="30-35")
    paint_to_file(shot, output, MESH, "wrist_L", 2, primvar="ramp", threshold=0)
    assert len(painted(output, "wrist_L")) == 19 and painted(output) == {}


def test_it_is_what_a_bake_slides_by(shot, tmp_path):
    paint_to_file(shot, tmp_path / "painted.usda", MESH, PATCH, 30, subset="seam")
    assert main(["bake", str(tmp_path / "painted.usda"), "-o", str(tmp_path / "slid.usda"), "--quiet"]) == 0
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "slid.usda"))
    slid = np.array(layer.QueryTimeSample(f"{MESH}.points", stages.FRAMES[2]))
    shape = stages.grid()
    edges = np.array([[8, 9], [9, 10], [10, 11]])
    for controls, same in ((Controls(edges=edges, edge_density=np.full(3, 30.0)), True), (Controls(), False)):
        slider = Slider(shape.counts, shape.indices, shape.points, [PatchSetup(PATCH, FACES, controls=controls)])
        direct = slider.slide(shape.moved(stages.FRAMES[2])).points
        assert (slid.tobytes() == direct.tobytes()) == same


def test_the_command(shot, tmp_path, capsys):
    output = tmp_path / "painted.skinslide"
    options = ["--prim", MESH, "--patch", PATCH, "--value", "4", "--curve", CURVE, "--within", "0.1"]
    assert main(["paint", str(shot), "-o", str(output), *options, "--direction", "across"]) == 0
    said = capsys.readouterr().out
    assert f"{PATCH}: 10 edges painted with 4; 10 painted in all" in said and f"{output}: written" in said
    options = ["--prim", MESH, "--patch", PATCH, "--value", "2", "--primvar", "ramp", "--threshold", "3"]
    assert main(["paint", str(shot), "-o", str(output), *options]) == 0
    assert "13 edges painted with 2; " in capsys.readouterr().out


# ---- Bad input ----


def typed(name: str, type_name: Sdf.ValueTypeName, interpolation: str, value):
    return lambda mesh: stages.set_primvar(mesh, name, type_name, interpolation, value)


def subset_indices(*indices: int):
    return lambda mesh: UsdGeom.Subset(mesh.GetPrim().GetChild("seam")).GetIndicesAttr().Set(list(indices))


def curve_attr(name: str, value):
    def change(mesh):
        mesh.GetPrim().GetStage().GetPrimAtPath(CURVE).GetAttribute(name).Set(value)

    return change


def animate(mesh) -> None:
    stages.set_property(mesh, "edges", [8, 9])
    stages.set_property(mesh, "edgeForceDensities", [5.0], time=1001)
    stages.set_property(mesh, "edgeForceDensities", [6.0], time=1002)


def unchanged(_mesh) -> None:
    """Leaves the stage as it is, which is good."""


NAN = float("nan")


def blocked(mesh) -> None:
    stages.set_primvar(mesh, "blocked", Sdf.ValueTypeNames.FloatArray, "vertex", Sdf.ValueBlock())


FAULTS = {
    "primvar without a value": (blocked, dict(primvar="blocked"), "primvars:blocked has no value"),
    "no such patch": (
        unchanged,
        dict(patch="knee_L", subset="seam"),
        "there is no such patch on the mesh; there is elbow_L",
    ),
    "no such subset": (unchanged, dict(subset="gone"), "there is no GeomSubset gone"),
    "subset of faces": (
        lambda mesh: UsdGeom.Subset(mesh.GetPrim().GetChild("seam")).GetElementTypeAttr().Set("face"),
        dict(subset="seam"),
        "elementType face; it must be edge",
    ),
    "subset odd": (subset_indices(8, 9, 10), dict(subset="seam"), "has 3 values; it must hold pairs"),
    "subset no edge": (subset_indices(9, 8, 9, 17), dict(subset="seam"), "has 9-17, which is not an edge of the mesh"),
    "subset no point": (subset_indices(8, 999), dict(subset="seam"), "has 8-999, which is not an edge of the mesh"),
    "subset off the patch": (subset_indices(47, 48), dict(subset="seam"), "seam chooses no edge of the patch"),
    "subset empty": (subset_indices(), dict(subset="seam"), "seam chooses no edge of the patch"),
    "no such primvar": (unchanged, dict(primvar="gone"), "there is no primvar gone"),
    "primvar by face": (
        typed("ramp", Sdf.ValueTypeNames.FloatArray, "uniform", [1.0] * 36),
        dict(primvar="ramp"),
        "interpolation uniform; it must be vertex",
    ),
    "primvar length": (
        typed("ramp", Sdf.ValueTypeNames.FloatArray, "vertex", [1.0] * 48),
        dict(primvar="ramp"),
        "48 values, but the mesh has 49 points",
    ),
    "primvar type": (
        typed("ramp", Sdf.ValueTypeNames.Color3fArray, "vertex", [Gf.Vec3f(1)] * 49),
        dict(primvar="ramp"),
        "is color3f[]",
    ),
    "primvar nan": (
        typed("ramp", Sdf.ValueTypeNames.FloatArray, "vertex", [NAN] * 49),
        dict(primvar="ramp"),
        "ramp[0] is nan",
    ),
    "above everything": (unchanged, dict(primvar="ramp", threshold=9), "ramp chooses no edge"),
    "no such curve": (unchanged, dict(curve="/World/gone", distance=1), "curve /World/gone: there is no such prim"),
    "curve is no curve": (unchanged, dict(curve=MESH, distance=1), f"curve {MESH}: is a Mesh, not a BasisCurves"),
    "curve too far": (
        unchanged,
        dict(curve=CURVE, distance=0.001),
        f"{CURVE} chooses no edge of the patch: the nearest is ",
    ),
    "curve too far across": (
        unchanged,
        dict(curve=CURVE, distance=0.001, direction="across"),
        "the nearest that runs across it is ",
    ),
    "curve counts": (
        curve_attr("curveVertexCounts", [3]),
        dict(curve=CURVE, distance=1),
        "curve vertex counts add up to 3, but there are 7 points",
    ),
    "curve too short": (
        curve_attr("type", "cubic"),
        dict(curve=CURVE, distance=1, spoil=curve_attr("curveVertexCounts", [3, 4])),
        "curve 0 has 3 points, which its basis and wrap cannot have",
    ),
    "curve without length": (
        curve_attr("points", [Gf.Vec3f(0)] * 7),
        dict(curve=CURVE, distance=1),
        f"{CURVE} chooses no edge of the patch: the curve has no length",
    ),
    "curve nan": (
        curve_attr("points", [Gf.Vec3f(NAN)] * 7),
        dict(curve=CURVE, distance=1),
        "curve points: vertex 0 is not finite",
    ),
    "curve of no points": (curve_attr("points", []), dict(curve=CURVE, distance=1), f"{CURVE}: "),
    "animated": (animate, dict(subset="seam"), "edgeForceDensities is animated, and cannot be painted on; clear it"),
}


@pytest.mark.parametrize(("spoil", "choice", "message"), FAULTS.values(), ids=FAULTS.keys())
def test_faults(spoil, choice, message, shot, tmp_path):
    choice = {"patch": PATCH, **choice}
    edit(shot, spoil)
    edit(shot, choice.pop("spoil", unchanged))
    with pytest.raises(StageProblems) as raised:
        paint_to_file(shot, tmp_path / "painted.usda", MESH, choice.pop("patch"), 2, **choice)
    (problem,) = raised.value.problems
    assert message in problem.message and problem.prim == MESH and problem.patch in (PATCH, "knee_L")
    assert [each.name for each in tmp_path.iterdir()] == ["shot.usda"]


def test_clearing_what_is_animated(shot, tmp_path):
    edit(shot, animate)
    paint_to_file(shot, tmp_path / "painted.usda", MESH, PATCH, 2, subset="seam", clear=True)
    assert painted(tmp_path / "painted.usda") == {(8, 9): 2, (9, 10): 2, (10, 11): 2}


USAGE = {
    "nothing": {},
    "two sources": dict(subset="seam", primvar="ramp"),
    "zero": dict(value=0, subset="seam"),
    "negative": dict(value=-1, subset="seam"),
    "nan": dict(value=NAN, subset="seam"),
    "too large for a float": dict(value=1e39, subset="seam"),
    "too small for a float": dict(value=1e-60, subset="seam"),
    "threshold": dict(primvar="ramp", threshold=NAN),
    "curve without distance": dict(curve=CURVE),
    "distance": dict(curve=CURVE, distance=-1),
    "distance without curve": dict(subset="seam", distance=1),
    "direction": dict(curve=CURVE, distance=1, direction="up"),
    "curve path": dict(curve="lines", distance=1),
}


@pytest.mark.parametrize("choice", USAGE.values(), ids=USAGE.keys())
def test_bad_usage(choice, shot, tmp_path):
    with pytest.raises(UsageError):
        paint_to_file(shot, tmp_path / "painted.usda", MESH, PATCH, **{"value": 2, **choice})
    assert [each.name for each in tmp_path.iterdir()] == ["shot.usda"]


def test_the_rules_of_setup_for_the_output(shot, tmp_path):
    (tmp_path / "other.usda").write_text("#usda 1.0\n")
    with pytest.raises(UsageError, match="--force"):
        paint_to_file(shot, tmp_path / "other.usda", MESH, PATCH, 2, subset="seam")
    with pytest.raises(UsageError, match="the stage reads this file"):
        paint_to_file(shot, shot, MESH, PATCH, 2, subset="seam")
    paint_to_file(shot, tmp_path / "other.usda", MESH, PATCH, 2, subset="seam", force=True)
    assert len(painted(tmp_path / "other.usda")) == 3
