"""Small awkward stages for the tests: a mesh that moves, and patches on it."""

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Ts, Usd, UsdGeom, Vt

import skinslide  # noqa: F401 (registers the schema, before the first stage is opened)

MESH = "/World/char/geo/skin_GEO"
PATCH = "elbow_L"
FRAMES = (1001.0, 1002.0, 1003.0)


@dataclass(frozen=True)
class Shape:
    """A polygon mesh at rest."""

    points: np.ndarray  # (V, 3) float32
    counts: np.ndarray  # (F,) int32
    indices: np.ndarray  # (sum of counts,) int32

    @property
    def all_faces(self) -> np.ndarray:
        return np.arange(len(self.counts))

    def moved(self, frame: float) -> np.ndarray:
        """Points (V, 3) of a frame: at rest at FRAMES[0], then ever more unevenly stretched."""
        amount = (frame - FRAMES[0]) / 4
        x, y, z = self.points.T.astype(np.float64)
        centre = self.points.mean(axis=0)
        size = np.ptp(self.points, axis=0).max() or 1.0
        u, v = (x - centre[0]) / size, (y - centre[1]) / size
        bent = np.stack([x + amount * size * u * u, y + amount * size * u * v, z + amount * size * (u * u - v)], axis=1)
        return bent.astype(np.float32)


def from_faces(points: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]) -> Shape:
    return Shape(
        np.array(points, np.float32).reshape(-1, 3),
        np.array([len(face) for face in faces], np.int32),
        np.array([vertex for face in faces for vertex in face], np.int32),
    )


def grid(columns: int = 6, rows: int = 6, size: float = 1.0, centre: Sequence[float] = (0, 0, 0)) -> Shape:
    """A bumpy sheet of quads, face by face along rows: face (i, j) is j * columns + i, vertex j * (columns + 1) + i."""
    i, j = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    x, y = i.ravel() / columns - 0.5, j.ravel() / rows - 0.5
    points = size * np.stack([x, y, 0.1 * np.sin(5 * x + 3 * y)], axis=1) + np.asarray(centre)
    return quads(points, columns, rows)


def split(shape: Shape) -> Shape:
    """A mesh with a point for each corner of each face, as games have them; copies of a point follow each other."""
    order = np.argsort(shape.indices, kind="stable")
    indices = np.empty_like(shape.indices)
    indices[order] = np.arange(len(order), dtype=np.int32)
    return Shape(shape.points[shape.indices[order]], shape.counts, indices)


def squares(side: int) -> Shape:
    """A flat sheet of unit squares, numbered as in a grid, from the origin along x and y."""
    y, x = np.divmod(np.arange((side + 1) ** 2), side + 1)
    return quads(np.stack([x, y, 0 * x], axis=1), side, side)


def quads(points: np.ndarray, columns: int, rows: int) -> Shape:
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    faces = np.stack([corner, corner + 1, corner + columns + 2, corner + columns + 1], axis=1)
    return from_faces(points, faces.tolist())


def box() -> Shape:
    """A closed surface."""
    points = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return from_faces(points, faces)


def torus(around: int = 12, across: int = 8) -> Shape:
    """A closed surface with a handle, face by face along the way around: vertex (i, j) is j * around + i."""
    j, i = np.divmod(np.arange(around * across), around)
    long, short = 2 * np.pi * i / around, 2 * np.pi * j / across
    ring = 2 + np.cos(short)
    right, up = j * around + (i + 1) % around, (j + 1) % across * around
    faces = np.stack([j * around + i, right, up + (i + 1) % around, up + i], axis=1)
    return from_faces(np.stack([ring * np.cos(long), ring * np.sin(long), np.sin(short)], axis=1), faces.tolist())


def fin() -> Shape:
    """Three triangles on the edge 0-1."""
    return from_faces([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1)], [(0, 1, 2), (1, 0, 3), (0, 1, 4)])


def block(shape_columns: int, columns: range, rows: range) -> np.ndarray:
    """The faces of a grid in a block of columns and rows."""
    return np.array([row * shape_columns + column for row in rows for column in columns], np.int32)


def annulus(columns: int = 6, rows: int = 6) -> np.ndarray:
    """The faces of a grid without its middle: a disk with one hole."""
    middle = block(columns, range(columns // 2 - 1, columns // 2 + 1), range(rows // 2 - 1, rows // 2 + 1))
    return np.setdiff1d(np.arange(columns * rows), middle)


def two_pieces(columns: int = 6, rows: int = 6) -> np.ndarray:
    """The faces of a grid without a column in the middle."""
    return np.setdiff1d(np.arange(columns * rows), block(columns, range(columns // 2, columns // 2 + 1), range(rows)))


def pinched() -> np.ndarray:
    """Faces of a 3 x 3 grid, connected by edges, whose boundary touches itself at vertex 5."""
    return np.setdiff1d(np.arange(9), [0, 4])


def add_mesh(
    stage: Usd.Stage, shape: Shape, path: str = MESH, frames: Iterable[float] = FRAMES, *, rest: str = "points"
) -> UsdGeom.Mesh:
    """A mesh with a sample of points at each frame.

    rest  where the rest points are: "points" for their default value, "" for nowhere, or the name of a primvar
    """
    for prefix in Sdf.Path(path).GetParentPath().GetPrefixes():
        UsdGeom.Xform.Define(stage, prefix)
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(shape.counts))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(shape.indices))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    points = mesh.CreatePointsAttr()
    for frame in frames:
        points.Set(vectors(shape.moved(frame)), frame)
    if rest == "points":
        points.Set(vectors(shape.points))
    elif rest:
        set_primvar(mesh, rest, Sdf.ValueTypeNames.Point3fArray, "vertex", vectors(shape.points))
    return mesh


def add_patch(mesh: UsdGeom.Mesh, faces: np.ndarray | None, name: str = PATCH) -> None:
    """Applies the schema, and chooses faces by a bool primvar; None: without one."""
    mesh.GetPrim().ApplyAPI("SkinSlideAPI", name)
    if faces is not None:
        chosen = np.isin(np.arange(len(mesh.GetFaceVertexCountsAttr().Get())), faces)
        values = Vt.BoolArray.FromNumpy(chosen)
        set_primvar(mesh, f"skinSlide:{name}:patch", Sdf.ValueTypeNames.BoolArray, "uniform", values)


def set_primvar(
    mesh: UsdGeom.Mesh, name: str, type_name: Sdf.ValueTypeName, interpolation: str, value, time: float | None = None
) -> None:
    """Sets a primvar, replacing one of another type."""
    attr = mesh.GetPrim().GetAttribute(f"primvars:{name}")
    if attr and attr.GetTypeName() != type_name:
        mesh.GetPrim().RemoveProperty(attr.GetName())
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(name, type_name, interpolation)
    primvar.Set(value, Usd.TimeCode.Default() if time is None else time)


def set_property(mesh: UsdGeom.Mesh, name: str, value, time: float | None = None, patch: str = PATCH) -> None:
    """Sets a property that the schema declares, such as envelope."""
    attr = mesh.GetPrim().GetAttribute(f"skinSlide:{patch}:{name}")
    attr.Set(value, Usd.TimeCode.Default() if time is None else time)


def linear_spline(knots: Mapping[float, float]) -> Ts.Spline:
    """Floats that go straight from knot to knot: values by their times."""
    spline = Ts.Spline("float")
    for time, value in knots.items():
        knot = Ts.Knot("float")
        knot.SetTime(time)
        knot.SetValue(value)
        knot.SetNextInterpolation(Ts.InterpLinear)
        spline.SetKnot(knot)
    return spline


def new_stage() -> Usd.Stage:
    """An empty stage with the metadata of a published one."""
    stage = Usd.Stage.CreateInMemory()
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.SetTimeCodesPerSecond(24)
    stage.SetFramesPerSecond(24)
    stage.SetStartTimeCode(FRAMES[0])
    stage.SetEndTimeCode(FRAMES[-1])
    return stage


def patched_stage(
    shape: Shape | None = None, faces: np.ndarray | None = None, *, rest: str = "points"
) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """A stage with one mesh, by default a grid, and one patch, by default of all faces. Keep both."""
    stage, shape = new_stage(), grid() if shape is None else shape
    mesh = add_mesh(stage, shape, rest=rest)
    add_patch(mesh, shape.all_faces if faces is None else faces)
    return stage, mesh


def clipped_stage(folder: Path) -> tuple[Usd.Stage, Usd.ClipsAPI]:
    """A patched grid whose points are in value clips in the folder, clip.FRAME.usda; which is read when is left open.

    The clips have a manifest, so that USD opens none before it is needed.
    """
    shape = grid()
    stage, mesh = patched_stage(shape, rest="Pref")
    for frame in FRAMES:
        mesh.GetPointsAttr().ClearAtTime(frame)
        clip = Usd.Stage.CreateInMemory()
        points = clip.OverridePrim(MESH).CreateAttribute("points", Sdf.ValueTypeNames.Point3fArray, False)
        points.Set(vectors(shape.moved(frame)), frame)
        save(clip, folder / f"clip.{frame:.0f}.usda")
    manifest = Usd.Stage.CreateInMemory()
    manifest.OverridePrim(MESH).CreateAttribute("points", Sdf.ValueTypeNames.Point3fArray, False)
    save(manifest, folder / "manifest.usda")
    clips = Usd.ClipsAPI(stage.GetPrimAtPath("/World"))
    clips.SetClipManifestAssetPath(Sdf.AssetPath("./manifest.usda"))
    clips.SetClipPrimPath("/World")
    return stage, clips


def use_clip_template(clips: Usd.ClipsAPI) -> None:
    """Each clip at its frame, by the template of their names."""
    clips.SetClipTemplateAssetPath("./clip.####.usda")
    clips.SetClipTemplateStartTime(FRAMES[0])
    clips.SetClipTemplateEndTime(FRAMES[-1])
    clips.SetClipTemplateStride(1)


def save(stage: Usd.Stage, path: Path) -> Path:
    stage.GetRootLayer().Export(str(path))
    return path


@contextmanager
def as_nobody() -> Iterator[None]:
    """Meanwhile runs as a user who may not write everywhere, if this process is root's."""
    if os.geteuid() != 0:
        yield
        return
    try:
        os.setresuid(65534, 65534, 0)
    except PermissionError:
        pytest.skip("this root may not become another user")
    try:
        yield
    finally:
        os.setresuid(0, 0, 0)


def vectors(points: np.ndarray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points, np.float32))
