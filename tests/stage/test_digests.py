"""The bytes of every bake, as recorded in digests.txt. Where a change means to change them, it records them again:

pytest tests/stage/test_digests.py            names each attribute of each bake that differs
pytest tests/stage/test_digests.py --record   takes what is baked now as right, and drops what is baked no more
"""

from collections.abc import Iterator
from itertools import product
from pathlib import Path

import pytest
from pxr import Sdf, UsdUtils

import skinslide
from digests import Digests, Record, contents, digest
from good_stages import GOOD
from rows import made

MESH = "/World/char/geo/body_GEO"
# Example -> its patch.
EXAMPLES = {
    "elbow": "elbow_L",
    "fine_elbow": "elbow_L",
    "bicep": "bicep_L",
    "face": "face",
    "finger": "index_L",
    "sleeve": "sleeve_L",
    "chequer": "sheet",
    "bump": "sheet",
}
RULES = ("unit", "fast", "relaxed")
INTERPOLATIONS = ("linear", "meanValue", "limit")
WAYS = [
    way
    for way in product(EXAMPLES, RULES, INTERPOLATIONS)
    if (way[0], way[2]) != ("chequer", "limit")  # it is no subdivision surface
]


@pytest.fixture(scope="module")
def record(request) -> Iterator[Record]:
    """What is recorded; with --record, what will be."""
    path = Path(__file__).with_name("digests.txt")
    if not request.config.getoption("--record"):
        yield Record(path)
        return
    taken = Record(path)
    yield taken
    taken.write()


@pytest.fixture
def same_as_recorded(request, record):
    def check(case: str, found: Digests) -> None:
        if request.config.getoption("--record"):
            record.take(case, found)
        assert not (differences := record.differences(case, found)), "\n".join(differences)

    return check


def with_settings(stage: Path, copy: Path, patch: str, rule: str, interpolation: str) -> Path:
    """A copy of a stage, whose patch is set otherwise."""
    layer = Sdf.Layer.CreateNew(str(copy))
    layer.TransferContent(Sdf.Layer.FindOrOpen(str(stage)))
    UsdUtils.ModifyAssetPaths(layer, lambda path: str(stage.parent / path))
    for name, token in (("forceDensityRule", rule), ("interpolation", interpolation)):
        Sdf.CreatePrimAttributeInLayer(
            layer, f"{MESH}.skinSlide:{patch}:{name}", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform
        )
        layer.GetAttributeAtPath(f"{MESH}.skinSlide:{patch}:{name}").default = token
    layer.Save()
    return copy


def baked(stage: Path, folder: Path) -> Digests:
    skinslide.bake_to_file(stage, folder / "slid.usdc", diagnostics=True)
    return digest(contents(Sdf.Layer.FindOrOpen(str(folder / "slid.usdc"))))


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_are_made_as_they_were(example, example_stage, same_as_recorded):
    """Where they are not, their bakes differ for no reason of ours: their points come from numpy."""
    cache = Sdf.Layer.FindOrOpen(str(example_stage(example).with_name("cache.usdc")))
    same_as_recorded(f"{example} before", digest(contents(cache)))


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_as_they_are(example, example_stage, same_as_recorded, tmp_path):
    same_as_recorded(example, baked(example_stage(example), tmp_path))


@pytest.mark.parametrize(("example", "rule", "interpolation"), WAYS)
def test_examples_set_otherwise(example, rule, interpolation, example_stage, same_as_recorded, tmp_path):
    stage = with_settings(example_stage(example), tmp_path / "shot.usda", EXAMPLES[example], rule, interpolation)
    same_as_recorded(f"{example} {rule} {interpolation}", baked(stage, tmp_path))


@pytest.mark.parametrize("row", [pytest.param(row, id=row.name) for row in GOOD])
def test_good_rows(row, same_as_recorded, tmp_path):
    same_as_recorded(f"row {row.name}", baked(made(row, tmp_path), tmp_path))


def test_nothing_else_is_recorded(request, record):
    cases = {*EXAMPLES, *(f"{example} before" for example in EXAMPLES), *(" ".join(way) for way in WAYS)}
    cases |= {f"row {row.name}" for row in GOOD}
    if request.config.getoption("--record"):
        record.keep(cases)
    assert record.cases() == cases
