"""Frames of a mesh as USD, each by Blender's own exporter, so that Blender stays in use between two of them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from skinslide.problems import Fault

from .live import unheard


def export_frame(context: bpy.types.Context, path: str, frame: int, *, materials: bool) -> None:
    """Exports only the active object, as it is at a frame of an animation. Raises Fault."""
    with unheard(), _selected_alone(context), _frame_alone(context.scene, frame):
        try:
            bpy.ops.wm.usd_export(
                filepath=path,
                check_existing=False,
                selected_objects_only=True,
                export_animation=True,
                export_shapekeys=False,
                export_armatures=False,
                export_materials=materials,
                export_textures_mode="KEEP",
                convert_world_material=False,
                evaluation_mode="VIEWPORT",
            )
        except RuntimeError as error:
            raise Fault(str(error).strip()) from error
    if not os.path.exists(path):
        raise Fault(f"Blender did not export {context.active_object.name}")


@contextmanager
def _frame_alone(scene: bpy.types.Scene, frame: int) -> Iterator[None]:
    before = scene.frame_start, scene.frame_end
    scene.frame_start = scene.frame_end = frame
    try:
        yield
    finally:
        scene.frame_start, scene.frame_end = before


@contextmanager
def _selected_alone(context: bpy.types.Context) -> Iterator[None]:
    before = [each for each in context.view_layer.objects if each.select_get()]
    if before == [context.active_object]:  # so nothing is drawn anew
        yield
        return
    for each in before:
        each.select_set(False)
    context.active_object.select_set(True)
    try:
        yield
    finally:
        context.active_object.select_set(False)
        for each in before:
            each.select_set(True)
