"""The table of rules: what must hold of its numbers, and the same by the core."""

import pytest
from pxr import Usd

import stages
from repository import load
from skinslide.arrays.setups import Sample
from skinslide.stage.reading import read_meshes


@pytest.fixture(scope="module")
def rules():
    return load("measure/rules.py")


def test_shares_are_of_what_can_be_removed(rules, example_stage):
    """No rule beats a search that starts where the rule ends, and one that comes near removes nearly all."""
    rows = {row[1]: dict(zip(rules.HEADINGS, row, strict=True)) for row in rules.rows(example_stage("finger"))}
    assert list(rows) == ["unit", "even", "relaxed"]
    for row in rows.values():
        assert 0 < float(row["share min"]) <= float(row["median"]) <= 1 and row["folds"] == "0"
    assert float(rows["relaxed"]["median"]) > float(rows["unit"]["median"])


def test_the_core_measures_the_same_roughness(rules, example_stage):
    mesh = read_meshes(Usd.Stage.Open(str(example_stage("finger"))))[0][0]
    for rule, slider in rules.sliders_of(mesh, rules.RULES).items():
        poses = [(time, mesh.points_at(Usd.TimeCode(time))) for time in mesh.sample_times()]
        samples = [Sample(time, points, slider.slide(points).points) for time, points in poses]
        found = [slider.roughness(three)[0] for three in zip(samples, samples[1:], samples[2:], strict=False)]
        ratio = max(each.after for each in found) / max(each.before for each in found)
        assert rules.roughness(mesh)[rule][0] == f"{ratio:.2f}"


def test_rules_that_cannot_slide_a_patch_are_left_out(rules):
    """As those of the paper cannot, on a closed surface."""
    mesh = read_meshes(stages.patched_stage(stages.box())[0])[0][0]
    assert list(rules.sliders_of(mesh, rules.RULES)) == ["even", "relaxed"]
