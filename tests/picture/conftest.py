"""Fixtures of the previews."""

import pytest

import stages
from sheets import sheet


@pytest.fixture
def shot(tmp_path):
    return stages.save(sheet()[0], tmp_path / "shot.usda")
