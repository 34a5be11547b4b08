"""A sheet that bends over three frames, and what is done to it."""

from __future__ import annotations

import bpy  # isort: skip (makes bmesh known)
import bmesh
import numpy as np
from bl_ext.user_default.skinslide import settings

SIDE = 12


def sheet(side: int = SIDE, name: str = "sheet", height: float = 0.1) -> bpy.types.Object:
    """A bumpy sheet of quads, at rest at frame 1001 and stretched unevenly at 1003, by a shape key."""
    i, j = np.meshgrid(np.arange(side + 1), np.arange(side + 1))
    x, y = i.ravel() / side - 0.5, j.ravel() / side - 0.5
    rest = np.stack([x, y, height * np.sin(5 * x + 3 * y)], axis=1)
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.stack([corner, corner + 1, corner + side + 2, corner + side + 1], axis=1)
    return animated(rest, faces.tolist(), name)


def animated(rest: np.ndarray, faces: list, name: str = "sheet") -> bpy.types.Object:
    """A mesh that is the active object."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(rest.tolist(), [], faces)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="bent")
    u, v = rest[:, 0], rest[:, 1]
    bent = rest + 0.5 * np.stack([u * u, u * v, u * u - v], axis=1)
    key.data.foreach_set("co", bent.astype(np.float32).ravel())
    for frame, value in ((1001, 0.0), (1003, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    bpy.context.scene.frame_set(1001)
    return thing


def select(thing: bpy.types.Object, held: str, chosen) -> None:
    """Selects some of the vertices, edges or faces, by a bool for each, and nothing else, as edit mode does."""
    # Setting Mesh's own flags of edges crashes Blender 5.0.1 where from_pydata made them.
    made = bmesh.new()
    made.from_mesh(thing.data)
    for elements in (made.verts, made.edges, made.faces):
        for element in elements:
            element.select = False
    for element, flag in zip(getattr(made, held), np.asarray(chosen, np.bool_).tolist(), strict=True):
        element.select = flag or element.select  # what is selected brings its corners and sides
    made.to_mesh(thing.data)
    made.free()


def line(*through: tuple[float, float, float]) -> bpy.types.Object:
    """A drawn curve of straight pieces."""
    curve = bpy.data.curves.new("drawn", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(len(through) - 1)
    for point, place in zip(spline.points, through, strict=True):
        point.co = (*place, 1)
    drawn = bpy.data.objects.new("drawn", curve)
    bpy.context.scene.collection.objects.link(drawn)
    bpy.context.view_layer.update()
    return drawn


def inner(thing: bpy.types.Object, margin: int = 1) -> np.ndarray:
    """The faces of a sheet except those at its border."""
    side = round(len(thing.data.polygons) ** 0.5)
    row, column = np.divmod(np.arange(side * side), side)
    return np.all([(each >= margin) & (each < side - margin) for each in (row, column)], axis=0)


def make_patch(thing: bpy.types.Object, name: str = "patch", rule: str = "even"):
    """A patch of all faces but those at the border."""
    select(thing, "faces", inner(thing))
    assert bpy.ops.skinslide.patch_from_faces(name=name) == {"FINISHED"}
    patch = settings.active_patch(thing)
    patch.forceDensityRule = rule
    return patch


def points(thing: bpy.types.Object) -> np.ndarray:
    """Points (V, 3) of an object's own mesh."""
    found = np.empty(3 * len(thing.data.vertices), np.float32)
    thing.data.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def values(thing: bpy.types.Object, name: str) -> np.ndarray:
    """The floats of an attribute."""
    attribute = thing.data.attributes[name]
    found = np.empty(len(attribute.data), np.float32)
    attribute.data.foreach_get("value", found)
    return found
