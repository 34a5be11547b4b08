"""skinslide, of whatever revision is installed."""

from __future__ import annotations

import time

import numpy as np

from compare.patch import Patch, Slid
from skinslide import PatchSetup, Slider, Subdivision


class Ours:
    """One patch by a rule, an interpolation and a lookup."""

    def __init__(self, rule: str = "unit", interpolation: str = "linear", lookup: str = "exact"):
        self._options = {"rule": rule, "interpolation": interpolation}
        self._lookup = lookup
        self._embeds = rule in ("unit", "fast")

    def begin(self, patch: Patch) -> None:
        setup = PatchSetup("bench", faces=np.arange(len(patch.counts)), **self._options)
        smooth = Subdivision("catmullClark") if self._options["interpolation"] == "limit" else None
        self._slider = Slider(patch.counts, patch.indices, patch.rest, [setup], lookup=self._lookup, subdivision=smooth)

    @property
    def rest_embedding(self) -> np.ndarray | None:
        """Vertices of the patch are those of the mesh."""
        return self._slider.embedding(0) if self._embeds else None

    def frame(self, points: np.ndarray) -> Slid:
        """The core's stages are by the clock: each counts as the thread ran, unless it waited for a device."""
        clock, start = time.perf_counter(), time.thread_time()
        frame = self._slider.slide(points, embeddings=self._embeds)
        ran, passed = time.thread_time() - start, time.perf_counter() - clock
        share = ran / passed if self._lookup == "exact" else 1
        of_patch = frame.patches[0]
        seconds = {
            "embed": share * (of_patch.density_seconds + of_patch.embed_seconds),
            "relax": share * of_patch.relax_seconds,
            "locate": share * of_patch.locate_seconds,
            "interpolate": share * of_patch.interpolate_seconds,
        }
        return Slid(seconds, frame.embeddings[0] if self._embeds else None, frame.points)
