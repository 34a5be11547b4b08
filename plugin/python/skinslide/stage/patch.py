"""One patch of a mesh: fetched from the stage, and meant by the core."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import cached_property, partial

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.fetched import Subset
from skinslide.arrays.idle import Idle
from skinslide.arrays.meaning import ControlsMeaning, MeshMeaning, Names, PatchMeaning
from skinslide.arrays.schema import Input, input_of, inputs
from skinslide.arrays.setups import Controls, PatchSetup
from skinslide.arrays.values import integers
from skinslide.problems import Fault, noting
from skinslide.stage import schema
from skinslide.stage.neighbours import Neighbours
from skinslide.stage.textures import give_files
from skinslide.stage.values import FIRST, Source, Span, read_primvar, read_value, take

_CHOOSING = ("paintChannel", "patch")  # what the chosen faces depend on


class Animation:
    """What is painted and animated on one patch, over time. Any number of threads may read it.

    Attributes:
        faults: What is wrong at the first time.
        textures: Those of the first time.
    """

    def __init__(
        self,
        prim: Usd.Prim,
        meaning: PatchMeaning,
        wanted: Sequence[Input] = inputs("controls"),
        painted: Painted | None = None,
    ):
        self._meaning, self._base = meaning, ControlsMeaning(meaning)
        self._idle = Idle(partial(ControlsMeaning, meaning, self._base))
        self._faces, *self._controls = paint_sources(prim, [input_of("patch", "patch"), *wanted], meaning, painted)
        self.faults = take(self._base, self._controls)
        self._coordinates = [Source(prim, each) for each in self._base.coordinates()]
        self.faults += take(self._base, self._coordinates)
        with noting(self.faults):
            give_files(self._base)
        self.textures = [found for each in wanted if (found := self._base.texture(each))]
        self._varying = [source for source in [*self._controls, *self._coordinates] if source.varies]

    @property
    def varies(self) -> bool:
        return bool(self._varying)

    @property
    def needs_subdivision(self) -> bool:
        return self._meaning.needs_subdivision

    def unread(self) -> list[str]:
        """The properties that say something for which the rule of the patch has no use, at the first time."""
        return [each.property(self._meaning.name) for each in self._meaning.unread(self._base)]

    def described(self) -> Iterator[str]:
        """What there is to say of paint that is not as the schema has it, at the first time."""
        for source in (self._faces, *self._controls):
            if note := self._meaning.describe(source.wanted, source.first()):
                yield note

    @property
    def warning(self) -> str:
        """What to warn of, or nothing."""
        return self._meaning.warning

    def times(self, span: Span | None = None, names: Collection[str] | None = None) -> list[float]:
        """When controls were authored that vary; names: of these inputs alone, with the coordinates of textures."""
        chosen = [source for source in self._controls if names is None or source.wanted.name in names]
        sampled = {texture.name for texture in self.textures}.intersection(source.name for source in chosen)
        chosen += self._coordinates if names is None or sampled else []
        return [time for source in chosen for time in source.times(span)]

    def samples(self) -> list[float]:
        """Those of controls that vary, without what is known of splines."""
        return [time for source in self._varying for time in source.samples()]

    @cached_property
    def setup(self) -> PatchSetup:
        """The patch with its controls at the first time. Raises Fault."""
        return self._meaning.setup(self._base)

    def edges(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Painted edges (k, 2) and their factors (k,) at the first time. Raises Fault."""
        controls = self._base.get()
        return controls.edges, controls.edge_density

    def at(self, time: Usd.TimeCode = FIRST) -> Controls:
        """The controls at a time. Raises Fault where a value is not valid."""
        if not self.varies:
            return self.setup.controls
        with self._idle.taken() as own:
            return self._read(own, time)

    def _read(self, own: ControlsMeaning, time: Usd.TimeCode) -> Controls:
        for source in self._varying:
            own.take(source.wanted, source.at(time))
        give_files(own)
        return own.get()


def read_patches(
    prim: Usd.Prim, names: Iterable[str], mesh: MeshMeaning, neighbours: Neighbours
) -> Iterator[tuple[str, Animation | None, list[str]]]:
    """Each patch by its name, or everything that is wrong with it."""
    painted, begun = Painted(prim), list[tuple[PatchMeaning, list[str]]]()
    for name in names:
        meaning = PatchMeaning(mesh, name)
        begun.append((meaning, take_settings(meaning, prim, inputs("patch"), painted)))
    _meet(begun, prim, neighbours)
    for meaning, faults in begun:
        animation = Animation(prim, meaning, painted=painted)
        faults += animation.faults
        with noting(faults):
            if not faults:
                animation.setup  # noqa: B018
        yield meaning.name, None if faults else animation, faults


def _meet(begun: Iterable[tuple[PatchMeaning, list[str]]], prim: Usd.Prim, neighbours: Neighbours) -> None:
    """Shows each neighbour to the patches that want them. Adds to the faults of each."""
    wanting = [each for each in begun if each[0].wants_neighbours]
    for other in neighbours.of(prim) if wanting else ():
        for meaning, faults in list(wanting):
            known = len(faults)
            with noting(faults):
                meaning.meet(other.points)
            if len(faults) > known:
                wanting.remove((meaning, faults))


def read_patch(prim: Usd.Prim, name: str, mesh: MeshMeaning) -> tuple[Animation | None, list[str]]:
    """The patch, or everything that is wrong with it."""
    ((_, animation, faults),) = read_patches(prim, [name], mesh, Neighbours(prim.GetStage()))
    return animation, faults


def read_faces(prim: Usd.Prim, name: str, mesh: MeshMeaning) -> PatchMeaning:
    """A patch that knows of its faces and edges alone. Raises Fault."""
    meaning, wanted = PatchMeaning(mesh, name), (*_CHOOSING, "forceDensityRule", "grow", "edges")
    faults = take_settings(meaning, prim, [each for each in inputs("patch") if each.name in wanted])
    if faults:
        raise Fault(faults[0])
    return meaning


def read_chosen(prim: Usd.Prim, name: str, mesh: MeshMeaning) -> np.ndarray:
    """The faces that were chosen for a patch, int32, ascending, without those that join them. Raises Fault."""
    meaning = PatchMeaning(mesh, name)
    for fault in take_settings(meaning, prim, [each for each in inputs("patch") if each.name in _CHOOSING]):
        raise Fault(fault)
    return meaning.faces


def read_pairs(attribute: Usd.Attribute, mesh: MeshMeaning) -> np.ndarray:
    """Any edges, int32 (n, 2), as the edges of a patch are read. Raises Fault."""
    name, edges = str(attribute.GetPath()), input_of("patch", "edges")
    meaning, value = PatchMeaning(mesh, name), read_value(attribute, FIRST, name=name)
    meaning.take(edges, value)
    for time in attribute.GetTimeSamples():
        meaning.check(edges, read_value(attribute, Usd.TimeCode(time), name=name), time)
    return integers(value).reshape(-1, 2)


def read_edges(prim: Usd.Prim, patch: PatchMeaning) -> Animation:
    """The painted edges of a patch alone, over time. Raises Fault."""
    animation = Animation(prim, patch, [each for each in inputs("controls") if each.name == "edgeForceDensities"])
    if animation.faults:
        raise Fault(animation.faults[0])
    return animation


def primvar_faces(primvar: UsdGeom.Primvar, mesh: MeshMeaning) -> np.ndarray:
    """The faces that any primvar chooses as that of a patch does, int32, ascending. Raises Fault."""
    meaning = PatchMeaning(mesh, primvar.GetPrimvarName())
    meaning.take(input_of("patch", "patch"), read_primvar(primvar))
    return meaning.faces


def subset_faces(child: Usd.Prim, mesh: MeshMeaning) -> np.ndarray:
    """The faces of a GeomSubset, int32, ascending. Raises Fault."""
    meaning = PatchMeaning(mesh, child.GetName())
    for fault in take_subset(meaning, child):
        raise Fault(fault)
    return meaning.faces


def take_settings(
    meaning: PatchMeaning, prim: Usd.Prim, wanted: Sequence[Input], painted: Painted | None = None
) -> list[str]:
    """Hands over settings, with the faces of the child of the patch's name. Returns what is wrong."""
    faults = take(meaning, paint_sources(prim, wanted, meaning, painted))
    child = schema.child(prim, meaning.name)
    return faults + take_subset(meaning, child if child and child.IsActive() else None)


class Painted:
    """The primvars of a prim, of its parent, and so on that say something: listed once for all patches."""

    def __init__(self, prim: Usd.Prim):
        above = [prim]
        while above[-1].GetParent():
            above.append(above[-1].GetParent())
        self._names = [Names(_primvars(each)) for each in above]

    def name_of(self, wanted: Input, meaning: PatchMeaning) -> str | None:
        """That of the nearest which is an input of a patch."""
        for names in (self._names if wanted.is_inherited else self._names[:1]) if wanted.is_primvar else ():
            found = names.of(wanted, meaning)
            if found:
                return found
        return None


def paint_sources(
    prim: Usd.Prim, wanted: Sequence[Input], meaning: PatchMeaning, painted: Painted | None = None
) -> list[Source]:
    """The sources of inputs of a patch, under the names by which the prim, or what it is below, has paint."""
    there = painted or Painted(prim)
    names = [there.name_of(each, meaning) for each in wanted]
    return [
        Source(prim, each, name=name) if name else Source(prim, each, meaning.name)
        for each, name in zip(wanted, names, strict=True)
    ]


def _primvars(prim: Usd.Prim) -> Iterator[str]:
    """The names of primvars that have values, or are blocked, which says that there is none."""
    for attribute in prim.GetAuthoredPropertiesInNamespace("primvars"):
        is_attribute = isinstance(attribute, Usd.Attribute)
        if is_attribute and (attribute.HasAuthoredValue() or attribute.GetResolveInfo().ValueIsBlocked()):
            yield str(attribute.GetName())


def take_subset(meaning: PatchMeaning, child: Usd.Prim | None) -> list[str]:
    """Hands over the faces of a child prim, or that there is none. Returns what is wrong."""
    faults: list[str] = []
    with noting(faults):
        there = child and Subset(str(child.GetPath()), child.GetTypeName(), child.IsA(UsdGeom.Subset))
        meaning.take_subset(there or None)
    return faults + take(meaning, [Source(child, each) for each in inputs("subset")] if child else [])
