"""The marks on what a bake authors, so that none is taken for a cache and slid twice."""

from __future__ import annotations

from pxr import Sdf, Usd, UsdGeom

MARK = "skinslide"  # in the customData of a property
VALUES = ("default", "timeSamples", "spline")  # of an attribute
_TARGETS = "targetPaths"  # of a relationship


def mark(spec: Sdf.PropertySpec) -> None:
    """Says that the values of an attribute, or the targets of a relationship, are a bake's."""
    spec.SetInfoDictionaryValue("customData", MARK, "baked")


def is_marked(spec: Sdf.PropertySpec) -> bool:
    return MARK in (spec.GetInfo("customData") or {})


def has_values(spec: Sdf.PropertySpec) -> bool:
    return any(map(spec.HasInfo, (*VALUES, _TARGETS)))


def baked_layer(prim: Usd.Prim) -> Sdf.Layer | None:
    """The layer of an earlier bake that the points of a mesh, or their default value, come from.

    Be it through value clips: then what is marked there has no values of its own.
    """
    stack = UsdGeom.PointBased(prim).GetPointsAttr().GetPropertyStack()
    opinions = [spec for spec in stack if has_values(spec) or is_marked(spec)]
    strongest = opinions[:1] + [spec for spec in opinions if spec.HasInfo("default")][:1]
    return next((spec.layer for spec in strongest if is_marked(spec)), None)
