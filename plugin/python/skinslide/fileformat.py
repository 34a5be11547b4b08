"""Registers the file format of `.skinslide` files with USD."""

from __future__ import annotations

import ctypes
import json
import warnings
from pathlib import Path

import pxr
from pxr import Plug, Sdf, Tf, Usd  # noqa: F401  Tf loads the libraries that libusd_ms needs

PLUGIN_DIR = Path(__file__).parent / "usd"
_DESCRIPTION = PLUGIN_DIR / "skinslideFileFormat" / "plugInfo.json"
# Has a file format read the text of a `.skinslide` file and compute nothing.
TEXT_ONLY = {"live": "0"}


def register() -> None:
    """Makes USD open `.skinslide` files, where the format was built for the USD that runs; else warns.

    A format that cannot be loaded would make every opening of such a file fail, and of whatever leads to one.
    """
    if not _DESCRIPTION.is_file():
        return
    built, running = _built_for(), ".".join(map(str, Usd.GetVersion()))
    if built != running:
        warnings.warn(
            f"skinslide's file format was built for USD {built}, but this is USD {running}: .skinslide files do not "
            "open as layers. Baking works; to open them, install skinslide again beside this USD.",
            RuntimeWarning,
            stacklevel=3,
        )
        return
    # The plug-in takes its symbols from USD's library, which is loaded but visible to its own modules only, and whose
    # name has a hash in it that a plug-in cannot link. A USD that was built here has no such library, and links.
    for library in (Path(pxr.__file__).parent.parent / "usd_core.libs").glob("libusd_ms-*"):
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    Plug.Registry().RegisterPlugins(str(_DESCRIPTION.parent))
    # USD lists its formats once, when it first needs one. A layer that is open shows that it has; without one, asking
    # would make it, and shut out the formats that others register later.
    if Sdf.Layer.GetLoadedLayers() and not registered():
        warnings.warn(
            "skinslide was imported after USD opened a layer, when it takes no more file formats: .skinslide files do "
            "not open as layers. Import skinslide first.",
            RuntimeWarning,
            stacklevel=3,
        )


def registered() -> bool:
    """Whether `.skinslide` files open as layers."""
    return Sdf.FileFormat.FindById("skinslide") is not None


def is_live(layer: Sdf.Layer) -> bool:
    """Whether a layer is a `.skinslide` file whose points are computed."""
    return layer.GetFileFormat().formatId == "skinslide" and layer.GetFileFormatArguments().get("live") != "0"


def _built_for() -> str:
    return json.loads(_DESCRIPTION.read_text())["Plugins"][0]["Info"]["UsdVersion"]
