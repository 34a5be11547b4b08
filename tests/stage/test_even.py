"""The tables of bad stages again, under the rule even: it refuses what no rule can slide, but needs no plane."""

from dataclasses import replace

import pytest

import bad_meshes
import bad_settings
import bad_types
from edits import all_of, even
from readers import command
from rows import made, named
from test_readers_agree import is_said

# What only the plane could not have.
GOOD_NOW = {"patch: closed", "patch: pinched", "corners: inside"}
OF_THE_RULE = {"token: rule"}
ROWS = [
    replace(row, edit=all_of(row.edit, even))
    for row in [*bad_meshes.GEOMETRY, *bad_types.TYPES, *bad_settings.CONTROLS, *bad_settings.SETTINGS]
    if row.name not in OF_THE_RULE
]


@pytest.fixture(autouse=True)
def no_device(monkeypatch):
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "")


@pytest.mark.parametrize("row", named(ROWS))
def test_what_is_said(row, tmp_path, capfd):
    code, said = command(capfd, "check", made(row, tmp_path))
    if row.name in GOOD_NOW:
        assert code == 0 and not said, said
    else:
        assert code == 3 and is_said(row, tmp_path, said), said
