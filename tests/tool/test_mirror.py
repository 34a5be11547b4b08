"""`mirror` copies a patch to the other side: everything it has, its animation, and nothing that it had there before."""

from typing import NamedTuple

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

import stages
from skinslide import PatchSetup, StageProblems, UsageError, check, mirror_to_file
from skinslide.arrays.geometry import mirror_faces
from skinslide.arrays.images import encode_exr
from skinslide.author.mirror import other_side
from skinslide.command.cli import main
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.opening import open_stage
from skinslide.stage.patch import Animation
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH

Types = Sdf.ValueTypeNames
LEFT, RIGHT = "elbow_L", "elbow_R"
COLUMNS, ROWS = 8, 6
# The sheet of 8 x 6 faces: the patch is its 3 x 4 faces from column 0 and row 1 on; column 7 - i mirrors column i.
FACES = stages.block(COLUMNS, range(3), range(1, 5))
ACROSS_FACES = stages.block(COLUMNS, range(5, 8), range(1, 5))
VERTEX_ROW, VERTEX_COLUMN = np.divmod(np.arange((COLUMNS + 1) * (ROWS + 1)), COLUMNS + 1)
ACROSS = VERTEX_ROW * (COLUMNS + 1) + COLUMNS - VERTEX_COLUMN
ON_PATCH = (VERTEX_COLUMN <= 3) & (VERTEX_ROW >= 1) & (VERTEX_ROW <= 5)


def symmetric_grid() -> stages.Shape:
    shape = stages.grid(COLUMNS, ROWS)
    x, y = VERTEX_COLUMN / COLUMNS - 0.5, VERTEX_ROW / ROWS - 0.5
    points = np.stack([x, y, 0.1 * np.sin(5 * np.abs(x) + 3 * y)], axis=1).astype(np.float32)
    return stages.Shape(points, shape.counts, shape.indices)


def moved(amount: float) -> np.ndarray:
    """The sheet stretched unevenly, the same on both sides."""
    x, y, z = symmetric_grid().points.T.astype(np.float64)
    return np.stack([x + amount * x * np.abs(x), y + amount * np.abs(x) * y, z + amount * (x * x - y)], axis=1)


def new_shot() -> tuple[Usd.Stage, UsdGeom.Mesh]:
    stage = stages.new_stage()
    mesh = stages.add_mesh(stage, symmetric_grid(), frames=())
    for i, frame in enumerate(FRAMES):
        mesh.GetPointsAttr().Set(stages.vectors(moved(i / 4)), frame)
    stages.add_patch(mesh, FACES, LEFT)
    return stage, mesh


def primvar(mesh, name: str, interpolation: str, values, patch: str = LEFT, time: float | None = None) -> None:
    value = Vt.FloatArray.FromNumpy(np.ascontiguousarray(values, np.float32))
    stages.set_primvar(mesh, f"skinSlide:{patch}:{name}", Types.FloatArray, interpolation, value, time)


def prop(mesh, name: str, value, patch: str = LEFT, time: float | None = None) -> None:
    stages.set_property(mesh, name, value, time, patch)


class Read(NamedTuple):
    """A patch with its controls over time, which live as long as the mesh."""

    patch: PatchSetup
    controls: Animation
    mesh: PatchedMesh


def read(path) -> dict[str, Read]:
    (mesh,), problems = read_meshes(open_stage(path))
    assert problems == []
    return {
        patch.name: Read(patch, over_time, mesh) for patch, over_time in zip(mesh.patches, mesh.animation, strict=True)
    }


def mirrored(stage: Usd.Stage, folder, **options) -> Read:
    """Mirrors the patch, and reads the one on the other side."""
    path = stages.save(stage, folder / "shot.usda")
    report = mirror_to_file(path, folder / "both.skinslide", MESH, LEFT, **options)
    assert not report.failed
    patches = read(folder / "both.skinslide")
    assert list(patches) == [RIGHT, LEFT]
    return patches[RIGHT]


# ---- What is copied ----


def test_what_the_rule_even_has(tmp_path):
    """Faces that join a patch by grow are joined on the other side too, and not chosen there."""
    stage, mesh = new_shot()
    hold = np.linspace(0.5, 4, 63)
    primvar(mesh, "hold", "vertex", hold)
    prop(mesh, "forceDensityRule", "even")
    prop(mesh, "stretchResponse", 0.5)
    prop(mesh, "grow", 0.145)  # more than a column is wide, and less than a row
    patch, *_ = mirrored(stage, tmp_path)
    grown = stages.block(COLUMNS, range(4, 8), range(1, 5))
    assert patch.faces.tolist() == sorted(grown.tolist()) and patch.rule == "even"
    there = np.flatnonzero((VERTEX_COLUMN <= 4) & (VERTEX_ROW >= 1) & (VERTEX_ROW <= 5))
    assert patch.controls.hold[ACROSS[there]] == pytest.approx(hold[there])
    assert patch.controls.stretch_response == 0.5
    both = open_stage(tmp_path / "both.skinslide")
    chosen = both.GetPrimAtPath(MESH).GetAttribute(f"primvars:skinSlide:{RIGHT}:patch")
    assert np.flatnonzero(chosen.Get()).tolist() == sorted(ACROSS_FACES.tolist())


def test_everything_of_a_patch(tmp_path):
    stage, mesh = new_shot()
    weight, density = np.linspace(0.1, 1, 63), np.linspace(1, 4, 63)
    primvar(mesh, "weight", "vertex", weight)
    primvar(mesh, "forceDensity", "vertex", density)
    primvar(mesh, "maxDistance", "vertex", density / 8)
    prop(mesh, "corners", [9, 12, 48, 45])
    prop(mesh, "edges", [10, 11, 20, 11])
    prop(mesh, "edgeForceDensities", [2.0, 3.0])
    prop(mesh, "boundary", "square")
    prop(mesh, "holes", "free")
    prop(mesh, "forceDensityRule", "fast")
    prop(mesh, "interpolation", "meanValue")
    prop(mesh, "envelope", 0.75)
    patch, *_ = mirrored(stage, tmp_path)
    assert patch.faces.tolist() == sorted(ACROSS_FACES.tolist())
    assert patch.corners.tolist() == ACROSS[[9, 12, 48, 45]].tolist() == [17, 14, 50, 53]
    assert (patch.boundary, patch.holes, patch.rule, patch.interpolation) == ("square", "free", "fast", "meanValue")
    controls = patch.controls
    there = np.flatnonzero(ON_PATCH)
    np.testing.assert_array_equal(controls.weight[ACROSS[there]], weight[there].astype(np.float32))
    np.testing.assert_array_equal(controls.vertex_density[ACROSS[there]], density[there].astype(np.float32))
    np.testing.assert_array_equal(controls.max_distance[ACROSS[there]], (density[there] / 8).astype(np.float32))
    assert controls.edges.tolist() == ACROSS[[[10, 11], [20, 11]]].tolist()
    assert controls.edge_density.tolist() == [2, 3] and controls.envelope == 0.75


def test_there_and_back_is_the_same(tmp_path):
    stage, mesh = new_shot()
    primvar(mesh, "weight", "vertex", np.linspace(0.1, 1, 63))
    primvar(mesh, "forceDensity", "uniform", np.linspace(1, 4, 48))
    prop(mesh, "edges", [10, 11])
    prop(mesh, "edgeForceDensities", [2.0])
    path = stages.save(stage, tmp_path / "shot.usda")
    mirror_to_file(path, tmp_path / "both.usda", MESH, LEFT)
    mirror_to_file(tmp_path / "both.usda", tmp_path / "back.usda", MESH, RIGHT, to="again")
    patches = read(tmp_path / "back.usda")
    first, again = patches[LEFT][0], patches["again"][0]
    assert first.faces.tolist() == again.faces.tolist()
    for name in ("weight", "face_density", "edges", "edge_density"):
        np.testing.assert_array_equal(getattr(first.controls, name), getattr(again.controls, name))


def test_density_by_face(tmp_path):
    stage, mesh = new_shot()
    density = np.arange(1, 49)
    primvar(mesh, "forceDensity", "uniform", density)
    patch, *_ = mirrored(stage, tmp_path)
    across = FACES // COLUMNS * COLUMNS + COLUMNS - 1 - FACES % COLUMNS
    np.testing.assert_array_equal(patch.controls.face_density[across], density[FACES])


def test_constants_and_what_is_absent(tmp_path):
    stage, mesh = new_shot()
    primvar(mesh, "weight", "constant", [0.5])
    primvar(mesh, "forceDensity", "constant", [3])
    patch, *_ = mirrored(stage, tmp_path)
    assert (patch.controls.weight[ACROSS[ON_PATCH]] == 0.5).all()
    assert patch.controls.vertex_density is None and patch.controls.edges is None and patch.corners is None


def test_animation(tmp_path):
    stage, mesh = new_shot()
    for frame, amount in zip(FRAMES, (0.2, 0.4, 0.6), strict=True):
        primvar(mesh, "weight", "vertex", np.full(63, amount), time=frame)
        prop(mesh, "envelope", amount, time=frame)
        prop(mesh, "edgeForceDensities", [1 + amount], time=frame)
    prop(mesh, "edges", [10, 11])
    _, controls, _mesh = mirrored(stage, tmp_path)
    for frame, amount in zip(FRAMES, (0.2, 0.4, 0.6), strict=True):
        there = controls.at(Usd.TimeCode(frame))
        np.testing.assert_allclose(there.weight[ACROSS[ON_PATCH]], amount, rtol=1e-6)
        assert there.envelope == pytest.approx(amount) and there.edge_density[0] == pytest.approx(1 + amount)


def test_a_spline(tmp_path):
    stage, mesh = new_shot()
    spline = stages.linear_spline({1001: 0.0, 1003: 1.0})
    mesh.GetPrim().GetAttribute(f"skinSlide:{LEFT}:envelope").SetSpline(spline)
    _, controls, _mesh = mirrored(stage, tmp_path)
    assert controls.at(Usd.TimeCode(1002)).envelope == pytest.approx(0.5)


def test_maps_become_paint(tmp_path):
    """Texture coordinates run on across the sheet: on the other side the map says something else."""
    stage, mesh = new_shot()
    st = [Gf.Vec2f(x, y) for x, y in zip((VERTEX_COLUMN / COLUMNS).tolist(), (VERTEX_ROW / ROWS).tolist(), strict=True)]
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, "vertex", st)
    (tmp_path / "ramp.exr").write_bytes(encode_exr({"R": np.linspace(0.1, 1, 64)[None].astype(np.float32)}))
    prop(mesh, "weightMap", Sdf.AssetPath("./ramp.exr"))
    prop(mesh, "forceDensityMap", Sdf.AssetPath("./ramp.exr"))
    primvar(mesh, "weight", "constant", [0.5])
    patch, controls, _mesh = mirrored(stage, tmp_path)
    left = read(tmp_path / "both.skinslide")[LEFT][0].controls
    there = np.flatnonzero(ON_PATCH)
    np.testing.assert_array_equal(patch.controls.weight[ACROSS[there]], left.weight[there])
    np.testing.assert_array_equal(patch.controls.vertex_density[ACROSS[there]], left.vertex_density[there])
    assert controls.textures == [] and len(np.unique(patch.controls.weight[ACROSS[there]])) > 3


def test_a_subset_becomes_a_primvar(tmp_path):
    stage, mesh = new_shot()
    mesh.GetPrim().RemoveProperty(f"primvars:skinSlide:{LEFT}:patch")
    subset = UsdGeom.Subset.Define(stage, f"{MESH}/{LEFT}")
    subset.CreateElementTypeAttr("face")
    subset.CreateIndicesAttr(FACES.tolist())
    patch, *_ = mirrored(stage, tmp_path)
    assert patch.faces.tolist() == sorted(ACROSS_FACES.tolist())


def test_what_was_there_before_is_replaced(tmp_path):
    """Also in the stage below: what the first patch does not have is blocked."""
    stage, mesh = new_shot()
    stages.add_patch(mesh, stages.block(COLUMNS, range(6, 8), range(2)), RIGHT)
    primvar(mesh, "weight", "vertex", np.full(63, 0.1), RIGHT)
    primvar(mesh, "forceDensity", "vertex", [7, 8], RIGHT)
    UsdGeom.PrimvarsAPI(mesh).GetPrimvar(f"skinSlide:{RIGHT}:forceDensity").SetIndices([0, 1] * 31 + [0])
    primvar(mesh, "forceDensity", "vertex", np.full(63, 2.0))
    for name, value in {"envelope": 0.2, "boundary": "square", "edges": [7, 8], "edgeForceDensities": [9.0]}.items():
        prop(mesh, name, value, RIGHT)
    prop(mesh, "weightMap", Sdf.AssetPath("./gone.exr"), RIGHT)
    path = stages.save(stage, tmp_path / "shot.usda")
    mirror_to_file(path, tmp_path / "both.usda", MESH, LEFT)
    patch = read(tmp_path / "both.usda")[RIGHT][0]
    assert patch.faces.tolist() == sorted(ACROSS_FACES.tolist()) and patch.boundary == "auto"
    controls = patch.controls
    assert controls.weight is None and controls.edges is None and controls.envelope == 1
    assert (controls.vertex_density[ACROSS[ON_PATCH]] == 2).all()


def test_again_into_the_same_layer(tmp_path):
    stage, mesh = new_shot()
    primvar(mesh, "weight", "vertex", np.full(63, 0.5))
    path = stages.save(stage, tmp_path / "shot.usda")
    output = tmp_path / "both.skinslide"
    mirror_to_file(path, output, MESH, LEFT)
    once = output.read_text()
    mirror_to_file(path, output, MESH, LEFT)
    assert output.read_text() == once
    assert list(read(output)) == [RIGHT, LEFT]


# ---- What it slides ----


def test_both_sides_slide_alike(tmp_path):
    stage, mesh = new_shot()
    primvar(mesh, "weight", "vertex", np.where(VERTEX_ROW < 3, 0.5, 1))
    primvar(mesh, "forceDensity", "vertex", 1 + VERTEX_ROW)
    prop(mesh, "interpolation", "meanValue")  # linear cuts a quad from its first point, which is no matter of symmetry
    path = stages.save(stage, tmp_path / "shot.usda")
    mirror_to_file(path, tmp_path / "both.usda", MESH, LEFT)
    assert main(["bake", str(tmp_path / "both.usda"), "-o", str(tmp_path / "slid.usda"), "--quiet"]) == 0
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "slid.usda"))
    slid = np.array(layer.QueryTimeSample(f"{MESH}.points", FRAMES[2]))
    cached = moved(2 / 4).astype(np.float32)
    assert np.abs(slid - cached)[ON_PATCH].max() > 0.005
    np.testing.assert_allclose(slid[ACROSS] * [-1, 1, 1], slid, atol=1e-6)


def test_another_plane(tmp_path):
    """The same sheet, turned so that it is symmetric about y = 2."""
    shape = symmetric_grid()
    turned = np.stack([shape.points[:, 1], shape.points[:, 0] + 2, shape.points[:, 2]], axis=1)
    found = mirror_faces(shape.counts, shape.indices, turned, FACES, axis="y", plane=2)
    assert sorted(found.faces.tolist()) == sorted(ACROSS_FACES.tolist())
    stage, mesh = new_shot()
    mesh.GetPointsAttr().Set(stages.vectors(turned))
    patch, *_ = mirrored(stage, tmp_path, axis="y", plane=2.0)
    assert patch.faces.tolist() == sorted(ACROSS_FACES.tolist())


def test_the_command(tmp_path, capsys):
    stage, _mesh = new_shot()
    path = stages.save(stage, tmp_path / "shot.usda")
    output = tmp_path / "both.skinslide"
    options = ["--prim", MESH, "--patch", LEFT, "--to", "other", "--axis", "x", "--plane", "0", "--tolerance", "0.001"]
    assert main(["mirror", str(path), "-o", str(output), *options]) == 0
    said = capsys.readouterr().out
    assert "  other: unit, linear, vertices 20" in said and f"{output}: written" in said
    assert [patch.name for patch in check(output).meshes[0].patches] == ["other", LEFT]


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("elbow_L", "elbow_R"),
        ("elbow_R", "elbow_L"),
        ("L_elbow", "R_elbow"),
        ("l_arm_upper", "r_arm_upper"),
        ("left:cheek", "right:cheek"),
        ("cheek_Right_2", "cheek_Left_2"),
        ("R", "L"),
    ],
)
def test_names_of_the_other_side(name, other):
    assert other_side(name) == other


@pytest.mark.parametrize("name", ["elbow", "bell", "L_arm_R", "elbowL", "cheek_lefty"])
def test_names_without_a_side(name):
    with pytest.raises(UsageError, match=f"{name} does not say its side"):
        other_side(name)


# ---- Faces that have no counterparts ----


def cut_alike(mesh) -> None:
    """Each quad cut from its first corner, all along the same diagonal, so that no face mirrors one."""
    quads = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 4)
    mesh.GetFaceVertexIndicesAttr().Set(quads[:, [0, 1, 2, 0, 2, 3]].ravel().tolist())
    mesh.GetFaceVertexCountsAttr().Set([3] * (2 * len(quads)))
    stages.add_patch(mesh, halves(FACES), LEFT)


def halves(faces: np.ndarray) -> np.ndarray:
    return np.sort(np.concatenate([2 * faces, 2 * faces + 1]))


def test_faces_cut_along_other_diagonals(tmp_path):
    """The region across, and paint where the mirror puts it, by point, by face and by edge."""
    stage, mesh = new_shot()
    cut_alike(mesh)
    weights, density = np.random.default_rng(0).uniform(size=63), np.repeat(np.arange(1, 49), 2)
    primvar(mesh, "weight", "vertex", weights)
    primvar(mesh, "forceDensity", "uniform", density)
    column = [[row * 9 + 1, row * 9 + 10] for row in (1, 2)]
    prop(mesh, "edges", [*column[0], 9, 19, *column[1]])  # the second is a diagonal
    prop(mesh, "edgeForceDensities", [2.0, 3.0, 4.0])
    prop(mesh, "corners", [9, 12, 45, 48])
    path = stages.save(stage, tmp_path / "shot.usda")
    report = mirror_to_file(path, tmp_path / "both.skinslide", MESH, LEFT)
    told = [problem for problem in report.problems if problem.severity == "note"]
    assert [problem.patch for problem in told] == [RIGHT, RIGHT]
    assert told[0].message.startswith("mirrored by nearest place, since faces are not symmetric: the farthest is ")
    assert float(told[0].message.split()[-2]) < 1e-6
    assert told[1].message == "1 of 3 painted edges are not on the other side"
    right = read(tmp_path / "both.skinslide")[RIGHT]
    assert np.array_equal(right.patch.faces, halves(ACROSS_FACES))
    controls = right.patch.controls
    np.testing.assert_array_equal(controls.weight[ACROSS[ON_PATCH]], weights.astype(np.float32)[ON_PATCH])
    quad = (right.patch.faces // 2) // 8 * 8 + 7 - (right.patch.faces // 2) % 8
    np.testing.assert_array_equal(controls.face_density[right.patch.faces], quad + 1)
    np.testing.assert_array_equal(controls.edges, ACROSS[column])
    np.testing.assert_array_equal(controls.edge_density, [2.0, 4.0])
    np.testing.assert_array_equal(right.patch.corners, ACROSS[[9, 12, 45, 48]])


def test_a_map_becomes_paint_there_too(tmp_path):
    stage, mesh = new_shot()
    cut_alike(mesh)
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, "vertex", [Gf.Vec2f(0.25)] * 63)
    (tmp_path / "q.exr").write_bytes(encode_exr({"R": np.full((2, 2), 0.5, np.float32)}))
    prop(mesh, "weightMap", Sdf.AssetPath("./q.exr"))
    path = stages.save(stage, tmp_path / "shot.usda")
    mirror_to_file(path, tmp_path / "both.skinslide", MESH, LEFT)
    right = read(tmp_path / "both.skinslide")[RIGHT]
    assert (right.patch.controls.weight[ACROSS[ON_PATCH]] == 0.5).all()


def test_a_tolerance_takes_what_is_about_there(tmp_path):
    stage, mesh = new_shot()
    cut_alike(mesh)
    move_point(mesh)
    path = stages.save(stage, tmp_path / "shot.usda")
    with pytest.raises(StageProblems, match=r"point 20 has no mirror image within 0\.0001"):
        mirror_to_file(path, tmp_path / "both.skinslide", MESH, LEFT)
    report = mirror_to_file(path, tmp_path / "both.skinslide", MESH, LEFT, tolerance=0.009)
    (told,) = [problem.message for problem in report.problems if problem.severity == "note"]
    assert 1e-4 < float(told.split()[-2]) < 0.009


def test_points_of_a_seam_are_mirrored_by_their_faces(tmp_path):
    """The mesh is split at every corner, so that several points are in each place."""
    whole = symmetric_grid()
    shape = stages.split(whole)
    places = np.sort(whole.indices)
    stage = stages.new_stage()
    mesh = stages.add_mesh(stage, shape, frames=())
    for i, frame in enumerate(FRAMES):
        mesh.GetPointsAttr().Set(stages.vectors(moved(i / 4)[places]), frame)
    stages.add_patch(mesh, FACES, LEFT)
    weights = np.random.default_rng(1).uniform(size=63).astype(np.float32)
    primvar(mesh, "weight", "vertex", weights[places])
    right = mirrored(stage, tmp_path)
    assert np.array_equal(np.sort(right.patch.faces), ACROSS_FACES)
    inside = right.mesh.topology.vertices_of(right.patch.faces)
    np.testing.assert_array_equal(right.patch.controls.weight[inside], weights[ACROSS[places[inside]]])


# ---- Bad input ----


def move_point(mesh) -> None:
    points = symmetric_grid().points.copy()
    points[ACROSS[20], 0] += 0.01
    mesh.GetPointsAttr().Set(stages.vectors(points))


def density_of_both_kinds(mesh) -> None:
    stages.set_primvar(mesh, "st", Types.TexCoord2fArray, "vertex", [Gf.Vec2f(0)] * 63)
    primvar(mesh, "forceDensity", "uniform", np.ones(48))
    prop(mesh, "forceDensityMap", Sdf.AssetPath("./q.exr"))


def corner_off_the_patch(mesh) -> None:
    prop(mesh, "corners", [9, 12, 48, 62])


def edge_off_the_patch(mesh) -> None:
    prop(mesh, "edges", [0, 9])
    prop(mesh, "edgeForceDensities", [2.0])


FAULTS = {
    "point": (move_point, {}, "point 20 has no mirror image within 0.0001 beyond x = 0"),
    "plane": (
        lambda mesh: None,
        dict(plane=0.5),
        "points 9, 10, 11, 12, 18, 19, 20, 21 and 12 more have no mirror image",
    ),
    "axis": (lambda mesh: None, dict(axis="y"), "have no mirror image within 0.0001 beyond y = 0"),
    "no such patch": (
        lambda mesh: mesh.GetPrim().RemoveAppliedSchema(f"SkinSlideAPI:{LEFT}"),
        {},
        "there is no such patch",
    ),
    "density by face and by map": (density_of_both_kinds, {}, "painted by face and has a map"),
    "corner": (corner_off_the_patch, {}, f"skinSlide:{LEFT}:corners has point 62, which is not of the patch"),
    "edge": (edge_off_the_patch, {}, f"skinSlide:{LEFT}:edges has point 0, which is not of the patch"),
    "token": (lambda mesh: prop(mesh, "holes", "open"), {}, "'open'; it must be one of pinned, free, freeAll"),
    "envelope": (lambda mesh: prop(mesh, "envelope", float("nan")), {}, "envelope is nan"),
}


@pytest.mark.parametrize(("spoil", "options", "message"), FAULTS.values(), ids=FAULTS.keys())
def test_faults(spoil, options, message, tmp_path):
    stage, mesh = new_shot()
    (tmp_path / "q.exr").write_bytes(encode_exr({"R": np.ones((2, 2), np.float32)}))
    spoil(mesh)
    path = stages.save(stage, tmp_path / "shot.usda")
    with pytest.raises(StageProblems) as raised:
        mirror_to_file(path, tmp_path / "both.usda", MESH, LEFT, **options)
    (problem,) = raised.value.problems
    assert message in problem.message and problem.prim == MESH and problem.patch in (LEFT, RIGHT)
    assert not (tmp_path / "both.usda").exists()


USAGE = {
    "no side": dict(patch="elbow"),
    "itself": dict(to=LEFT),
    "name": dict(to="elbow R"),
    "reserved name": dict(to="live"),
    "axis": dict(axis="w"),
    "plane": dict(plane=float("nan")),
    "tolerance": dict(tolerance=-1.0),
    "output": dict(output="both.txt"),
}


@pytest.mark.parametrize("change", USAGE.values(), ids=USAGE.keys())
def test_bad_usage(change, tmp_path):
    stage, _mesh = new_shot()
    path = stages.save(stage, tmp_path / "shot.usda")
    options = {"output": "both.usda", "patch": LEFT, **change}
    with pytest.raises(UsageError):
        mirror_to_file(path, tmp_path / options.pop("output"), MESH, options.pop("patch"), **options)
    assert [each.name for each in tmp_path.iterdir()] == ["shot.usda"]
