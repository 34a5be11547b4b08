"""Tests that run in Blender's own Python, each in an empty scene, with the extension as it was installed."""

from __future__ import annotations

import os
from pathlib import Path

import bpy
import pytest

MODULE = "bl_ext.user_default.skinslide"


@pytest.fixture(scope="session", autouse=True)
def extension():
    """Enabled, as it is after a start of Blender."""
    import addon_utils  # which importing bpy makes known

    if MODULE not in bpy.context.preferences.addons:
        addon_utils.enable(MODULE, default_set=True)
    assert hasattr(bpy.types.Object, "skinslide")


@pytest.fixture(autouse=True)
def scene():
    """An empty scene of three frames."""
    for held in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.curves, bpy.data.actions):
        bpy.data.batch_remove(list(held))
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1001, 1003
    bpy.context.scene.frame_set(1001)
    return bpy.context.scene


@pytest.fixture
def out() -> Path:
    """The folder for what the tests outside look at."""
    return Path(os.environ["SKINSLIDE_BLENDER_OUT"])
