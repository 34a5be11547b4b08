"""Set-ups in files: a round trip, what stays and what cannot be; and what the tests outside bake."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from bl_ext.user_default.skinslide.fetch import fetch

from sheets import SIDE, make_patch, points, select, sheet, values
from skinslide.arrays.images import encode_exr


def painted(thing, rule: str = "even") -> None:
    """A patch with something of everything."""
    patch = make_patch(thing, "arm:elbow_L", rule)
    patch.interpolation, patch.grow, patch.stretchResponse = "linear", 0.125, 0.75
    bpy.ops.skinslide.paint(what="weight", value=1.0, store="GROUP")
    group = thing.vertex_groups["skinSlide:arm:elbow_L:weight"]
    rng = np.random.default_rng(1)
    for vertex, weight in enumerate(rng.random(len(thing.data.vertices)).tolist()):
        group.add([vertex], weight, "REPLACE")
    for what, store in (("forceDensity", "FACE"), ("hold", "POINT"), ("maxDistance", "POINT")):
        bpy.ops.skinslide.paint(what=what, value=1.0, store=store)
        attribute = thing.data.attributes[f"skinSlide:arm:elbow_L:{what}"]
        attribute.data.foreach_set("value", rng.uniform(0.5, 3, len(attribute.data)).astype(np.float32))
    select(thing, "edges", np.arange(len(thing.data.edges)) % 3 == 0)
    bpy.ops.skinslide.paint_edges(value=3.7)
    for frame, value in ((1001, 0.2), (1003, 0.9)):
        patch.envelope = value
        thing.keyframe_insert("skinslide.patches[0].envelope", frame=frame)
    from bl_ext.user_default.skinslide.files import _curves

    for curve in _curves(thing):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def held(thing) -> dict:
    """All that an object is slid by, to the bit."""
    fetched = fetch(thing, bpy.context.evaluated_depsgraph_get())
    found = {
        name: (value.type_name, value.interpolation, value.value.tobytes()) for name, value in fetched.primvars.items()
    }
    for patch in fetched.patches:
        found |= {(patch.name, name): np.asarray(value.value).tobytes() for name, value in patch.values.items()}
    rest = fetched.values.get("skinSlide:restPoints")
    return found | {"rest": (rest.value if rest else fetched.basis).tobytes()}


def test_a_round_trip(tmp_path):
    """From Blender to a file and back to another mesh everything has its bits, and a second file is the first."""
    thing = sheet()
    painted(thing)
    first, second = tmp_path / "a.skinslide", tmp_path / "b.skinslide"
    assert bpy.ops.skinslide.export_setup(filepath=str(first)) == {"FINISHED"}
    other = sheet(name="other")
    other.data.shape_keys.key_blocks["bent"].value = 0
    assert bpy.ops.skinslide.import_setup(filepath=str(first)) == {"FINISHED"}
    assert held(other) == held(thing)
    assert other.skinslide.prim == "/root/sheet/sheet"
    cache = str(first).replace(".skinslide", ".usdc")
    assert bpy.ops.skinslide.export_setup(filepath=str(second), cache=cache, with_cache=False) == {"FINISHED"}
    assert second.read_text() == first.read_text()


def test_export_again_changes_what_is_blenders_alone(tmp_path):
    """Everything else in the file stays, such as a map or another prim; a patch that was removed goes."""
    thing = sheet()
    make_patch(thing, "a")
    make_patch(thing, "b")
    path = tmp_path / "x.skinslide"
    bpy.ops.skinslide.export_setup(filepath=str(path))
    text = path.read_text()
    assert "SkinSlideAPI:a" in text and "SkinSlideAPI:b" in text
    path.write_text(text + '\ndef Scope "notes"\n{\n    string note = "kept"\n}\n')
    bpy.ops.skinslide.remove_patch()
    bpy.ops.skinslide.export_setup(filepath=str(path), with_cache=False)
    text = path.read_text()
    assert "SkinSlideAPI:a" in text and "SkinSlideAPI:b" not in text and ":b:" not in text and "kept" in text


def sampled(path) -> dict:
    """Every attribute of a layer at each frame."""
    from pxr import Sdf, Usd

    layer = Sdf.Layer.OpenAsAnonymous(str(path))  # what Blender's USD holds of the path may be older
    stage = Usd.Stage.Open(layer)
    found = {"frames": (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond())}
    for prim in stage.TraverseAll():
        for attribute in prim.GetAuthoredAttributes():
            found[str(attribute.GetPath())] = [attribute.Get(frame) for frame in (1001, 1002, 1003)]
            found[f"{attribute.GetPath()} varies"] = attribute.ValueMightBeTimeVarying()
    return found


def test_the_cache_is_that_of_blenders_exporter(scene, tmp_path):
    """Joined from frames, it has at each what one export of all has: points, normals, a parent that moves."""
    thing = sheet()
    make_patch(thing)
    thing.data.uv_layers.new(name="st")
    thing.data.materials.append(bpy.data.materials.new("skin"))
    above = bpy.data.objects.new("above", None)
    scene.collection.objects.link(above)
    thing.parent = above
    for frame in (1002, 1003):
        above.location = (frame, 0, 1)
        above.keyframe_insert("location", frame=frame)
    assert bpy.ops.skinslide.export_setup(filepath=str(tmp_path / "x.skinslide")) == {"FINISHED"}
    assert (scene.frame_start, scene.frame_end, scene.frame_current) == (1001, 1003, 1001)
    thing.select_set(True)
    bpy.ops.wm.usd_export(
        filepath=str(tmp_path / "whole.usdc"), selected_objects_only=True, export_animation=True,
        export_shapekeys=False, export_textures_mode="KEEP", convert_world_material=False,
    )  # fmt: skip
    ours, whole = (sampled(tmp_path / name) for name in ("x.usdc", "whole.usdc"))
    assert ours.keys() == whole.keys() and ours["/root/above/sheet/sheet.points varies"]
    for name, wanted in whole.items():
        if "xformOp:" in name and "varies" not in name:  # which Blender leaves out where they are nearly the last one's
            assert np.allclose(ours[name], wanted, rtol=0, atol=1e-6), name
        elif "xformOp:" not in name:
            assert ours[name] == wanted, name


def test_a_cache_is_exported_again(tmp_path):
    """With other faces, under the same name, in the same session."""
    path = tmp_path / "x.skinslide"
    for side in (6, 12):
        thing = sheet(side, "thing")
        make_patch(thing)
        assert bpy.ops.skinslide.export_setup(filepath=str(path)) == {"FINISHED"}
        assert len(sampled(tmp_path / "x.usdc")[f"{thing.skinslide.prim}.faceVertexCounts"][0]) == side**2
        bpy.data.objects.remove(thing)
        path.unlink()
    assert [each.name for each in tmp_path.iterdir()] == ["x.usdc"]


def test_an_import_is_undone(tmp_path):
    thing = sheet()
    painted(thing)
    path = tmp_path / "x.skinslide"
    bpy.ops.skinslide.export_setup(filepath=str(path))
    sheet(name="other")
    bpy.ops.ed.undo_push(message="before")
    before = held(bpy.data.objects["other"])
    bpy.ops.skinslide.import_setup(filepath=str(path))
    after = held(bpy.data.objects["other"])
    bpy.ops.ed.undo_push(message="import")
    bpy.ops.ed.undo()
    assert held(bpy.data.objects["other"]) == before != after and not bpy.data.objects["other"].skinslide.patches
    bpy.ops.ed.redo()
    assert held(bpy.data.objects["other"]) == after


def test_what_cannot_be_imported(tmp_path):
    thing = sheet()
    make_patch(thing)
    path = tmp_path / "x.skinslide"
    bpy.ops.skinslide.export_setup(filepath=str(path))
    other = sheet(6, "other")
    with pytest.raises(RuntimeError, match=r"no mesh with a patch and the faces of this one.*/root/sheet/sheet"):
        bpy.ops.skinslide.import_setup(filepath=str(path))
    assert not other.skinslide.patches and not other.skinslide.file
    for text, says in (("#usda 1.0\n(", "cannot open"), ("", "cannot open")):
        path.write_text(text)
        with pytest.raises(RuntimeError, match=says):
            bpy.ops.skinslide.import_setup(filepath=str(path))
    with pytest.raises(RuntimeError, match="No such file"):
        bpy.ops.skinslide.import_setup(filepath=str(tmp_path / "none.skinslide"))


def test_what_cannot_be_exported(tmp_path):
    thing = sheet()
    path = tmp_path / "x.skinslide"
    with pytest.raises(RuntimeError, match="no patch"):
        bpy.ops.skinslide.export_setup(filepath=str(path))
    assert not list(tmp_path.iterdir())
    make_patch(thing)
    with pytest.raises(RuntimeError, match="there is no cache"):
        bpy.ops.skinslide.export_setup(filepath=str(path), with_cache=False)
    path.write_text("#usda 1.0\n")
    for others in ([], [tmp_path / "x.usdc"]):
        for each in others:
            each.write_text('#usda 1.0\n(doc = "another")\n')
        before = {each: (each.read_bytes(), each.stat().st_mtime_ns) for each in tmp_path.iterdir()}
        with pytest.raises(RuntimeError, match="does not sublayer"):
            bpy.ops.skinslide.export_setup(filepath=str(path))
        assert {each: (each.read_bytes(), each.stat().st_mtime_ns) for each in tmp_path.iterdir()} == before
    with pytest.raises(RuntimeError, match=r"the folder .* does not exist"):
        bpy.ops.skinslide.export_setup(filepath=str(tmp_path / "none" / "x.skinslide"))


@pytest.mark.parametrize("rule", ["unit", "even", "relaxed", "world"])
def test_for_the_bake(rule, scene, out):
    """Writes what is shown live, for the test outside to compare with a bake of what is exported."""
    thing = sheet()
    if rule == "world":
        above = bpy.data.objects.new("above", None)
        scene.collection.objects.link(above)
        thing.parent, above.scale, thing.skinslide.worldSpace = above, (1, 1, 3), True
        bpy.context.view_layer.update()
    painted(thing, "even" if rule == "world" else rule)
    bpy.ops.skinslide.live()
    for frame in (1001, 1002, 1003):
        scene.frame_set(frame)
        np.save(out / f"{rule}.{frame}.npy", points(thing.skinslide.slid))
    bpy.context.view_layer.objects.active = thing
    assert bpy.ops.skinslide.export_setup(filepath=str(out / f"{rule}.skinslide")) == {"FINISHED"}


def test_a_file_of_the_tool(out):
    """Imports what the tool wrote, of kinds that Blender does not have: a GeomSubset, a constant, indices."""
    thing = sheet()
    path = out / "given.skinslide"
    assert bpy.ops.skinslide.import_setup(filepath=str(path)) == {"FINISHED"}
    chosen = np.empty(SIDE * SIDE, np.bool_)
    thing.data.attributes["skinSlide:tool:patch"].data.foreach_get("value", chosen)
    assert np.array_equal(np.flatnonzero(chosen), np.arange(40, 80))
    assert np.all(values(thing, "skinSlide:tool:hold") == 2.5)
    assert np.array_equal(values(thing, "skinSlide:tool:forceDensity"), np.where(np.arange(SIDE * SIDE) % 2, 5.0, 1.5))
    patch = thing.skinslide.patches["tool"]
    assert (patch.forceDensityRule, patch.envelope) == ("relaxed", 0.5)
    assert not thing.skinslide.weld and not patch.is_property_set("corners")


def test_a_map_for_the_bake(scene, out):
    """The weight is an image beside the file, by its relative path, at texture coordinates that Blender exports."""
    thing = sheet()
    coordinates = thing.data.uv_layers.new(name="st")
    flat = np.array([thing.data.vertices[loop.vertex_index].co[:2] for loop in thing.data.loops], np.float32) + 0.5
    coordinates.uv.foreach_set("vector", flat.ravel())
    patch = make_patch(thing)
    pixels = np.random.default_rng(2).random((16, 16), np.float32)
    (out / "weight.exr").write_bytes(encode_exr({"R": pixels}))
    patch.weightMap, thing.skinslide.file = "./weight.exr", str(out / "map.skinslide")
    assert bpy.ops.skinslide.live() == {"FINISHED"}
    for frame in (1001, 1002, 1003):
        scene.frame_set(frame)
        np.save(out / f"map.{frame}.npy", points(thing.skinslide.slid))
    bpy.context.view_layer.objects.active = thing
    assert bpy.ops.skinslide.export_setup(filepath=str(out / "map.skinslide")) == {"FINISHED"}
    other = sheet(name="other")
    assert bpy.ops.skinslide.import_setup(filepath=str(out / "map.skinslide")) == {"FINISHED"}
    assert other.skinslide.patches["patch"].weightMap == "./weight.exr"


@pytest.mark.parametrize("setting", ['uniform token skinSlide:patch:boundary = "x"', "float skinSlide:patch:grow = -1"])
def test_settings_that_cannot_be_are_not_imported(setting, tmp_path):
    thing = sheet()
    make_patch(thing, "patch")
    path = tmp_path / "x.skinslide"
    bpy.ops.skinslide.export_setup(filepath=str(path))
    text = path.read_text()
    path.write_text(
        text.replace(
            "uniform token skinSlide:patch:forceDensityRule",
            f"{setting}\n uniform token skinSlide:patch:forceDensityRule",
        )
    )
    other = sheet(name="other")
    with pytest.raises(RuntimeError, match=f"patch patch: {setting.split()[-3]}.*"):
        bpy.ops.skinslide.import_setup(filepath=str(path))
    assert not other.skinslide.patches and "skinSlide:restPoints" not in other.data.attributes
