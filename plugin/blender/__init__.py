"""Skinslide in Blender: patches of a mesh, painted on it, slid as the timeline moves, and kept in `.skinslide` files.

What a mesh has is fetched under the names that a USD cache would have it by, and meant by the core, as any stage is.
"""

from __future__ import annotations

from . import files, live, paint, panel, patches, rest, settings

_PARTS = (settings, patches, paint, rest, files, live, panel)


def register() -> None:
    """Called by Blender when the extension is enabled."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    for part in reversed(_PARTS):
        part.unregister()
