"""From where a patch is seen: a camera that frames it, or a camera of the stage."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from pxr import Gf, Usd, UsdGeom

from skinslide.arrays.canvas import Camera, Shape, frame_faces
from skinslide.arrays.meaning import say
from skinslide.problems import NO_SUCH_PRIM, Fault, FrameProblem, SliderError
from skinslide.stage.mesh import PatchedMesh

_MOST_POSES = 24  # that a camera of a whole shot is framed by


class Eye(Protocol):
    """Gives the camera of a time."""

    def camera(self, time: Usd.TimeCode) -> Camera:
        """Raises Fault, SliderError and FrameProblem where there is none."""


class StageCamera:
    """A UsdGeomCamera, whatever it does over time; what the picture is wider or taller by is added around its view.

    Gives Fault where there is none, or where it can see nothing.
    """

    def __init__(self, stage: Usd.Stage, path: str, aspect: float):
        prim = stage.GetPrimAtPath(path) if path.startswith("/") else Usd.Prim()
        if not prim or not prim.IsA(UsdGeom.Camera):
            kind = prim.GetTypeName() or say("no_type") if prim else ""
            raise Fault(f"camera {path}: {f'is a {kind}, no Camera' if prim else NO_SUCH_PRIM}")
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
    """Stands still, with a patch in sight all through the shot: the same camera whichever frames are drawn."""

    def __init__(self, mesh: PatchedMesh, faces: np.ndarray, aspect: float):
        """Raises FrameProblem for a time that no camera could show."""
        times = [Usd.TimeCode(time) for time in mesh.sample_times()] or [Usd.TimeCode.Default()]
        chosen = [times[i] for i in np.unique(np.linspace(0, len(times) - 1, _MOST_POSES).round().astype(int))]
        self._camera = _framed(mesh, faces, chosen, aspect)

    def camera(self, time: Usd.TimeCode) -> Camera:
        return self._camera


class FollowingCamera:
    """Frames a patch anew in each frame."""

    def __init__(self, mesh: PatchedMesh, faces: np.ndarray, aspect: float):
        self._mesh, self._faces, self._aspect = mesh, faces, aspect

    def camera(self, time: Usd.TimeCode) -> Camera:
        return _framed(self._mesh, self._faces, [time], self._aspect)


def to_world(mesh: PatchedMesh, time: Usd.TimeCode) -> np.ndarray:
    """The way of a mesh to the world, (4, 4). Raises FrameProblem."""
    matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(mesh.prim))
    if not np.isfinite(matrix).all():
        raise FrameProblem(mesh.problem("its transform to the world is not finite", time))
    return matrix


def _framed(mesh: PatchedMesh, faces: np.ndarray, times: Sequence[Usd.TimeCode], aspect: float) -> Camera:
    """Raises FrameProblem for a pose that cannot be, and SliderError where no camera sees them."""
    up = (0, 0, 1) if UsdGeom.GetStageUpAxis(mesh.stage) == UsdGeom.Tokens.z else (0, 1, 0)
    poses = [mesh.drawn_points(mesh.points_at(time)) for time in times]
    matrices = np.array([to_world(mesh, time) for time in times])
    shape = Shape(mesh.face_counts, mesh.face_indices)
    try:
        return frame_faces(shape, faces, poses, matrices, up, aspect, left_handed=mesh.left_handed)
    except SliderError as error:
        pose = re.match(r"pose (\d+): ", str(error))
        if not pose:
            raise
        raise FrameProblem(mesh.problem(str(error)[pose.end() :], times[int(pose[1])])) from error
