"""The pictures of one piece of a patch: the same triangles, chequer and camera all through a shot."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.canvas import MOST_TARGETS, Camera, Canvas, Look, Marks, Outline, Scale, Shape, Tessellation
from skinslide.arrays.slider import Slider
from skinslide.picture import lettering
from skinslide.picture.cameras import Eye, FollowingCamera, ShotCamera, StageCamera, to_world
from skinslide.picture.material import base_colour
from skinslide.problems import Fault, FrameProblem, SliderError, frame_text
from skinslide.shot.checks import MOST
from skinslide.shot.options import PictureOptions
from skinslide.shot.plan import frame_of
from skinslide.shot.report import PatchReport
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST, primvar_source

_ST = "st"
_SQUARES = 16  # of the chequer, across a patch
_MOST_DENSITY = 16.0  # and its inverse are the ends of the scale
_MOST_SLIDE = 0.1  # of the patch's size at rest: the end of the scale


class Column(NamedTuple):
    """One of the poses that stand side by side on a picture."""

    title: str
    points: np.ndarray  # (V, 3)
    stretch: np.ndarray  # (V,)
    measure: float  # stretch of the patch
    density: np.ndarray | None = None  # (V,) as painted
    ways: np.ndarray | None = None  # (V, 3) by which vertices slid here


class Moment(NamedTuple):
    """What a picture needs to know of a time."""

    title: str  # "frame 1012", or nothing for the default time
    camera: Camera
    to_world: np.ndarray  # (4, 4)
    pins: np.ndarray | None = None  # (V,) bool, points of the patch that its paint lets not slide
    edges: np.ndarray | None = None  # (k, 2) of those that are painted
    edge_density: np.ndarray | None = None  # (k,)


@dataclass(frozen=True, eq=False)
class Skin:
    """A mesh as all of its pictures show it. Immutable."""

    mesh: PatchedMesh
    st: np.ndarray | None  # at the mesh's corners; None: the chequer is one of squares in space, at rest
    tessellation: Tessellation
    double_sided: bool
    left_handed: bool
    texture: dict[int, np.ndarray] | None = None  # by tile; None: it is not wanted

    @property
    def note(self) -> str:
        """What to report about the chequer, or nothing."""
        if self.st is not None:
            return ""
        there = self.mesh.meaning.coordinates_there
        return f"there is no primvars:{_ST}, so the chequer is on positions at rest; for texture coordinates {there}"

    @classmethod
    def of(cls, mesh: PatchedMesh, faces: np.ndarray, st: str | None, *, textured: bool = False) -> Skin:
        """To be looked at closely at some faces. Raises Fault and SliderError for what cannot be drawn."""
        corners = _st_of(mesh, st)
        shape, subdivision = Shape(mesh.face_counts, mesh.face_indices), mesh.drawn_subdivision()
        try:
            tessellation = Tessellation(shape, mesh.rest_points, corners, faces, subdivision, mesh.weld.vertices)
        except SliderError as error:
            if error.status == "BAD_CONTROL":  # st
                raise Fault(f"primvars:{st or _ST}: {error}") from error
            raise
        double_sided = bool(UsdGeom.Mesh(mesh.prim).GetDoubleSidedAttr().Get(FIRST))
        texture = base_colour(mesh.prim) if textured else None
        if textured and corners is None:
            raise Fault(f"there is no primvars:{_ST} to draw its texture on")
        return cls(mesh, corners, tessellation, double_sided, mesh.left_handed, texture)


@dataclass(frozen=True, eq=False)
class Series:
    """Immutable: any number of threads may draw it, each on its own canvas."""

    skin: Skin
    index: int  # among the slider's patches
    label: str
    outline: Outline
    eye: Eye
    squares: float
    faces: np.ndarray
    setup: int  # among those of the mesh
    wire: bool

    @classmethod
    def of(cls, skin: Skin, slider: Slider, index: int, options: PictureOptions, columns: int = 2) -> Series:
        """Raises Fault, SliderError and FrameProblem for what cannot be drawn."""
        faces = slider.faces(index)
        label, outline = PatchReport(slider.patches[index]).label, Outline(skin.tessellation, faces)
        eye, squares = _eye(skin.mesh, faces, options, columns), options.squares or _suitable_squares(skin, faces)
        setup = slider.patches[index].setup
        return cls(skin, index, label, outline, eye, squares, faces, setup, options.wire)

    @cached_property
    def most_slide(self) -> float:
        """The end of the scale of slides."""
        places = self.skin.mesh.rest_points[self.skin.mesh.topology.vertices_of(self.faces)]
        return _MOST_SLIDE * float(np.linalg.norm(np.ptp(places.astype(np.float64), axis=0))) or 1.0

    def moment(self, time: Usd.TimeCode) -> Moment:
        """Raises FrameProblem where the patch cannot be seen."""
        frame = frame_of(time)
        title = "" if frame is None else f"frame {frame_text(frame)}"
        to_the_world = to_world(self.skin.mesh, time)
        try:
            controls = self.skin.mesh.patch_controls_at(self.setup, time)
            pins = self._pins(controls.weight)
            return Moment(title, self.eye.camera(time), to_the_world, pins, controls.edges, controls.edge_density)
        except (Fault, SliderError) as fault:
            raise FrameProblem(self.skin.mesh.problem(str(fault), time, self.label)) from fault

    def _pins(self, weight: np.ndarray | None) -> np.ndarray | None:
        return None if weight is None else (weight <= 0) & self.skin.mesh.topology.vertices_of(self.faces)

    def _marks(self, view: str, at: Moment, column: Column) -> Marks:
        """The marks of a view, and of others with the same."""
        pinned, painted, sliding = _marked(view)
        marks = Marks(self.wire, at.pins if pinned else None, column.ways if sliding else None)
        if not painted or at.edges is None or at.edge_density is None:
            return marks
        return marks._replace(edges=at.edges, edge_values=np.log(at.edge_density))

    def draw(self, canvas: Canvas, view: str, at: Moment, columns: Sequence[Column], most_stretch: float) -> np.ndarray:
        """A picture of some poses side by side, (height, width, 4) as the canvas has it."""
        return next(self.draw_all(canvas, [view], at, columns, most_stretch))

    def draw_all(
        self, canvas: Canvas, views: Sequence[str], at: Moment, columns: Sequence[Column], most_stretch: float
    ) -> Iterator[np.ndarray]:
        """A picture of each view: those with the same marks at once, as many as the canvas has targets."""
        drawn: dict[str, np.ndarray] = {}
        for view in views:
            if view not in drawn:
                alike = [other for other in views if other not in drawn and _marked(other) == _marked(view)]
                drawn.update(self._draw_targets(canvas, alike[: canvas.targets], at, columns, most_stretch))
            yield drawn[view]

    def _draw_targets(
        self, canvas: Canvas, views: Sequence[str], at: Moment, columns: Sequence[Column], most_stretch: float
    ) -> Iterator[tuple[str, np.ndarray]]:
        canvas.clear(lettering.BACKGROUND)
        places = lettering.columns(canvas.width, canvas.height, len(columns))
        for column, place in zip(columns, places, strict=True):
            first, *others = (self._look(view, column, most_stretch) for view in views)
            canvas.draw(
                self.skin.tessellation,
                column.points,
                at.camera,
                place,
                to_world=at.to_world,
                squares=self.squares,
                scale=first.scale,
                double_sided=self.skin.double_sided,
                outline=self.outline,
                left_handed=self.skin.left_handed,
                ghosts=True,
                marks=self._marks(views[0], at, column),
                texture=first.texture,
                others=others,
            )
        for target, view in enumerate(views):
            yield view, self._lettered(canvas.read(target), view, at, columns, most_stretch)

    def _lettered(
        self, pixels: np.ndarray, view: str, at: Moment, columns: Sequence[Column], most_stretch: float
    ) -> np.ndarray:
        places = lettering.columns(pixels.shape[1], pixels.shape[0], len(columns))
        for column, place in zip(columns, places, strict=True):
            lettering.write_text(pixels, [column.title, f"stretch {column.measure:.3f}"], place)
        lettering.write_text(pixels, [f"{self.label}   {at.title}".rstrip()], places[-1], at_foot=True)
        ticks = self._ticks(view, most_stretch)
        if ticks:
            lettering.write_scale(pixels, *ticks, places[0])
        return pixels

    def _look(self, view: str, column: Column, most_stretch: float) -> Look:
        return Look(self._scale(view, column, most_stretch), self.skin.texture if view == "texture" else None)

    def _scale(self, view: str, column: Column, most_stretch: float) -> Scale | None:
        if view == "stretch":
            return Scale(column.stretch, 0.0, most_stretch)
        if view == "density":
            density = np.ones_like(column.stretch) if column.density is None else column.density
            return Scale(np.log(density), -math.log(_MOST_DENSITY), math.log(_MOST_DENSITY))
        if view == "slide":
            ways = np.zeros_like(column.points) if column.ways is None else column.ways
            return Scale(np.linalg.norm(ways, axis=1), 0.0, self.most_slide)
        return None

    def _ticks(self, view: str, most_stretch: float) -> tuple[str, tuple[str, str, str]] | None:
        """What the scale of colours of a view shows, and its values at the ends and the middle."""
        if view == "density":
            return "force density", (f"1/{_MOST_DENSITY:g}", "1", f"{_MOST_DENSITY:g}")
        most = {"stretch": most_stretch, "slide": self.most_slide}.get(view)
        return None if most is None else (view, ("0", f"{most / 2:.3g}", f"{most:.3g}"))


def _marked(view: str) -> tuple[bool, bool, bool]:
    """Whether a view shows pins, painted edges, and ways."""
    return view in ("density", "slide"), view == "density", view == "slide"


def targets_of(views: Sequence[str]) -> int:
    """How many targets a canvas needs so that all views that can be drawn at once are."""
    return min(MOST_TARGETS, max(Counter(_marked(view) for view in dict.fromkeys(views)).values(), default=1))


def _st_of(mesh: PatchedMesh, asked: str | None) -> np.ndarray | None:
    """Texture coordinates for the chequer; None where there are none and none were asked for."""
    value = primvar_source(mesh.prim, f"primvars:{asked or _ST}").at(FIRST)
    if value is not None:
        return mesh.meaning.coordinates(value)
    if asked:
        raise Fault(f"there is no primvars:{asked} to draw a chequer on; {mesh.meaning.coordinates_there}")
    return None


def _suitable_squares(skin: Skin, faces: np.ndarray) -> float:
    mesh, st = skin.mesh, skin.st
    inside = np.repeat(np.isin(np.arange(mesh.topology.face_count), faces), mesh.face_counts)
    places = mesh.rest_points[mesh.face_indices[inside]] if st is None else st[inside]
    across = _root_of_area(skin, faces) or float(np.ptp(places.astype(np.float64), axis=0).max())
    return min(_SQUARES / across, MOST) if across > 0 else 1.0


def _root_of_area(skin: Skin, faces: np.ndarray) -> float:
    """The square root of the area of faces in the texture, where they may be far apart; 0 without a texture."""
    if skin.st is None:
        return 0.0
    start = np.cumsum(skin.mesh.face_counts) - skin.mesh.face_counts
    x, y = skin.st.astype(np.float64).T
    following = np.arange(len(x)) + 1
    following[start + skin.mesh.face_counts - 1] = start
    doubled = np.abs(np.add.reduceat(x * y[following] - x[following] * y, start))
    return math.sqrt(doubled[faces].sum() / 2)


def _eye(mesh: PatchedMesh, faces: np.ndarray, options: PictureOptions, columns: int) -> Eye:
    width, height = options.size
    aspect = width / columns / height
    if options.camera is not None:
        return StageCamera(mesh.stage, options.camera, aspect)
    return (FollowingCamera if options.follow else ShotCamera)(mesh, faces, aspect)
