"""Fixtures of the previews."""

import pytest
from sheets import sheet

import stages


@pytest.fixture
def shot(tmp_path):
    return stages.save(sheet()[0], tmp_path / "shot.usda")
