"""The panel in the sidebar: patches of the active mesh, what is painted and set, rest, the live switch and files."""

from __future__ import annotations

from textwrap import wrap
from typing import Any

import bpy

from . import settings
from .paint import PAINTED
from .rest import REST

_CHARACTER = 8  # pixels, about
# Settings that the panel shows, with names that fit; then those that are folded away.
_SHOWN = {
    "forceDensityRule": "Rule", "interpolation": "Interp.", "holes": "Holes", "grow": "Grow",
    "envelope": "Envelope",
}  # fmt: skip
_FOLDED = {
    "stretchResponse": "Stretch", "compressionResponse": "Compression", "boundary": "Boundary",
    "paintChannel": "Channel", "weightMap": "Weight Map", "weightMapChannel": "Channel",
    "forceDensityMap": "Density Map", "forceDensityMapChannel": "Channel", "holdMap": "Hold Map",
    "holdMapChannel": "Channel", "mapSt": "UV Map",
}  # fmt: skip


class SKINSLIDE_UL_patches(bpy.types.UIList):
    """The patches, by name."""

    def draw_item(
        self, _context: Any, layout: Any, _data: Any, item: Any, _icon: Any, _active: Any, _active_name: Any
    ) -> None:
        """A row."""
        layout.label(text=item.name, icon="MESH_DATA")
        layout.label(text=item.forceDensityRule)


class SKINSLIDE_PT_panel(bpy.types.Panel):
    """The panel."""

    bl_label, bl_idname = "Skinslide", "SKINSLIDE_PT_panel"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Skinslide"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only for meshes."""
        return bool(context.active_object and context.active_object.type == "MESH")

    def draw(self, context: bpy.types.Context) -> None:
        """From top to bottom in the order of work: patches, their settings, paint, rest, what is shown, files."""
        thing = context.active_object
        own, patch = settings.of(thing), settings.active_patch(thing)
        layout = self.layout
        row = layout.row()
        row.template_list("SKINSLIDE_UL_patches", "", own, "patches", own, "active", rows=3)
        row.operator("skinslide.remove_patch", text="", icon="REMOVE")
        row = layout.row(align=True)
        row.operator("skinslide.patch_from_faces", text="From Faces", icon="FACESEL")
        row.operator("skinslide.patch_from_group", text="From Group", icon="GROUP_VERTEX")
        if patch:
            _draw_settings(layout, patch)
            _draw_paint(layout, thing, patch)
        _draw_rest(layout, thing, context.scene)
        layout.operator("skinslide.live", text="Live", depress=bool(own.slid), icon="PLAY")
        if own.slid:
            row = layout.row(align=True)
            row.prop(own, "false_colours", text="Stretch, up to", toggle=True)
            row.prop(own, "most_stretch", text="")
        _draw_problem(layout, own.problem, context)
        row = layout.row(align=True)
        row.operator("skinslide.import_setup", text="Import", icon="IMPORT")
        row.operator("skinslide.export_setup", text="Export", icon="EXPORT")


def _draw_settings(layout: Any, patch: Any) -> None:
    column = layout.column(align=True)
    for name, text in _SHOWN.items():
        column.prop(patch, name, text=text)
    header, body = layout.panel("skinslide_more", default_closed=True)
    header.label(text="More Settings")
    for name, text in _FOLDED.items() if body else ():
        body.prop(patch, name, text=text)


def _draw_paint(layout: Any, thing: bpy.types.Object, patch: Any) -> None:
    column = layout.column(align=True)
    column.label(text="Paint")
    for what in PAINTED:
        name = f"skinSlide:{patch.name}:{what}"
        is_painted = name in thing.vertex_groups or name in thing.data.attributes
        button = column.operator(
            "skinslide.paint", text=settings.title(what), icon="CHECKMARK" if is_painted else "DOT"
        )
        button.what = what
    row = column.row(align=True)
    row.operator("skinslide.paint_edges", text="Edges", icon="EDGESEL")
    row.operator("skinslide.paint_curve", text="Curve", icon="CURVE_DATA")


def _draw_rest(layout: Any, thing: bpy.types.Object, scene: bpy.types.Scene) -> None:
    column = layout.column(align=True)
    column.label(text="Rest: " + ("kept" if REST in thing.data.attributes else "the mesh itself"))
    row = column.row(align=True)
    row.operator("skinslide.rest_from_basis", text="Basis", icon="SHAPEKEY_DATA")
    row.operator("skinslide.rest_from_frame", text="Frame", icon="TIME").frame = scene.frame_current


def _draw_problem(layout: Any, problem: str, context: bpy.types.Context) -> None:
    """Breaks text into lines that fit the width of the sidebar."""
    column = layout.column(align=True)
    column.alert = True
    width = max(20, context.region.width // _CHARACTER) if context.region else 40
    for index, line in enumerate(line for said in problem.splitlines() for line in wrap(said, width)):
        column.label(text=line, icon="BLANK1" if index else "ERROR")


_CLASSES = (SKINSLIDE_UL_patches, SKINSLIDE_PT_panel)


def register() -> None:
    """Registers the panel."""
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Unregisters it."""
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
