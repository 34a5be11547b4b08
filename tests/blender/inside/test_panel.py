"""The panel: all that it shows is there; and operators and frames where Blender does not wait."""

from __future__ import annotations

import threading
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from bl_ext.user_default.skinslide import live, work
from bl_ext.user_default.skinslide.panel import SKINSLIDE_PT_panel

from sheets import make_patch, points, sheet
from skinslide.problems import Fault


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


# ---- Operators that wait ----


class Operator:
    """What Waiting does, on an object of ours: Blender makes operators itself, of events, of which there are none."""

    for _name in ("execute", "modal", "_fetched", "_worked", "_begun", "_ended", "_written", "_guarded"):
        locals()[_name] = getattr(work.Waiting, _name)

    def __init__(self, work_apart):
        self.work, self.written, self.reports = work_apart, [], []
        self.options = SimpleNamespace(is_invoke=True)

    def fetch(self, _context):
        return self.work

    def write(self, _context, found) -> str:
        self.written.append(found)
        return "done"

    def report(self, kinds: set[str], text: str) -> None:
        self.reports.append((kinds, text))


class Window:
    """A context that notes timers and who waits for them."""

    active_object = None
    window = None

    def __init__(self):
        self.window_manager, self.timers, self.waiting = self, [], []

    def event_timer_add(self, interval: float, window) -> object:
        self.timers.append(object())
        return self.timers[-1]

    def event_timer_remove(self, timer: object) -> None:
        self.timers.remove(timer)

    def modal_handler_add(self, operator: Operator) -> None:
        self.waiting.append(operator)


def ended(operator: Operator, window: Window) -> set[str]:
    until = time.monotonic() + 20
    while time.monotonic() < until:
        found = operator.modal(window, SimpleNamespace(type="TIMER"))
        if found != {"PASS_THROUGH"}:
            return found
        time.sleep(0.01)
    raise AssertionError("it never ends")


def test_an_operator_leaves_blender_in_use(monkeypatch):
    """It begins, lets events pass, and writes once its work is done."""
    monkeypatch.setattr(work, "interactive", lambda: True)
    go, window = threading.Event(), Window()
    operator = Operator(lambda: go.wait(20) and "found")
    assert operator.execute(window) == {"RUNNING_MODAL"}
    assert window.waiting == [operator] and len(window.timers) == 1
    assert operator.modal(window, SimpleNamespace(type="MOUSEMOVE")) == {"PASS_THROUGH"}
    assert operator.modal(window, SimpleNamespace(type="TIMER")) == {"PASS_THROUGH"} and not operator.written
    go.set()
    assert ended(operator, window) == {"FINISHED"}
    assert operator.written == ["found"] and not window.timers and operator.reports == [({"INFO"}, "done")]


def test_what_fails_apart_is_reported(monkeypatch):
    def fails():
        raise Fault("there is no patch to slide")

    monkeypatch.setattr(work, "interactive", lambda: True)
    operator, window = Operator(fails), Window()
    assert operator.execute(window) == {"RUNNING_MODAL"}
    assert ended(operator, window) == {"CANCELLED"}
    assert (
        operator.reports == [({"ERROR"}, "there is no patch to slide")] and not operator.written and not window.timers
    )


def test_another_object_is_not_written_to(scene, monkeypatch):
    """Whoever waits may choose another meanwhile."""
    monkeypatch.setattr(work, "interactive", lambda: True)
    window, first, second = Window(), sheet(), sheet()
    window.active_object = first
    operator = Operator(lambda: "found")
    assert operator.execute(window) == {"RUNNING_MODAL"}
    window.active_object = second
    assert ended(operator, window) == {"CANCELLED"}
    assert operator.reports == [({"ERROR"}, f"{first.name} is no longer the active object; nothing was changed")]
    assert not operator.written and not window.timers


def test_a_mesh_edited_meanwhile_is_not_written_to(scene, monkeypatch):
    monkeypatch.setattr(work, "interactive", lambda: True)
    window, thing = Window(), sheet()
    window.active_object = thing
    operator = Operator(lambda: "found")
    assert operator.execute(window) == {"RUNNING_MODAL"}
    thing.data.vertices.add(1)
    assert ended(operator, window) == {"CANCELLED"}
    assert operator.reports == [
        ({"ERROR"}, f"{thing.name} has other vertices or faces than it had; nothing was changed")
    ]
    assert not operator.written and not window.timers
