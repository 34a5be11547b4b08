"""The live switch: an object that shows another one's mesh slid, at each frame that the timeline comes to.

Points are fetched as Blender changes them, slid apart, and shown when they are there: of frames that come faster than
they can be slid, the last one counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
from bpy.app.handlers import persistent

from skinslide.arrays.canvas import false_colour
from skinslide.problems import Fault

from . import settings, work
from .fetch import evaluated_points, fetch, numbers
from .reading import Fetched, Numbers, Slid, Sliding
from .work import INTERVAL, Waiting, start, stop

STRETCH = "skinSlide:stretch"  # the colour attribute of the slid object
MATERIAL = "skinslide stretch"
SHADES = 256


@dataclass
class Session:
    """A live object: its slider, which is made on the thread that slides, and the frame that is being slid."""

    name: str
    sliding: Sliding | None = None
    future: Future[Slid] | None = None
    brings: bool = False  # the frame comes with a new set-up
    stale: bool = False  # paint or settings have changed since the last set-up

    def slide(self, fetched: Fetched | None, points: np.ndarray, own: Numbers) -> Slid:
        """Slides a frame, with a new set-up or the last one. Raises Fault."""
        if fetched:
            self.sliding = None
            self.sliding = Sliding(fetched)
        if not self.sliding:
            raise Fault("there is nothing to slide by")
        return self.sliding.slide(points, own)

    def fits(self, thing: bpy.types.Object) -> bool:
        """Whether the slider is up to date with the set-up."""
        names = [patch.name for patch in settings.of(thing).patches]
        return not self.stale and self.sliding is not None and self.sliding.names == names

    def drop(self) -> None:
        """Drops a frame that is not begun yet, but remembers the set-up that it came with."""
        if self.future and self.future.cancel():
            self.stale = self.stale or self.brings


_sessions: dict[str, Session] = {}
_shades: list[np.ndarray] = []
_unheard = False  # whether changes are ignored, since they are not the scene's


@contextmanager
def unheard() -> Iterator[None]:
    """Ignores frames and changes meanwhile: they come from what is shown itself, or from another view of the scene."""
    global _unheard
    before, _unheard = _unheard, True
    try:
        yield
    finally:
        _unheard = before


def live_objects() -> list[bpy.types.Object]:
    """The objects whose switch is on."""
    return [each for each in bpy.data.objects if each.type == "MESH" and settings.of(each).slid]


def refresh(thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
    """Starts to slide an object as it is now."""
    session = _sessions.setdefault(thing.name, Session(thing.name))
    if thing.mode == "EDIT":  # then nothing is evaluated
        session.stale = True
        return
    session.drop()
    try:
        fetched = None if session.fits(thing) else fetch(thing, depsgraph)
        points = fetched.points if fetched else evaluated_points(thing, depsgraph)
    except Fault as fault:
        _say(thing, str(fault))
        return
    session.stale, session.brings = False, fetched is not None
    session.future = start(session.slide, fetched, points, numbers(thing))
    _show_when_done(session)


def _show_when_done(session: Session) -> None:
    assert session.future
    try:
        session.future.result(work.patience())
    except TimeoutError:
        if not bpy.app.timers.is_registered(_look):
            bpy.app.timers.register(_look, first_interval=INTERVAL)
        return
    except Exception:  # reported when it is shown
        pass
    _finish(session)


def _look() -> float | None:
    """Shows what has been slid by now, and looks again later while there is more to come."""
    for session in list(_sessions.values()):
        if session.future and session.future.done():
            _finish(session)
    return INTERVAL if any(each.future for each in _sessions.values()) else None


def _finish(session: Session) -> None:
    thing, future = bpy.data.objects.get(session.name), session.future
    session.future = None
    if thing is None or future is None or not settings.of(thing).slid:
        return
    try:
        slid = future.result()
    except (Fault, MemoryError) as fault:
        _say(thing, str(fault))
        return
    show(thing, slid)
    _say(thing, "")


def _say(thing: bpy.types.Object, said: str) -> None:
    """Keeps a fault for the panel, and reports it once."""
    own = settings.of(thing)
    if own.problem != said:
        own.problem = said
        if said and work.interactive():
            bpy.app.timers.register(lambda: bpy.ops.skinslide.say(text=said) and None)


# ---- What is shown ----


def shades() -> np.ndarray:
    """The scale of false colours, (SHADES, 4), in linear light."""
    if not _shades:
        _shades.append(np.array([(*false_colour(i / (SHADES - 1)), 1) for i in range(SHADES)], np.float32))
    return _shades[0]


def show(thing: bpy.types.Object, slid: Slid) -> None:
    """Writes slid points, and stretch in false colours, to the object that shows them."""
    own = settings.of(thing)
    mesh = own.slid.data
    with unheard():
        if len(mesh.vertices) != len(slid.points):
            _copy_mesh(thing, own.slid)
            mesh = own.slid.data
        if len(mesh.vertices) != len(slid.points):  # edited meanwhile, so it will be slid anew
            return
        mesh.vertices.foreach_set("co", np.ascontiguousarray(slid.points).ravel())
        share = np.clip(slid.stretch / own.most_stretch, 0, 1)
        colours = shades()[np.rint(share * (SHADES - 1)).astype(np.int64)]
        mesh.attributes[STRETCH].data.foreach_set("color", colours.ravel())
        mesh.update()
        if own.slid.matrix_world != thing.matrix_world:
            own.slid.matrix_world = thing.matrix_world
        _dress(thing, own.slid)


def _copy_mesh(thing: bpy.types.Object, shown: bpy.types.Object) -> None:
    before, shown.data = shown.data, _plain_copy(thing)
    if before and not before.users:
        bpy.data.meshes.remove(before)


def _plain_copy(thing: bpy.types.Object) -> bpy.types.Mesh:
    """The mesh of an object, without its shape keys."""
    mesh = bpy.data.meshes.new_from_object(thing)
    mesh.name = f"{thing.data.name} slid"
    colours = mesh.color_attributes.new(STRETCH, "FLOAT_COLOR", "POINT")
    mesh.color_attributes.active_color = colours
    return mesh


def _dress(thing: bpy.types.Object, shown: bpy.types.Object) -> None:
    """The material of false colours, or the object's own."""
    own = (
        [_stretch_material()] if settings.of(thing).false_colours else [slot.material for slot in thing.material_slots]
    )
    if [slot.material for slot in shown.material_slots] == own:
        return
    shown.data.materials.clear()
    for material in own:
        shown.data.materials.append(material)


def _stretch_material() -> bpy.types.Material:
    found = bpy.data.materials.get(MATERIAL)
    if found:
        return found
    material = bpy.data.materials.new(MATERIAL)
    if not material.node_tree:  # Blender 5 has made one
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = STRETCH
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    links.new(attribute.outputs["Color"], surface.inputs["Base Color"])
    return material


# ---- The switch ----


class SKINSLIDE_OT_live(Waiting):
    """Shows the skin slid as the timeline moves, on an object beside the mesh; press again to end that."""

    bl_idname, bl_label = "skinslide.live", "Live"

    def fetch(self, context: bpy.types.Context) -> Any:
        """Fetches what is to be slid, unless the switch ends it."""
        thing = context.active_object
        if thing and settings.of(thing).slid:
            return None
        depsgraph = context.evaluated_depsgraph_get()
        fetched, own, session = fetch(thing, depsgraph), numbers(thing), Session(thing.name)
        return lambda: (session, session.slide(fetched, fetched.points, own))

    def write(self, context: bpy.types.Context, found: Any) -> str:
        """Makes the object, or removes it."""
        thing = context.active_object
        if found is None:
            switch_off(thing)
            return ""
        session, slid = found
        _sessions[thing.name] = session
        shown = bpy.data.objects.new(f"{thing.name} slid", _plain_copy(thing))
        for collection in thing.users_collection:
            collection.objects.link(shown)
        settings.of(thing).slid = shown
        _veil(thing, True)
        show(thing, slid)
        return "; ".join(session.sliding.warnings if session.sliding else ()) or _summary(slid)


def _veil(thing: bpy.types.Object, veiled: bool) -> None:
    """Draws an object as its bounds, and hides it from rays. If it were hidden, Blender would not evaluate it."""
    thing.display_type = "BOUNDS" if veiled else "TEXTURED"
    for ray in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(thing, f"visible_{ray}", not veiled)


def _make_way(thing: bpy.types.Object) -> None:
    """Draws the slid skin as wires while the mesh itself is drawn in the same place, to be painted."""
    drawn = "WIRE" if thing.mode in ("WEIGHT_PAINT", "VERTEX_PAINT", "SCULPT") else "TEXTURED"
    shown = settings.of(thing).slid
    if shown.display_type != drawn:
        shown.display_type = drawn


def _summary(slid: Slid) -> str:
    before, after = (
        np.mean([getattr(each, name) for each in slid.patches]) for name in ("stretch_before", "stretch_after")
    )
    return f"stretch {before:.3f}, slid {after:.3f}"


def switch_off(thing: bpy.types.Object) -> None:
    """Removes the slid object of another."""
    own = settings.of(thing)
    shown, own.slid, own.problem = own.slid, None, ""
    _sessions.pop(thing.name, None)
    _veil(thing, False)
    if shown:
        mesh = shown.data
        bpy.data.objects.remove(shown)
        if mesh and not mesh.users:
            bpy.data.meshes.remove(mesh)


class SKINSLIDE_OT_say(bpy.types.Operator):
    """Reports what went wrong apart from any operator."""

    bl_idname, bl_label, bl_options = "skinslide.say", "Say", {"INTERNAL"}
    text: bpy.props.StringProperty()  # type: ignore[valid-type]

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """Reports the text."""
        self.report({"ERROR"}, self.text)
        return {"FINISHED"}


# ---- What Blender says ----


@persistent  # type: ignore[untyped-decorator]
def _on_frame(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    for thing in () if _unheard else live_objects():
        refresh(thing, depsgraph)


@persistent  # type: ignore[untyped-decorator]
def _on_change(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """If a mesh has changed, its paint may have; if an object has, its points may have."""
    if _unheard:
        return
    changed = {each.id.original for each in depsgraph.updates if each.is_updated_geometry}
    for thing in live_objects():
        _make_way(thing)
        if thing.data in changed:
            _stale(thing)
        elif thing in changed:
            refresh(thing, depsgraph)


def _stale(thing: bpy.types.Object) -> None:
    """Called when the set-up of an object has changed."""
    if thing.type == "MESH" and settings.of(thing).slid:
        _sessions.setdefault(thing.name, Session(thing.name)).stale = True
        refresh(thing, bpy.context.evaluated_depsgraph_get())


@persistent  # type: ignore[untyped-decorator]
def _on_other_data(*_: Any) -> None:
    """After a file is loaded or a step undone, anything may have changed."""
    _sessions.clear()
    for thing in live_objects():
        refresh(thing, bpy.context.evaluated_depsgraph_get())


_HANDLERS = {
    "frame_change_post": _on_frame,
    "depsgraph_update_post": _on_change,
    "load_post": _on_other_data,
    "undo_post": _on_other_data,
    "redo_post": _on_other_data,
}


def register() -> None:
    """Registers the operators, and handlers for frames and changes."""
    for each in (SKINSLIDE_OT_live, SKINSLIDE_OT_say):
        bpy.utils.register_class(each)
    settings.on_change.append(_stale)
    for name, call in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(call)


def unregister() -> None:
    """Unregisters them."""
    for name, call in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(call)
    settings.on_change.remove(_stale)
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)
    for each in (SKINSLIDE_OT_say, SKINSLIDE_OT_live):
        bpy.utils.unregister_class(each)
    _sessions.clear()
    stop()
