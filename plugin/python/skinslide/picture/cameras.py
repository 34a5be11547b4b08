"""From where a patch is seen: a camera that frames it, or a camera of the stage."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from pxr import Gf, Usd, UsdGeom

from skinslide.arrays.canvas import Camera, Shape, frame_faces
from skinslide.problems import Fault, FrameProblem, SliderError
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.names import prim_of_type

_MOST_POSES = 24  # that a camera of a whole shot is framed by
# A camera that stands still shows too little of a patch if it is this many times as far off as one that goes along.
_FAR = 1.5


class Eye(Protocol):
    """Where a patch is seen from at each time."""

    def camera(self, time: Usd.TimeCode) -> Camera:
        """Raises Fault, SliderError and FrameProblem where there is none."""


class StageCamera:
    """A UsdGeomCamera, whatever it does over time; what the picture is wider or taller by is added around its view.

    Gives Fault where there is none, or where it can see nothing.
    """

    def __init__(self, stage: Usd.Stage, path: str, aspect: float):
        prim = prim_of_type(stage, path, UsdGeom.Camera, f"camera {path}: ")
        self._camera, self._aspect = UsdGeom.Camera(prim), aspect

    def camera(self, time: Usd.TimeCode) -> Camera:
        own = self._camera.GetCamera(time)
        fault = _blindness(own)
        if fault:
            raise Fault(f"camera {self._camera.GetPath()}: {fault}")
        frustum = own.frustum
        window, seen = frustum.GetWindow(), frustum.ComputeAspectRatio()
        wider, taller = max(1.0, self._aspect / seen), max(1.0, seen / self._aspect)
        half = Gf.CompMult(window.GetSize() / 2, Gf.Vec2d(wider, taller))
        frustum.SetWindow(Gf.Range2d(window.GetMidpoint() - half, window.GetMidpoint() + half))
        return Camera(np.array(frustum.ComputeViewMatrix()), np.array(frustum.ComputeProjectionMatrix()))


def _blindness(camera: Gf.Camera) -> str | None:
    """Why a camera sees nothing; None where it does."""
    flat = camera.projection == Gf.Camera.Orthographic
    lengths = ("horizontalAperture", "verticalAperture", *([] if flat else ["focalLength"]))
    for name in lengths:
        length = getattr(camera, name)
        if not (length > 0 and math.isfinite(length)):
            return f"{name} is {length:g}; it must be above 0"
    near, far = camera.clippingRange.min, camera.clippingRange.max
    if not (near < far and math.isfinite(far - near) and (flat or near > 0)):
        return f"clippingRange is ({near:g}, {far:g}); it must ascend{'' if flat else ', from above 0'}"
    size = abs(camera.transform.GetDeterminant3())
    return None if size > 0 and math.isfinite(size) else "its transform to the world has no inverse"


class ShotCamera:
    """Has a patch in sight all through the shot: the same camera whichever frames are drawn.

    It stands still, or goes along with the middle of a patch that goes so far that it would be small.
    """

    def __init__(self, mesh: PatchedMesh, faces: np.ndarray, aspect: float):
        """Raises FrameProblem for a time that no camera could show."""
        times = [Usd.TimeCode(time) for time in mesh.sample_times()] or [Usd.TimeCode.Default()]
        spread = np.linspace(0, len(times) - 1, _MOST_POSES).round().astype(int)
        chosen = [times[i] for i in sorted(set(spread.tolist()))]
        self._subject = _Subject(mesh, faces)
        poses = [self._subject.pose(time) for time in chosen]
        still = self._subject.framed(poses, aspect)
        middles = np.array([self._subject.middle(pose) for pose in poses])
        ways = middles - middles[0]
        along = self._subject.framed([pose.moved(-way) for pose, way in zip(poses, ways, strict=True)], aspect)
        goes = bool(_depths(still, middles).max() > _FAR * _depths(along, middles[:1])[0])
        self._camera, self._start = (along if goes else still), (middles[0] if goes else None)

    def camera(self, time: Usd.TimeCode) -> Camera:
        if self._start is None:
            return self._camera
        way = self._subject.middle(self._subject.pose(time)) - self._start
        return self._camera._replace(to_camera=_moving(-way) @ self._camera.to_camera)


class FollowingCamera:
    """Points at a patch anew in each frame."""

    def __init__(self, mesh: PatchedMesh, faces: np.ndarray, aspect: float):
        self._subject, self._aspect = _Subject(mesh, faces), aspect

    def camera(self, time: Usd.TimeCode) -> Camera:
        return self._subject.framed([self._subject.pose(time)], self._aspect)


def to_world(mesh: PatchedMesh, time: Usd.TimeCode) -> np.ndarray:
    """The matrix (4, 4) that takes a mesh to the world. Raises FrameProblem."""
    matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(mesh.prim))
    if not np.isfinite(matrix).all():
        raise FrameProblem(mesh.problem("its transform to the world is not finite", time))
    return matrix


class _Pose(NamedTuple):
    """A mesh at a time."""

    time: Usd.TimeCode
    points: np.ndarray  # (V, 3)
    to_world: np.ndarray  # (4, 4)

    def moved(self, way: np.ndarray) -> _Pose:
        """The same elsewhere in the world."""
        return self._replace(to_world=self.to_world @ _moving(way))


class _Subject:
    """The faces that a camera looks at."""

    def __init__(self, mesh: PatchedMesh, faces: np.ndarray):
        self._mesh, self._faces = mesh, faces
        self._vertices = mesh.topology.vertices_of(faces)

    def pose(self, time: Usd.TimeCode) -> _Pose:
        """Raises FrameProblem where there is none."""
        return _Pose(time, self._mesh.drawn_points(self._mesh.points_at(time)), to_world(self._mesh, time))

    def middle(self, pose: _Pose) -> np.ndarray:
        """The mean of the faces' vertices in the world, (3,)."""
        mean = pose.points[self._vertices].mean(axis=0, dtype=np.float64)
        return np.asarray(np.append(mean, 1) @ pose.to_world)[:3]

    def framed(self, poses: Sequence[_Pose], aspect: float) -> Camera:
        """Raises FrameProblem for a pose that cannot be drawn, and SliderError where no camera sees them."""
        mesh = self._mesh
        up = (0, 0, 1) if UsdGeom.GetStageUpAxis(mesh.stage) == UsdGeom.Tokens.z else (0, 1, 0)
        shape, points = Shape(mesh.face_counts, mesh.face_indices), [pose.points for pose in poses]
        matrices = np.array([pose.to_world for pose in poses])
        try:
            return frame_faces(shape, self._faces, points, matrices, up, aspect, left_handed=mesh.left_handed)
        except SliderError as error:
            pose = re.match(r"pose (\d+): ", str(error))
            if not pose:
                raise
            raise FrameProblem(mesh.problem(str(error)[pose.end() :], poses[int(pose[1])].time)) from error


def _moving(way: np.ndarray) -> np.ndarray:
    """The matrix of a translation (3,), for points as rows."""
    matrix = np.eye(4)
    matrix[3, :3] = way
    return matrix


def _depths(camera: Camera, points: np.ndarray) -> np.ndarray:
    """How far into the picture points (n, 3) are."""
    return np.asarray(-(np.column_stack([points, np.ones(len(points))]) @ camera.to_camera)[:, 2])
