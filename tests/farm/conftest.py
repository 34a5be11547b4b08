"""A shot that takes a moment to bake."""

from pathlib import Path

import pytest

import stages
from skinslide import bake_to_file

FRAMES = range(1001, 1009)


@pytest.fixture
def shot(tmp_path) -> Path:
    sheet = stages.grid(48, 48)
    stage, mesh = stages.patched_stage(sheet)
    stages.set_property(mesh, "forceDensityRule", "even")
    for frame in FRAMES:
        mesh.GetPointsAttr().Set(stages.vectors(sheet.moved(frame)), frame)
    return stages.save(stage, tmp_path / "shot.usda")


@pytest.fixture
def whole(shot, tmp_path) -> str:
    """What one machine bakes."""
    bake_to_file(shot, tmp_path / "whole.usda")
    return (tmp_path / "whole.usda").read_text()
