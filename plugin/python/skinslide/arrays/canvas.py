"""Pictures of skin drawn offscreen, on numpy arrays: no USD, no files. The manual is `picture.h`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from skinslide._core import ffi, lib
from skinslide.arrays.checks import as_array, device_number
from skinslide.arrays.native import Handle, call, enum_value, new, new_array, read, writable
from skinslide.arrays.records import DeviceInfo
from skinslide.arrays.setups import Subdivision
from skinslide.arrays.structs import Arguments
from skinslide.problems import SliderError


class Viewport(NamedTuple):
    """Part of a canvas, in pixels from its lower left corner."""

    x: int
    y: int
    width: int
    height: int


class Camera(NamedTuple):
    """Matrices (4, 4) as USD has them, for points as rows: from the world, and to clip space."""

    to_camera: np.ndarray
    to_screen: np.ndarray


class Shape(NamedTuple):
    """The faces of a mesh."""

    face_counts: np.ndarray  # (F,)
    face_indices: np.ndarray  # (sum of counts,)


class Tessellation:
    """A mesh made into triangles, with some of its faces outlined. Immutable: any number of threads may draw it."""

    def __init__(
        self,
        shape: Shape,
        rest_points: np.ndarray,
        st: np.ndarray | None,
        faces: np.ndarray,
        subdivision: Subdivision | None = None,
        weld: np.ndarray | None = None,
    ):
        """Makes the triangles.

        Args:
            shape: The faces of the mesh.
            rest_points: Of the mesh (V, 3).
            st: Texture coordinates of the mesh's corners (sum of counts, 2); None: chequers are cubes at rest.
            faces: Those to be outlined (n,).
            subdivision: How the mesh is subdivided: its limit surface is drawn; None: its faces are.
            weld: The point that each is one with (V,), so that no outline runs along a seam.
        """
        native, out = Arguments(), ffi.new("skinslide_tessellation **")
        mesh = native.mesh(*shape, rest_points, subdivision, weld)
        corners = native.optional(st, np.float32, (len(shape.face_indices), 2), "st")
        chosen = native.pointer(faces, np.int32, (-1,), "faces")
        call(lib.skinslide_tessellation_create, ffi.addressof(mesh), corners, chosen, len(faces), out)
        self.handle = Handle(out[0], lib.skinslide_tessellation_destroy)
        self.vertex_count = len(rest_points)
        info = new("tessellation_info")
        call(lib.skinslide_tessellation_describe, self.handle.pointer, info)
        self.triangle_count, self.flat_faces = info.triangle_count, info.flat_faces


class Outline:
    """Some faces (n,) of a tessellated mesh, to be outlined; what is outside them is drawn paler. Immutable."""

    def __init__(self, tessellation: Tessellation, faces: np.ndarray):
        native, out = Arguments(), ffi.new("skinslide_outline **")
        chosen = native.pointer(faces, np.int32, (-1,), "faces")
        call(lib.skinslide_outline_create, tessellation.handle.pointer, chosen, len(faces), out)
        self.handle = Handle(out[0], lib.skinslide_outline_destroy, tessellation.handle)


class Scale(NamedTuple):
    """What is drawn in false colours: values (V,), from the lowest to the highest colour."""

    values: np.ndarray
    lowest: float
    highest: float


class Marks(NamedTuple):
    """What is drawn on the skin of a patch."""

    wire: bool = False  # the sides of its faces
    pins: np.ndarray | None = None  # (V,) bool: a dot at each
    ways: np.ndarray | None = None  # (V, 3) how vertices slid: a line to each from where it came
    edges: np.ndarray | None = None  # (k, 2) vertices: lines in colours of the scale, along those that the patch has
    edge_values: np.ndarray | None = None  # (k,)


NO_MARKS = Marks()


class Look(NamedTuple):
    """How the surface of a mesh is coloured on a target: chequered, in false colours, or by a texture."""

    scale: Scale | None = None
    texture: Mapping[int, np.ndarray] | None = None  # uint8 (height, width, 4) by the number of its tile


MOST_TARGETS: int = lib.SKINSLIDE_MOST_TARGETS


class Canvas:
    """What pictures are drawn on, for one thread at a time. `pixels` is bytes (sRGB) or floats (linear light).

    It has several `targets`, at most MOST_TARGETS: pictures that a mesh is drawn on at once, each in a look of its own.
    """

    def __init__(self, width: int, height: int, pixels: str = "bytes", device: int | None = None, targets: int = 1):
        out = ffi.new("skinslide_canvas **")
        options = new("canvas_options")
        options.pixels, options.device = enum_value("pixels", pixels, ""), device_number(device)
        _set(options, "canvas options", width=width, height=height, targets=targets)
        call(lib.skinslide_canvas_create, options, out)
        self._handle = Handle(out[0], lib.skinslide_canvas_destroy)
        self.width, self.height, self.targets = width, height, targets
        self._dtype: Any = np.uint8 if pixels == "bytes" else np.float32

    @property
    def device(self) -> DeviceInfo:
        """The device that draws."""
        info = new("device_info")
        call(lib.skinslide_canvas_device, self._handle.pointer, info)
        return read(DeviceInfo, info[0])

    def clear(self, colour: Sequence[float]) -> None:
        """Fills all targets with a colour, linear light."""
        native = Arguments()
        call(lib.skinslide_canvas_clear, self._handle.pointer, native.pointer(colour, np.float32, (3,), "colour"))

    def draw(
        self,
        tessellation: Tessellation,
        points: np.ndarray,
        camera: Camera,
        viewport: Viewport,
        *,
        to_world: np.ndarray | None = None,
        squares: float = 1.0,
        scale: Scale | None = None,
        outline: Outline | None = None,
        double_sided: bool = False,
        left_handed: bool = False,
        ghosts: bool = False,
        marks: Marks = NO_MARKS,
        texture: Mapping[int, np.ndarray] | None = None,
        line: float = 1.0,
        others: Sequence[Look] = (),
    ) -> None:
        """Draws a mesh in a pose, chequered (`squares` a unit of st or of length) or in the false colours of scale.

        A texture takes the place of the chequer: tiles of uint8 (height, width, 4) by their numbers. With ghosts, what
        hides the patch is drawn as a mere shadow. Lines are `line` times as wide as usual. The targets after the first
        show the mesh in the looks of `others`.
        """
        native, figure = Arguments(), new("figure")
        world = None if to_world is None else _doubles(to_world, (4, 4), "to_world")
        figure.tessellation = tessellation.handle.pointer
        figure.outline = ffi.NULL if outline is None else outline.handle.pointer
        figure.points = native.points(points, tessellation.vertex_count, "points")
        figure.to_world = ffi.NULL if world is None else world
        figure.squares, figure.double_sided, figure.left_handed = squares, double_sided, left_handed
        kept = [_look(native, figure, scale, texture, tessellation.vertex_count)]
        figure.ghosts, figure.wire, figure.line = ghosts, marks.wire, line
        if marks.pins is not None:
            figure.pins = native.pointer(marks.pins, np.bool_, (tessellation.vertex_count,), "pins")
        if marks.ways is not None:
            figure.ways = native.points(marks.ways, tessellation.vertex_count, "ways")
        if marks.edges is not None:
            figure.edges = native.pointer(marks.edges, np.int32, (-1, 2), "edges")
            figure.edge_values = native.pointer(marks.edge_values, np.float32, (len(marks.edges),), "edge_values")
            figure.edge_count = len(marks.edges)
        looks = new_array("look", len(others))
        for look, own in zip(looks, others, strict=True):
            kept.append(_look(native, look, *own, tessellation.vertex_count))
        figure.others, figure.other_count = looks, len(others)
        call(lib.skinslide_canvas_draw, self._handle.pointer, _viewport(viewport), _camera(camera), figure)

    def read(self, target: int = 0) -> np.ndarray:
        """The picture on a target, (height, width, 4), uint8 or float32, from the top row on."""
        pixels = np.empty((self.height, self.width, 4), self._dtype)
        call(lib.skinslide_canvas_read_target, self._handle.pointer, target, writable("char[]", pixels))
        return pixels


def frame_faces(
    shape: Shape,
    faces: np.ndarray,
    poses: Sequence[np.ndarray],
    to_world: np.ndarray,
    up: Sequence[float],
    aspect: float,
    *,
    left_handed: bool = False,
) -> Camera:
    """A camera that has faces in sight in each of the poses, (V, 3), with to_world (poses, 4, 4)."""
    native, subject, found = Arguments(), new("subject"), ffi.new("skinslide_camera *")
    first = poses[0] if len(poses) else np.empty((0, 3), np.float32)
    mesh = native.mesh(*shape, first)
    pointers = ffi.new("float *[]", [native.points(points, len(first), "points") for points in poses])
    matrices = _doubles(to_world, (len(poses), 4, 4), "to_world")
    subject.mesh = ffi.addressof(mesh)
    subject.faces, subject.face_count = native.pointer(faces, np.int32, (-1,), "faces"), len(faces)
    subject.pose_count, subject.poses, subject.to_world = len(poses), pointers, matrices
    subject.left_handed = left_handed
    call(lib.skinslide_frame_faces, subject, _doubles(up, (3,), "up"), aspect, found)
    return Camera(*(np.array(list(field)).reshape(4, 4) for field in (found.to_camera, found.to_screen)))


def false_colour(share: float) -> tuple[float, float, float]:
    """A colour of the scale, linear light: 0 is the lowest, 1 the highest."""
    colour = ffi.new("float[3]")
    lib.skinslide_false_colour(share, colour)
    return colour[0], colour[1], colour[2]


def _doubles(values: Any, shape: tuple[int, ...], what: str) -> Any:
    return ffi.from_buffer("double[]", as_array(values, np.float64, shape, what).reshape(-1))


def _camera(camera: Camera) -> Any:
    made = ffi.new("skinslide_camera *")
    for name, values in camera._asdict().items():
        ffi.memmove(getattr(made, name), _doubles(values, (4, 4), name), 16 * 8)
    return made


def _look(
    native: Arguments, out: Any, scale: Scale | None, texture: Mapping[int, np.ndarray] | None, vertex_count: int
) -> Any:
    """Fills a skinslide_look, or the same members of a figure. Returns what must be kept alive for as long."""
    if scale:
        out.values = native.pointer(scale.values, np.float32, (vertex_count,), "values")
        out.lowest, out.highest = scale.lowest, scale.highest
    tiles = _tiles(native, texture or {})
    out.tiles, out.tile_count = tiles, len(texture or {})
    return tiles


def _tiles(native: Arguments, texture: Mapping[int, np.ndarray]) -> Any:
    tiles = new_array("colour_tile", len(texture))
    for tile, (number, pixels) in zip(tiles, texture.items(), strict=True):
        tile.pixels = native.pointer(pixels, np.uint8, (-1, -1, 4), f"tile {number}")
        tile.number, (tile.height, tile.width) = number, pixels.shape[:2]
    return tiles


def _viewport(viewport: Viewport) -> Any:
    made = ffi.new("skinslide_viewport *")
    _set(made, "viewport", **viewport._asdict())
    return made


def _set(struct: Any, what: str, **numbers: int) -> None:
    """Whole numbers; SliderError where one is too large."""
    try:
        for name, number in numbers.items():
            setattr(struct, name, number)
    except OverflowError as error:
        raise SliderError("BAD_ARGUMENT", f"{what}: {error}") from error
