"""The panel: all that it shows is there; and operators and frames where Blender does not wait."""

from __future__ import annotations

import threading
import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from bl_ext.user_default.skinslide import files, live, work
from bl_ext.user_default.skinslide.paint import PAINTED
from bl_ext.user_default.skinslide.panel import SKINSLIDE_PT_panel

from sheets import inner, line, make_patch, points, select, sheet
from skinslide.problems import Fault


class Properties:
    """The properties of an operator's button; notes what the button would paint."""

    def __init__(self, names: set[str], shown: list[str]):
        self.__dict__.update(names=names, shown=shown)

    def __setattr__(self, name: str, value):
        assert name in self.names
        if name == "what":
            self.shown.append(value)


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
        return Properties({each.identifier for each in properties}, self.shown)

    def template_list(self, kind: str, _identifier: str, data, held: str, _active_data, _active: str, **_):
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
    assert {"forceDensityRule", "interpolation", "skinslide.live"} <= set(shown)
    assert [each for each in shown if each in PAINTED] == list(PAINTED)
    thing.skinslide.problem = "one\ntwo"
    assert {"one", "two"} <= set(drawn())


def test_tooltips_leave_the_full_stop_to_blender():
    buttons = set(dir(bpy.ops.skinslide)) - {"say"}
    tips = [getattr(bpy.ops.skinslide, name).get_rna_type().description for name in buttons]
    assert len(tips) > 10 and all(tips)
    make_patch(thing := sheet())
    for group in (thing.skinslide, thing.skinslide.patches[0]):
        tips += [each.description for each in group.bl_rna.properties]
    assert len(tips) > 40 and not [tip for tip in tips if tip.endswith(".")]


def test_it_is_of_meshes_alone():
    assert not SKINSLIDE_PT_panel.poll(type("Context", (), {"active_object": None})())


@pytest.fixture
def impatient(monkeypatch):
    """Blender goes on at once, as in an interface whose frames come fast."""
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
    """A set-up whose frame is overtaken by a later one still counts."""
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
    """What Waiting does, on an object of ours: Blender makes operators itself, of events, which are not there."""

    bl_label = "Some Operator"
    for _name in ("execute", "modal", "cancel", "tell", "_may_wait", "_go_on", "_check", "_end", "_steps"):
        locals()[_name] = getattr(work.Waiting, _name)

    def __init__(self, *works):
        self.works, self.written, self.ended, self.reports = works, [], False, []
        self.options = SimpleNamespace(is_invoke=True, is_repeat=False, is_repeat_last=False)

    def steps(self, _context):
        try:
            for each in self.works:
                self.written.append((yield each))
        finally:
            self.ended = True
        return "done"

    def report(self, kinds: set[str], text: str) -> None:
        self.reports.append((kinds, text))


class Window:
    """A context that notes timers and operators that wait; everything else is Blender's."""

    workspace = None

    def __init__(self):
        self.window_manager, self.timers, self.waiting = self, [], []
        self.window, self.modal_operators = self, [SimpleNamespace(bl_idname="SKINSLIDE_OT_live")]

    def __getattr__(self, name: str):
        return getattr(bpy.context, name)

    def event_timer_add(self, interval: float, window) -> object:
        self.timers.append(object())
        return self.timers[-1]

    def event_timer_remove(self, timer: object) -> None:
        self.timers.remove(timer)

    def modal_handler_add(self, operator: Operator) -> None:
        self.waiting.append(operator)


@pytest.fixture
def window(scene, monkeypatch) -> Window:
    """Pretends that there is an interface."""
    monkeypatch.setattr(work, "interactive", lambda: True)
    return Window()


TIMER, ESC = SimpleNamespace(type="TIMER", value="NOTHING"), SimpleNamespace(type="ESC", value="PRESS")
RUNNING, PASSED = {"RUNNING_MODAL"}, {"PASS_THROUGH"}


def ended(operator: Operator, window: Window, on_tick=lambda: None) -> set[str]:
    until = time.monotonic() + 20
    while time.monotonic() < until:
        on_tick()
        found = operator.modal(window, TIMER)
        if found != PASSED:
            assert not window.timers
            return found
        time.sleep(0.001)
    raise AssertionError("it never ends")


def test_an_operator_leaves_blender_in_use(window):
    """It begins, lets events pass, and goes on once its work is done."""
    go = threading.Event()
    operator = Operator(lambda: go.wait(20) and "found", lambda: "more")
    assert operator.execute(window) == RUNNING
    assert window.waiting == [operator] and len(window.timers) == 1
    assert operator.modal(window, SimpleNamespace(type="MOUSEMOVE", value="NOTHING")) == PASSED
    assert operator.modal(window, TIMER) == PASSED and not operator.written
    go.set()
    assert ended(operator, window) == {"FINISHED"}
    assert operator.written == ["found", "more"] and operator.reports == [({"INFO"}, "done")]


@pytest.mark.parametrize("how", ["is_repeat", "is_repeat_last"])
def test_what_blender_repeats_is_done_at_once(how, window):
    """Blender repeats an operator to adjust it, and expects it to be done when it returns."""
    operator = Operator(lambda: "found")
    setattr(operator.options, how, True)
    assert operator.execute(window) == {"FINISHED"}
    assert operator.written == ["found"] and not window.waiting


def test_what_fails_apart_is_reported(window):
    def fails():
        raise Fault("there is no patch to slide")

    operator = Operator(lambda: "found", fails)
    assert operator.execute(window) == RUNNING
    assert ended(operator, window) == {"CANCELLED"}
    assert operator.reports == [({"ERROR"}, "there is no patch to slide")]
    assert operator.written == ["found"] and operator.ended


def test_esc_ends_it(window):
    """Once the work that has begun is done, and not while files are put in place."""
    go = threading.Event()
    operator = Operator(lambda: go.wait(20))
    assert operator.execute(window) == RUNNING
    assert operator.modal(window, ESC) == RUNNING
    assert operator.modal(window, TIMER) == PASSED and not operator.ended
    go.set()
    assert ended(operator, window) == {"CANCELLED"}
    assert operator.reports == [({"WARNING"}, "Some Operator: ended by Esc; nothing was changed")]
    assert not operator.written and operator.ended
    late = Operator(lambda: "found")
    late.execute(window)
    late.too_late = True
    assert late.modal(window, ESC) == PASSED
    assert ended(late, window) == {"FINISHED"}


def test_it_waits_for_what_is_edited(window):
    """If edit mode is left while points are being moved, Blender crashes."""
    thing = sheet()
    bpy.ops.object.mode_set(mode="EDIT")
    operator = Operator(lambda: "found")
    assert operator.execute(window) == RUNNING
    operator._future.result()
    window.modal_operators.append(SimpleNamespace(bl_idname="TRANSFORM_OT_translate"))
    assert operator.modal(window, TIMER) == PASSED and not operator.written
    window.modal_operators.pop()
    assert ended(operator, window) == {"FINISHED"} and thing.mode == "EDIT"


def test_blender_ends_it(window):
    """When it quits, loads a file, or when no file was chosen."""
    operator = Operator(lambda: "found")
    operator.cancel(window)
    assert operator.execute(window) == RUNNING
    operator.cancel(window)
    assert operator.ended and not window.timers and not operator.written and not operator.reports


def test_what_is_wrong_with_the_program_is_not_hidden(window):
    operator = Operator(lambda: 1 / 0)
    assert operator.execute(window) == RUNNING
    with pytest.raises(ZeroDivisionError):
        ended(operator, window)
    assert operator.ended and not window.timers


def test_another_object_is_not_written_to(window):
    """While an operator waits, another object may become active."""
    first, second = sheet(), sheet()
    bpy.context.view_layer.objects.active = first
    operator = Operator(lambda: "found")
    assert operator.execute(window) == RUNNING
    bpy.context.view_layer.objects.active = second
    assert ended(operator, window) == {"CANCELLED"}
    assert operator.reports == [({"ERROR"}, f"{first.name} is no longer the active object; nothing was changed")]
    assert not operator.written


def test_a_mesh_edited_meanwhile_is_not_written_to(window):
    thing = sheet()
    operator = Operator(lambda: "found")
    assert operator.execute(window) == RUNNING
    thing.data.vertices.add(1)
    assert ended(operator, window) == {"CANCELLED"}
    assert operator.reports == [
        ({"ERROR"}, f"{thing.name} has other vertices or faces than it had; nothing was changed")
    ]
    assert not operator.written


class Export(Operator):
    """The export, with Blender's own exporter, from frame to frame."""

    cache, prim, with_cache = "", "", True
    steps, _with_cache = files.SKINSLIDE_OT_export_setup.steps, files.SKINSLIDE_OT_export_setup._with_cache

    def __init__(self, path):
        super().__init__()
        self.filepath, self.told = str(path), []

    def tell(self, _context, text: str | None) -> None:
        self.told.append(text)


def test_an_export_leaves_blender_in_use(window, tmp_path):
    """From frame to frame, the timeline where it was; and what it writes is what a script's export writes."""
    thing = sheet()
    make_patch(thing)
    bpy.ops.skinslide.live()
    bpy.context.view_layer.objects.active = thing
    before, frames = points(thing.skinslide.slid), []
    export = Export(tmp_path / "x.skinslide")
    assert export.execute(window) == RUNNING
    assert ended(export, window, lambda: frames.append(bpy.context.scene.frame_current)) == {"FINISHED"}
    assert set(frames) == {1001} and np.array_equal(points(thing.skinslide.slid), before)
    assert export.told == [*(f"Exporting frame {each} of 1003; Esc ends it" for each in (1001, 1002, 1003)), None]
    assert bpy.ops.skinslide.export_setup(filepath=str(tmp_path / "y.skinslide")) == {"FINISHED"}
    assert {each.name for each in tmp_path.iterdir()} == {"x.skinslide", "x.usdc", "y.skinslide", "y.usdc"}
    assert (tmp_path / "x.usdc").read_bytes() == (tmp_path / "y.usdc").read_bytes()
    assert (tmp_path / "x.skinslide").read_text().replace("x.usdc", "y.usdc") == (tmp_path / "y.skinslide").read_text()


@pytest.mark.parametrize("after", range(6))
def test_an_export_that_is_ended_leaves_what_was_there(after, window, tmp_path):
    """By Esc at any time until it is too late, when all is written."""
    thing = sheet()
    make_patch(thing)
    path = tmp_path / "x.skinslide"
    bpy.ops.skinslide.export_setup(filepath=str(path))
    before = {each.name: (each.read_bytes(), each.stat().st_mtime_ns) for each in tmp_path.iterdir()}
    bpy.context.scene.frame_end = 1004
    export, ticks = Export(path), iter(range(1000))

    def press():
        export._future.exception()  # which waits
        if next(ticks) == after:
            export.modal(window, ESC)

    assert export.execute(window) == RUNNING
    assert ended(export, window, press) == {"CANCELLED"}
    assert {each.name: (each.read_bytes(), each.stat().st_mtime_ns) for each in tmp_path.iterdir()} == before
    assert bpy.context.scene.frame_end == 1004 and thing.skinslide.file == str(path)


def test_an_export_of_what_is_removed_meanwhile(window, tmp_path):
    thing = sheet()
    make_patch(thing)
    export = Export(tmp_path / "x.skinslide")
    assert export.execute(window) == RUNNING

    def remove():
        if export.told and "sheet" in bpy.data.objects:
            bpy.data.objects.remove(thing)

    assert ended(export, window, remove) == {"CANCELLED"}
    assert export.reports == [({"ERROR"}, "sheet is no longer the active object; nothing was changed")]
    assert not list(tmp_path.iterdir())


SIDE = 99  # 10,000 points
MOST = 0.05  # seconds of the processor, by the thread that the interface has


def test_nothing_blocks_the_interface(monkeypatch, tmp_path):
    """Between two of the works of an operator, the fastest of three times, as others use the processor too."""
    taken: dict[tuple, list[float]] = {}
    go_on = work.Waiting._go_on

    def timed(self, context, found):
        found = found()
        start = time.thread_time()
        state = go_on(self, context, lambda: found)
        self.step = getattr(self, "step", -1) + 1
        taken.setdefault((self.bl_idname, self.step), []).append(time.thread_time() - start)
        return state

    thing = sheet(SIDE)
    thing.data.uv_layers.new(name="st")
    drawn = line((-0.5, 0, 0), (0.5, 0, 0))
    group = thing.vertex_groups.new(name="group")
    group.add(
        np.unique([list(thing.data.polygons[each].vertices) for each in np.flatnonzero(inner(thing))]).tolist(),
        1,
        "ADD",
    )
    monkeypatch.setattr(work.Waiting, "_go_on", timed)
    operators = bpy.ops.skinslide
    for _ in range(3):
        select(thing, "faces", inner(thing))
        operators.patch_from_group(name="b", group="group")
        operators.remove_patch()
        operators.patch_from_faces(name="a")
        operators.paint(what="weight", value=1.0, store="GROUP")
        operators.paint(what="forceDensity", value=2.0, store="POINT")
        operators.paint_edges(value=2.0)
        operators.paint_curve(curve=drawn.name)
        operators.rest_from_basis()
        operators.rest_from_frame(frame=1002)
        operators.rest_from_basis()
        operators.live()
        bpy.context.view_layer.objects.active = thing
        operators.live()
        operators.export_setup(filepath=str(tmp_path / "x.skinslide"))
        operators.import_setup(filepath=str(tmp_path / "x.skinslide"))
        operators.remove_patch()
    assert {name for name, _ in taken} == {each.__name__ for each in operators_that_wait()}
    assert all(len(each) >= 3 for each in taken.values())
    assert not {step: min(each) for step, each in taken.items() if min(each) > MOST}


def operators_that_wait(kind: type = work.Waiting) -> list[type]:
    """Those of the extension, not what they have in common."""
    kinds = kind.__subclasses__()
    return [each for own in kinds for each in operators_that_wait(own)] if kinds else [kind]


def test_no_frame_blocks_the_interface(scene, impatient):
    """Neither when it is begun nor when it is shown, also after a change of paint."""
    thing = sheet(SIDE)
    make_patch(thing)
    bpy.ops.skinslide.paint(what="weight", value=0.5, store="GROUP")
    bpy.ops.skinslide.live()
    group, taken = thing.vertex_groups["skinSlide:patch:weight"], {}
    for frame in (1002, 1003, 1001) * 2:
        change = frame == 1001
        if change:
            group.add([0], 0.5, "REPLACE")
            thing.data.update_tag()
        start = time.thread_time()
        scene.frame_set(frame)
        taken.setdefault(("begun", change), []).append(time.thread_time() - start)
        live._sessions[thing.name].future.result()
        start = time.thread_time()
        assert live._look() is None
        taken.setdefault(("shown", change), []).append(time.thread_time() - start)
    assert not {step: each for step, each in taken.items() if min(each) > MOST}
