"""Paint of a patch: weight, force density, hold and distance on points and faces, and force density on edges."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import bpy
import numpy as np

from skinslide.arrays.fetched import Value
from skinslide.arrays.geometry import Curves, edge_distances
from skinslide.arrays.schema import inputs
from skinslide.problems import NO_EDGE, Fault

from . import settings
from .fetch import EDGES, INTERPOLATIONS, edge_keys, edges_of, fetch, group_weights
from .patches import write_attribute, write_weights
from .reading import CHOOSING, Fetched, Surface, check_paint
from .work import Waiting, asked

# What is painted, and what it does.
PAINTED = {each.name: each for each in inputs("controls") if each.is_primvar}
_SAYS = {
    "weight": "How far the skin slides: 0 leaves it where the cache has it, 1 slides it fully",
    "forceDensity": "How strongly edges pull: skin with more of it stretches less. Only ratios matter",
    "hold": "How closely points follow the slide of their neighbours, under the rules even and relaxed: low where "
    "spare skin may come from, high where it must not",
    "maxDistance": "The farthest that the skin may slide, in the units of the mesh",
}
_PAINTED = [(name, settings.title(name), _SAYS.get(name, "")) for name in PAINTED]


def active_name(context: bpy.types.Context) -> str:
    """The name of the patch that is painted. Raises Fault if there is none."""
    patch = settings.active_patch(context.active_object)
    if patch is None:
        raise Fault("there is no patch to paint; make one of selected faces first")
    return str(patch.name)


def _sources(_operator: Any, context: bpy.types.Context, _text: str) -> list[str]:
    """What can be painted from."""
    thing = context.active_object
    floats = [
        each.name for each in thing.data.attributes if each.data_type == "FLOAT" and each.domain in ("POINT", "FACE")
    ]
    return [*(group.name for group in thing.vertex_groups), *floats]


class _Paint(Waiting):
    @classmethod
    def need(cls, context: bpy.types.Context) -> None:
        """Raises Fault if there is no patch."""
        super().need(context)
        active_name(context)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Asks for what is painted."""
        return asked(self, context)


class SKINSLIDE_OT_paint(_Paint):
    """Paints a value: in edit mode on the selection, else everywhere. Blender's own brushes can go on from there."""

    bl_idname, bl_label = "skinslide.paint", "Paint"
    what: bpy.props.EnumProperty(name="What", items=_PAINTED, options={"SKIP_SAVE"})  # type: ignore[valid-type]
    value: bpy.props.FloatProperty(name="Value", default=1.0, min=0.0)  # type: ignore[valid-type]
    store: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="On",
        items=[
            ("GROUP", "Vertex Group", "For Blender's weight brushes, from 0 to 1"),
            ("POINT", "Point Attribute", "Of any value"),
            ("FACE", "Face Attribute", "Of any value, by face"),
        ],
        options={"SKIP_SAVE"},
    )

    source: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="From",
        search=_sources,
        options={"SKIP_SAVE"},
        description="The vertex group or attribute to copy values from; empty: the value above",
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: Any) -> str:
        """The tooltip of a button."""
        return f"{_SAYS.get(properties.what, '')}.\n{cls.bl_description}"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for the value. Paint that may exceed 1 goes on an attribute."""
        if not self.properties.is_property_set("store"):
            self.store = "GROUP" if self.what == "weight" else "POINT"
        return super().invoke(context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Begins, of what is selected in edit mode."""
        self._editing = context.mode == "EDIT_MESH"
        return super().execute(context)

    def fetch(self, context: bpy.types.Context) -> Callable[[], np.ndarray]:
        """What the mesh would have, once painted."""
        thing, patch = context.active_object, active_name(context)
        fetched, source = fetch(thing, None), PAINTED[self.what]
        self._name = f"skinSlide:{patch}:{self.what}"
        values = _merged(thing, self._name, self.store, self._given(thing), self._editing)
        least, most = values.min(initial=0), values.max(initial=0)
        if self.store == "GROUP" and not 0 <= least <= most <= 1:
            raise Fault(f"a vertex group holds 0 to 1, not {least if least < 0 else most:g}; paint on an attribute")
        value = Value(source.property(patch), values, "float[]", INTERPOLATIONS[_DOMAINS[self.store]])
        check = partial(check_paint, fetched, patch, source, value)
        return lambda: check() or values

    def _given(self, thing: bpy.types.Object) -> np.ndarray:
        """A value for each point or face. Raises Fault."""
        if self.source:
            return _values_of(thing, self.source, _DOMAINS[self.store])
        return np.full(len(getattr(thing.data, _ELEMENTS[_DOMAINS[self.store]])), self.value, np.float32)

    def write(self, context: bpy.types.Context, found: np.ndarray) -> str:
        """Paints."""
        thing, mesh = context.active_object, context.active_object.data
        group, attribute = thing.vertex_groups.get(self._name), mesh.attributes.get(self._name)
        if self.store == "GROUP":
            if attribute:
                mesh.attributes.remove(attribute)
            thing.vertex_groups.active = write_weights(thing, self._name, found)
        else:
            if group:
                thing.vertex_groups.remove(group)
            domain = _DOMAINS[self.store]
            mesh.attributes.active = write_attribute(mesh, self._name, domain, ("FLOAT", "value"), found)
        return ""


_DOMAINS = {"GROUP": "POINT", "POINT": "POINT", "FACE": "FACE"}
_ELEMENTS = {"POINT": "vertices", "FACE": "polygons"}


def _values_of(thing: bpy.types.Object, name: str, domain: str) -> np.ndarray:
    """The values of a vertex group, or of a float attribute of a domain. Raises Fault."""
    group, attribute = thing.vertex_groups.get(name), thing.data.attributes.get(name)
    if group and domain == "POINT":
        return group_weights(thing, [group])[0]
    if not attribute or (attribute.domain, attribute.data_type) != (domain, "FLOAT"):
        raise Fault(
            f"{thing.name} has no vertex group, and no attribute of floats by {domain.lower()}, called {name!r}"
        )
    values = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", values)
    return values


def _merged(thing: bpy.types.Object, name: str, store: str, given: np.ndarray, editing: bool) -> np.ndarray:
    """The new values; in edit mode only for selected elements, and for others what is painted already, or 1."""
    domain = _DOMAINS[store]
    if not editing:
        return given
    selected = np.empty(len(given), np.bool_)
    getattr(thing.data, _ELEMENTS[domain]).foreach_get("select", selected)
    try:
        before = _values_of(thing, name, domain)
    except Fault:  # nothing was painted, or of another type
        before = np.ones(len(given), np.float32)
    return np.where(selected, given, before)


# ---- Edges ----


class _PaintEdges(_Paint):
    """Gives edges of the patch a force density."""

    value: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Force Density",
        default=4.0,
        min=0.0,
        description="Multiplies painted force density; 0: no longer painted by edge",
    )

    def choose(self, context: bpy.types.Context) -> Callable[[Surface, np.ndarray], np.ndarray]:
        """What chooses among the edges (E, 2) of the mesh, on a surface: a bool for each. Raises Fault."""
        raise NotImplementedError

    def fetch(self, context: bpy.types.Context) -> Callable[[], np.ndarray]:
        """The chosen edges that belong to the patch."""
        thing = context.active_object
        fetched, name = fetch(thing, context.evaluated_depsgraph_get()), active_name(context)
        edges, choose = edges_of(thing.data), self.choose(context)
        return lambda: _chosen(fetched, name, edges, choose)

    def write(self, context: bpy.types.Context, found: np.ndarray) -> str:
        """Paints."""
        thing, patch = context.active_object, active_name(context)
        name, factors = f"skinSlide:{patch}:{EDGES}", np.zeros(len(thing.data.edges), np.float32)
        attribute = thing.data.attributes.get(name)
        if attribute and (attribute.domain, attribute.data_type) == ("EDGE", "FLOAT"):
            attribute.data.foreach_get("value", factors)
        factors[found] = self.value
        write_attribute(thing.data, name, "EDGE", ("FLOAT", "value"), factors)
        return f"{patch}: {np.count_nonzero(found)} edges painted {self.value:g}, {np.count_nonzero(factors)} in all"


def _chosen(
    fetched: Fetched, name: str, edges: np.ndarray, choose: Callable[[Surface, np.ndarray], np.ndarray]
) -> np.ndarray:
    surface = Surface(fetched)
    own = surface.topology.edges_of(surface.patch(fetched.patch(name), only=CHOOSING).faces)
    count = surface.topology.vertex_count
    chosen = choose(surface, edges) & np.isin(edge_keys(edges, count), edge_keys(own, count))
    if not chosen.any():
        raise Fault(f"what is selected, or near the curve, {NO_EDGE}")
    return chosen


class SKINSLIDE_OT_paint_edges(_PaintEdges):
    """Gives the selected edges of the patch a force density."""

    bl_idname, bl_label = "skinslide.paint_edges", "Paint Selected Edges"

    def choose(self, context: bpy.types.Context) -> Callable[[Surface, np.ndarray], np.ndarray]:
        """The selection."""
        mesh = context.active_object.data
        selected = np.empty(len(mesh.edges), np.bool_)
        mesh.edges.foreach_get("select", selected)
        if not selected.any():
            raise Fault("no edge is selected")
        return lambda _surface, _edges: selected


def _curves(_operator: Any, context: bpy.types.Context, _text: str) -> list[str]:
    """The objects that are curves."""
    return [each.name for each in context.scene.objects if each.type == "CURVE"]


class SKINSLIDE_OT_paint_curve(_PaintEdges):
    """Gives edges of the patch near a curve, drawn on the mesh at rest, a force density."""

    bl_idname, bl_label = "skinslide.paint_curve", "Paint Along Curve"
    curve: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Curve", search=_curves, description="The object that is the curve"
    )
    distance: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Distance", default=0.05, min=0.0, description="How far edges may be from the curve, in the mesh's units"
    )
    direction: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Edges",
        items=[
            ("any", "Any", "Whichever way they run"),
            ("along", "Along", "At 45 degrees or less to the curve"),
            ("across", "Across", "At more"),
        ],
    )

    def choose(self, context: bpy.types.Context) -> Callable[[Surface, np.ndarray], np.ndarray]:
        """What is near the curve."""
        curves = fetch_curves(context, bpy.data.objects.get(self.curve))
        distance, direction = self.distance, self.direction
        return lambda surface, edges: (
            edge_distances(surface.meaning.rest_points(), edges, curves, direction) <= distance
        )


def fetch_curves(context: bpy.types.Context, drawn: bpy.types.Object | None) -> Curves:
    """The splines of a curve object, as Blender draws them, in the space of the active object. Raises Fault."""
    if drawn is None or drawn.type != "CURVE":
        raise Fault("choose an object that is a curve")
    evaluated = drawn.evaluated_get(context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    try:
        points, edges = np.empty(3 * len(mesh.vertices), np.float32), edges_of(mesh)
        mesh.vertices.foreach_get("co", points)
        if len(mesh.polygons) or not len(edges):
            raise Fault(f"{drawn.name} is a surface or nothing; take bevel and extrusion away")
        chains = _chains(edges)
    finally:
        evaluated.to_mesh_clear()
    to_mesh = context.active_object.matrix_world.inverted() @ drawn.matrix_world
    order = np.concatenate(chains)
    counts = np.array([len(each) for each in chains], np.int32)
    return Curves(counts, points.reshape(-1, 3)[order], to_mesh=np.array(to_mesh.transposed()))


def _chains(edges: np.ndarray) -> list[np.ndarray]:
    """The points of each spline in order; if it is closed, with the first again at the end."""
    chains = list[list[int]]()
    for a, b in edges.tolist():
        if chains and chains[-1][-1] == a:
            chains[-1].append(b)
        else:
            chains.append([a, b])
    return [np.array(each) for each in chains]


_CLASSES = (SKINSLIDE_OT_paint, SKINSLIDE_OT_paint_edges, SKINSLIDE_OT_paint_curve)


def register() -> None:
    """Registers the operators."""
    for each in _CLASSES:
        bpy.utils.register_class(each)


def unregister() -> None:
    """Unregisters them."""
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
