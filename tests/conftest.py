"""Fixtures of several test files."""

import tempfile
from pathlib import Path

import pytest


@pytest.fixture
def public_folder():
    """A folder that every user can reach, unlike pytest's."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)
