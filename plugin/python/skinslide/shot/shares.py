"""The share of the stretch that can be removed which sliding removes: a search for the least that each pose allows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from pxr import Usd

from skinslide.arrays.setups import Controls
from skinslide.arrays.slider import Slider
from skinslide.shot.options import SlideOptions
from skinslide.shot.plan import PlannedMesh, frame_of
from skinslide.shot.products import Making, MeshMaking, Shot, SlidFrame, SlidFrames
from skinslide.shot.report import MeshReport
from skinslide.stage.mesh import PatchedMesh


class Shares:
    """What goes into reports of each frame."""

    def begin(self, _shot: Shot, _options: SlideOptions) -> Making:
        return _Searching()


class _Searching(Making):
    def of_mesh(self, planned: PlannedMesh, report: MeshReport) -> MeshMaking:
        return _MeshSearch(planned, report)


class _MeshSearch(MeshMaking):
    """Searches the poses of one mesh."""

    def __init__(self, planned: PlannedMesh, report: MeshReport):
        self._report, self._slider = report, _least_slider(planned.mesh)
        self.sliders = [self._slider]

    def read(self, _time: Usd.TimeCode) -> Callable[[SlidFrame], tuple[float, ...]]:
        return lambda frame: self._slider.least_stretch(frame.cached)

    def take(self, time: Usd.TimeCode, _frames: SlidFrames, made: tuple[float, ...]) -> None:
        self._report.add_least(frame_of(time), made)


def _least_slider(mesh: PatchedMesh) -> Slider:
    """Of the rule that leaves least stretch, unpainted: the search begins there."""
    return mesh.build(
        [replace(patch, rule="relaxed", interpolation="linear", controls=Controls()) for patch in mesh.patches]
    )
