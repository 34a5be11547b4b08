"""How long the interface of Blender waits for the extension, at 10,000 points.

    BLENDER_USER_RESOURCES=USER build/blender/5.0.1/bin/python tests/bench/bench_blender.py

Prints milliseconds, by the clock and of the thread's processor: of operators the longest of their steps, between which
Blender goes on, and the longest work apart; of frames fetching and showing, and the slide between, for which Blender
waits work.PATIENCE and no longer. The tests make the environment; USER is a folder into which
tests/blender/inside/install.py has installed the extension.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy

SIDE = 99  # 10,000 points
FRAMES = range(1001, 1004)


Times = dict[str, list[tuple[float, float]]]  # of each step, by the clock and of the processor


def timed(call: Callable[[], Any], times: Times, name: str) -> Any:
    """Returns what a call gives, and notes how long it took."""
    start = time.perf_counter(), time.thread_time()
    try:
        return call()
    finally:
        end = time.perf_counter(), time.thread_time()
        times.setdefault(name, []).append((1e3 * (end[0] - start[0]), 1e3 * (end[1] - start[1])))


class Steps:
    """The steps of an operator, each noted, and the works between them."""

    def __init__(self, steps: Any, times: Times, name: str):
        self._steps, self._times, self._name = steps, times, name
        self.close = steps.close

    def send(self, found: Any) -> Callable[[], Any]:
        """The next step."""
        work = timed(lambda: self._steps.send(found), self._times, f"{self._name} step")
        return lambda: timed(work, self._times, f"{self._name} apart")


def operators(times: Times) -> None:
    """Notes the steps of every operator that waits for work."""
    from bl_ext.user_default.skinslide.work import Waiting

    def noted(self: Any, context: Any, found: Any) -> Any:
        if not isinstance(self._steps, Steps):
            self._steps = Steps(self._steps, times, type(self).__name__)
        return own(self, context, found)

    own, Waiting._go_on = Waiting._go_on, noted


def frames(thing: bpy.types.Object, rule: str, times: Times) -> None:
    """Notes what a frame of the live switch takes."""
    from bl_ext.user_default.skinslide import live
    from bl_ext.user_default.skinslide.fetch import evaluated_points, numbers

    sliding = live._sessions[thing.name].sliding
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        points = timed(lambda: evaluated_points(thing, depsgraph), times, f"frame {rule}: fetched")  # noqa: B023
        slid = timed(lambda: sliding.slide(points, numbers(thing)), times, f"frame {rule}: slid apart")  # noqa: B023
        timed(lambda: live.show(thing, slid), times, f"frame {rule}: shown")  # noqa: B023


def files(thing: bpy.types.Object) -> None:
    """Exports a set-up with its cache and without, and imports it."""
    import numpy as np

    group = thing.vertex_groups[f"skinSlide:{thing.skinslide.patches[0].name}:weight"]
    for vertex, weight in enumerate(np.random.default_rng(1).random(len(thing.data.vertices)).tolist()):
        group.add([vertex], weight, "REPLACE")
    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/x.skinslide"
        bpy.ops.skinslide.export_setup(filepath=path)
        bpy.ops.skinslide.export_setup(filepath=path, with_cache=False)
        for _ in range(2):
            bpy.ops.skinslide.import_setup(filepath=path)


def main() -> None:
    """Prints the table."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "blender" / "inside"))
    import addon_utils

    addon_utils.enable("bl_ext.user_default.skinslide", default_set=True)
    from sheets import inner, make_patch, select, sheet

    times: Times = {}
    operators(times)
    for rule in ("unit", "even", "relaxed"):
        thing = sheet(SIDE, rule)
        make_patch(thing, rule=rule)
        bpy.ops.skinslide.paint(what="weight", value=1.0, store="GROUP")
        bpy.ops.skinslide.paint(what="forceDensity", value=2.0, store="POINT")
        select(thing, "faces", inner(thing))
        bpy.ops.skinslide.paint_edges(value=2.0)
        bpy.ops.skinslide.live()
        frames(thing, rule, times)
        bpy.ops.skinslide.live()
    files(thing)
    print(f"{'ms':36} {'clock':>8} {'most':>8} {'processor':>10} {'most':>8}")
    for name, each in sorted(times.items()):
        columns = [(statistics.median(of), max(of)) for of in zip(*each, strict=True)]
        print(f"{name:36} {columns[0][0]:8.1f} {columns[0][1]:8.1f} {columns[1][0]:10.1f} {columns[1][1]:8.1f}")


if __name__ == "__main__":
    main()
