"""Fetches what the core asks for: the values of attributes at a time, and when they were authored."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom

from skinslide.arrays.fetched import NOTHING, Asset, Other, Value
from skinslide.arrays.meaning import Taker
from skinslide.arrays.schema import DEFAULT_TIME, STILL, Input, phrase
from skinslide.problems import MOST_FRAMES, Fault, UsageError, noting, usd_message

Span = tuple[float, float]  # first and last moment
FIRST = Usd.TimeCode.EarliestTime()
# Of single numbers: an array knows its own.
_NUMBERS = {
    "bool": np.bool_,
    "uchar": np.uint8,
    "int": np.int32,
    "uint": np.uint32,
    "int64": np.int64,
    "uint64": np.uint64,
    "half": np.float16,
    "float": np.float32,
    "double": np.float64,
}


def count_of(attribute: Usd.Attribute, time: Usd.TimeCode = FIRST) -> int:
    """How many elements an attribute has; 0 where it holds no array, as one of a wrong type may."""
    found = _held(attribute, time)
    return len(found) if _is_array(found) else 0


def triples_of(attribute: Usd.Attribute, time: Usd.TimeCode = FIRST) -> np.ndarray:
    """What an attribute holds as it is authored (n, 3); nothing where that is no array of three numbers each."""
    held = _held(attribute, time)
    found = np.asarray(held if _is_array(held) else ())
    is_triples = found.ndim == 2 and found.shape[1] == 3 and found.dtype.kind == "f"
    return found if is_triples else np.empty((0, 3), np.float32)


def _held(attribute: Usd.Attribute, time: Usd.TimeCode) -> Any:
    """None where it cannot be read, either."""
    with suppress(Fault):
        return _get(attribute, time)
    return None


def _is_array(value: object) -> bool:
    return type(value).__name__.endswith("Array")


class Source:
    """Where the value of an input comes from on a stage."""

    def __init__(self, prim: Usd.Prim, wanted: Input, patch: str | None = None, *, name: str | None = None):
        self.wanted = wanted
        self.name = name or wanted.property(patch)
        attribute = prim.GetAttribute(self.name)
        if wanted.is_inherited:
            primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(self.name)
            attribute = primvar.GetAttr() if primvar else attribute
        self.attribute = attribute
        self.indices = UsdGeom.Primvar(attribute).GetIndicesAttr() if attribute and wanted.is_primvar else None

    def first(self) -> Value:
        """The value at the time at which it is taken first; where it was not authored, its name alone."""
        found = self.at(Usd.TimeCode.Default() if self.wanted.when == DEFAULT_TIME else FIRST)
        return found or Value(self.name, NOTHING, self.wanted.type_name)

    def at(self, time: Usd.TimeCode) -> Value | None:
        return read_value(self.attribute, time, self.indices)

    @property
    def varies(self) -> bool:
        return any(self._varying())

    def times(self, span: Span | None = None) -> list[float]:
        """When it varies: its samples, and those of its indices."""
        return [time for attribute in self._varying() for time in sample_times(attribute, span)]

    def samples(self) -> list[float]:
        """Those of a value and of its indices."""
        there = [each for each in (self.attribute, self.indices) if each]
        return sorted({time for attribute in there for time in attribute.GetTimeSamples()})

    def later(self) -> Iterator[tuple[float, Value | None]]:
        """What it is beside its first value, each with a frame: later samples, and the default that the first hides."""
        sampled, indices = self.samples(), self.indices
        is_whole = not (indices and indices.HasAuthoredValue()) or _has_default(indices)
        if sampled and is_whole and _has_default(self.attribute):
            yield sampled[0], self.at(Usd.TimeCode.Default())
        for frame in self.times():
            yield frame, self.at(Usd.TimeCode(frame))

    def _varying(self) -> list[Usd.Attribute]:
        there = [each for each in (self.attribute, self.indices) if each and self.attribute.HasAuthoredValue()]
        return [each for each in there if each.ValueMightBeTimeVarying()]


def primvar_source(prim: Usd.Prim, name: str) -> Source:
    """The source of any primvar of a prim itself, such as primvars:st."""
    wanted = Input(name.removeprefix("primvars:"), "primvars:", "", 0, True, False, None, None)
    return Source(prim, wanted)


def read_value(
    attribute: Usd.Attribute, time: Usd.TimeCode, indices: Usd.Attribute | None = None, *, name: str | None = None
) -> Value | None:
    """The value of an attribute as it was authored, or None where it was not. Raises Fault where it cannot be read.

    Sentences call it `name`; None: by its own.
    """
    if not attribute or not attribute.HasAuthoredValue():
        return None
    if time.IsDefault() and attribute.Get(time) is None:
        return None
    type_name = str(attribute.GetTypeName())
    interpolation = attribute.GetMetadata("interpolation")
    own = read_value(indices, time) if indices and indices.HasAuthoredValue() else None
    value = _plain(_get(attribute, time), type_name)
    if isinstance(value, Asset):
        value = Asset(_anchored(attribute, time, value))
    return Value(name or attribute.GetName(), value, type_name, interpolation, own)


def read_primvar(primvar: UsdGeom.Primvar) -> Value:
    """The value of a primvar at the first time; where it has none, its name without one. Raises Fault."""
    attribute = primvar.GetAttr()
    nothing = Value(primvar.GetName(), None, str(primvar.GetTypeName()), attribute.GetMetadata("interpolation"))
    return read_value(attribute, FIRST, primvar.GetIndicesAttr()) or nothing


def _anchored(attribute: Usd.Attribute, time: Usd.TimeCode, path: str) -> str:
    """Where to look for a file: relative to the layer that names it."""
    return Sdf.ComputeAssetPathRelativeToLayer(layer_of(attribute, time), path) if path else ""


def layer_of(attribute: Usd.Attribute, time: Usd.TimeCode) -> Sdf.Layer:
    """The layer of the strongest opinion, to which paths are relative."""
    return attribute.GetPropertyStack(time)[0].layer


def _get(attribute: Usd.Attribute, time: Usd.TimeCode) -> object:
    try:
        return attribute.Get(time)
    except Tf.ErrorException as error:
        raise Fault(f"{attribute.GetName()} {phrase('unreadable')}: {usd_message(error)}") from error


def _plain(value: object, type_name: str) -> object:
    """A value of USD as numpy or as a type of the core's."""
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, Sdf.AssetPath):
        return Asset(value.path)
    if isinstance(value, bool | int | float):
        natural = np.float64 if isinstance(value, float) else np.bool_ if isinstance(value, bool) else np.int64
        with np.errstate(over="ignore"):
            return _NUMBERS.get(type_name, natural)(value)
    array = np.asarray(value) if _is_array(value) else None
    return Other() if array is None or array.dtype.kind not in "biuf" else array


def sample_times(attribute: Usd.Attribute, span: Span | None = None) -> list[float]:
    """When a value was authored, in stage time; for a spline its knots and each whole frame between them in a span."""
    if not attribute.HasSpline():
        return list(attribute.GetTimeSamples())
    knots = _knots(attribute)
    if not knots:
        return []
    first, last = (
        math.ceil(max(knots[0], span[0] if span else -math.inf)),
        math.floor(min(knots[-1], span[1] if span else math.inf)),
    )
    if last - first >= MOST_FRAMES:
        raise UsageError(f"{attribute.GetPath()} is a spline over {last - first} frames; say which are wanted")
    return [*knots, *map(float, range(first, last + 1))]


def _knots(attribute: Usd.Attribute) -> list[float]:
    spline = attribute.GetSpline()
    if hasattr(spline, "GetKnotsWithInnerLoopsBaked"):
        return sorted(spline.GetKnotsWithInnerLoopsBaked().keys())
    if spline.HasInnerLoops():
        raise UsageError(f"{attribute.GetPath()} is a spline with inner loops, which USD 25.5 cannot list")
    return sorted(spline.GetKnots().keys())


def _has_default(attribute: Usd.Attribute) -> bool:
    """Whether a default is authored, even if samples hide it."""
    defaults = (spec.default for spec in attribute.GetPropertyStack() if spec.HasInfo("default"))
    return not isinstance(next(defaults, Sdf.ValueBlock()), Sdf.ValueBlock)


def take(taker: Taker, sources: Iterable[Source]) -> list[str]:
    """Hands over values, and those of other times of what must stay the same. Returns what is wrong."""
    faults: list[str] = []
    for source in sources:
        with noting(faults):
            taker.take(source.wanted, source.first())
            for frame, value in source.later() if source.wanted.when == STILL else ():
                taker.check(source.wanted, value, frame)
    return faults
