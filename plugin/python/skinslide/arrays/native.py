"""From numpy arrays to the structs of the public headers and back: checks types and shapes, raises statuses as errors.

Fields and enums are read from the declarations; only what C cannot see, the lengths of arrays, is checked here.
"""

from __future__ import annotations

import operator
import re
import weakref
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, partial
from typing import Any, NamedTuple, TypeVar

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.records import DeviceInfo, LookupInfo, PatchInfo, PatchResult, Roughness, WeldInfo
from skinslide.problems import SliderError, not_one_of

Record = TypeVar("Record", PatchInfo, PatchResult, DeviceInfo, LookupInfo, WeldInfo, Roughness)
Kind = TypeVar("Kind")


@dataclass(frozen=True, eq=False)
class Controls:
    """What an artist paints and animates on a patch, for a mesh of V vertices and F faces.

    Attributes:
        vertex_density: Force density multipliers (V,), above 0; an edge takes the mean of its ends; None: 1.
        face_density: The same by face (F,); an edge takes the mean of its faces; None: 1.
        edges: Pairs of vertices (k, 2), each an edge of the patch; None: none.
        edge_density: A factor above 0 for each of them (k,), which multiplies the others; None: none.
        weight: How far each vertex slides (V,), 0 to 1; None: 1.
        envelope: Scales the slide of the whole patch, 0 to 1.
        max_distance: How far each vertex may slide along the surface (V,), in the mesh's units; None: no limit.
        hold: How closely a vertex follows its neighbours' slide (V,), above 0; None: 1. For relaxed and even.
        stretch_response: How much of the stretch is evened out, 0 to 1. For relaxed and even.
        compression_response: How much of the compression is. For relaxed and even.
    """

    vertex_density: np.ndarray | None = None
    face_density: np.ndarray | None = None
    edges: np.ndarray | None = None
    edge_density: np.ndarray | None = None
    weight: np.ndarray | None = None
    envelope: float = 1.0
    max_distance: np.ndarray | None = None
    hold: np.ndarray | None = None
    stretch_response: float = 1.0
    compression_response: float = 1.0


@dataclass(frozen=True, eq=False)
class PatchSetup:
    """One patch as an artist sets it up; the settings are the tokens of `SkinSlideAPI`.

    Attributes:
        name: Of the patch, such as elbow_L.
        faces: Of the mesh: indices (n,), in any order, or a bool for each (F,).
        corners: Vertices (4,) on the outer boundary that are laid out at the corners of the square; None: none.
        boundary: auto, square or circle: the outline in which the patch is laid out.
        holes: pinned, free or freeAll: what happens at the rims of holes, and with freeAll at the outer boundary too.
        rule: unit, fast, relaxed or even: where skin slides to.
        interpolation: auto, linear, meanValue or limit: how a place within a face becomes a point.
        controls: What is painted.
        held: Whether each vertex of the mesh (V,) stays if it is on a border, whatever holes says; None: none does.
    """

    name: str
    faces: np.ndarray
    corners: np.ndarray | None = None
    boundary: str = "auto"
    holes: str = "pinned"
    rule: str = "unit"
    interpolation: str = "auto"
    controls: Controls = field(default_factory=Controls)
    held: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Subdivision:
    """How a mesh is subdivided, in the words of UsdGeomMesh. Sharpness 10 or more is infinitely sharp.

    Attributes:
        scheme: catmullClark, loop, bilinear or none.
        boundary_rule: edgeAndCorner, edgeOnly or none.
        triangle_rule: catmullClark or smooth.
        crease_lengths: Vertices of each crease (c,); None: no creases.
        crease_indices: Vertices (sum of lengths,), crease by crease.
        crease_sharpnesses: One for each crease (c,), or one for each edge of each crease.
        corner_indices: Sharp vertices (k,); None: none.
        corner_sharpnesses: One for each of them (k,).
        hole_indices: Faces that are holes of the surface (h,); None: none.
    """

    scheme: str = "catmullClark"
    boundary_rule: str = "edgeAndCorner"
    triangle_rule: str = "catmullClark"
    crease_lengths: np.ndarray | None = None
    crease_indices: np.ndarray | None = None
    crease_sharpnesses: np.ndarray | None = None
    corner_indices: np.ndarray | None = None
    corner_sharpnesses: np.ndarray | None = None
    hole_indices: np.ndarray | None = None


@dataclass(frozen=True)
class Lookup:
    """How rest vertices are looked up in a frame. The result is always the same.

    Attributes:
        method: auto, egl or exact.
        device: The number of one of EGL's devices; None: the first that works.
        resolution: Texels along a side of the texture of faces; 0: by the patch.
    """

    method: str = "auto"
    device: int | None = None
    resolution: int = 0

    @staticmethod
    def of(lookup: str | Lookup) -> Lookup:
        """Makes a lookup of one, or of its method alone.

        Args:
            lookup: A lookup, or its method.

        Returns:
            The lookup.
        """
        return lookup if isinstance(lookup, Lookup) else Lookup(lookup)

    def options(self) -> Any:
        """The core's struct of options. Raises SliderError for what none can have."""
        options = new("workspace_options")
        options.lookup, options.device = enum_value("lookup", self.method, ""), device_number(self.device)
        options.resolution = _number("resolution", self.resolution)
        return options


def new(struct: str) -> Any:
    """A struct of the headers, with its default values."""
    made = ffi.new(f"skinslide_{struct} *")
    getattr(lib, f"skinslide_{struct}_default")(made)
    return made


def new_array(struct: str, count: int) -> Any:
    made = ffi.new(f"skinslide_{struct}[]", count)
    for i in range(count):
        getattr(lib, f"skinslide_{struct}_default")(made + i)
    return made


def device_number(device: int | None) -> int:
    """The core's number for an EGL device; None: any. Raises SliderError for a number that no device can have."""
    return -1 if device is None else _number("device", device)


def _number(what: str, number: int) -> int:
    # Nothing else fits the core's int32, in which numbers below 0 mean none.
    if not 0 <= whole(number, what) < 2**31:
        raise SliderError("BAD_ARGUMENT", f"no such {what}: {number}")
    return number


def tokens(setting: str) -> tuple[str, ...]:
    """The tokens of a setting, such as boundary, rule, lookup, scheme or pixels."""
    return tuple(_values_by_token(setting))


class Handle:
    """A handle of the core. It is destroyed once nothing refers to this object, and before the handles that it needs.

    ffi.gc would not do: the collector breaks a cycle wherever it likes, and might destroy first what is needed.
    """

    def __init__(self, pointer: Any, destroy: Callable[[Any], None], *needed: Handle):
        self.pointer = pointer
        # The finalizer, which is part of no cycle, keeps alive what is needed.
        weakref.finalize(self, _destroy, destroy, pointer, needed).atexit = False


def _destroy(destroy: Callable[[Any], None], pointer: Any, _needed: tuple[Handle, ...]) -> None:
    destroy(pointer)


class Sizes(NamedTuple):
    """How many vertices and faces a mesh has."""

    vertices: int
    faces: int


class Sample(NamedTuple):
    """Points of one time, before and after sliding.

    Attributes:
        seconds: The time; except for rates, only ratios of steps matter.
        cached: Points before sliding (V, 3).
        slid: Points after it (V, 3).
    """

    seconds: float
    cached: np.ndarray
    slid: np.ndarray


_CTYPES: dict[type, str] = {
    np.int32: "int32_t[]",
    np.float32: "float[]",
    np.float64: "double[]",
    np.bool_: "uint8_t[]",
    np.uint8: "uint8_t[]",
}


class Arguments:
    """Fills the core's structs from arrays, and holds the memory they point into for as long as this object lives."""

    def __init__(self) -> None:
        self._alive: list[Any] = []

    def pointer(self, values: Any, dtype: type, shape: tuple[int, ...], what: str) -> Any:
        """A pointer to values as a contiguous array of that type and shape; -1 in the shape is any length."""
        buffer = ffi.from_buffer(_CTYPES[dtype], as_array(values, dtype, shape, what))
        self._alive.append(buffer)
        return buffer

    def optional(self, values: Any, dtype: type, shape: tuple[int, ...], what: str) -> Any:
        return ffi.NULL if values is None else self.pointer(values, dtype, shape, what)

    def points(self, values: Any, vertex_count: int, what: str) -> Any:
        return self.pointer(values, np.float32, (vertex_count, 3), what)

    def mesh(
        self,
        face_counts: Any,
        face_indices: Any,
        points: Any,
        subdivision: Subdivision | None = None,
        weld: Any = None,
        space: Any = None,
    ) -> Any:
        mesh = new("mesh")
        self._alive.append(mesh)
        mesh.face_counts = self.pointer(face_counts, np.int32, (-1,), "face counts")
        mesh.face_indices = self.pointer(face_indices, np.int32, (-1,), "face indices")
        mesh.rest_points = self.points(points, -1, "points")
        mesh.face_count, mesh.index_count, mesh.vertex_count = len(face_counts), len(face_indices), len(points)
        if subdivision is not None:
            mesh.subdivision = self.subdivision(subdivision)
        mesh.weld = self.optional(weld, np.int32, (len(points),), "weld")
        mesh.space = self.optional(space, np.float64, (3, 3), "space")
        return mesh[0]

    def subdivision(self, given: Subdivision) -> Any:
        check_kind("subdivision", given, Subdivision)
        target = new("subdivision")
        self._alive.append(target)
        for setting in ("scheme", "boundary_rule", "triangle_rule"):
            setattr(target, setting, enum_value(setting, getattr(given, setting), ""))
        for name, dtype in _SUBDIVISION_ARRAYS.items():
            values = getattr(given, name)
            setattr(target, name, self.optional(values, dtype, (-1,), name.replace("_", " ")))
        sharpnesses, corners = _length(given.corner_sharpnesses), _length(given.corner_indices)
        check_count("BAD_MESH", "corner sharpnesses", (sharpnesses, "values"), (corners, "corners"))
        target.crease_count, target.crease_index_count = _length(given.crease_lengths), _length(given.crease_indices)
        target.crease_sharpness_count = _length(given.crease_sharpnesses)
        target.corner_count, target.hole_count = _length(given.corner_indices), _length(given.hole_indices)
        return target

    def fill_setup(self, target: Any, patch: PatchSetup, sizes: Sizes) -> None:
        where = f"patch {patch.name}: "
        name = ffi.new("char[]", encoded_name(patch.name))
        self._alive.append(name)
        target.name = name
        faces = _indices(patch.faces, sizes.faces, f"{where}faces")
        target.faces = self.pointer(faces, np.int32, (-1,), f"{where}faces")
        target.face_count = len(faces)
        target.corners = self.optional(patch.corners, np.int32, (4,), f"{where}corners")
        target.held = self.optional(patch.held, np.bool_, (sizes.vertices,), f"{where}held")
        for setting in ("boundary", "holes", "rule", "interpolation"):
            setattr(target, setting, enum_value(setting, getattr(patch, setting), where))
        controls = new("controls")
        self._alive.append(controls)
        check_kind(f"{where}controls", patch.controls, Controls)
        self.fill_controls(controls, patch.controls, sizes, where)
        target.controls = controls

    def fill_controls(self, target: Any, controls: Controls, sizes: Sizes, where: str) -> None:
        counts = {
            "vertex_density": sizes.vertices,
            "face_density": sizes.faces,
            "weight": sizes.vertices,
            "max_distance": sizes.vertices,
            "hold": sizes.vertices,
        }
        for name, count in counts.items():
            values = getattr(controls, name)
            setattr(target, name, self.optional(values, np.float32, (count,), where + name.replace("_", " ")))
        edges, density = controls.edges, controls.edge_density
        if edges is not None and density is not None and not np.size(edges) and not np.size(density):
            edges = density = None
        if (edges is None) != (density is None):
            raise SliderError("BAD_ARGUMENT", f"{where}edges and edge density must be given together")
        target.edge_count = 0 if edges is None else len(edges)
        target.edges = self.optional(edges, np.int32, (-1, 2), f"{where}edges")
        target.edge_density = self.optional(density, np.float32, (target.edge_count,), f"{where}edge density")
        for name in ("envelope", "stretch_response", "compression_response"):
            setattr(target, name, real(getattr(controls, name), where + name.replace("_", " ")))

    def frame_controls(self, controls: Sequence[Controls] | None, names: tuple[str, ...], sizes: Sizes) -> Any:
        if controls is None:
            return ffi.NULL
        controls = all_of("controls", controls, Controls)
        check_count("BAD_ARGUMENT", "controls", (len(controls), "given"), (len(names), "patches"))
        targets = new_array("controls", len(names))
        self._alive.append(targets)
        for target, patch, name in zip(targets, controls, names, strict=True):
            self.fill_controls(target, patch, sizes, f"patch {name}: ")
        return targets

    def samples(self, samples: Sequence[Sample], count: int, vertex_count: int, what: str) -> Any:
        given = all_of("samples", samples, Sample)
        if len(given) != count:
            raise SliderError("BAD_ARGUMENT", f"{what} need {count} samples, not {len(given)}")
        targets = new_array("sample", count)
        for target, sample in zip(targets, given, strict=True):
            target.seconds = real(sample.seconds, "seconds")
            target.cached = self.points(sample.cached, vertex_count, "cached")
            target.slid = self.points(sample.slid, vertex_count, "slid")
        return targets


_SUBDIVISION_ARRAYS = {
    "crease_lengths": np.int32,
    "crease_indices": np.int32,
    "crease_sharpnesses": np.float32,
    "corner_indices": np.int32,
    "corner_sharpnesses": np.float32,
    "hole_indices": np.int32,
}


def _length(values: Any) -> int:
    return 0 if values is None else len(values)


def all_of(what: str, given: Any, kind: type[Kind]) -> tuple[Kind, ...]:
    """The elements of a sequence. Raises SliderError unless all are of a kind."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        said = f"{what} is of the type {type(given).__name__}; a sequence of {kind.__name__} is wanted"
        raise SliderError("BAD_ARGUMENT", said)
    each = tuple(given)
    for i, one in enumerate(each):
        check_kind(f"{what}[{i}]", one, kind)
    return each


def check_kind(what: str, given: Any, kind: type) -> None:
    if not isinstance(given, kind):
        said = f"{what} is of the type {type(given).__name__}; {kind.__name__} is wanted"
        raise SliderError("BAD_ARGUMENT", said)


def real(value: Any, what: str) -> float:
    """A number as a float, or SliderError."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error


def whole(value: Any, what: str) -> int:
    """A number that is an index or a count, or SliderError."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error


def _indices(chosen: Any, count: int, what: str) -> Any:
    """Indices as they are, or those at which an array of bools is true."""
    flags = np.asarray(chosen) if isinstance(chosen, np.ndarray | list | tuple) and len(chosen) else None
    if flags is None or flags.dtype != np.bool_ or flags.ndim != 1:
        return chosen
    check_count("BAD_ARGUMENT", what, (len(flags), "values"), (count, "faces"))
    return np.flatnonzero(flags).astype(np.int32)


def check_count(status: str, what: str, counted: tuple[int, str], of: tuple[int, str]) -> None:
    """Raises SliderError unless both counts are the same: `what` has (1, "values") for (2, "corners")."""
    if counted[0] != of[0]:
        raise SliderError(status, f"{what}: {counted[0]} {counted[1]} for {of[0]} {of[1]}")


def encoded_name(name: str) -> bytes:
    encoded = None
    with suppress(AttributeError, UnicodeEncodeError):
        encoded = name.encode()
    if encoded is None or b"\0" in encoded:
        raise SliderError("BAD_ARGUMENT", f"{name!r} cannot name a patch")
    return encoded


def as_array(values: Any, dtype: type, shape: tuple[int, ...], what: str) -> np.ndarray:
    """A contiguous array of values, or SliderError with both shapes."""
    try:
        source = np.asarray(values)
    except (TypeError, ValueError) as error:  # rows of different lengths
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error
    if source.shape != shape and not _fits(source.shape, shape):
        wanted = " x ".join("n" if size == -1 else str(size) for size in shape)
        got = " x ".join(map(str, source.shape)) or "a single value"
        raise SliderError("BAD_ARGUMENT", f"{what}: the shape is {got}; it must be {wanted}")
    if source.dtype == dtype and source.flags.c_contiguous:
        return source
    # Casts of the same kind lose no more than digits, except for integers that do not fit.
    fits = source.size == 0 or (
        np.can_cast(source.dtype, dtype, "same_kind") and (source.dtype == np.bool_) == (dtype == np.bool_)
    )
    with np.errstate(over="ignore"):
        result = np.ascontiguousarray(source, dtype) if fits else source
    if not fits or (dtype == np.int32 and not np.array_equal(result, source)):
        raise SliderError("BAD_ARGUMENT", f"{what}: {source.dtype} values do not fit {np.dtype(dtype)}")
    return result


def _fits(got: tuple[int, ...], shape: tuple[int, ...]) -> bool:
    return len(got) == len(shape) and all(wanted in (-1, size) for wanted, size in zip(shape, got, strict=True))


def writable(ctype: str, array: np.ndarray) -> Any:
    return ffi.from_buffer(ctype, array, require_writable=True)


def _values_by_token(setting: str) -> dict[str, int]:
    """The enum of a setting by its stage tokens: SKINSLIDE_INTERPOLATION_MEAN_VALUE is meanValue."""
    names = ffi.typeof(f"skinslide_{setting}").relements
    prefix = f"SKINSLIDE_{setting.removesuffix('_layout').upper()}_"
    words = {name: name.removeprefix(prefix).lower() for name in names}
    by_value = sorted(names, key=names.__getitem__)
    return {re.sub("_([a-z])", lambda match: match[1].upper(), words[name]): names[name] for name in by_value}


def enum_value(setting: str, token: str, where: str) -> int:
    values = _values_by_token(setting)
    if not isinstance(token, str) or token not in values:
        raise SliderError("BAD_ARGUMENT", where + not_one_of(setting, token, tuple(values)))
    return values[token]


def token_of(setting: str, value: int) -> str:
    return next(token for token, number in _values_by_token(setting).items() if number == value)


def call(function: Any, *arguments: Any) -> None:
    error = ffi.new("skinslide_error *")
    status = function(*arguments, error)
    if status != lib.SKINSLIDE_OK:
        raise SliderError(text(lib.skinslide_status_name(status)), ffi.string(error.message).decode(errors="replace"))


def read(kind: type[Record], *structs: Any) -> Record:
    """A record of the fields of structs, text and tokens as str."""
    values: dict[str, Any] = {}
    for struct in structs:
        names, get, meanings = _fields(kind._fields, ffi.typeof(struct))
        if names == kind._fields and not meanings:
            return kind._make(get(struct))  # the fast way for numbers alone, such as each patch's in each frame
        values.update(zip(names, get(struct), strict=True))
        for name, meaning in meanings.items():
            values[name] = meaning(values[name])
    return kind(*[values[name] for name in kind._fields])


@cache
def _fields(
    wanted: tuple[str, ...], struct: Any
) -> tuple[tuple[str, ...], Callable[[Any], tuple[Any, ...]], dict[str, Callable[[Any], str]]]:
    """Which of the wanted fields a type has, a getter of them all, and converters of those that are not numbers."""
    types = {name: field_.type for name, field_ in struct.fields}
    names, meanings = tuple(name for name in wanted if name in types), dict[str, Callable[[Any], str]]()
    for name in names:
        if types[name].kind == "enum":
            meanings[name] = partial(token_of, types[name].cname.removeprefix("enum skinslide_"))
        elif types[name].kind != "primitive":
            meanings[name] = text
    return names, operator.attrgetter(*names), meanings


def text(characters: Any) -> str:
    return ffi.string(characters).decode(errors="replace")
