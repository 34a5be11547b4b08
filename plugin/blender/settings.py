"""Settings of an object and its patches: Blender properties as the schema declares them, made from the core's table."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

import skinslide
from skinslide.arrays.fetched import Asset, Value
from skinslide.arrays.schema import Input, inputs

# Called with an object whose set-up has changed.
on_change: list[Callable[[bpy.types.Object], None]] = []


def _changed(settings: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    tell(settings.id_data)


def tell(thing: bpy.types.Object) -> None:
    """Tells all of on_change that the set-up of an object has changed."""
    for call in on_change:
        call(thing)


def title(name: str) -> str:
    """One of the core's names as Blender shows names."""
    return re.sub(r"(?<!^)([A-Z])", r" \1", name).title()


def _declarations() -> dict[str, dict[str, str]]:
    """The schema's title and documentation of each property."""
    text = (Path(skinslide.__file__).parent / "schema" / "generatedSchema.usda").read_text(encoding="utf-8")
    declared = (
        r'skinSlide:(?:__INSTANCE_NAME__:)?(\w+)(?: = [^\n]*)? \(\n.*?userDocBrief = "(.*?)"\n.*?displayName = "(.*?)"'
    )
    return {
        name: {"name": title, "description": said.removesuffix(".")}  # Blender ends a tooltip with a full stop
        for name, said, title in re.findall(declared, text, re.DOTALL)
    }


_DECLARATIONS = _declarations()


def _property(source: Input) -> Any:
    """The Blender property that holds an input; None if it is painted, or not a setting."""
    words: dict[str, Any] = {"update": _changed, **_DECLARATIONS.get(source.name, {})}
    if source.is_primvar or source.name in ("points", "restPoints", "edges", "edgeForceDensities"):
        return None
    if source.tokens:
        items = [(token, title(token), "") for token in source.tokens]
        return bpy.props.EnumProperty(items=items, default=source.fallback or source.tokens[0], **words)
    if source.type_name == "float":
        return bpy.props.FloatProperty(default=float(source.fallback or 0), precision=3, **words)
    if source.type_name == "bool":
        return bpy.props.BoolProperty(default=source.fallback == "1", **words)
    if source.type_name == "int[]":
        return bpy.props.IntVectorProperty(size=4, min=0, **words)
    if source.type_name == "asset":
        return bpy.props.StringProperty(subtype="FILE_PATH", **words)
    return bpy.props.StringProperty(default=source.fallback or "", **words)


def _declared(group: str) -> dict[str, Any]:
    found = {each.name: _property(each) for each in inputs(group) if each.prefix == "skinSlide:"}
    return {name: made for name, made in found.items() if made is not None}


class SkinslidePatch(bpy.types.PropertyGroup):
    """A patch, of the name that Blender gives every item of a collection."""

    __annotations__ = _declared("patch") | _declared("controls")


class SkinslideObject(bpy.types.PropertyGroup):
    """What a mesh object has."""

    __annotations__ = {
        **_declared("mesh"),
        "patches": bpy.props.CollectionProperty(type=SkinslidePatch),
        "active": bpy.props.IntProperty(name="Active Patch"),
        "slid": bpy.props.PointerProperty(
            type=bpy.types.Object, name="Slid", description="The object that shows it slid"
        ),
        "false_colours": bpy.props.BoolProperty(
            name="Stretch",
            default=True,
            update=_changed,
            description="Colours the slid skin by the RMS of log(length / rest length) around each point. Material "
            "Preview shows it, and the Solid view with its Color set to Attribute",
        ),
        "most_stretch": bpy.props.FloatProperty(
            name="Most Stretch",
            default=0.5,
            min=1e-3,
            update=_changed,
            description="The stretch that has the hottest colour",
        ),
        "problem": bpy.props.StringProperty(name="Problem", description="Why the skin does not slide"),
        "file": bpy.props.StringProperty(
            name="File", subtype="FILE_PATH", description="The .skinslide file of the set-up"
        ),
        "prim": bpy.props.StringProperty(name="Prim", description="The path of the mesh in the cache below that file"),
    }


def of(thing: bpy.types.Object) -> Any:
    """The settings of an object."""
    return thing.skinslide


def active_patch(thing: bpy.types.Object) -> Any:
    """The active patch, or None."""
    own = of(thing)
    return own.patches[own.active] if 0 <= own.active < len(own.patches) else None


def set_inputs(settings: Any, *groups: str) -> Iterator[Input]:
    """The inputs that were set, and not left to their fallbacks."""
    for group in groups:
        for each in inputs(group):
            known = each.prefix == "skinSlide:" and each.name in settings.bl_rna.properties
            if known and settings.is_property_set(each.name):
                yield each


def value_of(settings: Any, source: Input, name: str) -> Value:
    """A setting as a scene would hold it, under a name."""
    held = getattr(settings, source.name)
    kinds: dict[str, Callable[[Any], Any]] = {
        "float": np.float32,
        "bool": np.bool_,
        "asset": lambda path: Asset(bpy.path.abspath(path)),
        "int[]": lambda numbers: np.array(numbers, np.int32),
    }
    return Value(name, kinds.get(source.type_name, str)(held), source.type_name)


def register() -> None:
    """Gives objects their settings."""
    bpy.utils.register_class(SkinslidePatch)
    bpy.utils.register_class(SkinslideObject)
    bpy.types.Object.skinslide = bpy.props.PointerProperty(type=SkinslideObject)


def unregister() -> None:
    """Removes them."""
    del bpy.types.Object.skinslide
    bpy.utils.unregister_class(SkinslideObject)
    bpy.utils.unregister_class(SkinslidePatch)
