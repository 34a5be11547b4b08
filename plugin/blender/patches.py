"""Patches of a mesh: made of selected faces or of a group of vertices, and removed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import count
from typing import Any

import bpy
import numpy as np

from skinslide.arrays.fetched import Value
from skinslide.arrays.schema import can_name_patch, input_of
from skinslide.problems import NO_PATCH_NAME, Fault

from . import settings
from .fetch import EDGES, INTERPOLATIONS, KINDS, fetch, group_weights
from .reading import Fetched, FetchedPatch, check_one_piece
from .work import Waiting, asked

RULE = "even"  # of new patches
_LONGEST = 63  # bytes of the name of a vertex group
FACES = input_of("patch", "patch")  # what chooses them


def check_fits(patch: str) -> None:
    """Raises Fault for a name of a patch so long that Blender would cut the names of its paint short."""
    if len(f"skinSlide:{patch}:{EDGES}".encode()) > _LONGEST:
        raise Fault(f"the name {patch} is too long for what Blender calls attributes and vertex groups")


def check_name(thing: bpy.types.Object, name: str) -> None:
    """Raises Fault for a name that a patch cannot have, or that another has."""
    check_fits(name)
    if not all(part.isidentifier() for part in name.split(":")) or not can_name_patch(name):
        raise Fault(f"{name!r} {NO_PATCH_NAME}")
    if name in settings.of(thing).patches:
        raise Fault(f"{thing.name} has a patch {name} already")


def free_name(thing: bpy.types.Object, wanted: str) -> str:
    """A name like the wanted one, that a patch can have and no other has."""
    word = re.sub(r"\W", "_", wanted, flags=re.ASCII)
    word = word if word.isidentifier() else f"patch_{word}"
    names = (f"{word}_{number}" if number > 1 else word for number in count(1))
    return next(name for name in names if name not in settings.of(thing).patches)


class _NewPatch(Waiting):
    """Makes a patch, once it is known that it can slide."""

    name: bpy.props.StringProperty(name="Name", default="patch", options={"SKIP_SAVE"})  # type: ignore[valid-type]

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Proposes a name, and asks for it."""
        self.name = free_name(context.active_object, self.name)
        return asked(self, context)

    def chosen(self, context: bpy.types.Context) -> Value:
        """What chooses the faces. Raises Fault."""
        raise NotImplementedError

    def fetch(self, context: bpy.types.Context) -> Callable[[], Any]:
        """The mesh with the patch, as if it were there."""
        thing = context.active_object
        fetched = fetch(thing, context.evaluated_depsgraph_get())
        check_name(thing, self.name)
        chosen = self.chosen(context)
        return partial(_checked, _with_patch(fetched, self.name, chosen), chosen)

    def write(self, context: bpy.types.Context, found: Value) -> str:
        """Makes it."""
        thing = context.active_object
        write_primvar(thing.data, found)
        own = settings.of(thing)
        patch = own.patches.add()
        patch.name, patch.forceDensityRule = self.name, RULE
        own.active = len(own.patches) - 1
        settings.tell(thing)
        return f"{self.name}: a patch of {int(np.count_nonzero(found.value))} {_ELEMENTS[found.interpolation or '']}"


def _checked(fetched: Fetched, chosen: Value) -> Value:
    check_one_piece(fetched)
    return chosen


_ELEMENTS = {"uniform": "faces", "vertex": "points"}


def _with_patch(fetched: Fetched, name: str, chosen: Value) -> Fetched:
    rule = Value(f"skinSlide:{name}:forceDensityRule", RULE, "token")
    patch = FetchedPatch(name, {"forceDensityRule": rule})
    return replace(fetched, patches=(patch,), primvars=fetched.primvars | {chosen.name: chosen})


class SKINSLIDE_OT_patch_from_faces(_NewPatch):
    """Makes a patch of the selected faces."""

    bl_idname, bl_label = "skinslide.patch_from_faces", "Patch from Selected Faces"

    def chosen(self, context: bpy.types.Context) -> Value:
        """The selection."""
        mesh = context.active_object.data
        selected = np.empty(len(mesh.polygons), np.bool_)
        mesh.polygons.foreach_get("select", selected)
        if not selected.any():
            raise Fault("no face is selected")
        return Value(FACES.property(self.name), selected, "bool[]", "uniform")


def _groups(_operator: Any, context: bpy.types.Context, _text: str) -> list[str]:
    return [group.name for group in context.active_object.vertex_groups]


class SKINSLIDE_OT_patch_from_group(_NewPatch):
    """Makes a patch of the faces whose points are all in a vertex group, with weights above 0."""

    bl_idname, bl_label = "skinslide.patch_from_group", "Patch from Vertex Group"
    group: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Vertex Group", search=_groups, options={"SKIP_SAVE"}, description="Empty: the active one"
    )

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for the group and the name, by default that of the active group."""
        active = context.active_object.vertex_groups.active
        if active:
            self.group = self.name = active.name
        return super().invoke(context, event)

    def chosen(self, context: bpy.types.Context) -> Value:
        """The weights of the group."""
        thing = context.active_object
        group = thing.vertex_groups.get(self.group) if self.group else thing.vertex_groups.active
        if group is None:
            raise Fault(f"{thing.name} has no vertex group {self.group}" if self.group else "no vertex group is active")
        (weights,) = group_weights(thing, [group])
        return Value(FACES.property(self.name), weights, "float[]", "vertex")


class SKINSLIDE_OT_remove_patch(Waiting):
    """Removes the active patch, and all that is painted for it."""

    bl_idname, bl_label = "skinslide.remove_patch", "Remove Patch"

    @classmethod
    def need(cls, context: bpy.types.Context) -> None:
        """Raises Fault if there is no patch."""
        super().need(context)
        if not settings.active_patch(context.active_object):
            raise Fault("there is no patch")

    def fetch(self, context: bpy.types.Context) -> None:
        """Nothing is worked out."""

    def write(self, context: bpy.types.Context, _found: None) -> str:
        """Removes it."""
        thing = context.active_object
        own = settings.of(thing)
        remove_paint(thing, settings.active_patch(thing).name)
        own.patches.remove(own.active)
        own.active = max(0, own.active - 1)
        settings.tell(thing)
        return ""


def remove_paint(thing: bpy.types.Object, patch: str) -> None:
    """Removes all that is painted for a patch under the schema's names."""
    mine = f"skinSlide:{patch}:"
    for name in [each.name for each in thing.data.attributes if each.name.startswith(mine)]:
        if ":" not in name.removeprefix(mine):
            thing.data.attributes.remove(thing.data.attributes[name])
    for group in [each for each in thing.vertex_groups if each.name.startswith(mine)]:
        thing.vertex_groups.remove(group)


# ---- Writing paint ----

# The tables of fetch.py the other way round: Blender's domain, by interpolation; Blender's type and the property that
# holds an element, by type of element.
DOMAINS = {"varying": "POINT", **{name: domain for domain, name in INTERPOLATIONS.items() if domain != "EDGE"}}
_TYPES = {
    (np.dtype(dtype).kind, width): (kind, held)
    for kind, (held, width, dtype, _) in KINDS.items()
    if kind != "BYTE_COLOR"  # which holds less than a float
}


def write_primvar(mesh: bpy.types.Mesh, value: Value) -> None:
    """Makes an attribute of a primvar, replacing one of its name. Raises Fault for what no attribute can hold."""
    array = np.asarray(value.value)
    kind = _TYPES.get((array.dtype.kind, array.shape[1] if array.ndim == 2 else 1))
    domain = DOMAINS.get(value.interpolation or "")
    if kind is None or domain is None:
        raise Fault(
            f"{value.name} is {value.interpolation} {value.type_name}, which no attribute of Blender's can hold"
        )
    write_attribute(mesh, value.name.removeprefix("primvars:"), domain, kind, array)


def write_weights(thing: bpy.types.Object, name: str, weights: np.ndarray) -> bpy.types.VertexGroup:
    """Makes a group of vertices with weights (V,), or sets those of one that exists."""
    group = thing.vertex_groups.get(name) or thing.vertex_groups.new(name=name)
    order, each = np.argsort(weights, kind="stable"), np.unique(weights)
    for weight, vertices in zip(each.tolist(), np.split(order, np.searchsorted(weights[order], each[1:])), strict=True):
        group.add(vertices.tolist(), weight, "REPLACE")
    return group


def write_attribute(
    mesh: bpy.types.Mesh, name: str, domain: str, kind: tuple[str, str], array: np.ndarray
) -> bpy.types.Attribute:
    """Makes an attribute of a domain, and of a type with the property that holds an element."""
    before = mesh.attributes.get(name)
    if before:
        mesh.attributes.remove(before)
    attribute = mesh.attributes.new(name, kind[0], domain)
    if attribute is None or attribute.name != name:
        raise Fault(f"the mesh cannot have an attribute {name}: another thing of that name is in its place")
    flat: np.ndarray = np.ascontiguousarray(
        array, {"b": np.bool_, "i": np.int32}.get(array.dtype.kind, np.float32)
    ).ravel()
    attribute.data.foreach_set(kind[1], flat)
    mesh.update_tag()
    return attribute


_CLASSES = (SKINSLIDE_OT_patch_from_faces, SKINSLIDE_OT_patch_from_group, SKINSLIDE_OT_remove_patch)


def register() -> None:
    """Registers the operators."""
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Unregisters them."""
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
