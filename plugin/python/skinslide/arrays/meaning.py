"""What SkinSlideAPI means on values as a scene holds them: no USD here, and no meaning either, which is the core's.

The manual is `stage.h`: what there is to fetch is asked for, handed over, and comes back as what a `Slider` takes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.calls import StageRecords, call_stage, copied, optional
from skinslide.arrays.fetched import File, Subset, Value
from skinslide.arrays.native import Handle, new, new_array, read, text, token_of, writable
from skinslide.arrays.records import WeldInfo
from skinslide.arrays.schema import Input, read_input
from skinslide.arrays.setups import Controls, PatchSetup, Subdivision
from skinslide.arrays.structs import Arguments, Sizes


class Taker:
    """What inputs are handed to."""

    handle: Handle
    _take: Any
    _check: Any

    def take(self, source: Input, value: Value | None) -> None:
        """Takes an input of one of its groups. Raises Fault."""
        call_stage(self._take, self.handle, source, value)

    def check(self, source: Input, value: Value | None, frame: float) -> None:
        """Raises Fault where a later sample of what must stay the same does not."""
        call_stage(self._check, self.handle, source, value, frame)


def _sentence(sentence: Any) -> str:
    return text(sentence) if sentence else ""


class Weld(NamedTuple):
    """Which points are one: of each that which it is one with, and what came of it."""

    vertices: np.ndarray  # int32 (V,)
    info: WeldInfo


class MeshMeaning(Taker):
    """One mesh of a scene: its faces, its rest points, how it is subdivided."""

    _take, _check = lib.skinslide_stage_mesh_take, lib.skinslide_stage_mesh_check

    def __init__(self) -> None:
        out = ffi.new("skinslide_stage_mesh **")
        call_stage(lib.skinslide_stage_mesh_create, out)
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
    def rest_warning(self) -> str:
        """What to warn of in the rest points as they are authored, or nothing."""
        return _sentence(lib.skinslide_stage_mesh_rest_warning(self.handle.pointer))

    @property
    def warning(self) -> str:
        """What to warn of, or nothing."""
        return _sentence(lib.skinslide_stage_mesh_warning(self.handle.pointer))

    @property
    def space_warning(self) -> str:
        """What to warn of in the transforms above, or nothing."""
        return _sentence(lib.skinslide_stage_mesh_space_warning(self.handle.pointer))

    def offer(self, name: str, type_name: str, interpolation: str | None) -> None:
        """Offers a primvar, so that errors can list those that may be texture coordinates."""
        call_stage(lib.skinslide_stage_mesh_offer, self.handle, name, type_name, interpolation)

    @property
    def coordinates_there(self) -> str:
        """What could be named as texture coordinates, in words."""
        return f"there are {text(lib.skinslide_stage_mesh_coordinates(self.handle.pointer)) or 'none'}"

    def take_space(self, to_world: np.ndarray, frame: float) -> None:
        """Takes the way to the world (4, 4), of rows, at a time; the first first. Raises Fault."""
        matrix = np.ascontiguousarray(to_world, np.float64)
        call_stage(lib.skinslide_stage_mesh_space, self.handle, ffi.from_buffer("double[]", matrix), frame)

    def space(self) -> np.ndarray | None:
        """What takes points to where lengths are taken (3, 3); None: nothing. Raises Fault where rest was not taken."""
        return optional(self._read(lib.skinslide_stage_mesh_get).space, np.float64, 3, 3)

    @property
    def shape(self) -> Any:
        """A `skinslide_mesh` of points and faces, as long as this lives. Raises Fault where they were not taken."""
        return self._read(lib.skinslide_stage_mesh_faces)

    @property
    def face_counts(self) -> np.ndarray:
        return copied(self.shape.face_counts, np.int32, self.shape.face_count)

    @property
    def face_indices(self) -> np.ndarray:
        return copied(self.shape.face_indices, np.int32, self.shape.index_count)

    def rest_points(self) -> np.ndarray:
        """Float32 (V, 3). Raises Fault where none were taken."""
        mesh = self._read(lib.skinslide_stage_mesh_get)
        return copied(mesh.rest_points, np.float32, mesh.vertex_count, 3)

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
        call_stage(lib.skinslide_stage_mesh_weld, self.handle, setups, len(patches), out)
        weld, vertices = Handle(out[0], lib.skinslide_weld_destroy), np.arange(count, dtype=np.int32)
        if lib.skinslide_weld_wants_poses(weld.pointer):
            for frame, points in poses:
                # What cannot be slid there is said when it is to be.
                lib.skinslide_weld_show(weld.pointer, frame, Arguments().points(points, count, "points"), ffi.NULL)
            call_stage(lib.skinslide_weld_get, weld, writable("int32_t[]", vertices), info)
        return Weld(vertices, read(WeldInfo, info[0]))

    def points(self, value: Value | None) -> np.ndarray:
        """The points of a frame, float32 (V, 3): those of the value, if they can be taken as they are. Raises Fault."""
        found = value.value if value and not value.indices else None
        if isinstance(found, np.ndarray) and found.dtype == np.float32 and found.flags.c_contiguous:
            call_stage(lib.skinslide_stage_points, self.handle, value, ffi.NULL)
            return found
        out = np.empty((self.shape.vertex_count, 3), np.float32)
        call_stage(lib.skinslide_stage_points, self.handle, value, writable("float[]", out))
        return out

    def check_points(self, points: np.ndarray) -> None:
        """Raises Fault for points of a frame, (V, 3), that cannot be slid."""
        given = Arguments().points(points, self.shape.vertex_count, "points")
        call_stage(lib.skinslide_stage_check_points, self.handle, given)

    def coordinates(self, value: Value | None) -> np.ndarray:
        """Texture coordinates of the corners, float32 (sum of counts, 2). Raises Fault."""
        out = np.empty((self.shape.index_count, 2), np.float32)
        call_stage(lib.skinslide_stage_coordinates, self.handle, value, writable("float[]", out))
        return out

    def painted(self, value: Value | None) -> np.ndarray:
        """What any primvar says of the points, float64 (V,). Raises Fault."""
        out = np.empty(self.shape.vertex_count, np.float64)
        call_stage(lib.skinslide_stage_painted, self.handle, value, writable("double[]", out))
        return out

    def _read(self, function: Any) -> Any:
        mesh = new("mesh")
        call_stage(function, self.handle, mesh)
        return mesh


def _subdivision(found: Any) -> Subdivision:
    tokens = {name: token_of(name, getattr(found, name)) for name in ("scheme", "boundary_rule", "triangle_rule")}
    return Subdivision(
        **tokens,
        crease_lengths=optional(found.crease_lengths, np.int32, found.crease_count),
        crease_indices=optional(found.crease_indices, np.int32, found.crease_index_count),
        crease_sharpnesses=optional(found.crease_sharpnesses, np.float32, found.crease_sharpness_count),
        corner_indices=optional(found.corner_indices, np.int32, found.corner_count),
        corner_sharpnesses=optional(found.corner_sharpnesses, np.float32, found.corner_count),
        hole_indices=optional(found.hole_indices, np.int32, found.hole_count),
    )


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
        call_stage(lib.skinslide_stage_patch_create, mesh.handle, name, None, out)
        self.mesh, self.name = mesh, name
        self.handle = Handle(out[0], lib.skinslide_stage_patch_destroy, mesh.handle)

    def take_subset(self, subset: Subset | None) -> None:
        """Takes the child prim whose faces follow, or learns that there is none. Raises Fault."""
        call_stage(lib.skinslide_stage_patch_take_subset, self.handle, subset)

    @property
    def faces(self) -> np.ndarray:
        """Those of the patch so far, int32, ascending."""
        count = ffi.new("int32_t *")
        faces = lib.skinslide_stage_patch_faces(self.handle.pointer, count)
        return copied(faces, np.int32, count[0])

    def unread(self, controls: ControlsMeaning) -> list[Input]:
        """What is said of the patch that its rule has no use for."""
        found = list[Input]()
        known = self.handle.pointer, controls.handle.pointer
        while each := lib.skinslide_stage_next_unread(*known, found[-1].pointer if found else ffi.NULL):
            found.append(read_input(each))
        return found

    def describe(self, source: Input, value: Value) -> str:
        """What there is to say of paint that is not as the schema has it, or nothing."""
        native, words = StageRecords(), ffi.new("char[512]")
        has_note = lib.skinslide_stage_patch_describe(self.handle.pointer, source.pointer, native.of(value), words)
        return text(words) if has_note else ""

    @property
    def needs_subdivision(self) -> bool:
        return bool(lib.skinslide_stage_patch_needs_subdivision(self.handle.pointer))

    @property
    def warning(self) -> str:
        """What to warn of, or nothing."""
        return _sentence(lib.skinslide_stage_patch_warning(self.handle.pointer))

    @property
    def wants_neighbours(self) -> bool:
        """Whether its borders are to stay where another mesh meets them, and would slide else."""
        return bool(lib.skinslide_stage_patch_wants_neighbours(self.handle.pointer))

    def meet(self, others: np.ndarray) -> None:
        """Takes points (n, 3) of another mesh in the same space, at the first time. Raises Fault."""
        given = np.ascontiguousarray(others, np.float32)
        call_stage(lib.skinslide_stage_patch_meet, self.handle, ffi.from_buffer("float[]", given), len(given))

    def setup(self, controls: ControlsMeaning) -> PatchSetup:
        """The set-up with some controls. Raises Fault."""
        out = new("patch_setup")
        call_stage(lib.skinslide_stage_patch_get, self.handle, controls.handle, out)
        return PatchSetup(
            name=self.name,
            faces=self.faces,
            corners=copied(out.corners, np.int32, 4) if out.corners else None,
            boundary=token_of("boundary", out.boundary),
            holes=token_of("holes", out.holes),
            rule=token_of("rule", out.rule),
            interpolation=token_of("interpolation", out.interpolation),
            controls=controls.get(),
            held=optional(out.held, np.bool_, self.mesh.shape.vertex_count),
        )


class Need(NamedTuple):
    """A file that a texture is made of, as in `skinslide_stage_need`."""

    path: str
    largest: int


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
        call_stage(lib.skinslide_stage_controls_create, patch.handle, bases[0] if bases else None, out)
        self._patch = patch
        self.handle = Handle(out[0], lib.skinslide_stage_controls_destroy, patch.handle, *bases)

    def coordinates(self) -> list[Input]:
        """The primvar with the coordinates of textures, where there is one to take."""
        found = lib.skinslide_stage_controls_coordinates(self.handle.pointer)
        return [read_input(found)] if found else []

    def need(self) -> Need | None:
        """The next file that is wanted. Raises Fault."""
        out = ffi.new("skinslide_stage_need **")
        call_stage(lib.skinslide_stage_controls_need, self.handle, out)
        return Need(text(out[0].path), out[0].largest) if out[0] else None

    def holds(self, path: str) -> bool:
        """Whether the content of a resolved file is not needed again."""
        return bool(lib.skinslide_stage_controls_holds(self.handle.pointer, path.encode(errors="replace")))

    def give(self, file: File) -> None:
        """Gives the file that is wanted. Raises Fault."""
        call_stage(lib.skinslide_stage_controls_give, self.handle, file)

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
        call_stage(lib.skinslide_stage_controls_get, self.handle, out)
        mesh = self._patch.mesh.shape
        vertices, faces = mesh.vertex_count, mesh.face_count
        return Controls(
            vertex_density=optional(out.vertex_density, np.float32, vertices),
            face_density=optional(out.face_density, np.float32, faces),
            edges=optional(out.edges, np.int32, out.edge_count, 2),
            edge_density=optional(out.edge_density, np.float32, out.edge_count),
            weight=optional(out.weight, np.float32, vertices),
            envelope=out.envelope,
            max_distance=optional(out.max_distance, np.float32, vertices),
            hold=optional(out.hold, np.float32, vertices),
            stretch_response=out.stretch_response,
            compression_response=out.compression_response,
        )
