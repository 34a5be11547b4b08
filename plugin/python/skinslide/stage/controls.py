"""What an artist paints and animates on a patch, checked, over time.

Values off the patch do not count, since paint is often 0 there: they are replaced by ones that the core accepts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.native import Controls
from skinslide.problems import Fault
from skinslide.stage import schema
from skinslide.stage.textures import SampledTexture
from skinslide.stage.topology import Topology
from skinslide.stage.values import (
    FIRST,
    Reading,
    Span,
    check_length,
    flattened,
    floats,
    integers,
    primvar_sources,
    unchanging,
)

ABOVE_0 = "finite and above 0"


def envelope(prim: Usd.Prim, patch: str) -> Reading[float]:
    name = schema.property_name(patch, "envelope")

    def read(time: Usd.TimeCode) -> float:
        value = schema.value(prim, patch, "envelope", time)
        if not isinstance(value, int | float):
            raise Fault(f"{name} is {value!r}; it must be a float")
        if not np.isfinite(value):
            raise Fault(f"{name} is {value}")
        return float(value)

    return Reading(read, [schema.attribute(prim, patch, "envelope")])


MapReading = Reading[SampledTexture | None] | None


def weight(
    prim: Usd.Prim, patch: str, topology: Topology, faces: np.ndarray, mapped: MapReading = None
) -> Reading[np.ndarray | None]:
    """Slide weight by mesh vertex (V,), paint times map, or None where there is neither."""
    painted = _by_vertex(schema.inherited_primvar(prim, patch, "weight"), topology, faces, np.isfinite, "a number")

    def read(time: Usd.TimeCode) -> np.ndarray | None:
        sampled = mapped.at(time) if mapped else None
        return _times(painted.at(time), sampled.values if sampled else None)

    return Reading(read, [*painted.varying, *_varying(mapped)])


def max_distance(prim: Usd.Prim, patch: str, topology: Topology, faces: np.ndarray) -> Reading[np.ndarray | None]:
    """How far each mesh vertex may slide (V,), or None where it is not painted: no limit."""
    return _by_vertex(schema.inherited_primvar(prim, patch, "maxDistance"), topology, faces, _is_distance, "0 or more")


def _by_vertex(
    primvar: UsdGeom.Primvar,
    topology: Topology,
    faces: np.ndarray,
    is_good: Callable[[np.ndarray], np.ndarray],
    wanted: str,
) -> Reading[np.ndarray | None]:
    """A painted value by mesh vertex (V,), 0 off the patch, or None where it is not painted."""
    inside = topology.vertices_of(faces)
    sizes = {UsdGeom.Tokens.vertex: (topology.vertex_count, "points"), UsdGeom.Tokens.constant: None}

    def read(time: Usd.TimeCode) -> np.ndarray | None:
        values = _painted(primvar, time, sizes)
        if values is None:
            return None
        if primvar.GetInterpolation() == UsdGeom.Tokens.constant:
            _check(is_good(values), values, primvar.GetName(), wanted)
            return np.full(topology.vertex_count, values[0], np.float32)
        _check(is_good(values) | ~inside, values, primvar.GetName(), wanted)
        return np.where(inside, values, 0)

    return Reading(read, primvar_sources(primvar))


def density(
    prim: Usd.Prim, patch: str, topology: Topology, faces: np.ndarray, mapped: MapReading = None
) -> Reading[dict[str, np.ndarray]]:
    """Force density, painted and by map, as arguments of Controls: by vertex, by face, both or none.

    A constant is left out: it changes no ratio.
    """
    primvar = schema.inherited_primvar(prim, patch, "forceDensity")
    chosen = np.zeros(topology.face_count, dtype=bool)
    chosen[faces] = True
    kinds = {
        UsdGeom.Tokens.vertex: ("vertex_density", topology.vertices_of(faces)),
        UsdGeom.Tokens.uniform: ("face_density", chosen),
        UsdGeom.Tokens.constant: (None, np.ones(1, dtype=bool)),
    }
    sizes = {
        UsdGeom.Tokens.vertex: (topology.vertex_count, "points"),
        UsdGeom.Tokens.uniform: (topology.face_count, "faces"),
        UsdGeom.Tokens.constant: None,
    }

    def paint(time: Usd.TimeCode) -> dict[str, np.ndarray]:
        values = _painted(primvar, time, sizes)
        if values is None:
            return {}
        argument, inside = kinds[primvar.GetInterpolation()]
        _check(_is_density(values) | ~inside, values, primvar.GetName(), ABOVE_0)
        return {argument: np.where(inside, values, np.float32(1))} if argument else {}

    def read(time: Usd.TimeCode) -> dict[str, np.ndarray]:
        painted, sampled = paint(time), mapped.at(time) if mapped else None
        if sampled is None:
            return painted
        what = f"{sampled.name}: {sampled.file}"
        _check(_is_density(sampled.values), sampled.values, what, ABOVE_0, " at point {}")
        product = _times(painted.get("vertex_density"), sampled.values)
        _check(_is_density(product), product, f"{primvar.GetName()} times {what}", ABOVE_0, " at point {}")
        return {**painted, "vertex_density": product}

    return Reading(read, [*primvar_sources(primvar), *_varying(mapped)])


def _varying(mapped: MapReading) -> list[Usd.Attribute]:
    return mapped.varying if mapped else []


def _times(painted: np.ndarray | None, mapped: np.ndarray | None) -> np.ndarray | None:
    if painted is None or mapped is None:
        return mapped if painted is None else painted
    with np.errstate(over="ignore"):
        return painted * mapped


def edge_density(prim: Usd.Prim, patch: str) -> Reading[dict[str, np.ndarray]]:
    """Force density by edge as arguments of Controls: edges (k, 2) and their factors (k,)."""
    name, factors_name = (schema.property_name(patch, each) for each in ("edges", "edgeForceDensities"))
    edges_attr, factors_attr = (schema.attribute(prim, patch, each) for each in ("edges", "edgeForceDensities"))
    value = unchanging(edges_attr, name) if edges_attr else None
    edges = integers([] if value is None else value, name)
    if len(edges) % 2:
        raise Fault(f"{name} has {len(edges)} values; it must hold pairs of point indices")
    edges = edges.reshape(-1, 2)

    def read(time: Usd.TimeCode) -> dict[str, np.ndarray]:
        value = factors_attr.Get(time) if factors_attr else None
        factors = floats([] if value is None else value, factors_name)
        if len(factors) != len(edges):
            raise Fault(f"{factors_name} has {len(factors)} values, but {name} has {len(edges)} pairs")
        for k in np.flatnonzero(~_is_density(factors))[:1]:
            edge = f"edge {edges[k][0]}-{edges[k][1]}"
            raise Fault(f"{factors_name}[{k}], for {edge}, is {factors[k]:g}; it must be {ABOVE_0}")
        return {"edges": edges, "edge_density": factors} if len(edges) else {}

    return Reading(read, [factors_attr])


def corners(prim: Usd.Prim, patch: str, vertex_count: int) -> np.ndarray | None:
    """Four vertices, int32 (4,), or None."""
    name, attr = schema.property_name(patch, "corners"), schema.attribute(prim, patch, "corners")
    value = unchanging(attr, name) if attr else None
    found = integers([] if value is None else value, name)
    if not found.size:
        return None
    if len(found) != 4:
        raise Fault(f"{name} has {len(found)} values; it must have 4")
    for k, corner in enumerate(found):
        if not 0 <= corner < vertex_count:
            raise Fault(f"{name}[{k}] is {corner}, but the mesh has {vertex_count} points")
        if corner in found[:k]:
            raise Fault(f"{name} has point {corner} more than once")
    return found


class PatchControls:
    """The controls of one patch over time. `maps` are those of the first time."""

    def __init__(
        self,
        envelope: Reading,
        weight: Reading,
        max_distance: Reading,
        density: Reading,
        edge_density: Reading,
        maps: Iterable[SampledTexture] = (),
    ):
        self.maps = list(maps)
        self._envelope, self._weight, self._max_distance = envelope, weight, max_distance
        self._density, self._edges = density, edge_density
        self._readings = (envelope, weight, max_distance, density, edge_density)

    @property
    def vary(self) -> bool:
        return any(reading.varies for reading in self._readings)

    def times(self, span: Span | None) -> list[float]:
        return [time for reading in self._readings for time in reading.times(span)]

    def at(self, time: Usd.TimeCode = FIRST) -> Controls:
        """Raises Fault where a value is not valid."""
        return Controls(
            **self._density.at(time),
            **self._edges.at(time),
            weight=self._weight.at(time),
            envelope=self._envelope.at(time),
            max_distance=self._max_distance.at(time),
        )


Sizes = dict[str, tuple[int, str] | None]


def _painted(primvar: UsdGeom.Primvar, time: Usd.TimeCode, sizes: Sizes) -> np.ndarray | None:
    """The values of a float primvar, one for a constant; None where there is none.

    sizes  the interpolations it may have, each with how many values it then has and of what; None: one
    """
    if not primvar or not primvar.HasAuthoredValue():
        return None
    name, interpolation = primvar.GetName(), primvar.GetInterpolation()
    if str(primvar.GetTypeName()) not in ("float", "float[]"):
        raise Fault(f"{name} is {primvar.GetTypeName()}; it must be float[]")
    if interpolation not in sizes:
        raise Fault(f"{name} has interpolation {interpolation}; it must be {' or '.join(sizes)}")
    value = flattened(primvar, time)
    if value is None:
        raise Fault(f"{name} has no value")
    values = floats(np.atleast_1d(np.asarray(value)), name)
    if sizes[interpolation]:
        check_length(name, len(values), *sizes[interpolation])
    elif len(values) != 1:
        raise Fault(f"{name} has interpolation constant but {len(values)} values; is vertex missing?")
    return values


def _is_distance(values: np.ndarray) -> np.ndarray:
    return values >= 0


def _is_density(values: np.ndarray) -> np.ndarray:
    return np.isfinite(values) & (values > 0)


def _check(good: np.ndarray, values: np.ndarray, name: str, wanted: str, place: str = "[{}]") -> None:
    bad = np.flatnonzero(~good)
    if bad.size:
        raise Fault(f"{name}{place.format(bad[0])} is {values[bad[0]]:g}; it must be {wanted}")
