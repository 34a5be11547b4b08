"""Meshes that are split at seams or at every corner slide as those that they were split from."""

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

import rigs
import skinslide
import stages
from stages import FRAMES, MESH, PATCH


@pytest.fixture
def split():
    """The shape, split at every corner, and for each point the one of the whole that it is a copy of."""
    whole = stages.grid()
    return stages.split(whole), np.sort(whole.indices)


def split_stage(split) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A stage with the split mesh, which moves as the whole does."""
    shape, whole = split
    stage, mesh = stages.patched_stage(shape)
    for frame in FRAMES:
        mesh.GetPointsAttr().Set(stages.vectors(stages.grid().moved(frame)[whole]), frame)
    return stage, mesh


def slid(stage: Usd.Stage, tmp_path, frames=None) -> dict[float, np.ndarray]:
    """The points of a bake, frame by frame."""
    output = tmp_path / "out.usdc"
    skinslide.bake_to_file(stage, output, frames=frames)
    baked = Usd.Stage.Open(str(output))
    points = UsdGeom.Mesh(baked.GetPrimAtPath(MESH)).GetPointsAttr()
    return {time: np.array(points.Get(time)) for time in points.GetTimeSamples()}


def set_apart(mesh: UsdGeom.Mesh, point: int, frame: float) -> None:
    """Moves one point in a frame."""
    points = np.array(mesh.GetPointsAttr().Get(frame))
    points[point] += 0.01
    mesh.GetPointsAttr().Set(stages.vectors(points), frame)


def notes(report: skinslide.CheckReport) -> list[tuple[float | None, str]]:
    return [(problem.frame, problem.message) for problem in report.problems if problem.severity == "note"]


def test_a_mesh_of_a_game_slides_as_the_whole(split, tmp_path):
    whole = split[1]
    expected = slid(stages.patched_stage(stages.grid())[0], tmp_path)
    found = slid(split_stage(split)[0], tmp_path)
    assert found.keys() == expected.keys()
    for frame, points in found.items():
        assert points.tobytes() == expected[frame][whole].tobytes()
    assert not np.array_equal(found[FRAMES[-1]], stages.grid().moved(FRAMES[-1])[whole])


def test_check_counts_what_is_welded(split):
    report = skinslide.check(split_stage(split)[0])
    assert "144 points, 140 of them welded, 36 faces" in report.text()  # all but the corners of the sheet
    (mesh,) = report.meshes
    assert mesh.welded == report.as_dict()["meshes"][0]["welded"] == 140
    assert [patch.vertices for patch in mesh.patches] == [49] and not notes(report)


def test_a_record_counts_it_too(split, tmp_path):
    stage, _ = split_stage(split)
    (mesh,) = skinslide.bake_to_file(stage, tmp_path / "out.usdc").as_dict()["meshes"]
    assert mesh["welded"] == 140 and len(mesh["patches"]) == 1


def test_what_is_not_welded_is_summed_up(split):
    stage, mesh = split_stage(split)
    skinslide.SkinSlideMeshAPI.Apply(mesh).CreateWeldAttr(False)
    report = skinslide.check(stage)
    assert (
        f"  {PATCH}: 36 pieces, vertices 4 to 4, free 0 to 0, edges 4 to 4, faces 1 to 1, holes 0 to 0" in report.text()
    )
    assert len(report.text().splitlines()) < 20 and len(report.meshes[0].patches) == 36


def test_points_that_part_are_told_with_the_frame(split, tmp_path):
    stage, mesh = split_stage(split)
    (first, *_) = np.flatnonzero(split[1] == 24)
    set_apart(mesh, first + 1, FRAMES[1])
    report = skinslide.check(stage)
    ((frame, message),) = notes(report)
    assert frame == FRAMES[1]
    assert message == (
        f"1 point parts from others in its place at rest, points {first} and {first + 1} first: they are not welded"
    )
    assert report.meshes[0].welded == 139


def test_chunks_of_a_shot_agree(split, tmp_path):
    """Also if points part at a frame that is not in the chunk."""
    stage, mesh = split_stage(split)
    set_apart(mesh, np.flatnonzero(split[1] == 24)[1], FRAMES[2])
    together = slid(stage, tmp_path)
    for frame in FRAMES:
        assert slid(stage, tmp_path, [frame])[frame].tobytes() == together[frame].tobytes()


def test_a_doubled_sheet_is_two_pieces_and_told():
    front = stages.grid()
    back = front.indices.reshape(-1, 4)[:, ::-1] + len(front.points)
    both = stages.Shape(
        np.concatenate([front.points, front.points]),
        np.concatenate([front.counts, front.counts]),
        np.concatenate([front.indices, back.ravel()]).astype(np.int32),
    )
    report = skinslide.check(stages.patched_stage(both)[0])
    assert [patch.vertices for patch in report.meshes[0].patches] == [49, 49]
    ((_, message),) = notes(report)
    assert message == "90 points are in one place with others and cannot be welded: edge 1-8 would have 4 faces"


def neighbour(stage: Usd.Stage, parent: str = "/World/char/geo") -> str:
    """A mesh that goes on from the sheet's last column of points."""
    path = f"{parent}/head_GEO"
    stages.add_mesh(stage, stages.grid(centre=(1, 0, 0)), path)
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(path))
    for time in (Usd.TimeCode.Default(), *FRAMES):
        points = np.array(mesh.GetPointsAttr().Get(time))
        points[::7] = np.array(UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr().Get(time))[6::7]
        mesh.GetPointsAttr().Set(stages.vectors(points), time)
    return path


def test_borders_with_other_meshes_are_counted():
    stage, _ = stages.patched_stage(stages.grid())
    path = neighbour(stage)
    assert notes(skinslide.check(stage)) == [
        (None, f"7 border points coincide with points of {path}, and stay with them")
    ]
    UsdGeom.Xformable(stage.GetPrimAtPath(path)).AddTranslateOp().Set((0, 0, 1))
    assert not notes(skinslide.check(stage))


COLUMN = slice(6, None, 7)  # the border that the other mesh goes on from


def free_stage() -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A sheet all of whose border slides along itself."""
    stage, mesh = stages.patched_stage(stages.grid())
    stages.set_property(mesh, "forceDensityRule", "even")
    stages.set_property(mesh, "holes", "freeAll")
    return stage, mesh


def border_moves(stage: Usd.Stage, tmp_path) -> bool:
    """Whether the border next to the other mesh moves; everything else must, or the test would say nothing."""
    points = slid(stage, tmp_path)[FRAMES[-1]]
    moved = (points != np.array(UsdGeom.Mesh(stage.GetPrimAtPath(MESH)).GetPointsAttr().Get(FRAMES[-1]))).any(axis=1)
    assert moved[7:-7:7].any()
    return bool(moved[COLUMN].any())


def test_borders_that_may_slide_stay_with_another_mesh(tmp_path):
    stage, mesh = free_stage()
    assert border_moves(stage, tmp_path)
    path = neighbour(stage)
    assert not border_moves(stage, tmp_path)
    (checked,) = skinslide.check(stage).meshes
    assert checked.patches[0].held == 7
    (record,) = skinslide.bake_to_file(stage, tmp_path / "out.usdc").as_dict()["meshes"]
    assert record["patches"][0]["held_count"] == 7
    assert (None, f"7 border points coincide with points of {path}, and stay with them") in notes(
        skinslide.check(stage)
    )
    skinslide.SkinSlideMeshAPI.Apply(mesh).CreateWeldAttr(False)
    assert border_moves(stage, tmp_path)


def test_a_mesh_in_another_space_holds_nothing(tmp_path):
    stage, _ = free_stage()
    UsdGeom.Xformable(stage.GetPrimAtPath(neighbour(stage))).AddTranslateOp().Set((0, 0, 1))
    assert border_moves(stage, tmp_path)


def test_a_copy_of_the_mesh_holds_nothing(tmp_path):
    stage, _ = free_stage()
    stages.add_mesh(stage, stages.grid(), "/World/char/geo/proxy_GEO")
    assert border_moves(stage, tmp_path)


def test_a_skinned_mesh_meets_where_it_is_skinned(tmp_path):
    """Its points are elsewhere before they are skinned; equal up to rounding."""
    stage, body = free_stage()
    skinslide.SkinSlideMeshAPI.Apply(body).CreateWeldToleranceAttr(1e-6)
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(neighbour(stage)))
    rigs.skeleton(stage)
    binding = rigs.bind(mesh)
    mesh.GetPointsAttr().Set(stages.vectors(np.array(mesh.GetPointsAttr().Get()) + np.float32([0, 0, 4])))
    assert border_moves(stage, tmp_path)
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, -4)))
    assert not border_moves(stage, tmp_path)


def test_points_of_a_place_are_painted_as_their_mean(split, tmp_path):
    stage, mesh = split_stage(split)
    weights = np.ones(144, np.float32)
    weights[np.flatnonzero(split[1] == 24)] = [0, 0.5, 0.5, 1]
    stages.set_primvar(mesh, f"skinSlide:{PATCH}:weight", stages.Sdf.ValueTypeNames.FloatArray, "vertex", weights)
    plain, whole = stages.patched_stage(stages.grid())
    weights = np.ones(49, np.float32)
    weights[24] = 0.5
    stages.set_primvar(whole, f"skinSlide:{PATCH}:weight", stages.Sdf.ValueTypeNames.FloatArray, "vertex", weights)
    expected = slid(plain, tmp_path)
    for frame, points in slid(stage, tmp_path).items():
        assert points.tobytes() == expected[frame][split[1]].tobytes()


def test_a_slider_takes_what_is_one(split):
    shape, whole = split
    weld = np.searchsorted(whole, np.arange(49))[whole]
    patches = [skinslide.PatchSetup("sheet", np.arange(36))]
    welded = skinslide.Slider(shape.counts, shape.indices, shape.points, patches, weld=weld)
    expected = skinslide.Slider(*(lambda grid: (grid.counts, grid.indices, grid.points))(stages.grid()), patches)
    points = expected.slide(stages.grid().moved(FRAMES[-1])).points
    assert welded.slide(stages.grid().moved(FRAMES[-1])[whole]).points.tobytes() == points[whole].tobytes()


def test_what_is_one_can_be_found_without_usd(split):
    """The same points as in the stage, and fewer if points part in a pose."""
    shape, whole = split
    patches = [skinslide.PatchSetup("sheet", np.arange(36))]
    mesh = (shape.counts, shape.indices, shape.points, patches)
    poses = [stages.grid().moved(frame)[whole] for frame in FRAMES]
    weld = skinslide.find_weld(*mesh, poses)
    assert weld.dtype == np.int32 and np.array_equal(weld, np.searchsorted(whole, np.arange(49))[whole])
    poses[1][2] += 0.01
    parted = np.flatnonzero(skinslide.find_weld(*mesh, poses) != weld)
    assert parted.tolist() == [2]
    assert np.array_equal(skinslide.find_weld(*mesh, poses[:1] + poses[2:]), weld)
    near = shape.points.copy()
    near[2] += np.float32(1e-5)
    assert not np.array_equal(skinslide.find_weld(shape.counts, shape.indices, near, patches), weld)
    assert np.array_equal(skinslide.find_weld(shape.counts, shape.indices, near, patches, tolerance=1e-4), weld)
    with pytest.raises(skinslide.SliderError, match="the tolerance is 1;"):
        skinslide.find_weld(*mesh, tolerance=1)


def test_edges_by_a_curve_are_those_of_the_whole(split, tmp_path):
    """All copies of an edge are near the curve, and count as one."""
    found = []
    for stage, mesh in (split_stage(split), stages.patched_stage(stages.grid())):
        curve = UsdGeom.BasisCurves.Define(stage, "/World/char/line")
        curve.CreateTypeAttr("linear")
        curve.CreateCurveVertexCountsAttr([7])
        curve.CreatePointsAttr(stages.vectors(stages.grid().points[14:21]))
        report = skinslide.paint(
            stage, mesh.GetPrim(), PATCH, 8, curve=curve.GetPrim(), distance=1e-3, direction="along"
        )
        found.append((report.painted, slid(stage, tmp_path)))
    (copies, own), (edges, whole) = found
    assert edges == 6 and copies == 12
    for frame, points in own.items():
        assert points.tobytes() == whole[frame][split[1]].tobytes()
    plain = slid(stages.patched_stage(stages.grid())[0], tmp_path)
    assert not np.array_equal(plain[FRAMES[-1]], whole[FRAMES[-1]])
