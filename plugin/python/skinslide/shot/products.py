"""What is made of the frames of a shot as they are slid: what the loop of loop.py asks of each product.

A product, such as a layer or pictures, is asked for before anything is read. Its Making is one run of it, and gives the
meshes that it wants each a MeshMaking.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from pxr import Usd

from skinslide.arrays.setups import Controls
from skinslide.arrays.slider import Diagnostics, Slider
from skinslide.problems import Problem, UsageError
from skinslide.shot.options import SlideOptions
from skinslide.stage.given import StageLike, StrPath, given_stage

if TYPE_CHECKING:
    from skinslide.shot.plan import Plan, PlannedMesh
    from skinslide.shot.report import BakeReport, MeshReport


class Shot(NamedTuple):
    """An open stage, and the path it was opened from; None if it was given open."""

    stage: Usd.Stage
    path: StrPath | None

    @classmethod
    def of(cls, stage: StageLike) -> Shot:
        """Raises TypeError, and StageError where the stage cannot be opened."""
        return cls(given_stage(stage), None if isinstance(stage, Usd.Stage) else stage)

    @property
    def paths(self) -> list[StrPath]:
        return [] if self.path is None else [self.path]


class SlidFrame:
    """One time of a mesh, slid. Points float32 (V, 3); `patches` is the core's result of each, `turns` where wanted.

    `warning` is what to warn of in its points, or nothing.
    """

    def __init__(self, slider: Slider, points: np.ndarray, controls: Sequence[Controls] | None, *, turns: bool):
        frame = slider.slide(points, controls, turns=turns)
        self.cached, self.slid, self.patches, self.turns = points, frame.points, frame.patches, frame.turns
        self.warning = slider.check_points(points)
        self.controls, self._slider = controls, slider
        self._measured: dict[tuple[bool, ...], Diagnostics] = {}

    def by(self, slider: Slider) -> SlidFrame:
        """The same time slid by another slider of the mesh."""
        return SlidFrame(slider, self.cached, self.controls, turns=False)

    def measured(self, chosen: Sequence[bool] | None = None) -> Diagnostics:
        """What was done to each vertex by the set-ups chosen, None by all: measured once, by one thread at a time."""
        key = () if chosen is None or all(chosen) else tuple(chosen)
        if key not in self._measured:
            self._measured[key] = self._slider.diagnose(self.cached, self.slid, self.controls, chosen=key or None)
        return self._measured[key]


SlidFrames = Mapping[Usd.TimeCode, SlidFrame]


@runtime_checkable
class Product(Protocol):
    """What can be made of a shot."""

    def begin(self, shot: Shot, options: SlideOptions) -> Making:
        """Raises UsageError and StageProblems for what can be known before the meshes are read."""


def given_products(name: str, products: Sequence[Product]) -> Sequence[Product]:
    """Raises UsageError for what is no sequence of products."""
    if not isinstance(products, Sequence) or not all(isinstance(each, Product) for each in products):
        raise UsageError(f"{name} is {products!r}; it must be a sequence of Pictures and Maps")
    return products


class Making(ABC):
    """One run of a product."""

    patches: Sequence[str] | None = None  # names of those it is made of; None: all

    def planned(self, _plan: Plan) -> bool:
        """Learns what is going to be slid. Returns whether all that it makes is there already, and need not be made."""
        return False

    @abstractmethod
    def of_mesh(self, planned: PlannedMesh, report: MeshReport) -> MeshMaking | None:
        """None for a mesh of which nothing is made. Raises StageProblems and UsageError for one of which it cannot."""

    @contextmanager
    def running(self, report: BakeReport) -> Iterator[None]:
        """Around all frames, once every mesh is known; then ends what is made of all of them.

        Raises UsageError for a file that cannot be written, before the first frame.
        """
        yield


class MeshMaking(ABC):
    """One mesh of a run."""

    turns = False  # whether its frames are to say how the skin turned
    sliders: Sequence[Slider] = ()  # those of its own, which stop when the loop does

    def times_needed(self, time: Usd.TimeCode) -> set[Usd.TimeCode]:
        """The times that must be slid before `take` is called for `time`; it is one of them."""
        return {time}

    @abstractmethod
    def read(self, time: Usd.TimeCode) -> Callable[[SlidFrame], Any]:
        """Reads of the stage what a time needs; gives the work on its frame, which is done in the pool."""

    @abstractmethod
    def take(self, time: Usd.TimeCode, frames: SlidFrames, made: Any) -> None:
        """Takes what the work has made. Times come in order, each with the frames that it needs."""

    def end(self) -> list[Problem]:
        """Called after the last time. Returns warnings."""
        return []
