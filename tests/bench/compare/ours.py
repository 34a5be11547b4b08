"""skinslide, of whatever revision is installed."""

from __future__ import annotations

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
        """The embedding at rest: vertices of the patch are those of the mesh."""
        return self._slider.embedding(0) if self._embeds else None

    def frame(self, points: np.ndarray) -> Slid:
        frame = self._slider.slide(points, embeddings=self._embeds)
        of_patch = frame.patches[0]
        seconds = {
            "embed": of_patch.density_seconds + of_patch.embed_seconds,
            "relax": of_patch.relax_seconds,
            "locate": of_patch.locate_seconds,
            "interpolate": of_patch.interpolate_seconds,
        }
        # With a device the thread waits for it.
        return Slid(seconds, frame.embeddings[0] if self._embeds else None, frame.points, self._lookup == "exact")


class PointsAlone(Ours):
    """Does the same work as peers do: nothing is measured, and no embedding is copied out."""

    def frame(self, points: np.ndarray) -> Slid:
        return Slid({}, None, self._slider.slide(points, measures=False).points)
