"""Work of the core, done on a thread of its own while Blender stays in use, and operators that wait for it."""

from __future__ import annotations

from collections.abc import Callable, Generator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from typing import Any, ClassVar

import bpy

from skinslide.problems import Fault, SliderError

Work = Callable[[], Any]  # must not touch Blender
Steps = Generator[Work, Any, str]
# One thread, so that work is done in the order in which it was started.
_pool: list[ThreadPoolExecutor] = []
RUNNING = {"RUNNING_MODAL"}
INTERVAL = 1 / 60  # seconds from one look to the next
PATIENCE = 0.02  # seconds that a frame may take before Blender goes on without it


def interactive() -> bool:
    """Whether there is an interface that must stay in use."""
    return not bpy.app.background


def patience() -> float | None:
    """How long to wait for work; None: until it is done, as for pictures, and where there is no interface."""
    return PATIENCE if interactive() and not bpy.app.is_job_running("RENDER") else None


def start(work: Callable[..., Any], *arguments: Any) -> Future[Any]:
    """Starts some work."""
    if not _pool:
        _pool.append(ThreadPoolExecutor(1, "skinslide-blender"))
    return _pool[0].submit(work, *arguments)


def stop() -> None:
    """Ends the thread."""
    while _pool:
        _pool.pop().shutdown(wait=True, cancel_futures=True)


@contextmanager
def in_object_mode(context: bpy.types.Context) -> Any:
    """Where attributes can be written, and are evaluated; the mode is then as it was before."""
    mode = context.active_object.mode if context.active_object else "OBJECT"
    if mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    try:
        yield
    finally:
        if mode != "OBJECT":
            bpy.ops.object.mode_set(mode=mode)


def _active(context: bpy.types.Context) -> tuple[str, tuple[int, ...]]:
    """The name of the active object, which stays valid when that is gone, and its vertex, edge and face counts."""
    thing = context.active_object
    mesh = thing.data if thing and thing.type == "MESH" else None
    return thing.name if thing else "", (len(mesh.vertices), len(mesh.edges), len(mesh.polygons)) if mesh else ()


def _is_edited(context: bpy.types.Context) -> bool:
    """Whether an operator of Blender is running, such as a stroke or a move: then the mode cannot be left."""
    if context.mode == "OBJECT":
        return False
    names = [each.bl_idname for each in context.window.modal_operators]
    return any(bpy.types.Operator.bl_rna_get_subclass_py(name) is None for name in names)


def asked(operator: bpy.types.Operator, context: bpy.types.Context) -> set[str]:
    """Has Blender ask for the properties of an operator, and then run it."""
    return set(context.window_manager.invoke_props_dialog(operator))


class Waiting(bpy.types.Operator):
    """An operator in steps, with work apart between them.

    From the interface Blender goes on during that work, and Esc ends the operator; from scripts it waits. What raises
    Fault becomes a report, and nothing is written.
    """

    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}
    _steps: Steps | None = None

    def __init_subclass__(cls, **words: Any) -> None:
        super().__init_subclass__(**words)
        cls.bl_description = (cls.__doc__ or "").removesuffix(".")  # Blender ends a tooltip with a full stop

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether its button is of any use, or why not."""
        try:
            cls.need(context)
        except Fault as fault:
            cls.poll_message_set(str(fault))
            return False
        return True

    @classmethod
    def need(cls, context: bpy.types.Context) -> None:
        """Raises Fault if there is nothing to work on."""
        if context.active_object is None or context.active_object.type != "MESH":
            raise Fault("the active object is not a mesh")

    def steps(self, context: bpy.types.Context) -> Steps:
        """Yields work, is sent its result, and returns what to report. Whatever it has begun ends with it."""
        work = self.fetch(context)
        found = (yield work) if work else None
        return self.write(context, found)

    def fetch(self, context: bpy.types.Context) -> Work | None:
        """Fetches from Blender now, and returns the work to do on that; None: nothing."""
        raise NotImplementedError

    def write(self, context: bpy.types.Context, found: Any) -> str:
        """Writes what the work found, and returns what to report."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Begins, and goes on when the work is done; from a script, does everything at once."""
        self._steps, self._timer = self.steps(context), None
        self._begun_on: tuple[str, tuple[int, ...]] | None = None
        self._unwanted = self.too_late = False  # the latter once files are put in place
        state = self._go_on(context, lambda: None)
        if state == RUNNING and self._may_wait() and interactive():
            self._timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
            context.window_manager.modal_handler_add(self)
            return state
        while state == RUNNING:
            state = self._go_on(context, self._future.result)
        return state

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Goes on once the work is done."""
        if event.type == "ESC" and event.value == "PRESS" and not self.too_late:
            self._unwanted = True
            return RUNNING
        if event.type != "TIMER" or not self._future.done() or _is_edited(context):
            return {"PASS_THROUGH"}
        if self._unwanted:
            return self._end(context, "CANCELLED", "WARNING", f"{self.bl_label}: ended by Esc; nothing was changed")
        state = self._go_on(context, self._future.result)
        return {"PASS_THROUGH"} if state == RUNNING else state

    def cancel(self, context: bpy.types.Context) -> None:
        """Called when Blender ends the operator: it quits, loads a file, or the choice of a file was cancelled."""
        if self._steps:
            wait([self._future])
            self._end(context, "CANCELLED")

    def _may_wait(self) -> bool:
        """Not for scripts, nor when Blender repeats an operator, since it expects that to be done when it returns."""
        return self.options.is_invoke and not (self.options.is_repeat or self.options.is_repeat_last)

    def tell(self, context: bpy.types.Context, text: str | None) -> None:
        """Shows progress in the status bar."""
        if interactive() and context.workspace:
            context.workspace.status_text_set(text)

    def _go_on(self, context: bpy.types.Context, found: Work) -> set[str]:
        """Takes the next step with what was found, and starts the work that follows."""
        try:
            with in_object_mode(context):  # in edit mode nothing is evaluated
                given = found()
                self._check(_active(context))
                assert self._steps
                self._future = start(self._steps.send(given))
            return RUNNING
        except StopIteration as end:
            return self._end(context, "FINISHED", "INFO", end.value)
        except (Fault, SliderError, MemoryError) as fault:
            return self._end(context, "CANCELLED", "ERROR", str(fault))
        except Exception:
            self._end(context, "CANCELLED")
            raise

    def _check(self, active: tuple[str, tuple[int, ...]]) -> None:
        """Raises Fault if another object has become active, or the object was edited."""
        self._begun_on = self._begun_on or active
        name, counts = self._begun_on
        if active[0] != name:
            raise Fault(f"{name} is no longer the active object; nothing was changed")
        if active[1] != counts:
            raise Fault(f"{name} has other vertices or faces than it had; nothing was changed")

    def _end(self, context: bpy.types.Context, state: str, kind: str = "INFO", said: str = "") -> set[str]:
        assert self._steps
        self._steps.close()
        if self._timer:
            context.window_manager.event_timer_remove(self._timer)
            self.tell(context, None)
        if said:
            self.report({kind}, said)
        return {state}
