"""What a slider is given: set-ups, what of them may be animated, how a mesh is subdivided, points of a time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np


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
