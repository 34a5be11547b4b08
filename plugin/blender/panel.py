"""The panel in the sidebar: patches of the active mesh, what is painted and set, rest, the live switch and files."""

from __future__ import annotations

from typing import Any

import bpy

from . import settings
from .paint import PAINTED
from .rest import REST

# Settings that the panel shows, those of maps and of the plane's outline folded away.
_SHOWN = ("forceDensityRule", "interpolation", "holes", "grow", "envelope", "stretchResponse", "compressionResponse")
_FOLDED = ("paintChannel", "boundary", "weightMap", "weightMapChannel", "forceDensityMap", "forceDensityMapChannel",
           "holdMap", "holdMapChannel", "mapSt")  # fmt: skip


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
        """Of meshes alone."""
        return bool(context.active_object and context.active_object.type == "MESH")

    def draw(self, context: bpy.types.Context) -> None:
        """All of it."""
        thing = context.active_object
        own, patch = settings.of(thing), settings.active_patch(thing)
        layout = self.layout
        layout.template_list("SKINSLIDE_UL_patches", "", own, "patches", own, "active")
        row = layout.row(align=True)
        row.operator("skinslide.patch_from_faces", text="From Faces")
        row.operator("skinslide.patch_from_group", text="From Group")
        row.operator("skinslide.remove_patch", text="", icon="REMOVE")
        if patch:
            _draw_patch(layout, thing, patch)
        rest = layout.row(align=True)
        rest.label(text="Rest: " + ("kept" if REST in thing.data.attributes else "the mesh itself"))
        rest.operator("skinslide.rest_from_basis", text="Basis")
        rest.operator("skinslide.rest_from_frame", text="Frame").frame = context.scene.frame_current
        layout.operator("skinslide.live", text="Live", depress=bool(own.slid), icon="PLAY")
        if own.slid:
            row = layout.row()
            row.prop(own, "false_colours")
            row.prop(own, "most_stretch")
        if own.problem:
            problem = layout.column()
            problem.alert = True
            for line in own.problem.splitlines():
                problem.label(text=line, icon="ERROR")
        row = layout.row(align=True)
        row.operator("skinslide.import_setup", text="Import")
        row.operator("skinslide.export_setup", text="Export")


def _draw_patch(layout: Any, thing: bpy.types.Object, patch: Any) -> None:
    column = layout.column(align=True)
    for name in _SHOWN:
        column.prop(patch, name)
    header, body = layout.panel("skinslide_more", default_closed=True)
    header.label(text="More")
    for name in _FOLDED if body else ():
        body.prop(patch, name)
    paint = layout.column(align=True)
    for what in PAINTED:
        name = f"skinSlide:{patch.name}:{what}"
        row = paint.row(align=True)
        row.label(
            text=what, icon="CHECKMARK" if name in thing.vertex_groups or name in thing.data.attributes else "DOT"
        )
        row.operator("skinslide.paint", text="Paint").what = what
    row = layout.row(align=True)
    row.operator("skinslide.paint_edges", text="Edges")
    row.operator("skinslide.paint_curve", text="Curve")


_CLASSES = (SKINSLIDE_UL_patches, SKINSLIDE_PT_panel)


def register() -> None:
    """Shows the panel."""
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Takes it away."""
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
