"""UsdSkel on the small stages: a skeleton of three joints along x, animated, that a mesh is bound to."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

import stages
from stages import FRAMES

ROOT, SKELETON, ANIMATION = "/World/char", "/World/char/rig", "/World/char/rig/anim"
JOINTS = ["root", "root/arm", "root/arm/hand"]
PLACES = (-0.5, 0.0, 0.4)  # of joints, along x


def skeleton(stage: Usd.Stage, frames=FRAMES) -> UsdSkel.Skeleton:
    """Below a SkelRoot; the arm bends and the hand twists from frame to frame."""
    stage.GetPrimAtPath(ROOT).SetTypeName("SkelRoot")
    made = UsdSkel.Skeleton.Define(stage, SKELETON)
    made.CreateJointsAttr(JOINTS)
    made.CreateBindTransformsAttr([Gf.Matrix4d().SetTranslate(Gf.Vec3d(x, 0, 0)) for x in PLACES])
    steps = np.diff(PLACES, prepend=0)
    made.CreateRestTransformsAttr([Gf.Matrix4d().SetTranslate(Gf.Vec3d(float(x), 0, 0)) for x in steps])
    animation = UsdSkel.Animation.Define(stage, ANIMATION)
    animation.CreateJointsAttr(JOINTS[:0:-1])  # only some joints, and in another order
    animation.CreateTranslationsAttr([Gf.Vec3f(float(x), 0, 0) for x in steps[:0:-1]])
    animation.CreateScalesAttr([Gf.Vec3h(1)] * 2)
    rotations = animation.CreateRotationsAttr()
    for frame in frames:
        bend = 25 * (frame - FRAMES[0])
        turns = (Gf.Rotation(Gf.Vec3d(1, 0, 0), bend), Gf.Rotation(Gf.Vec3d(0, 1, 0), 2 * bend))
        rotations.Set(Vt.QuatfArray([Gf.Quatf(turn.GetQuat()) for turn in turns]), frame)
    UsdSkel.BindingAPI.Apply(made.GetPrim()).CreateAnimationSourceRel().SetTargets([ANIMATION])
    return made


def influences(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Joints (V, 2) and weights (V, 2) that fade along x."""
    x = np.asarray(points, np.float64)[:, 0]
    second = np.clip((x + 0.25) / 0.5, 0, 1)
    joints = np.where(x[:, None] < 0.25, [0, 1], [1, 2])
    second = np.where(x < 0.25, second, np.clip((x - 0.25) / 0.25, 0, 1))
    return joints.astype(np.int32), np.stack([1 - second, second], axis=1).astype(np.float32)


def bind(mesh: UsdGeom.Mesh) -> UsdSkel.BindingAPI:
    """Binds a mesh without samples to the skeleton."""
    points = mesh.GetPointsAttr()
    rest = points.Get()
    points.Clear()
    points.Set(rest)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([SKELETON])
    joints, weights = influences(np.array(rest))
    binding.CreateJointIndicesPrimvar(False, 2).Set(Vt.IntArray.FromNumpy(joints.ravel()))
    binding.CreateJointWeightsPrimvar(False, 2).Set(Vt.FloatArray.FromNumpy(weights.ravel()))
    return binding


def blend_shape(mesh: UsdGeom.Mesh, name: str = "bulge") -> UsdSkel.BlendShape:
    """Of some points of a mesh, with an in-between, animated beside the joints."""
    stage, binding = mesh.GetPrim().GetStage(), UsdSkel.BindingAPI(mesh.GetPrim())
    shape = UsdSkel.BlendShape.Define(stage, mesh.GetPath().AppendChild(name))
    moved = [8, 9, 10, 17]
    shape.CreatePointIndicesAttr(moved)
    shape.CreateOffsetsAttr([(0, 0.02 * point, 0.1) for point in moved])
    shape.CreateInbetween("half").SetOffsets([(0.05, 0, 0.2)] * 4)
    shape.GetInbetween("half").SetWeight(0.5)
    binding.CreateBlendShapesAttr([name])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    animation = UsdSkel.Animation(stage.GetPrimAtPath(ANIMATION))
    animation.CreateBlendShapesAttr(["other", name])
    for frame in FRAMES:
        animation.CreateBlendShapeWeightsAttr().Set([0.7, 0.3 * (frame - FRAMES[0])], frame)
    return shape


def skinned_stage(shape: stages.Shape | None = None, faces: np.ndarray | None = None) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """Like `stages.patched_stage`, but with a skinned mesh in place of samples. Keep both."""
    stage, mesh = stages.patched_stage(shape, faces)
    skeleton(stage)
    bind(mesh)
    return stage, mesh


def skinned_by_usd(stage: Usd.Stage) -> Usd.Stage:
    """A copy of a stage, with skinning baked by USD itself."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.TransferContent(stage.Flatten())
    copy = Usd.Stage.Open(layer)
    assert UsdSkel.BakeSkinning(Usd.PrimRange(copy.GetPseudoRoot()))
    return copy
