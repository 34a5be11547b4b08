"""Fixtures of the bakes."""

import pytest

from shots import Shot


@pytest.fixture
def shot(tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    return Shot(folder)


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out.usda"
