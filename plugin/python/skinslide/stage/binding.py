"""Whether the binding of a mesh to a skeleton can be used: the one place that says what is wrong with a rig."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdSkel

from skinslide.problems import Fault
from skinslide.stage.values import FIRST

# How far from 1 the weights of a point may add up to: what rounding to eight bits leaves of them.
_WEIGHT_TOLERANCE = 0.01
# Of the box that the axes of a transform span when they are square to each other: below it is rounding.
_LEAST_VOLUME = 1e-12
_COMPONENTS = ("translations", "rotations", "scales")


def skel_root(prim: Usd.Prim) -> Usd.Prim | None:
    """The nearest SkelRoot, of the prim and what it is below."""
    found = UsdSkel.Root.Find(prim)
    return found.GetPrim() if found else None


def skeleton_target(prim: Usd.Prim) -> Usd.Prim | None:
    """The Skeleton that is bound to a prim, there or below its SkelRoot; None where there is none, or it is unbound."""
    binding = _binding(prim)
    targets = binding.GetForwardedTargets() if binding else []
    found = prim.GetStage().GetPrimAtPath(targets[0]) if targets else None
    return found if found and found.IsA(UsdSkel.Skeleton) else None


def bound_skeleton(cache: UsdSkel.Cache, prim: Usd.Prim) -> UsdSkel.Skeleton:
    """The Skeleton that UsdSkel skins a prim by, with all of its influences. Raises Fault.

    Fills the cache with all below the prim's SkelRoot.
    """
    binding, root = _binding(prim), UsdSkel.Root.Find(prim)
    targets = binding.GetForwardedTargets() if binding else []
    if binding and len(targets) > 1:
        names = " and ".join(map(str, targets))
        raise Fault(f"{binding.GetName()} of {binding.GetPrimPath()} names {names}; it must name one skeleton")
    cache.Populate(root, Usd.TraverseInstanceProxies())
    for found in cache.ComputeSkelBindings(root, Usd.TraverseInstanceProxies()):
        for query in found.GetSkinningTargets():
            if query.GetPrim() == prim and _counts(query):
                return found.GetSkeleton()
    raise Fault(
        "UsdSkel cannot use its joints or blend shapes; is SkelBindingAPI applied to it, and are there as many joint "
        "indices as weights?"
    )


def skeleton_query(cache: UsdSkel.Cache, skeleton: UsdSkel.Skeleton) -> UsdSkel.SkeletonQuery:
    """What UsdSkel makes of a Skeleton. Raises Fault where it cannot use its joints."""
    found = cache.GetSkelQuery(skeleton)
    if not found:
        raise Fault(f"UsdSkel cannot use the joints of {skeleton.GetPath()}; is each there once, and after its parent?")
    return found


def _counts(query: UsdSkel.SkinningQuery) -> bool:
    """Whether there are influences, and UsdSkel takes those of joints where they are authored."""
    joints = query.GetJointIndicesPrimvar()
    return query.HasJointInfluences() or (query.HasBlendShapes() and not (joints and joints.HasAuthoredValue()))


def _binding(prim: Usd.Prim) -> Usd.Relationship | None:
    """That which says what skeleton a prim has, on it or nearest above it, but not above its SkelRoot."""
    root = skel_root(prim)
    while root and prim:
        binding = prim.GetRelationship(UsdSkel.Tokens.skelSkeleton)
        if binding.HasAuthoredTargets():
            return binding
        prim = prim.GetParent() if prim != root else None
    return None


def check_joints(query: UsdSkel.SkinningQuery, skeleton: UsdSkel.SkeletonQuery, point_count: int) -> None:
    """Raises Fault for joints and weights of a mesh that its skeleton cannot move it by."""
    where, own = skeleton.GetPrim().GetPath(), list(skeleton.GetJointOrder())
    if not skeleton.HasBindPose():
        raise Fault(f"the skeleton {where} has no bindTransforms, of which there must be one for each of its joints")
    joints = query.GetJointOrder()
    _check_known("skel:joints names", own if joints is None else list(joints), own, str(where))
    primvars = (query.GetJointIndicesPrimvar(), query.GetJointWeightsPrimvar())
    indices, weights = (np.array(each.ComputeFlattened(FIRST) or ()) for each in primvars)
    count = query.GetNumInfluencesPerComponent()
    wanted = count * (1 if query.GetInterpolation() == UsdGeom.Tokens.constant else point_count)
    for name, values in (("jointIndices", indices), ("jointWeights", weights)):
        if len(values) != wanted:
            raise Fault(f"primvars:skel:{name} has {len(values)} values, where {wanted} are needed")
    _check_indices(indices, len(own if joints is None else joints))
    sums = weights.reshape(-1, count).sum(axis=1, dtype=np.float64)
    for point in np.flatnonzero(~(np.abs(sums - 1) <= _WEIGHT_TOLERANCE))[:1]:
        raise Fault(f"primvars:skel:jointWeights of point {point} add up to {sums[point]:g}, not to 1")
    order = own if joints is None else list(joints)
    _check_bound(query, skeleton, {order[index] for index in np.unique(indices[weights != 0])})


def _check_bound(query: UsdSkel.SkinningQuery, skeleton: UsdSkel.SkeletonQuery, used: set[str]) -> None:
    """What is skinned goes back by the transforms of the joints used, and its normals by its own."""
    if not has_inverse(query.GetGeomBindTransform(FIRST)):
        raise Fault("primvars:skel:geomBindTransform has no inverse")
    for joint, transform in zip(skeleton.GetJointOrder(), skeleton.GetJointWorldBindTransforms(), strict=True):
        if joint in used and not has_inverse(transform):
            raise Fault(f"bindTransforms of {skeleton.GetPrim().GetPath()} has no inverse for the joint {joint}")


def has_inverse(transform: Gf.Matrix4d) -> bool:
    """Whether it is finite, and flattens nothing, whatever its scale along each axis."""
    rows = np.array(transform)
    if not np.isfinite(rows).all():
        return False
    volume, sides = abs(np.linalg.det(rows[:3, :3])), np.linalg.norm(rows[:3, :3], axis=1)
    return bool(volume > _LEAST_VOLUME * sides.prod()) and rows[3, 3] != 0


def _check_indices(indices: np.ndarray, joint_count: int) -> None:
    for wrong in np.flatnonzero((indices < 0) | (indices >= joint_count))[:1]:
        raise Fault(f"primvars:skel:jointIndices[{wrong}] is {indices[wrong]}, but there are {joint_count} joints")


def check_animation(animation: UsdSkel.AnimQuery | None, skeleton: UsdSkel.SkeletonQuery) -> None:
    """Raises Fault for an animation of joints that the skeleton has not."""
    if animation:
        own, where = list(skeleton.GetJointOrder()), str(skeleton.GetPrim().GetPath())
        _check_known(
            f"the animation {animation.GetPrim().GetPath()} moves", list(animation.GetJointOrder()), own, where
        )


def check_finite(query: UsdSkel.SkinningQuery, animation: UsdSkel.AnimQuery | None, time: Usd.TimeCode) -> None:
    """Raises Fault for the first weight or transform that is not finite, by which points come to be nowhere."""
    weights = query.GetJointWeightsPrimvar()
    if weights and weights.HasAuthoredValue():
        found = np.array(weights.ComputeFlattened(time) or ())
        for index in np.flatnonzero(~np.isfinite(found))[:1]:
            raise Fault(f"primvars:skel:jointWeights[{index}] is {found[index]:g}")
    if not animation:
        return
    path, components = animation.GetPrim().GetPath(), animation.ComputeJointLocalTransformComponents(time)
    for name, values in zip(_COMPONENTS, components, strict=True):
        _check_each(f"{name} of {path}", animation.GetJointOrder(), [_numbers(value) for value in values])
    _check_each(
        f"blendShapeWeights of {path}", animation.GetBlendShapeOrder(), animation.ComputeBlendShapeWeights(time) or ()
    )


def _numbers(value: Gf.Vec3f | Gf.Vec3h | Gf.Quatf) -> list[float]:
    return [value.GetReal(), *value.GetImaginary()] if isinstance(value, Gf.Quatf) else list(value)


def _check_each(name: str, owners: Sequence[str], values: Sequence[Sequence[float] | float]) -> None:
    for owner, value in zip(owners, values, strict=False):
        if not np.isfinite(np.asarray(value)).all():
            raise Fault(f"{name} is not finite for {owner}")


def check_transforms(animation: UsdSkel.AnimQuery, time: Usd.TimeCode) -> None:
    """Raises Fault where there are not as many transforms as joints, which UsdSkel would then leave at rest."""
    wanted = len(animation.GetJointOrder())
    components = animation.ComputeJointLocalTransformComponents(time)
    for name, values in zip(_COMPONENTS, components, strict=True):
        if len(values) != wanted:
            raise Fault(f"{name} of {animation.GetPrim().GetPath()} has {len(values)} values for {wanted} joints")


def _check_known(what: str, joints: list[str], own: list[str], skeleton: str) -> None:
    known = set(own)
    unknown = [joint for joint in joints if joint not in known]
    if unknown:
        more = f" and {len(unknown) - 1} more" if len(unknown) > 1 else ""
        raise Fault(f"{what} {unknown[0]}{more}, which the skeleton {skeleton} does not have")
