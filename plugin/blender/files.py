"""Import and export of `.skinslide` set-ups, the export with a USD cache beside it if that is wanted."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import bpy
import numpy as np
from bpy_extras.io_utils import ExportHelper, ImportHelper

from skinslide.arrays.fetched import Value
from skinslide.arrays.schema import inputs
from skinslide.problems import Fault

from . import settings
from .cache import export_frame
from .fetch import EDGES, edge_keys, edges_of, fetch
from .joining import Joined
from .patches import check_fits, remove_paint, write_attribute, write_primvar, write_weights
from .reading import Sliding
from .rest import REST
from .usd import Keys, Read, read_setup, write_setup
from .work import Steps, Waiting, Work

EXTENSION = ".skinslide"
_PRIM = {"name": "Prim", "description": "The mesh in the stage; empty: the one with these faces"}


class SKINSLIDE_OT_import_setup(Waiting, ImportHelper):
    """Imports the patches of a .skinslide file to the active mesh, in place of its own."""

    bl_idname, bl_label = "skinslide.import_setup", "Import Set-up"
    filename_ext = EXTENSION
    filter_glob: bpy.props.StringProperty(default=f"*{EXTENSION};*.usd*", options={"HIDDEN"})  # type: ignore[valid-type]
    prim: bpy.props.StringProperty(**_PRIM)  # type: ignore[valid-type]

    def fetch(self, context: bpy.types.Context) -> Callable[[], Read]:
        """The faces of the mesh, by which its prim is found."""
        fetched = fetch(context.active_object, context.evaluated_depsgraph_get())
        path, prim = bpy.path.abspath(self.filepath), self.prim
        bpy.utils.expose_bundled_modules()  # its pxr
        return lambda: read_setup(path, prim, fetched.counts, fetched.indices)

    def write(self, context: bpy.types.Context, found: Read) -> str:
        """Writes all that was read to the mesh."""
        thing = context.active_object
        take(thing, found)
        own = settings.of(thing)
        own.file, own.prim, own.problem = self.filepath, found.prim, ""
        settings.tell(thing)
        for each in found.left:
            self.report({"WARNING"}, each)
        return f"{len(found.patches)} patches of {found.prim}"


def take(thing: bpy.types.Object, read: Read) -> None:
    """Gives an object the set-up that was read, in place of any other."""
    own, mesh = settings.of(thing), thing.data
    for fetched in read.patches:
        check_fits(fetched.name)
    for patch in own.patches:
        remove_paint(thing, patch.name)
    own.patches.clear()
    own.active = 0
    for source in settings.set_inputs(own, "mesh"):
        own.property_unset(source.name)
    for value in read.values:
        if value.name != REST:
            setattr(own, value.name.removeprefix("skinSlide:"), _held(value.value))
    write_attribute(mesh, REST, "POINT", ("FLOAT_VECTOR", "vector"), read.rest)
    for value in read.primvars:
        _take_primvar(thing, value)
    for index, fetched in enumerate(read.patches):
        patch = own.patches.add()
        patch.name = fetched.name
        for name, value in fetched.values.items():
            if name in patch.bl_rna.properties:
                setattr(patch, name, _held(value.value))
        _take_edges(mesh, fetched.name, fetched.values)
        _take_keys(thing, index, fetched.name, read.keys)


def _take_primvar(thing: bpy.types.Object, value: Value) -> None:
    """Weights of 0 to 1 become a group of vertices, for which Blender has brushes; all else an attribute."""
    array = np.asarray(value.value)
    for_brushes = value.name.endswith(":weight") and value.interpolation in ("vertex", "varying") and array.ndim == 1
    if not (for_brushes and array.dtype == np.float32 and np.all((array >= 0) & (array <= 1))):
        write_primvar(thing.data, value)
        return
    write_weights(thing, value.name.removeprefix("primvars:"), array)


def _held(value: Any) -> Any:
    """A value as Blender's properties take it."""
    return str(value) if isinstance(value, str) else np.asarray(value).tolist()


def _take_edges(mesh: bpy.types.Mesh, patch: str, values: dict[str, Value]) -> None:
    if "edges" not in values or EDGES not in values:
        return
    pairs, factors = np.asarray(values["edges"].value).reshape(-1, 2), np.asarray(values[EDGES].value)
    keys, wanted = (edge_keys(each, len(mesh.vertices)) for each in (edges_of(mesh), pairs))
    order = np.argsort(keys)
    found = order[np.searchsorted(keys, wanted, sorter=order).clip(max=len(keys) - 1)]
    for a, b in pairs[keys[found] != wanted][:1]:
        raise Fault(f"patch {patch}: the mesh has no edge {a}-{b}")
    held = np.zeros(len(mesh.edges), np.float32)
    held[found] = factors
    write_attribute(mesh, f"skinSlide:{patch}:{EDGES}", "EDGE", ("FLOAT", "value"), held)


# ---- Animation ----


def _take_keys(thing: bpy.types.Object, index: int, patch: str, keys: Keys) -> None:
    for (of, name), samples in keys.items():
        if of != patch:
            continue
        path = f"skinslide.patches[{index}].{name}"
        for time, number in samples:
            setattr(settings.of(thing).patches[index], name, number)
            thing.keyframe_insert(path, frame=time)
        for point in next(curve for curve in _curves(thing) if curve.data_path == path).keyframe_points:
            point.interpolation = "LINEAR"


def _curves(thing: bpy.types.Object) -> Iterator[bpy.types.FCurve]:
    animated = thing.animation_data
    for layer in animated.action.layers if animated and animated.action else ():
        for strip in layer.strips:
            bag = strip.channelbag(animated.action_slot)
            yield from bag.fcurves if bag else ()


def fetch_keys(thing: bpy.types.Object) -> Keys:
    """What is animated on patches: the keys if lines join them, else every frame from the first to the last."""
    found: Keys = {}
    for curve in _curves(thing):
        for index, patch in enumerate(settings.of(thing).patches):
            for source in inputs("controls"):
                if curve.data_path == f"skinslide.patches[{index}].{source.name}" and source.type_name == "float":
                    found[patch.name, source.name] = [(time, curve.evaluate(time)) for time in _times(curve)]
    return found


def _times(curve: bpy.types.FCurve) -> list[float]:
    times = [float(point.co[0]) for point in curve.keyframe_points]
    straight = all(point.interpolation == "LINEAR" for point in curve.keyframe_points) and not curve.modifiers
    return times if straight else [float(time) for time in range(int(times[0]), int(np.ceil(times[-1])) + 1)]


# ---- Export ----


class SKINSLIDE_OT_export_setup(Waiting, ExportHelper):
    """Exports the patches of the active mesh, to a file beside a USD cache; everything else in that file stays."""

    bl_idname, bl_label = "skinslide.export_setup", "Export Set-up"
    filename_ext = EXTENSION
    filter_glob: bpy.props.StringProperty(default=f"*{EXTENSION}", options={"HIDDEN"})  # type: ignore[valid-type]
    cache: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Cache", subtype="FILE_PATH", description="The USD cache; empty: the one of the same name beside the file"
    )
    with_cache: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Export Cache",
        default=True,
        description="Also exports the animated mesh there, frame by frame, with Blender's own exporter",
    )
    prim: bpy.props.StringProperty(**_PRIM)  # type: ignore[valid-type]

    def steps(self, context: bpy.types.Context) -> Steps:
        """Makes the cache, if wanted, frame by frame, and the set-up; both are put in place together."""
        thing, scene = context.active_object, context.scene
        fetched, keys = fetch(thing, context.evaluated_depsgraph_get()), fetch_keys(thing)
        path = bpy.path.abspath(self.filepath)
        cache = bpy.path.abspath(self.cache) if self.cache else path.removesuffix(EXTENSION) + ".usdc"
        prim = self.prim or (settings.of(thing).prim if not self.with_cache else "")
        bpy.utils.expose_bundled_modules()
        rest = (yield lambda: Sliding(fetched)).rest_points
        setup = partial(write_setup, path, cache, prim, fetched, rest, keys)
        if self.with_cache:
            found = yield from self._with_cache(context, range(scene.frame_start, scene.frame_end + 1), cache, setup)
        elif os.path.exists(cache):
            self.too_late = True
            found = yield setup
        else:
            raise Fault(f"there is no cache {cache}")
        own = settings.of(context.active_object)
        own.file, own.prim = self.filepath, found
        return f"{len(own.patches)} patches of {found}"

    def _with_cache(self, context: bpy.types.Context, frames: range, cache: str, setup: Work) -> Steps:
        with (yield partial(Joined, cache)) as joined:
            for frame in frames:
                self.tell(context, f"Exporting frame {frame} of {frames[-1]}; Esc ends it")
                export_frame(context, joined.part, frame, materials=frame == frames[0])
                yield partial(joined.add, frame)
            self.too_late = True
            return (yield lambda: joined.put(setup))


_CLASSES = (SKINSLIDE_OT_import_setup, SKINSLIDE_OT_export_setup)


def register() -> None:
    """Registers the operators."""
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Unregisters them."""
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
