"""Writes an example: `cache.usdc`, as a character department would publish it, and the shot.

The shot payloads the cache with a layer offset. With a patch, whose set-up it has as ordinary opinions, it is
`stage.usda`; without one it is `shot.usda`, from which `skinslide setup` makes `stage.usda`.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, Vt

FRAME_COUNT = 24
FIRST_SHOT_FRAME = 1001
MESH_PATH = "/World/char/geo/body_GEO"


@dataclass(frozen=True)
class Cache:
    """A deforming mesh. Points are in centimetres, Y up."""

    rest: np.ndarray  # (V, 3)
    frames: Iterable[np.ndarray]  # one (V, 3) a frame, from cache frame 1
    faces: np.ndarray  # (F, 4)
    st: np.ndarray  # (T, 2)
    st_faces: np.ndarray  # (F, 4), rows of `st`
    rest_source: str = "points"  # the default value of `points`, or the name of a primvar, such as "Pref"
    subdivision: str = UsdGeom.Tokens.catmullClark
    colours: np.ndarray | None = None  # (F, 3), display colour by face
    masks: Mapping[str, np.ndarray] = field(default_factory=dict)  # primvars by name: bool (F,) or float (V,)


@dataclass(frozen=True)
class Patch:
    """A patch's opinions on the shot."""

    name: str
    region: np.ndarray  # bool (F,)
    store: str = "bool"  # how the faces are written: "bool", "int" (uniform), "float" (vertex), or "subset"
    weight: np.ndarray | None = None  # (V,), slide weight
    corners: tuple[int, ...] | None = None  # four point ids on the outer loop, in order


def write(folder: Path, cache: Cache, patch: Patch | None = None) -> Path:
    """Writes both files into `folder`, making it where needed, and returns the shot's path."""
    folder.mkdir(parents=True, exist_ok=True)
    # A stage must outlive the export: it alone keeps its root layer.
    published, shot = _cache_stage(cache), _shot_stage(cache, patch)
    published.GetRootLayer().Export(str(folder / "cache.usdc"))
    path = folder / ("stage.usda" if patch else "shot.usda")
    shot.GetRootLayer().Export(str(path))
    return path


def write_skinned(folder: Path, define: Callable[[Usd.Stage], None]) -> Path:
    """The same for a character that `define` makes at /char, a SkelRoot. The shot has no patch."""
    folder.mkdir(parents=True, exist_ok=True)
    published, shot = new_stage("char", first_frame=1), _payloading_stage("./character.usdc", "SkelRoot")
    define(published)
    published.GetRootLayer().Export(str(folder / "character.usdc"))
    shot.GetRootLayer().Export(str(folder / "shot.usda"))
    return folder / "shot.usda"


def _cache_stage(cache: Cache) -> Usd.Stage:
    stage = new_stage("char", first_frame=1)
    char = UsdGeom.Xform.Define(stage, "/char").GetPrim()
    Usd.ModelAPI(char).SetKind(Kind.Tokens.component)
    UsdGeom.Scope.Define(stage, "/char/geo")
    mesh = UsdGeom.Mesh.Define(stage, MESH_PATH.removeprefix("/World"))
    mesh.CreateFaceVertexCountsAttr(np.full(len(cache.faces), cache.faces.shape[1], dtype=np.int32))
    mesh.CreateFaceVertexIndicesAttr(cache.faces.astype(np.int32).ravel())
    mesh.CreateSubdivisionSchemeAttr(cache.subdivision)
    _write_primvars(mesh, cache)
    if cache.rest_source == "points":
        _write_points(mesh, cache.rest, Usd.TimeCode.Default())
    for frame, points in enumerate(cache.frames, start=1):
        _write_points(mesh, points, frame)
    return stage


def _payloading_stage(payload: str, type_name: str = "Xform") -> Usd.Stage:
    stage = new_stage("World", first_frame=FIRST_SHOT_FRAME)
    world = UsdGeom.Xform.Define(stage, "/World").GetPrim()
    Usd.ModelAPI(world).SetKind(Kind.Tokens.group)
    char = stage.DefinePrim("/World/char", type_name)
    offset = Sdf.LayerOffset(FIRST_SHOT_FRAME - 1)
    char.GetPayloads().AddPayload(Sdf.Payload(payload, layerOffset=offset))
    return stage


def _shot_stage(cache: Cache, patch: Patch | None) -> Usd.Stage:
    stage = _payloading_stage("./cache.usdc")
    if patch:
        prim = stage.OverridePrim(MESH_PATH)
        prim.AddAppliedSchema(f"SkinSlideAPI:{patch.name}")
        _write_patch(prim, cache, patch)
    return stage


def new_stage(default_prim: str, first_frame: int) -> Usd.Stage:
    """An empty stage in centimetres, Y up, with FRAME_COUNT frames, 24 a second."""
    # Nothing is loaded: the shot's payload has no folder to be found in until the layer is exported.
    stage = Usd.Stage.CreateInMemory(load=Usd.Stage.LoadNone)
    stage.SetDefaultPrim(stage.OverridePrim(f"/{default_prim}"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, UsdGeom.LinearUnits.centimeters)
    stage.SetTimeCodesPerSecond(24)
    stage.SetFramesPerSecond(24)
    stage.SetStartTimeCode(first_frame)
    stage.SetEndTimeCode(first_frame + FRAME_COUNT - 1)
    return stage


def _write_primvars(mesh: UsdGeom.Mesh, cache: Cache) -> None:
    types, tokens, primvars = Sdf.ValueTypeNames, UsdGeom.Tokens, UsdGeom.PrimvarsAPI(mesh)
    used, corners = np.unique(cache.st_faces, return_inverse=True)
    st = primvars.CreatePrimvar("st", types.TexCoord2fArray, tokens.faceVarying)
    st.Set(Vt.Vec2fArray.FromNumpy(cache.st[used].astype(np.float32)))
    st.SetIndices(Vt.IntArray.FromNumpy(corners.astype(np.int32).ravel()))
    if cache.rest_source != "points":
        rest = primvars.CreatePrimvar(cache.rest_source, types.Point3fArray, tokens.vertex)
        rest.Set(Vt.Vec3fArray.FromNumpy(cache.rest.astype(np.float32)))
    if cache.colours is not None:
        colours = primvars.CreatePrimvar("displayColor", types.Color3fArray, tokens.uniform)
        colours.Set(Vt.Vec3fArray.FromNumpy(cache.colours.astype(np.float32)))
    for name, mask in cache.masks.items():
        by_face = mask.dtype == bool
        kind, where = (types.BoolArray, tokens.uniform) if by_face else (types.FloatArray, tokens.vertex)
        primvars.CreatePrimvar(name, kind, where).Set(mask if by_face else mask.astype(np.float32))


def _write_points(mesh: UsdGeom.Mesh, points: np.ndarray, time: Usd.TimeCode | float) -> None:
    points = points.astype(np.float32)
    mesh.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), time)
    extent = [Gf.Vec3f(*points.min(axis=0).tolist()), Gf.Vec3f(*points.max(axis=0).tolist())]
    mesh.CreateExtentAttr().Set(extent, time)


def _write_patch(prim: Usd.Prim, cache: Cache, patch: Patch) -> None:
    types, space = Sdf.ValueTypeNames, f"skinSlide:{patch.name}"
    primvars = UsdGeom.PrimvarsAPI(prim)
    if patch.store == "subset":
        _write_subset(prim, patch)
    elif patch.store == "float":
        paint = np.zeros(len(cache.rest), dtype=np.float32)
        paint[cache.faces[patch.region]] = 1
        primvars.CreatePrimvar(f"{space}:patch", types.FloatArray, UsdGeom.Tokens.vertex).Set(paint)
    else:
        kind = {"bool": types.BoolArray, "int": types.IntArray}[patch.store]
        flags = patch.region if patch.store == "bool" else patch.region.astype(np.int32)
        primvars.CreatePrimvar(f"{space}:patch", kind, UsdGeom.Tokens.uniform).Set(flags)
    if patch.weight is not None:
        weight = primvars.CreatePrimvar(f"{space}:weight", types.FloatArray, UsdGeom.Tokens.vertex)
        weight.Set(patch.weight.astype(np.float32))
    if patch.corners is not None:
        attr = prim.CreateAttribute(
            f"{space}:corners", types.IntArray, custom=False, variability=Sdf.VariabilityUniform
        )
        attr.Set(list(patch.corners))


def _write_subset(prim: Usd.Prim, patch: Patch) -> None:
    mesh_subset = UsdGeom.Subset.Define(prim.GetStage(), prim.GetPath().AppendChild(patch.name))
    mesh_subset.CreateElementTypeAttr(UsdGeom.Tokens.face)
    mesh_subset.CreateFamilyNameAttr("skinSlide")
    mesh_subset.CreateIndicesAttr(np.flatnonzero(patch.region).astype(np.int32))
    family = prim.CreateAttribute(
        "subsetFamily:skinSlide:familyType", Sdf.ValueTypeNames.Token, custom=False, variability=Sdf.VariabilityUniform
    )
    family.Set(UsdGeom.Tokens.unrestricted)
