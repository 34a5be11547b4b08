"""Installs the extension into a user's folder, by Blender's own operator: install.py ZIP"""

from __future__ import annotations

import sys

import bpy

if __name__ == "__main__":
    import addon_utils

    addon_utils.enable("bl_pkg")
    installed = bpy.ops.extensions.package_install_files(
        filepath=sys.argv[1], repo="user_default", enable_on_install=True
    )
    assert installed == {"FINISHED"} and hasattr(bpy.types.Object, "skinslide")
