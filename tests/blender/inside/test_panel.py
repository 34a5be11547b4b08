"""The panel: all that it shows is there; and the switch where Blender does not wait."""

from __future__ import annotations

import time

import bpy
import numpy as np
import pytest
from bl_ext.user_default.skinslide import live, work
from bl_ext.user_default.skinslide.panel import SKINSLIDE_PT_panel

from sheets import make_patch, points, sheet


class Layout:
    """A layout that notes what it is given, and knows no property or operator that Blender does not."""

    def __init__(self, shown: list[str]):
        self.shown = shown

    def column(self, **_):
        return self

    row = column

    def panel(self, *_arguments, **_keywords):
        return self, self

    def label(self, text: str = "", **_):
        self.shown.append(text)

    def prop(self, data, name: str, **_):
        assert name in data.bl_rna.properties
        self.shown.append(name)

    def operator(self, name: str, **_):
        room, _, own = name.partition(".")
        properties = getattr(getattr(bpy.ops, room), own).get_rna_type().properties
        self.shown.append(name)
        return type("Properties", (), {each.identifier: None for each in properties})()

    def template_list(self, kind: str, _identifier: str, data, held: str, _active_data, _active: str):
        assert hasattr(bpy.types, kind)
        self.shown += [item.name for item in getattr(data, held)]


def drawn() -> list[str]:
    shown: list[str] = []
    panel = type("Panel", (), {"layout": Layout(shown)})()
    SKINSLIDE_PT_panel.draw(panel, bpy.context)
    return shown


def test_it_lists_patches_and_what_is_wrong():
    thing = sheet()
    assert "forceDensityRule" not in drawn()
    make_patch(thing, "elbow_L")
    make_patch(thing, "knee_L")
    shown = drawn()
    assert shown[:2] == ["elbow_L", "knee_L"]
    assert {"forceDensityRule", "interpolation", "weight", "forceDensity", "hold", "skinslide.live"} <= set(shown)
    thing.skinslide.problem = "one\ntwo"
    assert {"one", "two"} <= set(drawn())


def test_it_is_of_meshes_alone():
    assert not SKINSLIDE_PT_panel.poll(type("Context", (), {"active_object": None})())


@pytest.fixture
def impatient(monkeypatch):
    """Blender goes on at once, as with an interface whose frames come fast."""
    monkeypatch.setattr(work, "patience", lambda: 0)


def test_frames_are_shown_once_they_are_there(scene, impatient):
    thing = sheet(40)
    make_patch(thing, rule="relaxed")
    bpy.ops.skinslide.live()
    shown = thing.skinslide.slid
    before = points(shown)
    for frame in (1002, 1003):
        scene.frame_set(frame)
    assert np.array_equal(points(shown), before)
    until = time.monotonic() + 20
    while live._look() and time.monotonic() < until:
        time.sleep(0.01)
    late = points(shown)
    assert not np.array_equal(late, before)
    work.patience = lambda: None  # monkeypatch puts it back
    scene.frame_set(1003)
    assert points(shown).tobytes() == late.tobytes()


def test_a_change_is_not_lost_with_its_frame(scene, impatient):
    """A set-up that a later frame overtakes counts all the same."""
    thing = sheet(40)
    patch = make_patch(thing, rule="relaxed")
    bpy.ops.skinslide.live()
    for rule, frame in (("unit", 1002), ("even", 1003), ("fast", 1002), ("unit", 1003)):
        patch.forceDensityRule = rule
        scene.frame_set(frame)
    until = time.monotonic() + 20
    while live._look() and time.monotonic() < until:
        time.sleep(0.01)
    late = points(thing.skinslide.slid)
    bpy.ops.skinslide.live()
    work.patience = lambda: None
    bpy.ops.skinslide.live()
    assert points(thing.skinslide.slid).tobytes() == late.tobytes()
