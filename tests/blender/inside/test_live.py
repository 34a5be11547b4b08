"""The live switch: what it shows at each frame, in which colours, and what becomes of it as things change."""

from __future__ import annotations

import bpy
import numpy as np
from bl_ext.user_default.skinslide.fetch import fetch, numbers
from bl_ext.user_default.skinslide.live import SHADES, STRETCH, shades
from bl_ext.user_default.skinslide.reading import Sliding

from sheets import make_patch, points, sheet


def slid_now(thing) -> np.ndarray:
    """The frame, slid from scratch."""
    fetched = fetch(thing, bpy.context.evaluated_depsgraph_get())
    return Sliding(fetched).slide(fetched.points, numbers(thing)).points


def test_it_follows_the_timeline(scene):
    thing = sheet()
    make_patch(thing)
    assert bpy.ops.skinslide.live() == {"FINISHED"}
    shown = thing.skinslide.slid
    fetched = fetch(thing, bpy.context.evaluated_depsgraph_get())
    assert np.array_equal(points(shown), fetched.basis)
    for frame in (1003, 1002, 1001, 1003):
        scene.frame_set(frame)
        cached = fetch(thing, bpy.context.evaluated_depsgraph_get()).points
        assert points(shown).tobytes() == slid_now(thing).tobytes()
        assert (frame == 1001) == np.array_equal(points(shown), cached)
    assert bpy.ops.skinslide.live() == {"FINISHED"}
    assert thing.skinslide.slid is None and "sheet slid" not in bpy.data.objects
    assert (thing.display_type, thing.visible_camera) == ("TEXTURED", True)


def test_stretch_in_false_colours(scene):
    thing = sheet()
    make_patch(thing)
    thing.skinslide.most_stretch = 0.2
    bpy.ops.skinslide.live()
    scene.frame_set(1003)
    shown = thing.skinslide.slid
    found = np.empty(4 * len(thing.data.vertices), np.float32)
    shown.data.attributes[STRETCH].data.foreach_get("color", found)
    fetched = fetch(thing, bpy.context.evaluated_depsgraph_get())
    stretch = Sliding(fetched).slide(fetched.points, numbers(thing)).stretch
    share = np.rint(np.clip(stretch / np.float32(0.2), 0, 1) * (SHADES - 1)).astype(int)
    assert np.array_equal(found.reshape(-1, 4), shades()[share])
    assert len(set(share.tolist())) > 10
    assert [slot.material.name for slot in shown.material_slots] == ["skinslide stretch"]
    thing.skinslide.false_colours = False
    assert not list(shown.material_slots)


def test_it_follows_paint_and_settings(scene):
    thing = sheet()
    patch = make_patch(thing)
    bpy.ops.skinslide.live()
    scene.frame_set(1003)
    shown, before = thing.skinslide.slid, points(thing.skinslide.slid)
    patch.envelope = 0.5
    half = points(shown)
    assert not np.array_equal(half, before) and half.tobytes() == slid_now(thing).tobytes()
    patch.envelope, patch.forceDensityRule = 1.0, "unit"
    assert points(shown).tobytes() == slid_now(thing).tobytes() != before.tobytes()
    bpy.ops.skinslide.paint(what="weight", value=0.0, store="GROUP")
    bpy.context.view_layer.update()
    assert np.array_equal(points(shown), fetch(thing, bpy.context.evaluated_depsgraph_get()).points)


def test_it_makes_way_for_brushes(scene):
    """The slid skin is drawn as wires over what is painted, and follows strokes."""
    thing = sheet()
    make_patch(thing)
    bpy.ops.skinslide.paint(what="weight", value=1.0, store="GROUP")
    bpy.ops.skinslide.live()
    scene.frame_set(1003)
    bpy.context.view_layer.objects.active = thing
    shown, before = thing.skinslide.slid, points(thing.skinslide.slid)
    bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
    bpy.context.view_layer.update()
    assert shown.display_type == "WIRE"
    thing.vertex_groups["skinSlide:patch:weight"].add([84], 0.0, "REPLACE")
    thing.data.update_tag()
    bpy.context.view_layer.update()
    assert points(shown).tobytes() == slid_now(thing).tobytes() != before.tobytes()
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.update()
    assert shown.display_type == "TEXTURED"


def test_it_follows_patches(scene):
    """Patches that are made and removed; without any nothing can be slid, which is reported."""
    thing = sheet()
    make_patch(thing, "a")
    bpy.ops.skinslide.live()
    scene.frame_set(1003)
    before = points(thing.skinslide.slid)
    make_patch(thing, "b", "unit")
    both = points(thing.skinslide.slid)
    assert both.tobytes() == slid_now(thing).tobytes() != before.tobytes()
    bpy.ops.skinslide.remove_patch()
    assert points(thing.skinslide.slid).tobytes() == before.tobytes()
    bpy.ops.skinslide.remove_patch()
    assert thing.skinslide.problem == "there is no patch to slide"


def test_an_animated_envelope(scene):
    thing = sheet()
    patch = make_patch(thing)
    for frame, value in ((1001, 0.0), (1003, 1.0)):
        patch.envelope = value
        thing.keyframe_insert("skinslide.patches[0].envelope", frame=frame)
    scene.frame_set(1001)
    bpy.ops.skinslide.live()
    scene.frame_set(1002)
    assert abs(patch.envelope - 0.5) < 0.1
    assert points(thing.skinslide.slid).tobytes() == slid_now(thing).tobytes()


def test_what_goes_wrong_is_said_and_mends(scene):
    """The skin stays as it was last shown, and slides again as soon as it can."""
    thing = sheet()
    make_patch(thing)
    bpy.ops.skinslide.live()
    scene.frame_set(1003)
    shown, before = thing.skinslide.slid, points(thing.skinslide.slid)
    thing.modifiers.new("Subdivision", "SUBSURF")
    bpy.context.view_layer.update()
    assert "change its topology" in thing.skinslide.problem
    assert points(shown).tobytes() == before.tobytes()
    thing.modifiers.clear()
    bpy.context.view_layer.update()
    scene.frame_set(1002)
    assert thing.skinslide.problem == ""
    assert points(shown).tobytes() == slid_now(thing).tobytes()


def test_it_is_undone(scene):
    thing = sheet()
    make_patch(thing)
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.skinslide.live()
    bpy.ops.ed.undo_push(message="live")
    bpy.ops.ed.undo()
    thing = bpy.data.objects["sheet"]
    assert thing.skinslide.slid is None and "sheet slid" not in bpy.data.objects
    bpy.ops.ed.redo()
    thing = bpy.data.objects["sheet"]
    scene = bpy.context.scene
    scene.frame_set(1003)
    assert points(thing.skinslide.slid).tobytes() == slid_now(thing).tobytes()


def set_the_scene(scene, size: int) -> None:
    """A camera above the sheet, and a light."""
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.1, -0.2, 1.9), (0.05, 0, 0)
    light = bpy.data.objects.new("light", bpy.data.lights.new("light", "SUN"))
    for each in (camera, light):
        scene.collection.objects.link(each)
    scene.camera, scene.render.engine = camera, "CYCLES"
    scene.cycles.samples, scene.cycles.device = 4, "CPU"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.resolution_percentage = 100


def test_a_picture(scene, out):
    """Rendered at the worst frame, in false colours: the slid skin is seen, and the cached is not."""
    thing = sheet(24)
    make_patch(thing)
    thing.skinslide.most_stretch = 0.3
    bpy.ops.skinslide.live()
    set_the_scene(scene, 192)
    scene.frame_set(1003)
    scene.render.filepath = str(out / "slid.png")
    bpy.ops.render.render(write_still=True)
    assert (out / "slid.png").stat().st_size > 4000


def test_an_animation(scene, tmp_path):
    """Each frame of a rendered animation is the picture of that frame alone."""
    thing = sheet()
    make_patch(thing)
    bpy.ops.skinslide.live()
    set_the_scene(scene, 32)
    scene.render.filepath = str(tmp_path / "frame")
    bpy.ops.render.render(animation=True)
    frames = [tmp_path / f"frame{frame}.png" for frame in (1001, 1002, 1003)]
    assert len({each.read_bytes() for each in frames}) == 3
    for frame, rendered in zip((1002, 1003), frames[1:], strict=True):
        scene.frame_set(frame)
        scene.render.filepath = str(tmp_path / "alone.png")
        bpy.ops.render.render(write_still=True)
        assert pixels(tmp_path / "alone.png") == pixels(rendered)


def pixels(path) -> list[float]:
    image = bpy.data.images.load(str(path))
    try:
        return list(image.pixels)
    finally:
        bpy.data.images.remove(image)
