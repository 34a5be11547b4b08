"""Writes the human as its rig comes out of an exporter: skinned by UsdSkel, split at UV seams, with authored normals.

A point on a seam has a copy for each of its texture coordinates. The copies share one normal.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

from makers import makehuman
from makers.stage import MESH_PATH

INFLUENCES = 8  # joints of a point; where a point has more, those of the smallest weights are left out
SKELETON, ANIMATION = "/char/rig", "/char/rig/anim"


@dataclass(frozen=True)
class Character:
    """A body and the turns of its joints. Points are in centimetres."""

    points: np.ndarray  # the base mesh's, targets applied
    turns: Mapping[str, Sequence[tuple[np.ndarray, float]]]  # by bone: an axis (3,) and an angle for each frame


def define(stage: Usd.Stage, character: Character) -> None:
    """Defines the character below /char, a SkelRoot."""
    UsdSkel.Root.Define(stage, "/char")
    UsdGeom.Scope.Define(stage, "/char/geo")
    bones = list(makehuman.read_rig())
    paths = {bone: _path(bone) for bone in bones}
    bones.sort(key=lambda bone: paths[bone].count("/"))  # parents before children
    _write_skeleton(stage, bones, paths, _heads(character.points))
    _write_animation(stage, paths, _heads(character.points), character.turns)
    _write_mesh(stage, bones, character.points)


def _path(bone: str) -> str:
    """The path of a bone's joint: upperarm01.L is .../upperarm01_L."""
    parent = makehuman.read_rig()[bone]["parent"]
    return f"{_path(parent)}/{joint_name(bone)}" if parent else joint_name(bone)


def joint_name(bone: str) -> str:
    return bone.replace(".", "_").replace("-", "_")


def _heads(points: np.ndarray) -> dict[str, np.ndarray]:
    """Where each bone begins, (3,)."""
    cubes = makehuman.read_mesh().cubes

    def place(head: dict) -> np.ndarray:
        match head["strategy"]:
            case "CUBE":
                return points[cubes[head["cube_name"]]].mean(axis=0)
            case "VERTEX":
                return points[head["vertex_index"]]
            case _:
                return points[head["vertex_indices"]].mean(axis=0)

    return {bone: place(entry["head"]) for bone, entry in makehuman.read_rig().items()}


def _offset(bone: str, heads: Mapping[str, np.ndarray]) -> np.ndarray:
    """From the head of the parent to that of the bone, (3,)."""
    parent = makehuman.read_rig()[bone]["parent"]
    return heads[bone] - (heads[parent] if parent else 0)


def _translation(vector: np.ndarray) -> Gf.Matrix4d:
    return Gf.Matrix4d().SetTranslate(Gf.Vec3d(*vector.tolist()))


def _write_skeleton(
    stage: Usd.Stage, bones: Sequence[str], paths: Mapping[str, str], heads: Mapping[str, np.ndarray]
) -> None:
    skeleton = UsdSkel.Skeleton.Define(stage, SKELETON)
    skeleton.CreateJointsAttr([paths[bone] for bone in bones])
    skeleton.CreateBindTransformsAttr([_translation(heads[bone]) for bone in bones])
    skeleton.CreateRestTransformsAttr([_translation(_offset(bone, heads)) for bone in bones])
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([ANIMATION])


def _write_animation(
    stage: Usd.Stage,
    paths: Mapping[str, str],
    heads: Mapping[str, np.ndarray],
    turns: Mapping[str, Sequence[tuple[np.ndarray, float]]],
) -> None:
    """Writes the animation of only those joints that turn."""
    animation = UsdSkel.Animation.Define(stage, ANIMATION)
    animation.CreateJointsAttr([paths[bone] for bone in turns])
    animation.CreateTranslationsAttr([Gf.Vec3f(*_offset(bone, heads).tolist()) for bone in turns])
    animation.CreateScalesAttr([Gf.Vec3h(1)] * len(turns))
    rotations = animation.CreateRotationsAttr()
    for frame, poses in enumerate(zip(*turns.values(), strict=True), start=1):
        turned = [Gf.Rotation(Gf.Vec3d(*axis.tolist()), float(np.degrees(angle))) for axis, angle in poses]
        rotations.Set(Vt.QuatfArray([Gf.Quatf(each.GetQuat()) for each in turned]), frame)


def _write_mesh(stage: Usd.Stage, bones: Sequence[str], points: np.ndarray) -> None:
    human = makehuman.read_mesh()
    corners = np.stack([human.faces.ravel(), human.st_faces.ravel()], axis=1)
    split, indices = np.unique(corners, axis=0, return_inverse=True)
    of_body, body = split[:, 0], points[: human.body_size]
    mesh = UsdGeom.Mesh.Define(stage, MESH_PATH.removeprefix("/World"))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray(len(human.faces), 4))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(indices.ravel().astype(np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreatePointsAttr(_vectors(body[of_body]))
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(mesh.GetPointsAttr().Get()))
    mesh.CreateNormalsAttr(_vectors(_smooth_normals(body, human.faces)[of_body]))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
    st.Set(Vt.Vec2fArray.FromNumpy(human.st[split[:, 1]]))
    _bind(mesh, bones, of_body)


def _bind(mesh: UsdGeom.Mesh, bones: Sequence[str], of_body: np.ndarray) -> None:
    shares = np.stack([makehuman.read_weights()[bone] for bone in bones], axis=1)
    joints = np.argsort(-shares, axis=1, kind="stable")[:, :INFLUENCES]
    weights = np.take_along_axis(shares, joints, axis=1)
    weights /= weights.sum(axis=1, keepdims=True)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([SKELETON])
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d(1))
    indices = Vt.IntArray.FromNumpy(joints[of_body].ravel().astype(np.int32))
    binding.CreateJointIndicesPrimvar(False, INFLUENCES).Set(indices)
    binding.CreateJointWeightsPrimvar(False, INFLUENCES).Set(
        Vt.FloatArray.FromNumpy(weights[of_body].ravel().astype(np.float32))
    )


def _smooth_normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Means of face normals by area, (V, 3)."""
    around = points[faces]
    of_faces = np.cross(around[:, 2] - around[:, 0], around[:, 3] - around[:, 1])
    sums = np.zeros(points.shape)
    np.add.at(sums, faces.ravel(), of_faces.repeat(4, axis=0))
    return sums / np.linalg.norm(sums, axis=1, keepdims=True)


def _vectors(array: np.ndarray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(array.astype(np.float32))
