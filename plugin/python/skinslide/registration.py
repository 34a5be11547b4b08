"""Tells USD of the schema and of the file format of `.skinslide` files as soon as USD is there, without loading it."""

from __future__ import annotations

import ctypes
import json
import sys
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

_PACKAGE = Path(__file__).parent
PLUGIN_DIR = _PACKAGE / "usd"
_DESCRIPTION = PLUGIN_DIR / "skinslideFileFormat" / "plugInfo.json"
# What holds stages and layers; Usd imports Sdf, while it is not yet whole itself.
_SDF, _USD = "pxr.Sdf", "pxr.Usd"


def register_early() -> None:
    """Registers now where USD has been imported, else at the end of its import: before it can open any layer."""
    if _SDF in sys.modules:
        register()
    else:
        sys.meta_path.insert(0, _Finder)


def register() -> None:
    """Gives USD the schema, and the file format where it was built for the USD that runs; else warns.

    A format that cannot be loaded would make every opening of such a file fail, and of whatever leads to one.
    """
    import pxr
    from pxr import Plug, Sdf, Tf, Usd  # noqa: F401  Tf loads the libraries that libusd_ms needs

    Plug.Registry().RegisterPlugins(str(_PACKAGE / "schema"))
    if not _DESCRIPTION.is_file():
        return
    built, running = _built_for(), ".".join(map(str, Usd.GetVersion()))
    if built != running:
        warnings.warn(
            f"skinslide's file format was built for USD {built}, but this is USD {running}: .skinslide files do not "
            "open as layers. Baking works; to open them, install skinslide again beside this USD.",
            RuntimeWarning,
            stacklevel=4,
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
            stacklevel=4,
        )


def registered() -> bool:
    """Whether `.skinslide` files open as layers."""
    from pxr import Sdf

    return Sdf.FileFormat.FindById("skinslide") is not None


class _Finder:
    """Finds USD's modules as Python does, and has skinslide registered once they are loaded."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = PathFinder.find_spec(fullname, path, target) if fullname in (_SDF, _USD) else None
        if spec and spec.loader:
            spec.loader.exec_module = partial(_load, spec.loader.exec_module)  # type: ignore[method-assign]
        return spec


def _load(load: Callable[[ModuleType], None], module: ModuleType) -> None:
    load(module)
    if module.__name__ == _USD or _USD not in sys.modules:
        sys.meta_path.remove(_Finder)
        register()


def _built_for() -> str:
    return json.loads(_DESCRIPTION.read_text())["Plugins"][0]["Info"]["UsdVersion"]
