"""Arguments as the rest needs them: a stage or its path, prims or their paths, numpy arrays or other sequences.

One of another type raises TypeError, one that cannot be used UsageError; both name the argument.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.checks import as_array
from skinslide.problems import Fault, SliderError, UsageError, in_place_of
from skinslide.stage import schema
from skinslide.stage.names import primvar_names, subset_names
from skinslide.stage.opening import check_clocks, open_stage

StrPath: TypeAlias = str | os.PathLike[str]
StageLike: TypeAlias = Usd.Stage | StrPath
PrimLike: TypeAlias = Usd.Prim | Usd.SchemaBase | Sdf.Path | str
PrimsLike: TypeAlias = PrimLike | Iterable[PrimLike]

# What is an array to numpy: its type there, its class in USD, its shape.
ARRAYS = {
    "bool[]": (np.bool_, Vt.BoolArray, (-1,)),
    "int[]": (np.int32, Vt.IntArray, (-1,)),
    "float[]": (np.float32, Vt.FloatArray, (-1,)),
    "point3f[]": (np.float32, Vt.Vec3fArray, (-1, 3)),
}


def given_stage(stage: StageLike) -> Usd.Stage:
    """The stage, opened if a path is given. Raises StageError if it cannot be."""
    if isinstance(stage, Usd.Stage):
        check_clocks(stage)
        return stage
    if isinstance(stage, str | os.PathLike):
        return open_stage(os.fspath(stage))
    raise TypeError(f"stage is {stage!r}; it must be a Usd.Stage or a path")


def given_file(stage: StageLike) -> Path:
    """The file of a stage: that of its root layer, if it was given open."""
    if isinstance(stage, str | os.PathLike):
        return Path(stage)
    layer = given_stage(stage).GetRootLayer()
    if not layer.realPath:
        raise UsageError(f"the stage {layer.identifier} is in no file; save it first")
    return Path(layer.realPath)


def given_paths(name: str, prims: PrimsLike) -> list[str]:
    """The paths of prims, of which one may be given alone. Strings are taken as they are."""
    if isinstance(prims, str | Sdf.Path | Usd.Prim | Usd.SchemaBase):
        return [_path_text(name, prims)]
    if not isinstance(prims, Iterable):
        raise TypeError(f"{name} is {prims!r}; it must be a Usd.Prim, an Sdf.Path or a str, or several of them")
    paths = [_path_text(name, prim) for prim in prims]
    if not paths:
        raise UsageError(f"{name} is empty; leave it out to take every prim")
    return paths


def given_path(name: str, prim: PrimLike) -> Sdf.Path:
    """The absolute path of a prim."""
    text = _path_text(name, prim)
    if not (Sdf.Path.IsValidPathString(text) and Sdf.Path(text).IsAbsolutePath() and Sdf.Path(text).IsPrimPath()):
        raise UsageError(f"{name} {text!r} is not the path of a prim, such as /World/char/geo/body_GEO")
    return Sdf.Path(text)


def given_array(name: str, values: npt.ArrayLike, dtype: type, shape: tuple[int, ...]) -> np.ndarray:
    """Values as an array of a type and shape, in which -1 is any length; no value may lose more than digits."""
    try:
        return as_array(values, dtype, shape, name)
    except SliderError as error:
        raise UsageError(str(error)) from error


def given_faces(name: str, faces: npt.ArrayLike, face_count: int) -> np.ndarray:
    """Faces, int32, ascending, each once: of their indices, or of a bool for each face. Fault for one that is not."""
    try:
        chosen = np.asarray(faces)
    except ValueError as error:  # rows of different lengths
        raise UsageError(f"{name}: {error}") from error
    if chosen.dtype == np.bool_:
        if chosen.size != face_count:
            raise Fault(f"{name}: {chosen.size} values for {face_count} faces")
        return np.flatnonzero(chosen).astype(np.int32)
    if chosen.dtype.kind == "f" and chosen.size:
        raise UsageError(f"{name} are floats; they must be indices, or a bool for each face, such as mask > 0")
    found = given_array(name, chosen, np.int32, (-1,))
    wrong = found[(found < 0) | (found >= face_count)]
    if len(wrong):
        check_face(int(wrong.max()), face_count)
    flags = np.zeros(face_count, np.bool_)
    flags[found] = True
    return np.flatnonzero(flags).astype(np.int32)


def check_face(face: int, face_count: int) -> None:
    """Raises Fault for a face that a mesh has not."""
    if not 0 <= face < face_count:
        raise Fault(f"there is no face {face}: the mesh has {face_count} faces")


def given_subset(prim: Usd.Prim, name: str) -> Usd.Prim:
    """The child of a mesh that is to be a GeomSubset. Raises Fault, and UsageError for an empty name."""
    child = schema.child(prim, given_name("a GeomSubset", name))
    if not child:
        raise Fault(f"there is no GeomSubset {name} under the mesh; {in_place_of(name, subset_names(prim))}")
    return child


def given_primvar(prim: Usd.Prim, name: str) -> UsdGeom.Primvar:
    """A primvar that a mesh is to have. Raises Fault, and UsageError for an empty name."""
    primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar(given_name("a primvar", name))
    if not primvar:
        raise Fault(f"there is no primvar {name} on the mesh; {in_place_of(name, primvar_names(prim))}")
    return primvar


def given_name(what: str, name: str) -> str:
    """The name of something on a mesh, which is not empty."""
    if not name:
        raise UsageError(f"the name of {what} is empty")
    return name


def given_value(name: str, value: Any, type_name: Sdf.ValueTypeName) -> Any:
    """A value as an attribute of a type takes it."""
    if str(type_name) in ARRAYS:
        dtype, array, shape = ARRAYS[str(type_name)]
        return array.FromNumpy(given_array(name, value, dtype, shape))
    if type_name == Sdf.ValueTypeNames.Bool:
        return bool(value)
    if type_name == Sdf.ValueTypeNames.Float:
        return given_number(name, value)
    if type_name == Sdf.ValueTypeNames.Asset and isinstance(value, str | os.PathLike):
        return Sdf.AssetPath(os.fspath(value))
    return value


def given_number(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name} is {value!r}; it must be a number") from error


def given_text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise UsageError(f"{name} is {value!r}; it must be a text")
    return value


def _path_text(name: str, prim: PrimLike) -> str:
    if isinstance(prim, str | Sdf.Path):
        return str(prim)
    if not isinstance(prim, Usd.Prim | Usd.SchemaBase):
        raise TypeError(f"{name} is {prim!r}; it must be a Usd.Prim, an Sdf.Path or a str")
    if not prim.GetPrim():
        raise UsageError(f"{name} is an {prim.GetPrim()!r}")
    return str(prim.GetPath())
