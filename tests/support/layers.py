"""`.skinslide` files for the tests, and what the file format says and does."""

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom, UsdUtils

import skinslide
from stages import MESH, grid, patched_stage, save

LIBRARY = Path(skinslide.__file__).parent / "lib" / "skinslideFileFormat.so"
HEAD = 'defaultPrim = "World"; metersPerUnit = 0.01; upAxis = "Y"; timeCodesPerSecond = 24; framesPerSecond = 24'
CLOCK = "startTimeCode = 1001; endTimeCode = 1003"


def counter(name: str) -> Callable[[], int]:
    def count() -> int:
        function = getattr(ctypes.CDLL(str(LIBRARY)), name)  # the USD in use may not be able to load it
        function.restype = ctypes.c_uint64
        return function()

    return count


solve_count = counter("skinslideFormatSolveCount")
most_at_once = counter("skinslideFormatMostAtOnce")
cache_bytes = counter("skinslideFormatCacheBytes")


def write(
    path: Path, *, over: str = "", head: str = f"{HEAD}; {CLOCK}", cache: str = "./cache.usda", body: str = ""
) -> Path:
    """A `.skinslide` file that sublayers a cache. over: properties of the mesh; body: other prims."""
    path.write_text(
        f"#usda 1.0\n({head}; subLayers = [@{cache}@])\n"
        f'over "World" {{\nover "char" {{\nover "geo" {{\nover "skin_GEO" {{\n{over}\n}}\n}}\n}}\n}}\n{body}\n'
    )
    return path


def make(folder: Path, edit: Callable[[UsdGeom.Mesh], None] = lambda mesh: None, **text: str) -> Path:
    """A cache of a grid with a patch, `cache.usda`, and `x.skinslide` above it."""
    stage, mesh = patched_stage(grid())
    edit(mesh)
    save(stage, folder / "cache.usda")
    return write(folder / "x.skinslide", **text)


def open_mesh(path: Path | str, mesh: str = MESH) -> tuple[Usd.Stage, UsdGeom.Mesh]:
    """Keep both: without its stage a prim expires."""
    stage = Usd.Stage.Open(str(path))
    return stage, UsdGeom.Mesh(stage.GetPrimAtPath(mesh))


def points(mesh: UsdGeom.Mesh, time: float) -> np.ndarray:
    return np.asarray(mesh.GetPointsAttr().Get(time))


def baked(path: Path, folder: Path, name: str = "baked.usdc") -> Sdf.Layer:
    skinslide.bake_to_file(path, folder / name)
    return Sdf.Layer.FindOrOpen(str(folder / name))


def samples(layer: Sdf.Layer, attribute: str) -> dict[float, np.ndarray]:
    path = f"{MESH}.{attribute}"
    return {time: np.asarray(layer.QueryTimeSample(path, time)) for time in layer.ListTimeSamplesForPath(path)}


def same(a: dict[float, np.ndarray], b: dict[float, np.ndarray]) -> bool:
    """Bit for bit."""
    return list(a) == list(b) and all(a[time].tobytes() == b[time].tobytes() for time in a)


@contextmanager
def said() -> Iterator[list[str]]:
    """Collects the diagnostics that USD prints; those of a thread that raises are its own."""
    delegate, messages = UsdUtils.CoalescingDiagnosticDelegate(), []
    try:
        yield messages
    finally:
        messages += [diagnostic.commentary for diagnostic in delegate.TakeUncoalescedDiagnostics()]


def refusal(path: Path) -> str:
    """What USD says of a file that does not open."""
    try:
        Usd.Stage.Open(str(path))
    except Tf.ErrorException as error:
        return str(error)
    raise AssertionError(f"{path} opened")
