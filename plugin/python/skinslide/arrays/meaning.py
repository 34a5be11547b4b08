"""What SkinSlideAPI means, on values as a scene holds them: no USD here, and no meaning either, which is the core's.

The manual is `stage.h`: what there is to fetch is asked for, handed over, and comes back as what a `Slider` takes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.native import (
    Arguments,
    Controls,
    Handle,
    PatchSetup,
    Sizes,
    Subdivision,
    new,
    new_array,
    read,
    text,
    token_of,
    writable,
)
from skinslide.arrays.records import WeldInfo
from skinslide.problems import Fault

SCHEMA = text(lib.skinslide_stage_schema())

_TYPES = {
    np.dtype(np.bool_): lib.SKINSLIDE_VALUE_BOOL,
    np.dtype(np.uint8): lib.SKINSLIDE_VALUE_UINT8,
    np.dtype(np.int32): lib.SKINSLIDE_VALUE_INT32,
    np.dtype(np.uint32): lib.SKINSLIDE_VALUE_UINT32,
    np.dtype(np.int64): lib.SKINSLIDE_VALUE_INT64,
    np.dtype(np.uint64): lib.SKINSLIDE_VALUE_UINT64,
    np.dtype(np.float16): lib.SKINSLIDE_VALUE_HALF,
    np.dtype(np.float32): lib.SKINSLIDE_VALUE_FLOAT,
    np.dtype(np.float64): lib.SKINSLIDE_VALUE_DOUBLE,
}
# When an input is fetched that is not simply taken at the first time.
STILL: int = lib.SKINSLIDE_STAGE_STILL
DEFAULT_TIME: int = lib.SKINSLIDE_STAGE_DEFAULT_TIME


class Asset(str):
    """The path of a file, as it was authored."""


class Other:
    """A value of a kind that nothing takes."""


NOTHING = Other()  # of a property that was not authored


class Value(NamedTuple):
    """A property at one time, as it was authored."""

    name: str
    # (n,) or (n, width) numpy of an array; a numpy scalar, str, Asset or Other; None: there is none at this time.
    value: Any
    type_name: str
    interpolation: str | None = None
    indices: Value | None = None


class Input(NamedTuple):
    """A property to fetch, as in `skinslide_stage_input`."""

    name: str
    prefix: str
    type_name: str
    when: int
    is_primvar: bool
    is_inherited: bool
    fallback: str | None
    pointer: Any
    tokens: tuple[str, ...] = ()  # that it may be; none: it is no choice

    def property(self, patch: str | None = None) -> str:
        """Its name on a prim, for an input of a patch or of none."""
        return f"{self.prefix}{self.name}" if patch is None else f"{self.prefix}{patch}:{self.name}"


@cache
def inputs(group: str) -> tuple[Input, ...]:
    """What there is to fetch of a group, in order: mesh, subdivision, patch, controls, derived, live."""
    number, found = getattr(lib, f"SKINSLIDE_STAGE_{group.upper()}"), list[Input]()
    while each := lib.skinslide_stage_next_input(number, found[-1].pointer if found else ffi.NULL):
        found.append(_input(each))
    return tuple(found)


def _input(each: Any) -> Input:
    is_primvar, is_inherited = bool(each.is_primvar), bool(each.is_inherited)
    words = (text(each.name), text(each.prefix), text(each.type_name))
    fallback = text(each.fallback) if each.fallback else None
    tokens = list[str]()
    while each.tokens and each.tokens[len(tokens)]:
        tokens.append(text(each.tokens[len(tokens)]))
    return Input(*words, each.when, is_primvar, is_inherited, fallback, each, tuple(tokens))


def input_of(group: str, name: str) -> Input:
    """The first input of that name."""
    return next(each for each in inputs(group) if each.name == name)


def is_texture(source: Input) -> bool:
    """Whether the values of an input are paths of files."""
    return bool(lib.skinslide_stage_is_texture(source.pointer))


def say(saying: str) -> str:
    """Words that the core says too: no_type, no_file, irregular, unreadable."""
    return text(lib.skinslide_stage_say(getattr(lib, f"SKINSLIDE_SAYING_{saying.upper()}")))


def can_name_patch(name: str) -> bool:
    """Whether a name may be a patch's, as far as the schema goes."""
    return bool(lib.skinslide_stage_can_name_patch(name.encode(errors="replace")))


def check_text(usda: str) -> None:
    """Raises Fault for text that USD cannot parse, or would end the process over."""
    encoded = usda.encode()
    _call(lib.skinslide_stage_text, ffi.from_buffer(encoded), len(encoded))


def check_value(source: Input, value: Value) -> None:
    """Raises Fault for what cannot be authored for an input of the group PATCH or LIVE, whatever the mesh."""
    _call(lib.skinslide_stage_check_value, source, value)


def nothing_to_slide(where: str) -> str:
    """The sentence for a scene in which no mesh carries a patch."""
    error = ffi.new("skinslide_error *")
    lib.skinslide_stage_nothing(where.encode(errors="replace"), error)
    return text(error.message)


def times_between(times: Sequence[float]) -> list[float]:
    """The whole times between those of a merged list that are more than 1 apart. Raises Fault for too many."""
    given, count = ffi.new("double[]", list(times)), ffi.new("int64_t *")
    _call(lib.skinslide_stage_times_between, given, len(given), ffi.NULL, count)
    between = ffi.new("double[]", count[0])
    _call(lib.skinslide_stage_times_between, given, len(given), between, count)
    return list(between)


def merge_times(times: Iterable[float]) -> list[float]:
    """Times in order; of those that differ by noise only, the one given first."""
    merged = np.array(list(times), np.float64)
    count = ffi.new("int64_t *", len(merged))
    _call(lib.skinslide_stage_merge_times, writable("double[]", merged), count)
    return merged[: count[0]].tolist()


def integers(value: Value | None) -> np.ndarray:
    """Whole numbers, int32 (n,). Raises Fault."""
    out = np.empty(_length(value), np.int32)
    _call(lib.skinslide_value_integers, value, writable("int32_t[]", out))
    return out


def positions(value: Value | None) -> np.ndarray:
    """Points, float32 (n, 3). Raises Fault."""
    out = np.empty((_length(value), 3), np.float32)
    _call(lib.skinslide_value_positions, value, writable("float[]", out))
    return out


def _length(value: Value | None) -> int:
    native = _Native()
    return int(lib.skinslide_value_length(native.of(value)))


# ---- Prims ----


@dataclass(frozen=True)
class PrimFacts:
    """Facts of a prim, as in `skinslide_stage_prim`."""

    type_name: str = ""
    is_mesh: bool = False
    is_defined: bool = True
    instance: str | None = None
    instancer: str | None = None
    slid_by: str | None = None
    baked_by: str | None = None
    point_samples: int = 0
    has_joint_indices: bool = False
    blend_shape_count: int = 0
    schemas: Sequence[str] = ()
    properties: Sequence[str] = ()
    uncomposed: str | None = None
    variant_set: str | None = None
    variant: str | None = None
    skel_root: str | None = None
    skeleton: str | None = None
    has_joint_weights: bool = False
    reads_skinning: bool = False


class Said(NamedTuple):
    """One thing to say about a prim."""

    severity: str  # error or warning
    patch: str | None
    message: str


class Finding(NamedTuple):
    """The patches of a prim, whether they can be slid, what there is to say of it, and whether UsdSkel moves it."""

    patches: list[str]
    slides: bool
    said: list[Said]
    is_skinned: bool


def find(facts: PrimFacts) -> Finding:
    """Looks at a prim."""
    out = ffi.new("skinslide_stage_finding **")
    _call(lib.skinslide_stage_find, facts, out)
    found = ffi.gc(out[0], lib.skinslide_stage_finding_destroy)
    problems = (found.problems[i] for i in range(found.problem_count))
    said = [
        Said(token_of("severity", each.severity), text(each.patch) if each.patch else None, text(each.message))
        for each in problems
    ]
    patches = [text(found.patches[i]) for i in range(found.patch_count)]
    return Finding(patches, bool(found.slides), said, bool(found.skinned_by))


class Taker:
    """What inputs are handed to."""

    handle: Handle
    _take: Any
    _check: Any

    def take(self, source: Input, value: Value | None) -> None:
        """Takes an input of one of its groups. Raises Fault."""
        _call(self._take, self.handle, source, value)

    def check(self, source: Input, value: Value | None, frame: float) -> None:
        """Raises Fault where a later sample of what must stay the same does not."""
        _call(self._check, self.handle, source, value, frame)


def _said(sentence: Any) -> str:
    return text(sentence) if sentence else ""


# ---- Meshes ----


class Weld(NamedTuple):
    """Which points are one: of each that which it is one with, and what came of it."""

    vertices: np.ndarray  # int32 (V,)
    info: WeldInfo


class MeshMeaning(Taker):
    """One mesh of a scene: its faces, its rest points, how it is subdivided."""

    _take, _check = lib.skinslide_stage_mesh_take, lib.skinslide_stage_mesh_check

    def __init__(self) -> None:
        out = ffi.new("skinslide_stage_mesh **")
        _call(lib.skinslide_stage_mesh_create, out)
        self.handle = Handle(out[0], lib.skinslide_stage_mesh_destroy)

    @property
    def has_faces(self) -> bool:
        """Whether points and faces were taken, which patches need."""
        mesh = new("mesh")
        return lib.skinslide_stage_mesh_faces(self.handle.pointer, mesh, ffi.NULL) == lib.SKINSLIDE_OK

    @property
    def left_handed(self) -> bool:
        return bool(lib.skinslide_stage_mesh_left_handed(self.handle.pointer))

    @property
    def rest_source(self) -> str:
        return text(lib.skinslide_stage_mesh_rest_source(self.handle.pointer))

    @property
    def warning(self) -> str:
        """What to warn of, or nothing."""
        return _said(lib.skinslide_stage_mesh_warning(self.handle.pointer))

    @property
    def space_warning(self) -> str:
        """What to warn of in the transforms above, or nothing."""
        return _said(lib.skinslide_stage_mesh_space_warning(self.handle.pointer))

    def offer(self, name: str, type_name: str, interpolation: str | None) -> None:
        """Offers a primvar, so that errors can list those that may be texture coordinates."""
        _call(lib.skinslide_stage_mesh_offer, self.handle, name, type_name, interpolation)

    @property
    def coordinates_there(self) -> str:
        """What could be named as texture coordinates, in words."""
        return f"there are {text(lib.skinslide_stage_mesh_coordinates(self.handle.pointer)) or 'none'}"

    def take_space(self, to_world: np.ndarray, frame: float) -> None:
        """Takes the way to the world (4, 4), of rows, at a time; the first first. Raises Fault."""
        matrix = np.ascontiguousarray(to_world, np.float64)
        _call(lib.skinslide_stage_mesh_space, self.handle, ffi.from_buffer("double[]", matrix), frame)

    def space(self) -> np.ndarray | None:
        """What takes points to where lengths are taken (3, 3); None: nothing. Raises Fault where rest was not taken."""
        return _optional(self._read(lib.skinslide_stage_mesh_get).space, np.float64, 3, 3)

    @property
    def shape(self) -> Any:
        """A `skinslide_mesh` of points and faces, as long as this lives. Raises Fault where they were not taken."""
        return self._read(lib.skinslide_stage_mesh_faces)

    @property
    def face_counts(self) -> np.ndarray:
        return _copied(self.shape.face_counts, np.int32, self.shape.face_count)

    @property
    def face_indices(self) -> np.ndarray:
        return _copied(self.shape.face_indices, np.int32, self.shape.index_count)

    def rest_points(self) -> np.ndarray:
        """Float32 (V, 3). Raises Fault where none were taken."""
        mesh = self._read(lib.skinslide_stage_mesh_get)
        return _copied(mesh.rest_points, np.float32, mesh.vertex_count, 3)

    def subdivision(self) -> Subdivision | None:
        """None where the mesh renders as its faces, or where that was not asked. Raises Fault."""
        found = self._read(lib.skinslide_stage_mesh_get).subdivision
        return _subdivision(found) if found else None

    def weld(self, patches: Sequence[PatchSetup], poses: Iterable[tuple[float, np.ndarray]]) -> Weld:
        """Which points are one, over rest and all poses of the shot, each with its frame. Raises Fault."""
        native, count = Arguments(), self.shape.vertex_count
        setups, out, info = new_array("patch_setup", len(patches)), ffi.new("skinslide_weld **"), new("weld_info")
        for setup, patch in zip(setups, patches, strict=True):
            native.fill_setup(setup, patch, Sizes(count, self.shape.face_count))
        _call(lib.skinslide_stage_mesh_weld, self.handle, setups, len(patches), out)
        weld, vertices = Handle(out[0], lib.skinslide_weld_destroy), np.arange(count, dtype=np.int32)
        if lib.skinslide_weld_wants_poses(weld.pointer):
            for frame, points in poses:
                # What cannot be slid there is said when it is to be.
                lib.skinslide_weld_show(weld.pointer, frame, Arguments().points(points, count, "points"), ffi.NULL)
            _call(lib.skinslide_weld_get, weld, writable("int32_t[]", vertices), info)
        return Weld(vertices, read(WeldInfo, info[0]))

    def points(self, value: Value | None) -> np.ndarray:
        """The points of a frame, float32 (V, 3): those of the value, if they can be taken as they are. Raises Fault."""
        found = value.value if value and not value.indices else None
        if isinstance(found, np.ndarray) and found.dtype == np.float32 and found.flags.c_contiguous:
            _call(lib.skinslide_stage_points, self.handle, value, ffi.NULL)
            return found
        out = np.empty((self.shape.vertex_count, 3), np.float32)
        _call(lib.skinslide_stage_points, self.handle, value, writable("float[]", out))
        return out

    def check_points(self, points: np.ndarray) -> None:
        """Raises Fault for points of a frame, (V, 3), that cannot be slid."""
        given = Arguments().points(points, self.shape.vertex_count, "points")
        _call(lib.skinslide_stage_check_points, self.handle, given)

    def coordinates(self, value: Value | None) -> np.ndarray:
        """Texture coordinates of the corners, float32 (sum of counts, 2). Raises Fault."""
        out = np.empty((self.shape.index_count, 2), np.float32)
        _call(lib.skinslide_stage_coordinates, self.handle, value, writable("float[]", out))
        return out

    def painted(self, value: Value | None) -> np.ndarray:
        """What any primvar says of the points, float64 (V,). Raises Fault."""
        out = np.empty(self.shape.vertex_count, np.float64)
        _call(lib.skinslide_stage_painted, self.handle, value, writable("double[]", out))
        return out

    def _read(self, function: Any) -> Any:
        mesh = new("mesh")
        _call(function, self.handle, mesh)
        return mesh


def _subdivision(found: Any) -> Subdivision:
    tokens = {name: token_of(name, getattr(found, name)) for name in ("scheme", "boundary_rule", "triangle_rule")}
    return Subdivision(
        **tokens,
        crease_lengths=_optional(found.crease_lengths, np.int32, found.crease_count),
        crease_indices=_optional(found.crease_indices, np.int32, found.crease_index_count),
        crease_sharpnesses=_optional(found.crease_sharpnesses, np.float32, found.crease_sharpness_count),
        corner_indices=_optional(found.corner_indices, np.int32, found.corner_count),
        corner_sharpnesses=_optional(found.corner_sharpnesses, np.float32, found.corner_count),
        hole_indices=_optional(found.hole_indices, np.int32, found.hole_count),
    )


# ---- Patches ----


class Subset(NamedTuple):
    """A child prim of a patch's name, as in `skinslide_stage_subset`."""

    path: str
    type_name: str
    is_subset: bool


class Names:
    """Names of properties, sorted to be looked up for many inputs."""

    def __init__(self, names: Iterable[str]):
        self._names = {name.encode(errors="replace"): name for name in names}
        self._texts = [ffi.new("char[]", name) for name in self._names]
        self._sorted = ffi.new("const char *[]", self._texts)
        lib.skinslide_stage_sort_names(self._sorted, len(self._texts))

    def of(self, source: Input, patch: PatchMeaning) -> str | None:
        """Which of them is an input of a patch; None: none."""
        count = len(self._texts)
        found = lib.skinslide_stage_patch_property(patch.handle.pointer, source.pointer, self._sorted, count)
        return None if found < 0 else self._names[ffi.string(self._sorted[found])]


class PatchMeaning(Taker):
    """One patch: its faces and its settings."""

    _take, _check = lib.skinslide_stage_patch_take, lib.skinslide_stage_patch_check

    def __init__(self, mesh: MeshMeaning, name: str):
        out = ffi.new("skinslide_stage_patch **")
        _call(lib.skinslide_stage_patch_create, mesh.handle, name, None, out)
        self.mesh, self.name = mesh, name
        self.handle = Handle(out[0], lib.skinslide_stage_patch_destroy, mesh.handle)

    def take_subset(self, subset: Subset | None) -> None:
        """Takes the child prim whose faces follow, or learns that there is none. Raises Fault."""
        _call(lib.skinslide_stage_patch_take_subset, self.handle, subset)

    @property
    def faces(self) -> np.ndarray:
        """Those of the patch so far, int32, ascending."""
        count = ffi.new("int32_t *")
        faces = lib.skinslide_stage_patch_faces(self.handle.pointer, count)
        return _copied(faces, np.int32, count[0])

    def unread(self, controls: ControlsMeaning) -> list[Input]:
        """What is said of the patch that its rule has no use for."""
        found = list[Input]()
        known = self.handle.pointer, controls.handle.pointer
        while each := lib.skinslide_stage_next_unread(*known, found[-1].pointer if found else ffi.NULL):
            found.append(_input(each))
        return found

    def describe(self, source: Input, value: Value) -> str:
        """What there is to say of paint that is not as the schema has it, or nothing."""
        native, words = _Native(), ffi.new("char[512]")
        said = lib.skinslide_stage_patch_describe(self.handle.pointer, source.pointer, native.of(value), words)
        return text(words) if said else ""

    @property
    def needs_subdivision(self) -> bool:
        return bool(lib.skinslide_stage_patch_needs_subdivision(self.handle.pointer))

    @property
    def warning(self) -> str:
        """What to warn of, or nothing."""
        return _said(lib.skinslide_stage_patch_warning(self.handle.pointer))

    @property
    def wants_neighbours(self) -> bool:
        """Whether its borders are to stay where another mesh meets them, and would slide else."""
        return bool(lib.skinslide_stage_patch_wants_neighbours(self.handle.pointer))

    def meet(self, others: np.ndarray) -> None:
        """Takes points (n, 3) of another mesh in the same space, at the first time. Raises Fault."""
        given = np.ascontiguousarray(others, np.float32)
        _call(lib.skinslide_stage_patch_meet, self.handle, ffi.from_buffer("float[]", given), len(given))

    def setup(self, controls: ControlsMeaning) -> PatchSetup:
        """The set-up with some controls. Raises Fault."""
        out = new("patch_setup")
        _call(lib.skinslide_stage_patch_get, self.handle, controls.handle, out)
        return PatchSetup(
            name=self.name,
            faces=self.faces,
            corners=_copied(out.corners, np.int32, 4) if out.corners else None,
            boundary=token_of("boundary", out.boundary),
            holes=token_of("holes", out.holes),
            rule=token_of("rule", out.rule),
            interpolation=token_of("interpolation", out.interpolation),
            controls=controls.get(),
            held=_optional(out.held, np.bool_, self.mesh.shape.vertex_count),
        )


class Need(NamedTuple):
    """A file that a texture is made of, as in `skinslide_stage_need`."""

    path: str
    largest: int


class File(NamedTuple):
    """A file that was asked for, as in `skinslide_stage_file`."""

    path: str | None
    content: bytes | None = None
    size: int = 0
    reason: str | None = None
    descriptor: int | None = None  # of an open file that has the content


class Texture(NamedTuple):
    """A texture that was sampled."""

    name: str  # of the attribute, such as skinSlide:elbow_L:weightMap
    file: str  # resolved, with <UDIM> where it has tiles
    channel: str
    st: str  # the primvar it was sampled at
    sizes: dict[int, tuple[int, int]]  # width and height, by tile; 0 for the one of a texture without


class ControlsMeaning(Taker):
    """What is painted and animated on a patch, at one time; for use by one thread at a time.

    It begins with the values of a base, controls of the patch which stay as they are.
    """

    _take = lib.skinslide_stage_controls_take

    def __init__(self, patch: PatchMeaning, base: ControlsMeaning | None = None):
        out = ffi.new("skinslide_stage_controls **")
        bases = [base.handle] if base else []
        _call(lib.skinslide_stage_controls_create, patch.handle, bases[0] if bases else None, out)
        self._patch = patch
        self.handle = Handle(out[0], lib.skinslide_stage_controls_destroy, patch.handle, *bases)

    def coordinates(self) -> list[Input]:
        """The primvar with the coordinates of textures, where there is one to take."""
        found = lib.skinslide_stage_controls_coordinates(self.handle.pointer)
        return [_input(found)] if found else []

    def need(self) -> Need | None:
        """The next file that is wanted. Raises Fault."""
        out = ffi.new("skinslide_stage_need **")
        _call(lib.skinslide_stage_controls_need, self.handle, out)
        return Need(text(out[0].path), out[0].largest) if out[0] else None

    def holds(self, path: str) -> bool:
        """Whether the content of a resolved file is not needed again."""
        return bool(lib.skinslide_stage_controls_holds(self.handle.pointer, path.encode(errors="replace")))

    def give(self, file: File) -> None:
        """Gives the file that is wanted. Raises Fault."""
        _call(lib.skinslide_stage_controls_give, self.handle, file)

    def texture(self, source: Input) -> Texture | None:
        found = lib.skinslide_stage_controls_texture(self.handle.pointer, source.pointer)
        if not found:
            return None
        tiles = (found.tiles[i] for i in range(found.tile_count))
        sizes = {tile.number: (tile.width, tile.height) for tile in tiles}
        st = text(found.st).removeprefix("primvars:")
        return Texture(text(found.name), text(found.file), text(found.channel), st, sizes)

    def get(self) -> Controls:
        """Raises Fault."""
        out = new("controls")
        _call(lib.skinslide_stage_controls_get, self.handle, out)
        mesh = self._patch.mesh.shape
        vertices, faces = mesh.vertex_count, mesh.face_count
        return Controls(
            vertex_density=_optional(out.vertex_density, np.float32, vertices),
            face_density=_optional(out.face_density, np.float32, faces),
            edges=_optional(out.edges, np.int32, out.edge_count, 2),
            edge_density=_optional(out.edge_density, np.float32, out.edge_count),
            weight=_optional(out.weight, np.float32, vertices),
            envelope=out.envelope,
            max_distance=_optional(out.max_distance, np.float32, vertices),
            hold=_optional(out.hold, np.float32, vertices),
            stretch_response=out.stretch_response,
            compression_response=out.compression_response,
        )


# ---- What follows from points ----


class Output(NamedTuple):
    """An attribute to write beside the points, as in `skinslide_stage_output`."""

    name: str
    type_name: str
    pose_count: int
    value_count: int
    reason: str | None
    hidden: str | None
    is_carried: bool
    is_double: bool
    pointer: Any


class Pose(NamedTuple):
    """Points of one time, before and after sliding, and turns of the skin where wanted: float32 (V, 3) each."""

    time: float
    cached: np.ndarray
    slid: np.ndarray
    turns: np.ndarray | None


class DerivedMeaning:
    """What a mesh has beside its points that follows from them: vectors that the skin carries, and rates of change."""

    def __init__(self, mesh: MeshMeaning, point_times: Sequence[float], rate: float):
        out = ffi.new("skinslide_stage_derived **")
        times = ffi.new("double[]", list(point_times))
        _call(lib.skinslide_stage_derived_create, mesh.handle, times, len(times), rate, out)
        self.handle = Handle(out[0], lib.skinslide_stage_derived_destroy, mesh.handle)

    def fill(self) -> None:
        """Takes the frames between samples of points for slid too."""
        _call(lib.skinslide_stage_derived_fill, self.handle)

    def offer(self, name: str, type_name: str, interpolation: str | None, element_size: int) -> Input | None:
        """The input that a primvar is to be taken as; None where it does not follow, or nobody knows how."""
        out = ffi.new("const skinslide_stage_input **")
        _call(lib.skinslide_stage_derived_offer, self.handle, name, type_name, interpolation, element_size, out)
        return _input(out[0]) if out[0] else None

    def take(self, source: Input, value: Value | None, times: Sequence[float]) -> None:
        """Takes an input of the group derived, or one that was offered, at its first time, with its samples."""
        given = ffi.new("double[]", list(times))
        _call(lib.skinslide_stage_derived_take, self.handle, source, value, given, len(times))

    def outputs(self) -> list[Output]:
        found: list[Output] = []
        while each := lib.skinslide_stage_derived_output(self.handle.pointer, len(found)):
            reason, hidden = (text(words) if words else None for words in (each.reason, each.hidden))
            words = (text(each.name), text(each.type_name))
            kind = (bool(each.is_carried), bool(each.is_double))
            found.append(Output(*words, each.pose_count, each.count, reason, hidden, *kind, each))
        return found

    def warnings(self) -> list[str]:
        found: list[str] = []
        while said := lib.skinslide_stage_derived_warning(self.handle.pointer, len(found)):
            found.append(text(said))
        return found

    def times(self, output: Output, time: float) -> list[float]:
        """The times of the poses that a value takes."""
        times = ffi.new("double[3]")
        count = lib.skinslide_stage_derived_times(self.handle.pointer, output.pointer, time, times)
        return list(times[0:count])

    def look(self, output: Output, cached: Value | None) -> str:
        """What to warn of in a value of the cache: what is not finite and passes as it is; or nothing."""
        faults, told = ffi.new("int32_t *"), ffi.new("skinslide_error *")
        _call(lib.skinslide_stage_derived_look, self.handle, output, cached, faults, told)
        return text(told.message) if faults[0] else ""

    def value(self, output: Output, cached: Value | None, poses: Sequence[Pose]) -> np.ndarray:
        """The value at a time, (n, 3) of float32 or, where the output is double, float64. Raises Fault."""
        out = np.empty((output.value_count, 3), np.float64 if output.is_double else np.float32)
        place = writable("char[]", out)
        _call(lib.skinslide_stage_derived_value, self.handle, output, cached, _Poses(poses), len(poses), place)
        return out


# ---- Records ----


class _Poses(tuple[Pose, ...]):
    """Poses that are handed over as an array."""


class _Native:
    """The structs of one call, and the memory they point into for as long as this object lives."""

    def __init__(self) -> None:
        self._alive: list[Any] = []
        self._makers: dict[type, Callable[[Any], Any]] = {
            Value: self._value,
            Subset: self._subset,
            File: self._file,
            PrimFacts: self._facts,
            _Poses: self._poses,
            list: self._texts,
            Handle: lambda handle: handle.pointer,
            Input: lambda source: source.pointer,
            Output: lambda output: output.pointer,
            str: self._text,
            type(None): lambda _nothing: ffi.NULL,
        }

    def of(self, argument: Any) -> Any:
        """An argument as the core takes it."""
        maker = self._makers.get(type(argument))
        return maker(argument) if maker else argument

    def _sized(self, struct: str, **fields: Any) -> Any:
        made = self._keep(new(struct))
        for name, value in fields.items():
            setattr(made, name, self.of(value))
        return made

    def _value(self, value: Value) -> Any:
        fields = {"type": lib.SKINSLIDE_VALUE_BLOCKED, "width": 1, "count": 1, **self._content(value.value)}
        record = self._sized("value", name=value.name, interpolation=value.interpolation, **fields)
        record.type_name, record.indices = self._text(value.type_name), self.of(value.indices)
        return record

    def _content(self, value: Any) -> dict[str, Any]:
        if isinstance(value, str):
            kind = lib.SKINSLIDE_VALUE_ASSET if isinstance(value, Asset) else lib.SKINSLIDE_VALUE_TEXT
            return {"type": kind, "data": self._text(value)}
        if value is None or value is NOTHING:
            return {} if value is None else {"type": lib.SKINSLIDE_VALUE_NONE}
        return {"type": lib.SKINSLIDE_VALUE_OTHER} if isinstance(value, Other) else self._numbers(np.asarray(value))

    def _numbers(self, array: np.ndarray) -> dict[str, Any]:
        kind = _TYPES.get(array.dtype) if array.ndim < 3 else None
        fields = {"is_array": array.ndim > 0, "count": len(array) if array.ndim else 1}
        if kind is None:
            return {**fields, "type": lib.SKINSLIDE_VALUE_OTHER}
        width = array.shape[1] if array.ndim == 2 else 1
        return {**fields, "type": kind, "width": max(width, 1), "data": self._array("char[]", array)}

    def _subset(self, subset: Subset) -> Any:
        return self._sized("stage_subset", **subset._asdict())

    def _file(self, file: File) -> Any:
        struct = self._sized("stage_file", path=file.path, reason=file.reason, byte_count=file.size)
        if file.content is not None:
            struct.bytes = self._keep(ffi.from_buffer("uint8_t[]", file.content))
        if file.descriptor is not None:
            struct.descriptor = self._keep(ffi.new("int32_t *", file.descriptor))
        return struct

    def _facts(self, facts: PrimFacts) -> Any:
        fields = vars(facts) | {"schemas": self._texts(facts.schemas), "properties": self._texts(facts.properties)}
        counts = {"schema_count": len(facts.schemas), "property_count": len(facts.properties)}
        return self._sized("stage_prim", **fields, **counts)

    def _poses(self, poses: _Poses) -> Any:
        structs = self._keep(new_array("stage_pose", len(poses)))
        for struct, pose in zip(structs, poses, strict=True):
            struct.time = pose.time
            struct.cached, struct.slid = (self._array("float[]", each) for each in (pose.cached, pose.slid))
            struct.turns = ffi.NULL if pose.turns is None else self._array("float[]", pose.turns)
        return structs

    def _text(self, words: str) -> Any:
        return self._keep(ffi.new("char[]", words.encode(errors="replace")))

    def _texts(self, words: Sequence[str]) -> Any:
        return self._keep(ffi.new("char *[]", [self._text(each) for each in words]))

    def _array(self, ctype: str, array: np.ndarray) -> Any:
        return self._keep(ffi.from_buffer(ctype, np.ascontiguousarray(array)))

    def _keep(self, made: Any) -> Any:
        self._alive.append(made)
        return made


def _call(function: Any, *arguments: Any) -> None:
    """Raises Fault with the core's sentence, MemoryError."""
    native, error = _Native(), ffi.new("skinslide_error *")
    status = function(*map(native.of, arguments), error)
    if status == lib.SKINSLIDE_OUT_OF_MEMORY:
        raise MemoryError(text(error.message))
    if status != lib.SKINSLIDE_OK:
        raise Fault(text(error.message))


def _copied(pointer: Any, dtype: type, count: int, width: int | None = None) -> np.ndarray:
    size = count * (width or 1) * np.dtype(dtype).itemsize
    array: np.ndarray = np.frombuffer(ffi.buffer(pointer, size), dtype).copy() if size else np.empty(0, dtype)
    return array if width is None else array.reshape(count, width)


def _optional(pointer: Any, dtype: type, count: int, width: int | None = None) -> np.ndarray | None:
    return _copied(pointer, dtype, count, width) if pointer else None
