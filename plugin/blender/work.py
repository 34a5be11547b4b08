"""Work of the core, done on a thread of its own while Blender stays in use, and operators that wait for it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, ClassVar

import bpy

from skinslide.problems import Fault, SliderError

# One thread: what is asked for later has what was asked for earlier behind it.
_pool: list[ThreadPoolExecutor] = []
INTERVAL = 1 / 60  # seconds from one look to the next
PATIENCE = 0.02  # seconds that a frame may take before Blender goes on without it


def interactive() -> bool:
    """Whether there is an interface to keep in use."""
    return not bpy.app.background


def patience() -> float | None:
    """How long to wait for work; None: until it is done, as for pictures, and where there is no interface."""
    return PATIENCE if interactive() and not bpy.app.is_job_running("RENDER") else None


def start(work: Callable[..., Any], *arguments: Any) -> Future[Any]:
    """Begins some work, which must not touch anything of Blender's."""
    if not _pool:
        _pool.append(ThreadPoolExecutor(1, "skinslide-blender"))
    return _pool[0].submit(work, *arguments)


def stop() -> None:
    """Lets go of the thread."""
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
    """The name of the active object, which outlives it, and how many vertices, edges and faces it has."""
    thing = context.active_object
    mesh = thing.data if thing and thing.type == "MESH" else None
    return thing.name if thing else "", (len(mesh.vertices), len(mesh.edges), len(mesh.polygons)) if mesh else ()


class Waiting(bpy.types.Operator):
    """An operator in three steps: fetch, work apart, and write.

    From the interface Blender goes on meanwhile; from scripts it waits. What raises Fault becomes a report, and nothing
    is written.
    """

    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    def fetch(self, context: bpy.types.Context) -> Callable[[], Any] | None:
        """Says what there is to work out, of what is fetched now; None: nothing."""
        raise NotImplementedError

    def write(self, context: bpy.types.Context, found: Any) -> str:
        """Writes what was worked out, and says what was done."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Begins, and waits for the work; of a script does all at once."""
        if self.options.is_invoke and interactive():
            return self._guarded(lambda: self._begun(context))
        return self._guarded(lambda: self._written(context, self._worked(self._fetched(context))))

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Ends once the work is done."""
        if event.type != "TIMER" or not self._future.done():
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self._timer)
        return self._guarded(lambda: self._ended(context))

    def _fetched(self, context: bpy.types.Context) -> Callable[[], Any] | None:
        with in_object_mode(context):  # in edit mode nothing is evaluated
            return self.fetch(context)

    def _worked(self, work: Callable[[], Any] | None) -> Any:
        return work() if work else None

    def _begun(self, context: bpy.types.Context) -> set[str]:
        work = self._fetched(context)
        if not work:
            return self._written(context, None)
        with in_object_mode(context):
            self._begun_on = _active(context)
        self._future = start(work)
        self._timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _ended(self, context: bpy.types.Context) -> set[str]:
        found = self._future.result()
        name, counts = self._begun_on
        with in_object_mode(context):
            if _active(context)[0] != name:
                raise Fault(f"{name} is no longer the active object; nothing was changed")
            if _active(context)[1] != counts:
                raise Fault(f"{name} has other vertices or faces than it had; nothing was changed")
            return self._written(context, found)

    def _written(self, context: bpy.types.Context, found: Any) -> set[str]:
        with in_object_mode(context):
            said = self.write(context, found)
        if said:
            self.report({"INFO"}, said)
        return {"FINISHED"}

    def _guarded(self, step: Callable[[], set[str]]) -> set[str]:
        try:
            return step()
        except (Fault, SliderError, MemoryError) as fault:
            self.report({"ERROR"}, str(fault))
            return {"CANCELLED"}
