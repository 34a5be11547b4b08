"""skinslide: skin that slides over a deformed mesh instead of sticking to it.

On stages:
- `setup` writes a patch, `paint` the force density of its edges, `mirror` its counterpart on the mesh's other side.
- `check` says what would be slid; `bake` slides it, and `cache` writes what UsdSkel skins.
- `preview` draws skin before and after sliding, `maps` in texture coordinates; a bake does both too, when it is given
  `Pictures` or `Maps`. `report` makes one page of many shots.
- `farm` writes a job that bakes chunks of a shot, and `stitch` joins them.

On numpy arrays, without USD: `Slider`, and `carry` for the normals of what it slid.

Importing skinslide loads only this module: each name loads what it needs when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from skinslide import registration

if TYPE_CHECKING:
    from skinslide.arrays.attributes import carry
    from skinslide.arrays.lookup import Lookup, choose_lookup
    from skinslide.arrays.records import LookupInfo, PatchInfo, PatchResult, Roughness
    from skinslide.arrays.setups import Controls, PatchSetup, Sample, Subdivision
    from skinslide.arrays.slider import Diagnostics, Frame, Slider
    from skinslide.arrays.weld import find_weld
    from skinslide.author.api import SkinSlideAPI, SkinSlideLiveAPI, SkinSlideMeshAPI
    from skinslide.author.applied import CanApplyResult
    from skinslide.author.mirror import mirror, mirror_to_file
    from skinslide.author.paint import PaintReport, paint, paint_to_file
    from skinslide.author.setup import setup, setup_to_file
    from skinslide.picture.drawing import DrawnPictures
    from skinslide.picture.maps import DrawnMaps, Maps, MapsReport, maps
    from skinslide.picture.meshmaps import WrittenMap
    from skinslide.picture.preview import Pictures, PreviewReport, preview
    from skinslide.picture.shots import ShotPatch, ShotRecord, ShotsReport, report
    from skinslide.problems import (
        FrameProblem,
        FrameSpecError,
        Problem,
        SliderError,
        StageError,
        StageProblems,
        UsageError,
    )
    from skinslide.queues.farm import FarmReport, farm
    from skinslide.shot.bake import bake, bake_to_file
    from skinslide.shot.cache import CachedMesh, CacheReport, cache
    from skinslide.shot.candidates import Candidate
    from skinslide.shot.check import (
        CheckedLookup,
        CheckedMap,
        CheckedMesh,
        CheckedPatch,
        CheckedShare,
        CheckReport,
        check,
    )
    from skinslide.shot.frames import parse_frames
    from skinslide.shot.report import BakeReport, MeshReport, PatchReport
    from skinslide.shot.stitch import StitchReport, stitch

    __version__: str

__all__ = [
    "BakeReport",
    "CacheReport",
    "CachedMesh",
    "CanApplyResult",
    "Candidate",
    "CheckReport",
    "CheckedLookup",
    "CheckedMap",
    "CheckedMesh",
    "CheckedPatch",
    "CheckedShare",
    "Controls",
    "Diagnostics",
    "DrawnMaps",
    "DrawnPictures",
    "FarmReport",
    "Frame",
    "FrameProblem",
    "FrameSpecError",
    "Lookup",
    "LookupInfo",
    "Maps",
    "MapsReport",
    "MeshReport",
    "PaintReport",
    "PatchInfo",
    "PatchReport",
    "PatchResult",
    "PatchSetup",
    "Pictures",
    "PreviewReport",
    "Problem",
    "Roughness",
    "Sample",
    "ShotPatch",
    "ShotRecord",
    "ShotsReport",
    "SkinSlideAPI",
    "SkinSlideLiveAPI",
    "SkinSlideMeshAPI",
    "Slider",
    "SliderError",
    "StageError",
    "StageProblems",
    "StitchReport",
    "Subdivision",
    "UsageError",
    "WrittenMap",
    "bake",
    "bake_to_file",
    "cache",
    "carry",
    "check",
    "choose_lookup",
    "cmake_dir",
    "farm",
    "find_weld",
    "maps",
    "mirror",
    "mirror_to_file",
    "paint",
    "paint_to_file",
    "parse_frames",
    "plugin_dir",
    "preview",
    "report",
    "setup",
    "setup_to_file",
    "stitch",
]

# The modules that have these names; a test compares them with what type checkers are told above.
_HOMES = {
    "arrays.attributes": ("carry",),
    "arrays.lookup": ("Lookup", "choose_lookup"),
    "arrays.records": ("LookupInfo", "PatchInfo", "PatchResult", "Roughness"),
    "arrays.setups": ("Controls", "PatchSetup", "Sample", "Subdivision"),
    "arrays.slider": ("Diagnostics", "Frame", "Slider"),
    "arrays.weld": ("find_weld",),
    "author.applied": ("CanApplyResult",),
    "author.api": ("SkinSlideAPI", "SkinSlideLiveAPI", "SkinSlideMeshAPI"),
    "author.mirror": ("mirror", "mirror_to_file"),
    "author.paint": ("PaintReport", "paint", "paint_to_file"),
    "author.setup": ("setup", "setup_to_file"),
    "picture.drawing": ("DrawnPictures",),
    "picture.maps": ("DrawnMaps", "Maps", "MapsReport", "maps"),
    "picture.meshmaps": ("WrittenMap",),
    "picture.preview": ("Pictures", "PreviewReport", "preview"),
    "picture.shots": ("ShotPatch", "ShotRecord", "ShotsReport", "report"),
    "problems": (
        "FrameProblem",
        "FrameSpecError",
        "Problem",
        "SliderError",
        "StageError",
        "StageProblems",
        "UsageError",
    ),
    "queues.farm": ("FarmReport", "farm"),
    "shot.bake": ("bake", "bake_to_file"),
    "shot.cache": ("CachedMesh", "CacheReport", "cache"),
    "shot.candidates": ("Candidate",),
    "shot.check": (
        "CheckedLookup",
        "CheckedMap",
        "CheckedMesh",
        "CheckedPatch",
        "CheckedShare",
        "CheckReport",
        "check",
    ),
    "shot.frames": ("parse_frames",),
    "shot.report": ("BakeReport", "MeshReport", "PatchReport"),
    "shot.stitch": ("StitchReport", "stitch"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        value = import_module("skinslide.arrays.native").version()
    elif name in _HOME_OF:
        value = getattr(import_module(f"skinslide.{_HOME_OF[name]}"), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


def cmake_dir() -> str:
    """The folder with skinslideConfig.cmake, for `find_package(skinslide)` in a C or C++ project."""
    return str(Path(__file__).parent / "lib" / "cmake" / "skinslide")


def plugin_dir() -> str:
    """The folder to add to PXR_PLUGINPATH_NAME in a host whose USD skinslide was built for, with pxr_DIR.

    This does not do for the wheel usd-core, whose library hides its symbols: import skinslide first there.
    """
    return str(registration.PLUGIN_DIR)


registration.register_early()
