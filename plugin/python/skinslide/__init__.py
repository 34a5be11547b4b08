"""skinslide: skin that slides over a deformed mesh instead of sticking to it.

`bake` corrects a stage, `stitch` puts chunks of a bake together, `check` says what would be slid, `preview` draws it
before and after, `maps` in texture coordinates; `setup` writes a patch, `paint` its edges, `mirror` its counterpart on
a mesh's other side. `Slider` is the same on numpy arrays.
"""

from pathlib import Path

from pxr import Plug

from skinslide import fileformat
from skinslide.bake import bake, bake_to_file
from skinslide.check import check
from skinslide.frames import FrameSpecError, UsageError, parse_frames
from skinslide.maps import MapsReport, maps
from skinslide.mirror import mirror
from skinslide.paint import PaintReport, paint
from skinslide.preview import PreviewReport, preview
from skinslide.problems import FrameProblem, Problem, StageError, StageProblems
from skinslide.report import BakeReport
from skinslide.setup import setup
from skinslide.slider import (
    Controls,
    Diagnostics,
    Frame,
    Lookup,
    LookupInfo,
    PatchSetup,
    Slider,
    SliderError,
    Subdivision,
    choose_lookup,
    version,
)
from skinslide.stitch import StitchReport, stitch

__version__ = version()

Plug.Registry().RegisterPlugins(str(Path(__file__).parent / "schema"))
fileformat.register()


def cmake_dir() -> str:
    """The folder with skinslideConfig.cmake, for `find_package(skinslide)` in a C or C++ project."""
    return str(Path(__file__).parent / "lib" / "cmake" / "skinslide")


def plugin_dir() -> str:
    """The folder to add to PXR_PLUGINPATH_NAME, for a host with a USD that skinslide was built for with pxr_DIR.

    Not with the wheel usd-core, whose library hides its symbols until skinslide is imported: import it first there.
    """
    return str(fileformat.PLUGIN_DIR)


__all__ = [
    "BakeReport",
    "Controls",
    "Diagnostics",
    "Frame",
    "FrameProblem",
    "FrameSpecError",
    "Lookup",
    "LookupInfo",
    "MapsReport",
    "PaintReport",
    "PatchSetup",
    "PreviewReport",
    "Problem",
    "Slider",
    "SliderError",
    "StageError",
    "StageProblems",
    "StitchReport",
    "Subdivision",
    "UsageError",
    "bake",
    "bake_to_file",
    "check",
    "choose_lookup",
    "cmake_dir",
    "maps",
    "mirror",
    "paint",
    "parse_frames",
    "plugin_dir",
    "preview",
    "setup",
    "stitch",
]
