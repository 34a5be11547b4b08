"""Whatever the schema declares, and whatever is painted, has a good row and a bad one in the tables."""

import re
from pathlib import Path

import pytest
from pxr import Sdf

from bad_stages import BAD
from edits import PLACE
from good_stages import GOOD
from repository import ROOT
from rows import made
from skinslide.arrays.schema import inputs
from stages import MESH

LAYER = Sdf.Layer.FindOrOpen(str(ROOT / "schema" / "generatedSchema.usda"))


def declared(schema_class: str) -> list[str]:
    return [
        spec.name.replace("skinSlide:__INSTANCE_NAME__", PLACE)
        for spec in LAYER.GetPrimAtPath(f"/{schema_class}").attributes
    ]


NAMES = [
    *declared("SkinSlideAPI"),
    *declared("SkinSlideMeshAPI"),
    *(
        each.property(PLACE.removeprefix("skinSlide:"))
        for group in ("patch", "controls")
        for each in inputs(group)
        if each.is_primvar
    ),
]


def test_every_class_counts():
    """But for the settings of a layer that is opened live, which no bake knows: tests/format has those."""
    assert list(LAYER.rootPrims.keys()) == ["SkinSlideAPI", "SkinSlideMeshAPI", "SkinSlideLiveAPI"]
    tried = (ROOT / "tests" / "format" / "test_fileformat.py").read_text()
    assert all(name in tried for name in declared("SkinSlideLiveAPI"))


@pytest.fixture(scope="module")
def authored(tmp_path_factory) -> set[str]:
    """The properties of the meshes of all good rows."""
    names = set()
    for row in GOOD:
        folder: Path = tmp_path_factory.mktemp("row")
        made(row, folder)
        cache = Sdf.Layer.FindOrOpen(str(folder / "cache.usda"))
        names.update(spec.name for spec in cache.GetPrimAtPath(MESH).properties)
    return names


@pytest.mark.parametrize("name", NAMES)
def test_a_good_row(name, authored):
    assert name in authored


@pytest.mark.parametrize("name", NAMES)
def test_a_bad_row(name):
    assert any(re.search(rf"(^|\W){re.escape(name)}(?!\w|:\w)", row.says) for row in BAD)
