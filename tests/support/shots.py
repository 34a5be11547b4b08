"""A cached sheet under a shot, bakes of it, and the same arrays through `Slider`."""

import hashlib
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

import skinslide
import stages
from skinslide import PatchSetup, Slider
from stages import vectors

SIZE = 8  # quads a side
VERTICES, FACES = (SIZE + 1) ** 2, SIZE**2
MESH = "/World/char/geo/body_GEO"
SHEET = stages.squares(SIZE)
COUNTS, INDICES, REST = SHEET.counts, SHEET.indices, SHEET.points
OFFSET = 1000


def pose(frame: float) -> np.ndarray:
    """The sheet with a bump that travels along x."""
    points = REST.copy()
    points[:, 2] = 3 * np.exp(-0.3 * ((REST[:, 0] - frame) ** 2 + (REST[:, 1] - 4.0) ** 2))
    return points


class Shot:
    """A cache with frames 1 to 5, under a payload of a shot with an offset of 1000, in a folder."""

    def __init__(self, folder: Path):
        self.path, self.cache_path = folder / "shot.usda", folder / "cache.usdc"
        self.cache = Usd.Stage.CreateNew(str(self.cache_path))
        self.cache.SetDefaultPrim(UsdGeom.Xform.Define(self.cache, "/char").GetPrim())
        self.cache.SetTimeCodesPerSecond(25)
        self.mesh = UsdGeom.Mesh.Define(self.cache, "/char/geo/body_GEO")
        self.mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(COUNTS))
        self.mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(INDICES))
        self.mesh.CreateSubdivisionSchemeAttr("none")
        self.mesh.CreatePointsAttr(vectors(REST))
        for frame in range(1, 6):
            self.mesh.GetPointsAttr().Set(vectors(pose(frame)), frame)
        self.shot = Usd.Stage.CreateNew(str(self.path))
        self.shot.SetDefaultPrim(UsdGeom.Xform.Define(self.shot, "/World").GetPrim())
        self.shot.SetTimeCodesPerSecond(25)
        self.shot.SetFramesPerSecond(25)
        self.shot.SetStartTimeCode(OFFSET + 1)
        self.shot.SetEndTimeCode(OFFSET + 5)
        UsdGeom.SetStageUpAxis(self.shot, "Z")
        UsdGeom.SetStageMetersPerUnit(self.shot, 0.01)
        UsdGeom.Xform.Define(self.shot, "/World/char").GetPrim().GetPayloads().AddPayload(
            Sdf.Payload("./cache.usdc", layerOffset=Sdf.LayerOffset(OFFSET))
        )
        self.over = self.shot.OverridePrim(MESH)
        self.over.AddAppliedSchema("SkinSlideAPI:sheet")
        self.primvar("patch", Sdf.ValueTypeNames.BoolArray, "uniform").Set(Vt.BoolArray(FACES, True))

    def primvar(self, name: str, kind: Sdf.ValueTypeName, interpolation: str) -> UsdGeom.Primvar:
        return UsdGeom.PrimvarsAPI(self.over).CreatePrimvar(f"skinSlide:sheet:{name}", kind, interpolation)

    def envelope(self) -> Usd.Attribute:
        return self.over.CreateAttribute("skinSlide:sheet:envelope", Sdf.ValueTypeNames.Float)

    def save(self) -> "Shot":
        self.cache.Save()
        self.shot.Save()
        return self


def baked_mesh(path: Path) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    stage = Usd.Stage.Open(str(path))
    return stage, UsdGeom.Mesh(stage.GetPrimAtPath(MESH))


def composed_mesh(shot: Shot, baked: Path) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """The shot with the bake above it."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.subLayerPaths = [str(baked), str(shot.path)]
    stage = Usd.Stage.Open(layer)
    stage.SetTimeCodesPerSecond(25)
    UsdGeom.SetStageUpAxis(stage, "Z")
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    stage.SetDefaultPrim(stage.GetPrimAtPath("/World"))
    return stage, UsdGeom.Mesh(stage.GetPrimAtPath(MESH))


def direct(points: np.ndarray, **controls: float) -> np.ndarray:
    """The same arrays through `Slider`."""
    made = Slider(COUNTS, INDICES, REST, [PatchSetup("sheet", np.arange(FACES))])
    return made.slide(points, [skinslide.Controls(**controls)]).points


def digest(folder: Path) -> dict[str, str]:
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}
