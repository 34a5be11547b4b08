"""What UsdSkel makes of a mesh: its points and normals at a time, as USD computes them, in the mesh's own space.

points, as authored
+ blend shapes, with in-betweens, by the animation's weights
x geomBindTransform, x the joints' transforms by their weights      in the skeleton's space
x skeleton to mesh                                                  in the mesh's

Rest points are the default value of points x geomBindTransform x skeleton to mesh: the pose in which the mesh was
bound, in the space of what is skinned.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt

from skinslide.problems import Fault
from skinslide.stage.binding import (
    bound_skeleton,
    check_animation,
    check_finite,
    check_joints,
    check_transforms,
    has_inverse,
    skeleton_query,
)
from skinslide.stage.blendshapes import BlendShapes
from skinslide.stage.rig import Rig
from skinslide.stage.values import FIRST, count_of


class Skinning:
    """How UsdSkel moves the points of one mesh. Raises Fault where it cannot."""

    def __init__(self, prim: Usd.Prim):
        self._prim = prim
        self._cache = UsdSkel.Cache()  # what is asked lives no longer than it
        self._skeleton = skeleton_query(self._cache, bound_skeleton(self._cache, prim))
        self._query, self._animation = self._cache.GetSkinningQuery(prim), self._skeleton.GetAnimQuery()
        self._has_joints = self._query.HasJointInfluences()
        self.point_count = count_of(UsdGeom.PointBased(prim).GetPointsAttr())
        if self._has_joints:
            check_joints(self._query, self._skeleton, self.point_count)
            check_animation(self._animation, self._skeleton)
        self._shapes = BlendShapes(self._query, self.point_count) if self._query.HasBlendShapes() else None

    @property
    def skeleton(self) -> str:
        """The path of the Skeleton."""
        return str(self._skeleton.GetPrim().GetPath())

    def times(self) -> list[float]:
        """When something is authored that points follow from, in stage time."""
        times = [*UsdGeom.PointBased(self._prim).GetPointsAttr().GetTimeSamples()]
        if self._animation and self._shapes:
            times += self._animation.GetBlendShapeWeightTimeSamples()
        if self._animation and self._has_joints:
            times += self._animation.GetJointTransformTimeSamples()
        if self._has_joints:
            times += [time for each in self._between() for time in UsdGeom.Xformable(each).GetTimeSamples()]
            times += [time for each in self._influences() if each for time in each.GetTimeSamples()]
        return sorted(set(times))

    def _influences(self) -> list[Usd.Attribute]:
        """Those that there may be."""
        primvars = (self._query.GetJointIndicesPrimvar(), self._query.GetJointWeightsPrimvar())
        return [self._query.GetGeomBindTransformAttr(), *(primvar.GetAttr() for primvar in primvars)]

    def points(self, authored: np.ndarray, time: Usd.TimeCode) -> np.ndarray:
        """The points (V, 3) float32 that UsdSkel makes of those authored. Raises Fault."""
        points = Vt.Vec3fArray.FromNumpy(authored)
        if self._shapes:
            self._shapes.move(points, self._weights(time))
        if self._has_joints:
            transforms = self._transforms(time)
            if not self._query.ComputeSkinnedPoints(transforms, points, time):
                raise self._unskinned()
            _transform(points, self._to_mesh(time))
        made = np.array(points)
        if not np.isfinite(made[np.isfinite(authored).all(axis=1)]).all():
            check_finite(self._query, self._animation, time)
        return made

    def bound(self, points: np.ndarray) -> np.ndarray:
        """Points as they are authored (V, 3), in the pose in which they were bound."""
        if not self._has_joints:
            return points
        bound = Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points, np.float32))
        _transform(bound, self._query.GetGeomBindTransform(FIRST) * self._to_mesh(FIRST))
        return np.array(bound)

    def rig(self) -> Rig:
        """The joints of the skeleton, with their weights. Raises Fault for a mesh that blend shapes alone move."""
        if not self._has_joints:
            raise Fault("no joint moves it: it has blend shapes alone")
        binds = self._skeleton.GetJointWorldBindTransforms()
        places = Vt.Vec3fArray([Gf.Vec3f(each.ExtractTranslation()) for each in binds])
        _transform(places, self._to_mesh(FIRST))
        count, order = self._query.GetNumInfluencesPerComponent(), list(self._skeleton.GetJointOrder())
        indices, weights = map(np.array, self._query.ComputeVaryingJointInfluences(self.point_count, FIRST))
        if self._query.GetJointOrder():
            indices = np.array([order.index(joint) for joint in self._query.GetJointOrder()], np.int32)[indices]
        return Rig(
            order,
            np.array(self._skeleton.GetTopology().GetParentIndices(), np.int32),
            np.array(places),
            self.bound(np.array(UsdGeom.PointBased(self._prim).GetPointsAttr().Get())),
            indices.reshape(-1, count),
            weights.reshape(-1, count),
        )

    def normals(self, authored: np.ndarray, corners: np.ndarray | None, time: Usd.TimeCode) -> np.ndarray:
        """The normals (n, 3) float32 that UsdSkel makes of those authored. Raises Fault.

        Args:
            authored: One for each vertex, or for each corner.
            corners: The vertex of each corner; None: they are by vertex.
            time: When.
        """
        normals = Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(authored, np.float32))
        if self._shapes and corners is None:
            self._shapes.turn(normals, self._weights(time))
        if self._has_joints:
            self._turn(normals, corners, time)
        return np.array(normals)

    def vectors(self, authored: np.ndarray, corners: np.ndarray | None, time: Usd.TimeCode) -> np.ndarray:
        """Other vectors (n, 3) that turn as normals do, and keep their lengths; blend shapes know none of them."""
        turned = Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(authored, np.float32))
        if self._has_joints:
            self._turn(turned, corners, time)
        made, lengths = np.array(turned, np.float64), np.linalg.norm(authored, axis=1, keepdims=True)
        now = np.linalg.norm(made, axis=1, keepdims=True)
        return made * np.divide(lengths, now, out=np.zeros_like(now), where=now > 0)

    def _turn(self, normals: Vt.Vec3fArray, corners: np.ndarray | None, time: Usd.TimeCode) -> None:
        given = self._query.ComputeVaryingJointInfluences(self.point_count, time)
        if given is None:  # of other counts than at first
            raise self._unskinned()
        influences = map(np.array, given)
        count, transforms = self._query.GetNumInfluencesPerComponent(), self._transforms(time)
        indices, weights = (
            each if corners is None else each.reshape(-1, count)[corners].ravel() for each in influences
        )
        if self._query.GetJointMapper():
            transforms = self._query.GetJointMapper().RemapTransforms(transforms, Vt.Matrix4dArray())
        UsdSkel.SkinNormals(
            self._query.GetSkinningMethod(),
            _of_normals(self._query.GetGeomBindTransform(time)),
            Vt.Matrix3dArray([_of_normals(each) for each in transforms]),
            Vt.IntArray.FromNumpy(indices),
            Vt.FloatArray.FromNumpy(weights),
            count,
            normals,
        )
        to_mesh = Vt.Matrix3dArray([_of_normals(self._to_mesh(time))])
        UsdSkel.SkinNormalsLBS(Gf.Matrix3d(1), to_mesh, *_one_joint(len(normals)), 1, normals)

    def _unskinned(self) -> Fault:
        return Fault(f"UsdSkel cannot skin points with the skeleton {self.skeleton}")

    def _transforms(self, time: Usd.TimeCode) -> Vt.Matrix4dArray:
        """Of the skeleton's joints, from where they were bound."""
        if self._animation:
            check_transforms(self._animation, time)
        return self._skeleton.ComputeSkinningTransforms(time)

    def _weights(self, time: Usd.TimeCode) -> Vt.FloatArray:
        """Of the mesh's blend shapes, all 0 where nothing animates them."""
        count = len(self._query.GetBlendShapeOrder())
        if not self._animation or not self._query.GetBlendShapeMapper():
            return Vt.FloatArray(count)
        return self._query.GetBlendShapeMapper().Remap(self._animation.ComputeBlendShapeWeights(time))

    def _to_mesh(self, time: Usd.TimeCode) -> Gf.Matrix4d:
        """From the skeleton's space to the mesh's; what moves both is left out, lest noise is left. Raises Fault."""
        cache, above = UsdGeom.XformCache(time), _common(self._prim, self._skeleton.GetPrim())
        skeleton, resets = cache.ComputeRelativeTransform(self._skeleton.GetPrim(), above)
        mesh, mesh_resets = cache.ComputeRelativeTransform(self._prim, above)
        if resets != mesh_resets:
            skeleton = cache.GetLocalToWorldTransform(self._skeleton.GetPrim())
            mesh = cache.GetLocalToWorldTransform(self._prim)
        if not has_inverse(mesh):
            raise Fault(f"its transform has no inverse, by which UsdSkel brings points back from {self.skeleton}")
        return skeleton * mesh.GetInverse()

    def _between(self) -> Iterator[Usd.Prim]:
        """The prims whose transforms lie between the mesh and its skeleton."""
        above = _common(self._prim, self._skeleton.GetPrim())
        for prim in (self._prim, self._skeleton.GetPrim()):
            while prim != above:
                yield prim
                prim = prim.GetParent()


# ---- What USD computes, on arrays ----


def _transform(points: Vt.Vec3fArray, matrix: Gf.Matrix4d) -> None:
    """Moves points as one joint would."""
    if matrix != Gf.Matrix4d(1):
        UsdSkel.SkinPointsLBS(Gf.Matrix4d(1), Vt.Matrix4dArray([matrix]), *_one_joint(len(points)), 1, points)


def _one_joint(count: int) -> tuple[Vt.IntArray, Vt.FloatArray]:
    """The influences of one joint on all."""
    return Vt.IntArray(count, 0), Vt.FloatArray(count, 1.0)


def _of_normals(matrix: Gf.Matrix4d) -> Gf.Matrix3d:
    return matrix.ExtractRotationMatrix().GetInverse().GetTranspose()


def _common(one: Usd.Prim, other: Usd.Prim) -> Usd.Prim:
    """The nearest prim that both are below, or that one of them is."""
    return one.GetStage().GetPrimAtPath(one.GetPath().GetCommonPrefix(other.GetPath()))
