"""The blend shapes of a skinned mesh, with their in-betweens, as UsdSkel adds them to points and to normals."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from pxr import Sdf, Usd, UsdSkel, Vt

from skinslide.problems import Fault


class BlendShapes:
    """All that a mesh names. Raises Fault for those that do not fit it."""

    def __init__(self, query: UsdSkel.SkinningQuery, point_count: int):
        _check_targets(query, point_count)
        self._query = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(query.GetPrim()))
        self._indices = self._query.ComputeBlendShapePointIndices()
        self._offsets = self._query.ComputeSubShapePointOffsets()

    def move(self, points: Vt.Vec3fArray, weights: Vt.FloatArray) -> None:
        """Adds the shapes to points, by a weight each."""
        sub_shapes = self._query.ComputeSubShapeWeights(weights)
        if not self._query.ComputeDeformedPoints(*sub_shapes, self._indices, self._offsets, points):
            raise Fault("UsdSkel cannot add the blend shapes")

    def turn(self, normals: Vt.Vec3fArray, weights: Vt.FloatArray) -> None:
        """Adds their offsets of normals, where they have them."""
        for weight, shape, sub_shape in zip(*self._query.ComputeSubShapeWeights(weights), strict=True):
            inbetween = self._query.GetInbetween(sub_shape)
            offsets = inbetween.GetNormalOffsets() if inbetween else self._shape(shape).GetNormalOffsetsAttr().Get()
            if offsets:
                UsdSkel.ApplyBlendShape(weight, offsets, self._indices[shape], normals)

    def _shape(self, index: int) -> UsdSkel.BlendShape:
        return self._query.GetBlendShape(index)


def _check_targets(query: UsdSkel.SkinningQuery, point_count: int) -> None:
    targets, names = query.GetBlendShapeTargetsRel().GetForwardedTargets(), query.GetBlendShapeOrder()
    if len(targets) != len(names):
        raise Fault(f"skel:blendShapes has {len(names)} names, but skel:blendShapeTargets {len(targets)} targets")
    for path in targets:
        prim = query.GetPrim().GetStage().GetPrimAtPath(path)
        if not prim or not prim.IsA(UsdSkel.BlendShape):
            raise Fault(f"skel:blendShapeTargets names {path}, which is not a BlendShape")
        _check_shape(UsdSkel.BlendShape(prim), point_count)


def _check_shape(shape: UsdSkel.BlendShape, point_count: int) -> None:
    _check_types(shape)
    indices = shape.GetPointIndicesAttr().Get()
    wanted, path = len(indices) if indices else point_count, shape.GetPath()
    for name, count in _lengths(shape):
        if count != wanted:
            of = "point indices" if indices else "points of the mesh"
            raise Fault(f"{name} of {path} has {count} values for {wanted} {of}")
    outside = np.flatnonzero((np.array(indices or ()) < 0) | (np.array(indices or ()) >= point_count))
    if outside.size:
        raise Fault(
            f"pointIndices[{outside[0]}] of {path} is {indices[int(outside[0])]}, but the mesh has {point_count} points"
        )


def _check_types(shape: UsdSkel.BlendShape) -> None:
    """UsdSkel takes values of another type for none."""
    vectors = [shape.GetOffsetsAttr(), shape.GetNormalOffsetsAttr(), *_inbetween_attributes(shape)]
    wanted = [(Sdf.ValueTypeNames.IntArray, shape.GetPointIndicesAttr())]
    wanted += [(Sdf.ValueTypeNames.Vector3fArray, each) for each in vectors]
    for needed, attribute in wanted:
        held = attribute.Get()
        if held is not None and not isinstance(held, needed.type.pythonClass):
            raise Fault(f"{attribute.GetName()} of {shape.GetPath()} is of type {type(held).__name__}, not {needed}")


def _lengths(shape: UsdSkel.BlendShape) -> Iterator[tuple[str, int]]:
    """How many offsets there are: of points always, of normals where they are authored."""
    yield "offsets", len(shape.GetOffsetsAttr().Get() or ())
    for attribute in [shape.GetNormalOffsetsAttr(), *_inbetween_attributes(shape)]:
        offsets = attribute.Get()
        if offsets is not None:
            yield attribute.GetName(), len(offsets)


def _inbetween_attributes(shape: UsdSkel.BlendShape) -> Iterator[Usd.Attribute]:
    for inbetween in shape.GetAuthoredInbetweens():
        yield inbetween.GetAttr()
        normals = shape.GetPrim().GetAttribute(f"{inbetween.GetAttr().GetName()}:normalOffsets")
        yield from [normals] if normals else []
