"""What an object has, fetched under the names and with the types of a USD cache. Nothing is interpreted here.

An attribute of a mesh, or a group of its vertices, called NAME is the primvar primvars:NAME. Edges have no primvars:
a float attribute of edges called skinSlide:PATCH:edgeForceDensities says which are painted and how, with 0 for others.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any

import bpy
import numpy as np

from skinslide.arrays.fetched import Other, Value
from skinslide.arrays.schema import Input, inputs
from skinslide.problems import Fault

from . import settings
from .reading import Fetched, FetchedPatch

EDGES = "edgeForceDensities"
INTERPOLATIONS = {"POINT": "vertex", "FACE": "uniform", "CORNER": "faceVarying", "EDGE": "edge"}
# By type of attribute: the property that holds an element, how many numbers it has, their type, USD's name for it.
KINDS = {
    "FLOAT": ("value", 1, np.float32, "float[]"),
    "INT": ("value", 1, np.int32, "int[]"),
    "BOOLEAN": ("value", 1, np.bool_, "bool[]"),
    "FLOAT2": ("vector", 2, np.float32, "float2[]"),
    "FLOAT_VECTOR": ("vector", 3, np.float32, "float3[]"),
    "FLOAT_COLOR": ("color", 4, np.float32, "color4f[]"),
    "BYTE_COLOR": ("color", 4, np.float32, "color4f[]"),
}
# Modifiers that move points, but neither add nor remove any.
DEFORMING = {
    "ARMATURE", "CAST", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM", "LAPLACIANSMOOTH",
    "LATTICE",
    "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "CLOTH",
    "SURFACE_DEFORM", "WARP", "WAVE", "NORMAL_EDIT", "WEIGHTED_NORMAL", "UV_PROJECT", "UV_WARP", "DATA_TRANSFER",
    "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY",
}  # fmt: skip


def fetch(thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph | None) -> Fetched:
    """All that is needed to slide an object; depsgraph None: without modifiers. Raises Fault if it cannot be slid."""
    check(thing)
    own, mesh = settings.of(thing), thing.data
    primvars = {value.name: value for value in (*_attributes(mesh), *_groups(thing))}
    values = {
        each.property(): settings.value_of(own, each, each.property()) for each in settings.set_inputs(own, "mesh")
    }
    rest = primvars.pop("primvars:skinSlide:restPoints", None)
    if rest:
        values["skinSlide:restPoints"] = rest._replace(name="skinSlide:restPoints")
    patches = tuple(_patch(mesh, each) for each in own.patches)
    folder = os.path.dirname(bpy.path.abspath(own.file or "//"))
    basis = basis_points(mesh)
    poses = basis, evaluated_points(thing, depsgraph) if depsgraph else basis
    to_world = np.array(thing.matrix_world.transposed(), np.float64)
    return Fetched(thing.name, folder, *_faces(mesh), *poses, to_world, values, primvars, patches)


def _faces(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """How many vertices each face has, and which they are."""
    counts, indices = np.empty(len(mesh.polygons), np.int32), np.empty(len(mesh.loops), np.int32)
    mesh.polygons.foreach_get("loop_total", counts)
    mesh.loops.foreach_get("vertex_index", indices)
    return counts, indices


def check(thing: bpy.types.Object) -> None:
    """Raises Fault for what has a scale of its own, by which lengths would differ from what is meant."""
    own = [a * b for a, b in zip(thing.scale, thing.delta_scale, strict=True)]
    if any(abs(scale - 1) > 1e-6 for scale in own):
        scale = ", ".join(f"{each:g}" for each in own)
        raise Fault(f"{thing.name} has the scale {scale}; apply it first (Object, Apply, Scale)")


def basis_points(mesh: bpy.types.Mesh) -> np.ndarray:
    """Points (V, 3) without shape keys: those of the basis, if there is one."""
    points = np.empty(3 * len(mesh.vertices), np.float32)
    held = mesh.shape_keys.reference_key.data if mesh.shape_keys else mesh.vertices
    held.foreach_get("co", points)
    return points.reshape(-1, 3)


def evaluated_points(thing: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> np.ndarray:
    """Points (V, 3) as modifiers and shape keys leave them. Raises Fault if the faces are not the mesh's own."""
    mesh, evaluated = thing.data, thing.evaluated_get(depsgraph).data
    if not _same_faces(mesh, evaluated):
        names = [each.name for each in thing.modifiers if each.show_viewport and each.type not in DEFORMING]
        said = f"{len(mesh.polygons)} faces become {len(evaluated.polygons)}"
        raise Fault(f"modifiers of {thing.name} change its topology ({said}); turn them off: {', '.join(names)}")
    points = np.empty(3 * len(mesh.vertices), np.float32)
    evaluated.vertices.foreach_get("co", points)
    return points.reshape(-1, 3)


def _same_faces(mesh: bpy.types.Mesh, other: bpy.types.Mesh) -> bool:
    if any(len(getattr(mesh, each)) != len(getattr(other, each)) for each in ("vertices", "loops", "polygons")):
        return False
    for held, name in (("loops", "vertex_index"), ("polygons", "loop_start")):
        own, theirs = (np.empty(len(getattr(each, held)), np.int32) for each in (mesh, other))
        getattr(mesh, held).foreach_get(name, own)
        getattr(other, held).foreach_get(name, theirs)
        if not np.array_equal(own, theirs):
            return False
    return True


def numbers(thing: bpy.types.Object) -> tuple[tuple[tuple[Input, Value], ...], ...]:
    """For each patch, the settings that may be animated, as they are now."""
    animated = [each for each in inputs("controls") if each.type_name == "float"]
    return tuple(
        tuple((each, settings.value_of(patch, each, each.property(patch.name))) for each in animated)
        for patch in settings.of(thing).patches
    )


# ---- Paint ----


def _is_ours(name: str) -> bool:
    """Whether an attribute may be paint, or rest points; the core knows which."""
    rest = {each.name for each in inputs("mesh") if each.is_primvar}
    return name.casefold().startswith("skinslide") or name in rest


def _attributes(mesh: bpy.types.Mesh) -> Iterator[Value]:
    for attribute in mesh.attributes:
        is_edges = attribute.domain == "EDGE" and attribute.name.endswith(f":{EDGES}")
        is_map = attribute.domain == "CORNER" and attribute.data_type == "FLOAT2"
        if (_is_ours(attribute.name) and not is_edges) or is_map:
            yield attribute_value(attribute)


def attribute_value(attribute: bpy.types.Attribute) -> Value:
    """The primvar that an attribute is, by its name."""
    name, interpolation = f"primvars:{attribute.name}", INTERPOLATIONS.get(attribute.domain, attribute.domain)
    if attribute.data_type not in KINDS:
        return Value(name, Other(), attribute.data_type.lower(), interpolation)
    held, width, dtype, type_name = KINDS[attribute.data_type]
    array: np.ndarray = np.empty(width * len(attribute.data), dtype)
    attribute.data.foreach_get(held, array)
    return Value(name, array.reshape(-1, width) if width > 1 else array, type_name, interpolation)


def _groups(thing: bpy.types.Object) -> Iterator[Value]:
    ours = [group for group in thing.vertex_groups if _is_ours(group.name)]
    for group, weights in zip(ours, group_weights(thing, ours), strict=True):
        yield Value(f"primvars:{group.name}", weights, "float[]", "vertex")


def group_weights(thing: bpy.types.Object, groups: Sequence[bpy.types.VertexGroup]) -> list[np.ndarray]:
    """The weights (V,) in some groups of vertices; 0 for vertices that are not in a group."""
    weights = {group.index: np.zeros(len(thing.data.vertices), np.float32) for group in groups}
    for vertex in thing.data.vertices if groups else ():
        for element in vertex.groups:
            if element.group in weights:
                weights[element.group][vertex.index] = element.weight
    return list(weights.values())


def _patch(mesh: bpy.types.Mesh, patch: Any) -> FetchedPatch:
    found = {
        each.name: settings.value_of(patch, each, each.property(patch.name))
        for each in settings.set_inputs(patch, "patch", "controls")
    }
    attribute = mesh.attributes.get(f"skinSlide:{patch.name}:{EDGES}")
    if attribute and attribute.domain == "EDGE" and attribute.data_type == "FLOAT":
        pairs, factors = painted_edges(mesh, attribute)
        for name, array in (("edges", pairs.ravel()), (EDGES, factors)):
            found[name] = Value(f"skinSlide:{patch.name}:{name}", array, "int[]" if name == "edges" else "float[]")
    return FetchedPatch(patch.name, found)


def edges_of(mesh: bpy.types.Mesh) -> np.ndarray:
    """The edges of a mesh, int32 (E, 2), as Blender numbers them."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    return edges.reshape(-1, 2)


def edge_keys(edges: np.ndarray, vertex_count: int) -> np.ndarray:
    """A number for each edge (n, 2), which does not depend on its direction."""
    keys: np.ndarray = np.sort(edges, axis=1).astype(np.int64) @ (vertex_count, 1)
    return keys


def painted_edges(mesh: bpy.types.Mesh, attribute: bpy.types.Attribute) -> tuple[np.ndarray, np.ndarray]:
    """The edges that are painted (k, 2), and their factors (k,)."""
    factors = np.empty(len(mesh.edges), np.float32)
    attribute.data.foreach_get("value", factors)
    return edges_of(mesh)[factors != 0], factors[factors != 0]
