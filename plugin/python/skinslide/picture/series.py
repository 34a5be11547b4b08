"""The pictures of one piece of a patch: the same triangles, chequer and camera all through a shot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pxr import Usd, UsdGeom

from skinslide.arrays.canvas import Camera, Canvas, Outline, Scale, Shape, Tessellation
from skinslide.arrays.slider import Slider
from skinslide.picture import lettering
from skinslide.picture.cameras import Eye, FollowingCamera, ShotCamera, StageCamera, to_world
from skinslide.problems import Fault, FrameProblem, SliderError, frame_text
from skinslide.shot.checks import MOST
from skinslide.shot.options import PictureOptions
from skinslide.shot.plan import frame_of
from skinslide.shot.report import PatchReport
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.values import FIRST, primvar_source

_ST = "st"
_SQUARES = 16  # of the chequer, across a patch


class Column(NamedTuple):
    """One of the poses that stand side by side on a picture."""

    title: str
    points: np.ndarray  # (V, 3)
    stretch: np.ndarray  # (V,)
    measure: float  # stretch of the patch


class Moment(NamedTuple):
    """What a picture needs to know of a time."""

    title: str  # "frame 1012", or nothing for the default time
    camera: Camera
    to_world: np.ndarray  # (4, 4)


@dataclass(frozen=True, eq=False)
class Skin:
    """A mesh as all of its pictures show it. Immutable."""

    mesh: PatchedMesh
    st: np.ndarray | None  # at the mesh's corners; None: the chequer is one of squares in space, at rest
    tessellation: Tessellation
    double_sided: bool
    left_handed: bool

    @classmethod
    def of(cls, mesh: PatchedMesh, faces: np.ndarray, st: str | None) -> Skin:
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
        return cls(mesh, corners, tessellation, double_sided, mesh.left_handed)


@dataclass(frozen=True, eq=False)
class Series:
    """Immutable: any number of threads may draw it, each on its own canvas."""

    skin: Skin
    index: int  # among the slider's patches
    label: str
    outline: Outline
    eye: Eye
    squares: float

    @classmethod
    def of(cls, skin: Skin, slider: Slider, index: int, options: PictureOptions, columns: int = 2) -> Series:
        """Raises Fault, SliderError and FrameProblem for what cannot be drawn."""
        faces = slider.faces(index)
        label, outline = PatchReport(slider.patches[index]).label, Outline(skin.tessellation, faces)
        eye, squares = _eye(skin.mesh, faces, options, columns), options.squares or _suitable_squares(skin, faces)
        return cls(skin, index, label, outline, eye, squares)

    def moment(self, time: Usd.TimeCode) -> Moment:
        """Raises FrameProblem where the patch cannot be seen."""
        frame = frame_of(time)
        title = "" if frame is None else f"frame {frame_text(frame)}"
        to_the_world = to_world(self.skin.mesh, time)
        try:
            return Moment(title, self.eye.camera(time), to_the_world)
        except (Fault, SliderError) as fault:
            raise FrameProblem(self.skin.mesh.problem(str(fault), time, self.label)) from fault

    def draw(self, canvas: Canvas, view: str, at: Moment, columns: Sequence[Column], most_stretch: float) -> np.ndarray:
        """A picture of some poses side by side, (height, width, 4) as the canvas has it."""
        canvas.clear(lettering.BACKGROUND)
        places = lettering.columns(canvas.width, canvas.height, len(columns))
        for column, place in zip(columns, places, strict=True):
            scale = Scale(column.stretch, 0.0, most_stretch) if view == "stretch" else None
            canvas.draw(
                self.skin.tessellation,
                column.points,
                at.camera,
                place,
                to_world=at.to_world,
                squares=self.squares,
                scale=scale,
                double_sided=self.skin.double_sided,
                outline=self.outline,
                left_handed=self.skin.left_handed,
            )
        pixels = canvas.read()
        for column, place in zip(columns, places, strict=True):
            lettering.write_text(pixels, [column.title, f"stretch {column.measure:.3f}"], place)
        lettering.write_text(pixels, [f"{self.label}   {at.title}".rstrip()], places[-1], at_foot=True)
        if view == "stretch":
            lettering.write_scale(pixels, most_stretch, places[0])
        return pixels


def _st_of(mesh: PatchedMesh, asked: str | None) -> np.ndarray | None:
    """Texture coordinates for the chequer; None where there are none and none were asked for."""
    value = primvar_source(mesh.prim, f"primvars:{asked or _ST}").at(FIRST)
    if value is not None:
        return mesh.meaning.coordinates(value)
    if asked:
        raise Fault(f"there is no primvars:{asked} to draw a chequer on")
    return None


def _suitable_squares(skin: Skin, faces: np.ndarray) -> float:
    mesh, st = skin.mesh, skin.st
    inside = np.repeat(np.isin(np.arange(mesh.topology.face_count), faces), mesh.face_counts)
    places = mesh.rest_points[mesh.face_indices[inside]] if st is None else st[inside]
    extent = float(np.ptp(places.astype(np.float64), axis=0).max())
    return min(_SQUARES / extent, MOST) if extent > 0 else 1.0


def _eye(mesh: PatchedMesh, faces: np.ndarray, options: PictureOptions, columns: int) -> Eye:
    width, height = options.size
    aspect = width / columns / height
    if options.camera is not None:
        return StageCamera(mesh.stage, options.camera, aspect)
    return (FollowingCamera if options.follow else ShotCamera)(mesh, faces, aspect)
