"""The rest pose of a mesh, in which nothing slides: kept in an attribute, whatever the frame."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from skinslide.problems import Fault

from . import fetch, settings
from .patches import write_attribute
from .work import Waiting

REST = "skinSlide:restPoints"


class _Rest(Waiting):
    def write(self, context: bpy.types.Context, found: np.ndarray) -> str:
        """Keeps the points that were found."""
        write_attribute(context.active_object.data, REST, "POINT", ("FLOAT_VECTOR", "vector"), found)
        settings.of(context.active_object).problem = ""
        return ""


class SKINSLIDE_OT_rest_from_basis(_Rest):
    """Takes the basis shape key as the rest pose."""

    bl_idname, bl_label = "skinslide.rest_from_basis", "Rest from Basis"

    @classmethod
    def need(cls, context: bpy.types.Context) -> None:
        """Raises Fault if there is none."""
        super().need(context)
        if not context.active_object.data.shape_keys:
            said = "has no shape keys; without a rest of its own the mesh itself is at rest"
            raise Fault(f"{context.active_object.name} {said}")

    def fetch(self, context: bpy.types.Context) -> Any:
        """Its points."""
        thing = context.active_object
        fetch.check(thing)
        points = fetch.basis_points(thing.data)
        return lambda: points


class SKINSLIDE_OT_rest_from_frame(_Rest):
    """Takes the mesh as it is at a frame as the rest pose."""

    bl_idname, bl_label = "skinslide.rest_from_frame", "Rest from Frame"
    frame: bpy.props.IntProperty(name="Frame", default=1)  # type: ignore[valid-type]

    def fetch(self, context: bpy.types.Context) -> Any:
        """Its points there."""
        thing, scene = context.active_object, context.scene
        fetch.check(thing)
        now = scene.frame_current, scene.frame_subframe
        scene.frame_set(self.frame)
        try:
            points = fetch.evaluated_points(thing, context.evaluated_depsgraph_get())
        finally:
            scene.frame_set(now[0], subframe=now[1])
        return lambda: points


_CLASSES = (SKINSLIDE_OT_rest_from_basis, SKINSLIDE_OT_rest_from_frame)


def register() -> None:
    """Registers the operators."""
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Unregisters them."""
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
