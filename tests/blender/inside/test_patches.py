"""Patches, paint and rest: what operators write, what they refuse, and that it can be undone."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from bl_ext.user_default.skinslide import settings
from bl_ext.user_default.skinslide.fetch import fetch
from bl_ext.user_default.skinslide.patches import check_name, free_name
from bl_ext.user_default.skinslide.reading import Sliding

from sheets import SIDE, animated, inner, line, make_patch, points, select, sheet, values


def fetched(thing):
    return fetch(thing, bpy.context.evaluated_depsgraph_get())


def state(thing) -> tuple:
    """What bad input must not change."""
    mesh = thing.data
    attributes = [(each.name, each.domain, each.data_type) for each in mesh.attributes]
    groups = [group.name for group in thing.vertex_groups]
    return attributes, groups, [patch.name for patch in thing.skinslide.patches], points(thing).tobytes(), thing.mode


def refused(operator, thing, says: str, **arguments) -> None:
    """An operator says so in the report area, and nothing has changed."""
    before = state(thing)
    with pytest.raises(RuntimeError, match=says):
        operator(**arguments)
    assert state(thing) == before


# ---- Patches ----


def test_a_patch_of_selected_faces():
    thing = sheet()
    make_patch(thing, "elbow_L")
    attribute = thing.data.attributes["skinSlide:elbow_L:patch"]
    chosen = np.empty(SIDE * SIDE, np.bool_)
    attribute.data.foreach_get("value", chosen)
    assert (attribute.domain, attribute.data_type) == ("FACE", "BOOLEAN")
    assert np.array_equal(chosen, inner(thing))
    sliding = Sliding(fetched(thing))
    assert np.array_equal(sliding.slider.faces(0), np.flatnonzero(chosen))
    assert sliding.slider.patches[0].name == "elbow_L"
    assert thing.skinslide.patches[0].forceDensityRule == "even"


def test_a_patch_of_a_vertex_group():
    """Its faces are those whose points are all in the group, as the core has it."""
    thing = sheet()
    group = thing.vertex_groups.new(name="arm")
    group.add(list(range(5 * (SIDE + 1))), 0.7, "REPLACE")
    assert bpy.ops.skinslide.patch_from_group(name="arm_L", group="arm") == {"FINISHED"}
    assert np.array_equal(Sliding(fetched(thing)).slider.faces(0), np.arange(4 * SIDE))


def test_a_patch_is_undone():
    thing = sheet()
    bpy.ops.ed.undo_push(message="before")
    before = state(thing)
    make_patch(thing)
    bpy.ops.ed.undo_push(message="patch")
    assert bpy.ops.ed.undo() == {"FINISHED"}
    assert state(bpy.data.objects["sheet"]) == before
    assert bpy.ops.ed.redo() == {"FINISHED"}
    assert [patch.name for patch in bpy.data.objects["sheet"].skinslide.patches] == ["patch"]


def test_a_patch_is_removed_with_its_paint():
    thing = sheet()
    select(thing, "faces", inner(thing))
    before = state(thing)
    make_patch(thing)
    bpy.ops.skinslide.paint(what="weight", value=0.5, store="GROUP")
    bpy.ops.skinslide.paint(what="forceDensity", value=2.0, store="POINT")
    assert bpy.ops.skinslide.remove_patch() == {"FINISHED"}
    assert state(thing) == before


def test_names_that_are_free():
    thing = sheet()
    assert [free_name(thing, each) for each in ("arm.L", "1", "")] == ["arm_L", "patch_1", "patch_"]
    make_patch(thing, "patch")
    assert free_name(thing, "patch") == "patch_2"
    for name in ("arm_L", "patch_1", "patch_", "patch_2"):
        check_name(thing, name)


def test_edit_mode_is_kept():
    thing = sheet()
    select(thing, "faces", inner(thing))
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.skinslide.patch_from_faces(name="a") == {"FINISHED"}
    assert thing.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    assert len(Sliding(fetched(thing)).slider.faces(0)) == (SIDE - 2) ** 2


# ---- Paint ----


def test_paint_on_a_group_and_on_attributes():
    thing = sheet()
    make_patch(thing)
    assert bpy.ops.skinslide.paint(what="weight", value=0.25, store="GROUP") == {"FINISHED"}
    assert bpy.ops.skinslide.paint(what="forceDensity", value=3.0, store="FACE") == {"FINISHED"}
    assert bpy.ops.skinslide.paint(what="hold", value=2.0, store="POINT") == {"FINISHED"}
    controls = Sliding(fetched(thing))._base[0].get()
    assert np.all(controls.weight[np.unique(thing_faces(thing))] == 0.25)
    assert np.all(controls.face_density[inner(thing)] == 3) and np.all(controls.face_density[~inner(thing)] == 1)
    assert set(controls.hold[np.unique(thing_faces(thing))]) == {2.0}


def thing_faces(thing) -> np.ndarray:
    """The points of the faces of the patch."""
    return np.array([list(face.vertices) for face in thing.data.polygons])[inner(thing)]


def test_paint_in_edit_mode_is_of_the_selection():
    thing = sheet()
    make_patch(thing)
    some = np.arange((SIDE + 1) ** 2) % 3 == 0
    select(thing, "verts", some)
    bpy.context.tool_settings.mesh_select_mode = (True, False, False)
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.skinslide.paint(what="forceDensity", value=5.0, store="POINT") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    assert np.array_equal(values(thing, "skinSlide:patch:forceDensity"), np.where(some, 5, 1))


def test_paint_from_what_is_there():
    """From another group or attribute, by point and by face; one that does not exist is refused."""
    thing = sheet()
    make_patch(thing)
    ramp = np.linspace(0, 1, len(thing.data.vertices), dtype=np.float32)
    group = thing.vertex_groups.new(name="mask")
    for vertex, weight in enumerate(ramp.tolist()):
        group.add([vertex], weight, "REPLACE")
    faces = thing.data.attributes.new("tendon", "FLOAT", "FACE")
    faces.data.foreach_set("value", np.linspace(1, 4, SIDE * SIDE, dtype=np.float32))
    assert bpy.ops.skinslide.paint(what="weight", store="GROUP", source="mask") == {"FINISHED"}
    assert bpy.ops.skinslide.paint(what="hold", store="POINT", source="mask") == {"FINISHED"}
    assert bpy.ops.skinslide.paint(what="forceDensity", store="FACE", source="tendon") == {"FINISHED"}
    found = fetched(thing).primvars
    assert np.array_equal(found["primvars:skinSlide:patch:weight"].value, ramp)
    assert np.array_equal(values(thing, "skinSlide:patch:hold"), ramp)
    assert np.array_equal(values(thing, "skinSlide:patch:forceDensity"), values(thing, "tendon"))
    refused(bpy.ops.skinslide.paint, thing, "no vertex group, and no attribute", what="weight", source="nothing")
    refused(bpy.ops.skinslide.paint, thing, "by point, called 'tendon'", what="weight", source="tendon")


def test_edges():
    """The patch's edges, in Blender's own domain; other edges that are selected are left out."""
    thing = sheet()
    make_patch(thing)
    select(thing, "edges", np.ones(len(thing.data.edges), bool))
    assert bpy.ops.skinslide.paint_edges(value=4.0) == {"FINISHED"}
    controls = Sliding(fetched(thing))._base[0].get()
    own = 2 * (SIDE - 2) * (SIDE - 1)
    assert len(controls.edges) == own and np.all(controls.edge_density == 4)
    assert thing.data.attributes["skinSlide:patch:edgeForceDensities"].domain == "EDGE"


@pytest.mark.parametrize("direction", ["along", "across", "any"])
def test_a_curve(direction):
    """A straight one, along a row of the flat sheet: the edges along it, those across it, or both."""
    thing = sheet(height=0)
    drawn = line((-0.5, 0, 0), (0.5, 0, 0))
    make_patch(thing, rule="unit")
    arguments = {"curve": drawn.name, "distance": 0.6 / SIDE, "direction": direction, "value": 8.0}
    assert bpy.ops.skinslide.paint_curve(**arguments) == {"FINISHED"}
    edges = Sliding(fetched(thing))._base[0].get().edges
    steps = set(np.abs(edges[:, 1] - edges[:, 0]).tolist())
    assert steps == {"along": {1}, "across": {SIDE + 1}, "any": {1, SIDE + 1}}[direction]
    counts = {"along": SIDE - 2, "across": 2 * (SIDE - 1)}
    assert len(edges) == counts.get(direction, sum(counts.values()))


# ---- Rest ----


def test_rest_from_the_basis_and_from_a_frame():
    thing = sheet()
    make_patch(thing)
    assert bpy.ops.skinslide.rest_from_frame(frame=1003) == {"FINISHED"}
    bent = np.empty(3 * len(thing.data.vertices), np.float32)
    thing.data.shape_keys.key_blocks["bent"].data.foreach_get("co", bent)
    sliding = Sliding(fetched(thing))
    assert bpy.context.scene.frame_current == 1001
    assert np.allclose(rest_of(thing).ravel(), bent, rtol=0, atol=1e-6)  # the key's value is added to the basis
    assert sliding.slider
    assert bpy.ops.skinslide.rest_from_basis() == {"FINISHED"}
    assert rest_of(thing).tobytes() == fetched(thing).basis.tobytes()


def rest_of(thing) -> np.ndarray:
    return fetched(thing).values["skinSlide:restPoints"].value


# ---- Undo ----


def everything(thing) -> dict:
    """All that operators write on a mesh."""
    mesh = thing.data
    found = {name: value.value.tobytes() for name, value in fetched(thing).primvars.items()}
    for attribute in mesh.attributes:
        if attribute.data_type == "FLOAT":
            found[attribute.name] = values(thing, attribute.name).tobytes()
    patches = [(patch.name, patch.forceDensityRule) for patch in thing.skinslide.patches]
    rest = fetched(thing).values.get("skinSlide:restPoints")
    return found | {
        "patches": patches,
        "groups": list(thing.vertex_groups.keys()),
        "rest": rest and rest.value.tobytes(),
    }


@pytest.mark.parametrize(
    "name, arguments",
    [
        ("patch_from_faces", {"name": "other"}),
        ("patch_from_group", {"name": "other", "group": "arm"}),
        ("remove_patch", {}),
        ("paint", {"what": "weight", "value": 0.5, "store": "GROUP"}),
        ("paint", {"what": "hold", "value": 2.0, "store": "POINT"}),
        ("paint_edges", {"value": 3.0}),
        ("paint_curve", {"curve": "drawn", "distance": 0.2}),
        ("rest_from_basis", {}),
        ("rest_from_frame", {"frame": 1003}),
    ],
)
def test_each_is_undone_and_done_again(name, arguments):
    thing = sheet()
    thing.vertex_groups.new(name="arm").add(list(range(5 * (SIDE + 1))), 0.7, "REPLACE")
    line((-0.5, 0, 0), (0.5, 0, 0))
    bpy.context.view_layer.objects.active = thing
    make_patch(thing)
    bpy.ops.ed.undo_push(message="before")
    before = everything(thing)
    assert getattr(bpy.ops.skinslide, name)(**arguments) == {"FINISHED"}
    after = everything(thing)
    bpy.ops.ed.undo_push(message=name)
    bpy.ops.ed.undo()
    assert everything(bpy.data.objects["sheet"]) == before != after
    bpy.ops.ed.redo()
    assert everything(bpy.data.objects["sheet"]) == after


# ---- What is refused ----


def test_modifiers_that_change_topology():
    thing = sheet()
    thing.modifiers.new("Subdivision", "SUBSURF")
    select(thing, "faces", inner(thing))
    bpy.context.view_layer.update()
    refused(bpy.ops.skinslide.patch_from_faces, thing, "change its topology.*Subdivision", name="a")
    thing.modifiers["Subdivision"].show_viewport = False
    make_patch(thing)
    thing.modifiers["Subdivision"].show_viewport = True
    bpy.context.view_layer.update()
    refused(bpy.ops.skinslide.live, thing, "144 faces become 576.*turn them off: Subdivision")
    assert not thing.skinslide.slid


def test_a_scale_that_is_not_applied():
    thing = sheet()
    thing.scale = (1, 1, 2)
    select(thing, "faces", inner(thing))
    refused(bpy.ops.skinslide.patch_from_faces, thing, "has the scale 1, 1, 2; apply it first", name="a")


def test_a_delta_scale():
    """Blender keeps the delta scale apart from the scale, and applies it apart."""
    thing = sheet()
    thing.delta_scale, thing.rotation_euler = (2, 2, 2), (1, 2, 3)
    select(thing, "faces", inner(thing))
    bpy.context.view_layer.update()
    refused(bpy.ops.skinslide.patch_from_faces, thing, "has the scale 2, 2, 2; apply it first", name="a")
    thing.delta_scale = (1, 1, 1)
    bpy.context.view_layer.update()
    make_patch(thing)


def test_a_selection_in_pieces():
    thing = sheet()
    chosen = np.zeros(SIDE * SIDE, bool)
    chosen[[0, 1, 50, 51]] = True
    select(thing, "faces", chosen)
    refused(bpy.ops.skinslide.patch_from_faces, thing, "lies in 2 pieces", name="a")


def test_a_selection_that_is_not_manifold():
    rest = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1)], float)
    thing = animated(rest, [(0, 1, 2), (1, 0, 3), (0, 1, 4)])
    select(thing, "faces", [True] * 3)
    refused(bpy.ops.skinslide.patch_from_faces, thing, "edge 0-1 has 3 faces", name="a")


def test_nothing_selected_and_names_that_are_none():
    thing = sheet()
    select(thing, "faces", np.zeros(SIDE * SIDE, bool))
    refused(bpy.ops.skinslide.patch_from_faces, thing, "no face is selected", name="a")
    select(thing, "faces", inner(thing))
    for name in ("", "1a", "a b", "live"):
        refused(bpy.ops.skinslide.patch_from_faces, thing, "cannot name a patch", name=name)
    refused(bpy.ops.skinslide.patch_from_faces, thing, "is too long for what Blender calls", name="a" * 40)
    make_patch(thing, "a")
    refused(bpy.ops.skinslide.patch_from_faces, thing, "has a patch a already", name="a")
    refused(bpy.ops.skinslide.patch_from_group, thing, "no vertex group is active", name="b")
    refused(bpy.ops.skinslide.patch_from_group, thing, "has no vertex group x", name="b", group="x")


def test_paint_of_another_domain():
    thing = sheet()
    make_patch(thing)
    thing.data.attributes.new("skinSlide:patch:weight", "FLOAT", "EDGE")
    refused(bpy.ops.skinslide.live, thing, "weight has interpolation edge; it must be vertex, faceVarying or constant")


def test_paint_of_another_type():
    thing = sheet()
    make_patch(thing)
    thing.data.attributes.new("skinSlide:patch:hold", "INT", "POINT")
    refused(bpy.ops.skinslide.live, thing, r"hold is int\[\]; it must be float")


def test_what_cannot_be_painted_is_not():
    """Paint that the core would refuse is refused; other paint that is wrong already does not matter."""
    thing = sheet()
    make_patch(thing)
    thing.data.attributes.new("skinSlide:patch:weight", "FLOAT", "EDGE")
    refused(bpy.ops.skinslide.paint, thing, "patch patch: .*hold has interpolation uniform", what="hold", store="FACE")
    refused(bpy.ops.skinslide.paint, thing, "forceDensity", what="forceDensity", store="POINT", value=0.0)
    assert bpy.ops.skinslide.paint(what="hold", store="POINT") == {"FINISHED"}


def test_paint_does_not_mind_modifiers():
    thing = sheet()
    make_patch(thing)
    thing.modifiers.new("Subdivision", "SUBSURF")
    bpy.context.view_layer.update()
    assert bpy.ops.skinslide.paint(what="hold", store="POINT") == {"FINISHED"}


def test_a_rest_of_another_domain():
    thing = sheet()
    make_patch(thing)
    thing.data.attributes.new("skinSlide:restPoints", "FLOAT_VECTOR", "FACE")
    refused(bpy.ops.skinslide.live, thing, "restPoints has 144 values, but the mesh has 169 points|restPoints")


def test_no_rest_of_its_own():
    thing = sheet()
    make_patch(thing)
    thing.shape_key_clear()
    refused(bpy.ops.skinslide.rest_from_basis, thing, "has no shape keys")


def test_what_is_no_mesh():
    sheet()
    empty = bpy.data.objects.new("empty", None)
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.objects.active = empty
    with pytest.raises(RuntimeError, match="is not a mesh"):
        bpy.ops.skinslide.live()


def test_paint_without_a_patch_and_beyond_a_group():
    thing = sheet()
    refused(bpy.ops.skinslide.paint, thing, "there is no patch to paint", what="weight")
    make_patch(thing)
    refused(
        bpy.ops.skinslide.paint, thing, "a vertex group holds 0 to 1, not 3", what="weight", value=3.0, store="GROUP"
    )
    select(thing, "edges", np.zeros(len(thing.data.edges), bool))
    refused(bpy.ops.skinslide.paint_edges, thing, "no edge is selected")
    refused(bpy.ops.skinslide.paint_curve, thing, "choose an object that is a curve", curve="nothing")


def test_settings_are_those_of_the_schema():
    """Every token and fallback is the core's."""
    from skinslide.arrays.schema import inputs

    thing = sheet()
    patch = make_patch(thing)
    for source in (*inputs("patch"), *inputs("controls")):
        if source.tokens:
            held = patch.bl_rna.properties[source.name]
            assert [item.identifier for item in held.enum_items] == list(source.tokens)
            assert held.default == source.fallback
            assert held.name and "." in held.description  # as the schema says it
    assert (
        settings.value_of(patch, next(each for each in inputs("controls") if each.name == "envelope"), "x").value == 1
    )
