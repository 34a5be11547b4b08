"""From where pictures of a shot are seen."""

import math

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

import stages
from sheets import NAME, contrast, draw, halves, picture, sheet
from skinslide.command.cli import main
from stages import PATCH


def test_a_camera_of_the_stage_is_used(tmp_path):
    """A camera that looks past the mesh sees nothing of it; one that looks at it does; its animation counts."""
    stage, _mesh = sheet()
    camera = UsdGeom.Camera.Define(stage, "/World/cam")
    translate = camera.AddTranslateOp()
    translate.Set((0, 0, 2), 1001)
    translate.Set((50, 0, 2), 1003)
    camera.CreateFocalLengthAttr(35)
    draw(stage, tmp_path, camera="/World/cam")
    seen = [contrast(halves(picture(tmp_path, frame=frame))[0]) for frame in ("1001", "1003")]
    assert seen[0] > 100 and seen[1] == 0


@pytest.mark.parametrize("size", [(400, 300), (800, 300), (300, 400)])
def test_a_camera_shows_its_own_view_in_every_picture(size, tmp_path):
    """A sheet as wide and high as the camera's view is seen to its edges, on the shorter side of each half."""
    stage, _mesh = sheet()
    own = Gf.Camera(Gf.Matrix4d().SetTranslate((0, 0, 10)))
    own.SetOrthographicFromAspectRatioAndSize(1.0, 1.0, Gf.Camera.FOVHorizontal)
    UsdGeom.Camera.Define(stage, "/World/cam").SetFromCamera(own, Usd.TimeCode.Default())
    draw(stage, tmp_path, camera="/World/cam", size=size, frames="1001")
    left = picture(tmp_path, frame="1001")[:, : size[0] // 2].astype(int)
    drawn = np.abs(left - [59, 59, 63]).sum(axis=2) > 12  # the background
    side = min(size[0] // 2, size[1])
    across = np.count_nonzero(drawn[size[1] // 2]), np.count_nonzero(drawn[:, size[0] // 4])  # past the titles
    assert max(abs(count - side) for count in across) <= 3


def columns(folder, frame: str) -> np.ndarray:
    """The columns of the left half in which a sheet is seen, ascending."""
    left = halves(picture(folder, frame=frame))[0].astype(int)
    return np.flatnonzero(np.abs(left - [59, 59, 63]).sum(axis=2).max(axis=0) > 60)  # the background


def across(folder, frame: str) -> int:
    return len(columns(folder, frame))


def test_following_frames_the_patch_anew(tmp_path):
    """A mesh that shrinks fills the picture; to a camera of the whole shot it becomes small."""
    stage, mesh = sheet()
    size = UsdGeom.Xformable(mesh).AddScaleOp()
    size.Set((1, 1, 1), 1001)
    size.Set((0.2, 0.2, 0.2), 1003)
    draw(stage, tmp_path / "followed", follow=True)
    draw(stage, tmp_path / "still")
    first, last = (across(tmp_path / "followed", frame) for frame in ("1001", "1003"))
    assert abs(first - last) <= 2
    first, last = (across(tmp_path / "still", frame) for frame in ("1001", "1003"))
    assert last < 0.3 * first


@pytest.mark.parametrize("way", [(30.0, 0.0, 0.0), (0.0, 20.0, -40.0)])
def test_the_camera_goes_along_with_a_patch_that_goes_far(way, tmp_path):
    """Such as that of a character that walks by, which is as large in every picture as if it stayed."""
    stage, mesh = sheet()
    draw(stage, tmp_path / "stays")
    walk = UsdGeom.Xformable(mesh).AddTranslateOp()
    walk.Set((0, 0, 0), 1001)
    walk.Set(way, 1003)
    draw(stage, tmp_path / "walks")
    for frame in ("1001", "1002", "1003"):
        assert abs(across(tmp_path / "stays", frame) - across(tmp_path / "walks", frame)) <= 2


def test_the_camera_stands_still_where_that_shows_enough(tmp_path):
    """A sheet that goes by a third of its width does so in the pictures too."""
    stage, mesh = sheet()
    walk = UsdGeom.Xformable(mesh).AddTranslateOp()
    walk.Set((0, 0, 0), 1001)
    walk.Set((0.35, 0, 0), 1003)
    draw(stage, tmp_path)
    first, last = (columns(tmp_path, frame) for frame in ("1001", "1003"))
    assert last[0] - first[0] > 20


def test_the_camera_does_not_depend_on_the_frames_drawn(shot, tmp_path):
    draw(shot, tmp_path / "a", frames="1001-1002")
    draw(shot, tmp_path / "b", frames="1002")
    name = f"{NAME}.chequer.1002.png"
    assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def camera_stage(**values):
    """A sheet, and a camera that looks at it, with some attributes of its own."""
    stage, _mesh = sheet()
    camera = UsdGeom.Camera.Define(stage, "/World/cam")
    camera.AddTransformOp().Set(values.pop("transform", Gf.Matrix4d().SetTranslate((0, 0, 2))))
    for name, value in values.items():
        camera.GetPrim().GetAttribute(name).Set(value)
    return stage


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"horizontalAperture": 0.0}, "horizontalAperture is 0; it must be above 0"),
        ({"verticalAperture": -20.0}, "verticalAperture is -20; it must be above 0"),
        ({"horizontalAperture": math.nan}, "horizontalAperture is nan; it must be above 0"),
        ({"verticalAperture": math.inf, "projection": "orthographic"}, "verticalAperture is inf; it must be above 0"),
        ({"focalLength": 0.0}, "focalLength is 0; it must be above 0"),
        ({"focalLength": math.nan}, "focalLength is nan; it must be above 0"),
        ({"clippingRange": Gf.Vec2f(0, 100)}, "clippingRange is (0, 100); it must ascend, from above 0"),
        ({"clippingRange": Gf.Vec2f(100, 1)}, "clippingRange is (100, 1); it must ascend, from above 0"),
        ({"clippingRange": Gf.Vec2f(1, 1), "projection": "orthographic"}, "clippingRange is (1, 1); it must ascend"),
        ({"clippingRange": Gf.Vec2f(1, math.inf)}, "clippingRange is (1, inf); it must ascend"),
        ({"transform": Gf.Matrix4d(math.nan)}, "its transform to the world has no inverse"),
        ({"transform": Gf.Matrix4d().SetScale((1, 1, 0))}, "its transform to the world has no inverse"),
    ],
)  # fmt: skip
def test_a_camera_that_sees_nothing(values, message, tmp_path, capfd):
    path = str(stages.save(camera_stage(**values), tmp_path / "shot.usda"))
    words = ["--camera", "/World/cam", "--size", "64x32", "--frames", "1002"]
    assert main(["preview", path, "-o", str(tmp_path / "out"), *words]) == 3
    where = f"error: {stages.MESH}: patch {PATCH}: frame 1002: camera /World/cam: "
    assert capfd.readouterr().err.startswith(where + message)
    assert not (tmp_path / "out").exists()


def test_an_orthographic_camera_may_see_what_is_behind_it(tmp_path):
    stage = camera_stage(projection="orthographic", clippingRange=Gf.Vec2f(-10, 10))
    draw(stage, tmp_path, camera="/World/cam", frames="1001")
    assert contrast(halves(picture(tmp_path, frame="1001"))[0]) > 100


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (Gf.Matrix4d(math.nan), "its transform to the world is not finite"),
        (Gf.Matrix4d(0), "no camera can have the faces in sight"),
    ],
)
@pytest.mark.parametrize("frame", [None, 1001.0, 1003.0])
def test_a_mesh_that_is_nowhere(frame, matrix, message, tmp_path, capfd):
    """Throughout, or at a frame, which the message names."""
    stage, mesh = sheet()
    transform = UsdGeom.Xformable(mesh).AddTransformOp()
    if frame is None:
        transform.Set(matrix)
    else:
        transform.Set(Gf.Matrix4d(1), 1002.0)
        transform.Set(matrix, frame)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    words = ["--size", "64x32", *([] if frame is None else ["--follow"])]
    assert main(["preview", path, "-o", str(tmp_path / "out"), *words]) == (3 if frame is None else 1)
    said = capfd.readouterr().err
    assert f"error: {stages.MESH}: " in said and message in said
    assert frame is None or f": frame {frame:g}: " in said


def test_a_pose_that_no_camera_of_a_shot_can_have(tmp_path, capfd):
    stage, mesh = sheet()
    points = np.array(mesh.GetPointsAttr().Get(1003.0))
    points[312] = np.nan
    mesh.GetPointsAttr().Set(stages.vectors(points), 1003.0)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x32"]) == 3
    assert f"error: {stages.MESH}: frame 1003: points: vertex 312 is not finite" in capfd.readouterr().err


def test_a_mesh_that_is_nowhere_at_a_frame_of_the_shot(tmp_path, capfd):
    """The camera of a shot is framed by all of it."""
    stage, mesh = sheet()
    transform = UsdGeom.Xformable(mesh).AddTransformOp()
    transform.Set(Gf.Matrix4d(1), 1002.0)
    transform.Set(Gf.Matrix4d(math.nan), 1003.0)
    path = str(stages.save(stage, tmp_path / "shot.usda"))
    assert main(["preview", path, "-o", str(tmp_path / "out"), "--size", "64x32", "--frames", "1001"]) == 3
    assert f"error: {stages.MESH}: frame 1003: its transform to the world is not finite" in capfd.readouterr().err


def test_a_camera_by_a_path_of_usd(tmp_path):
    draw(camera_stage(), tmp_path, camera=Sdf.Path("/World/cam"), frames="1001")
    assert contrast(halves(picture(tmp_path, frame="1001"))[0]) > 100
