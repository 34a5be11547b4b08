"""The limit surface: against subdivision by hand, read from a stage, and what a bake of it holds."""

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom, Vt

import stages
from makers import refine
from repository import load
from skinslide import PatchSetup, Slider, SliderError, Subdivision, bake_to_file
from skinslide.arrays.limit import limit_points
from skinslide.stage.reading import read_meshes
from stages import FRAMES, MESH, PATCH

CATMULL_CLARK = Subdivision()
LEVELS = 5


# ---- limit points ----


@pytest.mark.parametrize("shape", [stages.grid(4, 3), stages.box()])
def test_limit_points_are_what_subdivision_goes_to(shape):
    """Five levels of the makers' own subdivision, which rounds the corners of a sheet off.

    A level takes the distance to the limit down to about a quarter.
    """
    faces, points = shape.indices.reshape(-1, 4), shape.points.astype(np.float64)
    corners, rounded = np.arange(4 * len(faces)), Subdivision(boundary_rule="edgeOnly")
    places = {"corner": (0, 0), "side": (1, 0), "middle": (1, 1)}
    limit = {
        name: limit_points(
            shape.counts, shape.indices, shape.points, rounded, corners, np.tile(place, (len(corners), 1))
        )
        for name, place in places.items()
    }
    fine, fine_faces = refine.refined(points, faces), refine.refined_faces(faces)
    quarters = fine_faces[corners]  # the quad at each corner: corner, middle of the side, middle of the face
    for _ in range(LEVELS - 1):
        fine, fine_faces = refine.refined(fine, fine_faces), refine.refined_faces(fine_faces)
    for column, name in enumerate(places):
        # Old points keep their numbers from level to level.
        np.testing.assert_allclose(limit[name], fine[quarters[:, column]], atol=2 * 0.25**LEVELS)


def test_limit_points_name_what_is_wrong():
    shape = stages.grid()
    arrays = (shape.counts, shape.indices, shape.points)
    with pytest.raises(SliderError, match="corner 144"):
        limit_points(*arrays, CATMULL_CLARK, np.array([144]), np.zeros((1, 2)))
    with pytest.raises(SliderError, match="hole"):
        limit_points(*arrays, Subdivision(hole_indices=np.array([0])), np.array([0]), np.zeros((1, 2)))
    with pytest.raises(SliderError, match="corner sharpnesses: 0 values for 1 corners"):
        limit_points(*arrays, Subdivision(corner_indices=np.array([0])), np.array([0]), np.zeros((1, 2)))
    with pytest.raises(SliderError, match="'butterfly' is not one of none, catmullClark, loop, bilinear"):
        limit_points(*arrays, Subdivision(scheme="butterfly"), np.array([0]), np.zeros((1, 2)))


# ---- from the stage ----


def subdivided_stage(shape: stages.Shape | None = None, faces: np.ndarray | None = None):
    stage, mesh = stages.patched_stage(shape or stages.grid(8, 8), faces)
    mesh.GetSubdivisionSchemeAttr().Set("catmullClark")
    return stage, mesh


def baked(stage: Usd.Stage, folder: Path) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    path = stages.save(stage, folder / "shot.usda")
    bake_to_file(path, folder / "out.usda")
    result = Usd.Stage.Open(str(folder / "out.usda"))
    return result, UsdGeom.Mesh(result.GetPrimAtPath(MESH))


def slid_by(
    shape: stages.Shape, subdivision: Subdivision | None, interpolation: str = "auto", faces=None
) -> np.ndarray:
    setup = PatchSetup(PATCH, shape.all_faces if faces is None else faces, interpolation=interpolation)
    made = Slider(shape.counts, shape.indices, shape.points, [setup], subdivision=subdivision)
    return made.slide(shape.moved(FRAMES[-1])).points


def test_a_subdivided_mesh_is_baked_on_its_limit_surface(tmp_path):
    shape = stages.grid(8, 8)
    stage, _ = subdivided_stage(shape)
    result, mesh = baked(stage, tmp_path)
    slid = np.array(mesh.GetPointsAttr().Get(FRAMES[-1]))
    assert slid.tobytes() == slid_by(shape, CATMULL_CLARK, "limit").tobytes()
    assert slid.tobytes() != slid_by(shape, None).tobytes()
    del result


@pytest.mark.parametrize("interpolation", ["linear", "meanValue"])
def test_a_patch_may_choose_otherwise(tmp_path, interpolation):
    shape = stages.grid(8, 8)
    stage, mesh = subdivided_stage(shape)
    stages.set_property(mesh, "interpolation", interpolation)
    mesh.CreateCreaseIndicesAttr([0, 80])  # not an edge: nothing that these need
    mesh.CreateCreaseLengthsAttr([2])
    result, mesh = baked(stage, tmp_path)
    slid = np.array(mesh.GetPointsAttr().Get(FRAMES[-1]))
    assert slid.tobytes() == slid_by(shape, None, interpolation).tobytes()
    del result


def test_creases_corners_holes_and_rules_are_read(tmp_path):
    shape = stages.grid(8, 8)
    faces = stages.block(8, range(2, 6), range(2, 6))
    crease = np.arange(9) * 9 + 4
    stage, mesh = subdivided_stage(shape, faces)
    mesh.CreateCreaseIndicesAttr(Vt.IntArray.FromNumpy(crease.astype(np.int32)))
    mesh.CreateCreaseLengthsAttr([9])
    mesh.CreateCreaseSharpnessesAttr([1.5] * 4 + [3.0] * 4)  # by edge
    mesh.CreateCornerIndicesAttr([30])
    mesh.CreateCornerSharpnessesAttr([10])
    mesh.CreateHoleIndicesAttr([0, 9])
    mesh.CreateInterpolateBoundaryAttr("edgeOnly")
    mesh.CreateTriangleSubdivisionRuleAttr("smooth")
    expected = Subdivision(
        boundary_rule="edgeOnly",
        triangle_rule="smooth",
        crease_lengths=np.array([9]),
        crease_indices=crease,
        crease_sharpnesses=np.array([1.5] * 4 + [3.0] * 4),
        corner_indices=np.array([30]),
        corner_sharpnesses=np.array([10.0]),
        hole_indices=np.array([0, 9]),
    )
    [found], problems = read_meshes(stage)
    assert not problems
    for name, value in vars(expected).items():
        assert np.array_equal(getattr(found.subdivision, name), value), name
    result, mesh = baked(stage, tmp_path)
    slid = np.array(mesh.GetPointsAttr().Get(FRAMES[-1]))
    assert slid.tobytes() == slid_by(shape, expected, faces=faces).tobytes()
    assert slid.tobytes() != slid_by(shape, CATMULL_CLARK, faces=faces).tobytes()
    del result


def spoil_crease(mesh):
    mesh.CreateCreaseIndicesAttr([0, 8])
    mesh.CreateCreaseLengthsAttr([2])
    mesh.CreateCreaseSharpnessesAttr([1.0])


def spoil_sharpness(mesh):
    mesh.CreateCornerIndicesAttr([0])
    mesh.CreateCornerSharpnessesAttr([-2.0])


def spoil_over_time(mesh):
    mesh.CreateHoleIndicesAttr().Set([0], FRAMES[0])
    mesh.GetHoleIndicesAttr().Set([1], FRAMES[1])


# What is spoiled → what must be said, after the mesh and, where the patch is to blame, the patch.
SPOILED = {
    "a crease that is no edge": (spoil_crease, None, "crease 0: 0-8 is not an edge of the mesh"),
    "sharpness": (spoil_sharpness, None, "corner sharpness 0 is -2; it must be 0 or more"),
    "changing": (spoil_over_time, None, "holeIndices changes at frame"),
    "scheme": (lambda mesh: mesh.GetSubdivisionSchemeAttr().Set("butterfly"), None, "subdivisionScheme is 'butterfly'"),
    "loop": (lambda mesh: mesh.GetSubdivisionSchemeAttr().Set("loop"), None, "face 0 has 4 vertices; the loop scheme"),
    "hole": (lambda mesh: mesh.CreateHoleIndicesAttr([7]), PATCH, "face 7 has no limit surface: it is one of hole"),
    "boundary": (lambda mesh: mesh.CreateInterpolateBoundaryAttr("none"), PATCH, "face 0 has no limit surface: interp"),
}


@pytest.mark.parametrize("case", SPOILED)
def test_bad_subdivisions_are_named_and_nothing_is_written(tmp_path, capfd, case):
    from skinslide.command.cli import main

    spoil, patch, says = SPOILED[case]
    stage, mesh = subdivided_stage(stages.grid())
    spoil(mesh)
    path = stages.save(stage, tmp_path / "shot.usda")
    place = f"error: {MESH}" + (f": patch {patch}" if patch else "") + f": {says}"
    assert main(["check", str(path)]) == 3
    assert place in capfd.readouterr().out
    assert main(["bake", str(path), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 3
    said = capfd.readouterr()
    assert place in said.err and "Warning" not in said.err + said.out  # OpenSubdiv's own words
    assert not (tmp_path / "out.usda").exists()


# ---- what else a bake holds ----


def test_normals_extent_and_velocities_belong_to_the_slid_points(tmp_path):
    shape = stages.grid(8, 8)
    stage, mesh = subdivided_stage(shape)
    inner = np.flatnonzero((shape.points[:, :2] > -0.49).all(axis=1) & (shape.points[:, :2] < 0.49).all(axis=1))
    mesh.SetNormalsInterpolation("vertex")
    step = 1 / 24  # seconds a frame
    for frame in FRAMES:
        normals = np.tile([0.0, 0.0, 1.0], (len(shape.points), 1))
        normals[inner] = limit_normals(shape, shape.moved(frame), inner)
        mesh.CreateNormalsAttr().Set(stages.vectors(normals), frame)
        rate = (shape.moved(frame + 1e-2).astype(np.float64) - shape.moved(frame - 1e-2)) / (2e-2 * step)
        mesh.CreateVelocitiesAttr().Set(stages.vectors(rate), frame)
    result, mesh = baked(stage, tmp_path)
    slid = {frame: np.array(mesh.GetPointsAttr().Get(frame)) for frame in FRAMES}
    last = slid[FRAMES[-1]]
    assert last.tobytes() == slid_by(shape, CATMULL_CLARK).tobytes()
    np.testing.assert_array_equal(mesh.GetExtentAttr().Get(FRAMES[-1]), [last.min(axis=0), last.max(axis=0)])
    # Across the limit surface, as they were: carried, they are within a few degrees of its own.
    normals = np.array(mesh.GetNormalsAttr().Get(FRAMES[-1]))
    across = limit_normals(shape, last, inner)
    assert np.degrees(np.arccos(np.clip((normals[inner] * across).sum(axis=1), -1, 1))).max() < 6
    # The rate at which slid points move, from the frames beside: 24 per second, displacement by its difference.
    middle = np.array(mesh.GetVelocitiesAttr().Get(FRAMES[1]))
    np.testing.assert_allclose(middle, (last - slid[FRAMES[0]].astype(np.float64)) / (2 * step), atol=0.05 * 24)
    del result


def limit_normals(shape: stages.Shape, points: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Unit normals of the limit surface at vertices (n,): (n, 3)."""
    across = np.cross(*(limit_step(shape, points, vertices, direction) for direction in ((0.05, 0), (0, 0.05))))
    return across / np.linalg.norm(across, axis=1)[:, None]


def limit_step(shape: stages.Shape, points: np.ndarray, vertices: np.ndarray, direction: tuple[float, float]):
    """From the limit point of each vertex (n,) a short way along a side of the first face it begins."""
    corners = np.array([np.flatnonzero(shape.indices.reshape(-1, 4)[:, 0] == vertex)[0] * 4 for vertex in vertices])
    arrays = (shape.counts, shape.indices, points, CATMULL_CLARK, corners)
    here = limit_points(*arrays, np.zeros((len(corners), 2)))
    return limit_points(*arrays, np.tile(direction, (len(corners), 1))) - here.astype(np.float64)


def test_damped_vertices_are_reported(tmp_path):
    stage, mesh = subdivided_stage(stages.grid(8, 8, 8.0))
    points = np.array(mesh.GetPointsAttr().Get(FRAMES[-1]))
    points[[40, 41, 42], 2] += [30, -30, 30]
    mesh.GetPointsAttr().Set(stages.vectors(points), FRAMES[-1])
    report = bake_to_file(stages.save(stage, tmp_path / "shot.usda"), tmp_path / "out.usda")
    assert any("limit surface rings" in str(problem) for problem in report.problems)
    assert report.as_dict()["meshes"][0]["patches"][0]["max"]["damped_vertices"] > 0


# ---- the examples ----


@pytest.mark.parametrize("example", ["bump", "elbow", "fine_elbow"])
def test_the_limit_surface_keeps_its_shape(example_stage, example):
    """Five times as well as with linear, at its largest and on average, and with no more than 5 % more stretch."""
    measure = load("measure/limit_distance.py")
    path = example_stage(example)
    stage = Usd.Stage.Open(str(path))
    [mesh], _ = read_meshes(stage)
    ways = measure.Ways(mesh, 0)
    linear, plain, _ = ways.measure("linear")
    limit, stretch, _ = ways.measure("limit")
    assert (limit * 5 <= linear).all()
    assert stretch <= 1.05 * plain
