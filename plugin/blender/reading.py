"""A fetched mesh as the core interprets it: what is wrong with it, or a slider. No Blender here; for any thread."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from skinslide.arrays.fetched import NOTHING, File, Value
from skinslide.arrays.meaning import ControlsMeaning, MeshMeaning, Names, PatchMeaning, Taker
from skinslide.arrays.records import PatchResult
from skinslide.arrays.schema import DEFAULT_TIME, Input, inputs
from skinslide.arrays.setups import PatchSetup
from skinslide.arrays.slider import Slider
from skinslide.arrays.topology import Topology
from skinslide.problems import Fault, SliderError, noting

CHOOSING = ("paintChannel", "patch", "forceDensityRule", "grow")  # what the faces of a patch depend on
Numbers = Sequence[Sequence[tuple[Input, Value]]]


@dataclass(frozen=True)
class FetchedPatch:
    """A patch: its settings by name, and its painted edges with their factors."""

    name: str
    values: dict[str, Value]

    def value(self, source: Input) -> Value:
        """A setting; without a value if it is not set."""
        name = source.property(self.name)
        return self.values.get(source.name) or Value(name, NOTHING, source.type_name)


@dataclass(frozen=True)
class Fetched:
    """A mesh as arrays that nobody else has, so that threads may read them."""

    name: str
    folder: str  # where its relative paths start
    counts: np.ndarray  # (F,) int32
    indices: np.ndarray  # (sum of counts,) int32
    basis: np.ndarray  # (V, 3) float32
    points: np.ndarray  # (V, 3) float32, as modifiers and shape keys leave them
    to_world: np.ndarray  # (4, 4), takes points, as rows, to the world
    values: dict[str, Value]  # of the mesh, by property
    primvars: dict[str, Value]
    patches: tuple[FetchedPatch, ...]

    def patch(self, name: str) -> FetchedPatch:
        """The patch of a name."""
        return next(each for each in self.patches if each.name == name)


class Slid(NamedTuple):
    """A frame: points (V, 3) and stretch (V,), and what happened to each patch."""

    points: np.ndarray
    stretch: np.ndarray
    patches: tuple[PatchResult, ...]


class Surface:
    """A mesh as the core interprets it, without its patches. Raises Fault."""

    def __init__(self, fetched: Fetched):
        self.fetched, self.meaning, self._painted = fetched, MeshMeaning(), Names(fetched.primvars)
        with joined() as faults:
            _take(self.meaning, ((each, self._value(each)) for each in inputs("mesh")), faults)
            with noting(faults):
                if self.meaning.has_faces:
                    self.meaning.take_space(fetched.to_world, 0)
        self.topology = Topology.of(self.meaning)

    def _value(self, source: Input) -> Value:
        name, fetched = source.property(), self.fetched
        arrays = {
            "points": fetched.basis if source is _AT_REST else fetched.points,
            "faceVertexCounts": fetched.counts,
            "faceVertexIndices": fetched.indices,
        }
        if name in arrays:
            return Value(name, arrays[name], source.type_name)
        found = fetched.primvars if source.is_primvar else fetched.values
        return found.get(name) or Value(name, NOTHING, source.type_name)

    def patch(self, fetched: FetchedPatch, *, only: Iterable[str] | None = None) -> PatchMeaning:
        """A patch, from all or only some of its settings. Raises Fault."""
        meaning = PatchMeaning(self.meaning, fetched.name)
        wanted = [each for each in inputs("patch") if only is None or each.name in only]
        with joined(fetched.name) as faults:
            _take(meaning, ((each, self.painted(meaning, each, fetched)) for each in wanted), faults)
            with noting(faults):
                meaning.take_subset(None)
        return meaning

    def painted(self, meaning: PatchMeaning, source: Input, patch: FetchedPatch) -> Value:
        """The value of an input of a patch."""
        if not source.is_primvar:
            return patch.value(source)
        found = self._painted.of(source, meaning)
        return self.fetched.primvars[found] if found else patch.value(source)

    def controls(self, meaning: PatchMeaning, patch: FetchedPatch) -> ControlsMeaning:
        """What is painted on a patch. Raises Fault."""
        controls = ControlsMeaning(meaning)
        with joined(patch.name) as faults:
            _take(controls, ((each, self.painted(meaning, each, patch)) for each in inputs("controls")), faults)
            named = ((each, each.property()) for each in controls.coordinates())
            nothing = ((each, Value(name, NOTHING, each.type_name)) for each, name in named)
            _take(controls, ((each, self.fetched.primvars.get(value.name, value)) for each, value in nothing), faults)
            with noting(faults):
                give_files(controls, self.fetched.folder)
        return controls


def check_paint(fetched: Fetched, name: str, source: Input, value: Value) -> None:
    """Raises Fault for what cannot be painted on a patch."""
    surface = Surface(fetched)
    with joined(name) as faults, noting(faults):
        controls = ControlsMeaning(surface.patch(fetched.patch(name), only=CHOOSING))
        controls.take(source, value)
        controls.get()


_AT_REST = next(each for each in inputs("mesh") if each.when == DEFAULT_TIME)  # rest if there is no other


class Sliding:
    """A mesh with all its patches, ready to be slid. Raises Fault with all that is wrong."""

    def __init__(self, fetched: Fetched):
        self.fetched, surface = fetched, Surface(fetched)
        self.names = [patch.name for patch in fetched.patches]
        self._meanings, self._base = list[PatchMeaning](), list[ControlsMeaning]()
        with joined() as faults:
            for patch in fetched.patches:
                with noting(faults):
                    self._meanings.append(surface.patch(patch))
                    self._base.append(surface.controls(self._meanings[-1], patch))
        if not self._base:
            raise Fault("there is no patch to slide")
        if any(each.needs_subdivision for each in self._meanings):
            with joined() as faults:
                _take(surface.meaning, ((each, self._subdivision(each)) for each in inputs("subdivision")), faults)
        setups = [meaning.setup(base) for meaning, base in zip(self._meanings, self._base, strict=True)]
        self.rest_points = surface.meaning.rest_points()
        self.slider = _slider(surface, setups)
        meaning, patches = surface.meaning, (each.warning for each in self._meanings)
        own = (meaning.rest_warning, meaning.warning, meaning.space_warning, *patches)
        self.warnings = [each for each in own if each]

    def _subdivision(self, source: Input) -> Value:
        """Of a mesh that Blender draws as its faces, unless a modifier subdivides it, which is off while it slides."""
        is_scheme = source.name == "subdivisionScheme"
        return self.fetched.values.get(source.name) or Value(source.name, "none" if is_scheme else NOTHING, "token")

    def slide(self, points: np.ndarray, numbers: Numbers) -> Slid:
        """Slides points (V, 3), with the animated settings of their frame. Raises Fault."""
        each = []
        for meaning, base, own in zip(self._meanings, self._base, numbers, strict=True):
            controls = ControlsMeaning(meaning, base)
            for source, value in own:
                controls.take(source, value)
            each.append(controls.get())
        try:
            frame = self.slider.slide(points, each)
            stretch = self.slider.diagnose(points, frame.points, each).stretch_after
        except SliderError as error:
            raise Fault(str(error)) from error
        return Slid(frame.points, stretch, frame.patches)


def _slider(surface: Surface, setups: Sequence[PatchSetup]) -> Slider:
    fetched, meaning = surface.fetched, surface.meaning
    try:
        weld = meaning.weld(setups, [(0, fetched.points)]).vertices
        rest, subdivision, space = meaning.rest_points(), meaning.subdivision(), meaning.space()
        shape = fetched.counts, fetched.indices, rest
        return Slider(*shape, setups, subdivision=subdivision, weld=weld, space=space)
    except SliderError as error:
        raise Fault(str(error)) from error


def check_one_piece(fetched: Fetched) -> None:
    """Raises Fault if the last patch cannot be slid, or lies in several pieces."""
    alone = replace(fetched, patches=fetched.patches[-1:])
    pieces = len(Sliding(alone).slider.patches)
    if pieces > 1:
        raise Fault(
            f"what is chosen lies in {pieces} pieces; choose faces that meet edge to edge, a patch for each piece"
        )


def give_files(controls: ControlsMeaning, folder: str) -> None:
    """Gives the controls all files of textures that they need; relative paths start from a folder. Raises Fault."""
    while need := controls.need():
        path = os.path.join(folder, need.path)
        if not os.path.isfile(path) or controls.holds(path):
            controls.give(File(path if os.path.exists(path) else None))
            continue
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            controls.give(File(path, size=size, descriptor=file.fileno()))


# ---- Faults ----


def _take(taker: Taker, values: Iterable[tuple[Input, Value]], faults: list[str]) -> None:
    for source, value in values:
        with noting(faults):
            taker.take(source, value)


@contextmanager
def joined(patch: str = "") -> Iterator[list[str]]:
    """Collects faults, and raises them as one, a line each, with the name of a patch."""
    faults: list[str] = []
    yield faults
    if faults:
        raise Fault("\n".join(f"patch {patch}: {each}" if patch else each for each in faults))
