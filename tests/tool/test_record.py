"""The record of a bake: as its schema says, with all that check warns of, and all that a limit is compared with."""

import json

import jsonschema
import numpy as np
import pytest

import skinslide
import stages
from repository import ROOT
from skinslide import FrameProblem, UsageError, bake_to_file
from skinslide.command.cli import main
from stages import FRAMES, MESH, PATCH

SCHEMA = json.loads((ROOT / "plugin/python/skinslide/shot/record.schema.json").read_text())
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


@pytest.fixture
def shot(tmp_path):
    """A stage with a setting that has no effect, and a second patch over the first, which cannot slide."""
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "grow", 0.1)
    stages.add_patch(mesh, stages.block(6, range(2), range(1)), "strip")
    return stages.save(stage, tmp_path / "shot.usda")


def told(capfd, *words) -> dict:
    assert main([*map(str, words), "--json"]) == 0
    document = json.loads(capfd.readouterr().out)
    VALIDATOR.validate(document)
    return document


def test_the_schema_is_one():
    VALIDATOR.check_schema(SCHEMA)
    described = set(SCHEMA["$defs"]["result"]["properties"])
    stage, _mesh = stages.patched_stage()
    (patch,) = skinslide.bake(stage).as_dict()["meshes"][0]["patches"]
    assert set(patch["frames"][0]) == described, "every member of a frame is in the schema"
    assert set(SCHEMA["$defs"]["patch"]["properties"]) <= set(patch)


def test_records_are_as_the_schema_says(shot, tmp_path, capfd):
    out = tmp_path / "out.usdc"
    record = told(capfd, "bake", shot, "-o", out, "--share")
    assert (record["record"], record["resumed"], record["output"]) == (1, False, str(out))
    told(capfd, "bake", shot, "-o", out, "--frames", "1002", "--pictures", tmp_path / "p", "--size", "64x64")
    bake_to_file(shot, out)
    again = told(capfd, "bake", shot, "-o", out, "--resume")
    assert again["resumed"] and not again["meshes"] and set(again["worst"].values()) == {None}


def test_the_worst_is_where_the_frames_have_it(shot, tmp_path, capfd):
    record = told(capfd, "bake", shot, "-o", tmp_path / "out.usdc")
    frames = [(frame, patch["name"]) for patch in record["meshes"][0]["patches"] for frame in patch["frames"]]
    measures = {
        "folded": lambda frame: frame["folded_faces"],
        "clamped": lambda frame: frame["clamped_vertices"],
        "stretch": lambda frame: frame["stretch_after"],
        "added_stretch": lambda frame: frame["stretch_after"] - frame["stretch_before"],
    }
    for name, measure in measures.items():
        worst = record["worst"][name]
        assert worst["value"] == max(measure(frame) for frame, _ in frames) and worst["prim"] == MESH
        (there,) = (frame for frame, patch in frames if (frame["frame"], patch) == (worst["frame"], worst["patch"]))
        assert measure(there) == worst["value"]
    assert record["worst"]["roughness"]["value"] == max(p["roughness"] for p in record["meshes"][0]["patches"])


def test_what_check_warns_of_is_in_it(shot, tmp_path):
    def warnings(problems):
        return {str(problem) for problem in problems if problem.severity != "error"}

    checked = warnings(skinslide.check(shot).problems)
    assert any("nothing can slide" in said for said in checked)
    assert any("has no effect" in said for said in checked)
    assert any("overlaps patch" in said for said in checked)
    assert checked <= warnings(bake_to_file(shot, tmp_path / "out.usdc").problems)


@pytest.mark.parametrize(
    ("limit", "says"),
    [
        ("stretch", r"stretch of \d\.\d{4}, where at most .* is allowed"),
        ("added_stretch", r"stretch \d\.\d{4} above that of the cache, where at most .* is allowed"),
    ],
)
def test_limits_of_stretch(limit, says, tmp_path):
    """A limit lets pass the worst there is, and fails a little below. The rule fast adds stretch at a lifted vertex."""
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "forceDensityRule", "fast")
    for frame in FRAMES:
        points = stages.grid().points.copy()
        points[24, 2] += (frame - FRAMES[0]) / 4
        mesh.GetPointsAttr().Set(stages.vectors(points), frame)
    out = tmp_path / "out.usda"
    worst = bake_to_file(stage, out).as_dict()["worst"][limit]
    assert worst["value"] > 0.01
    bake_to_file(stage, out, **{f"max_{limit}": worst["value"]})
    before = out.read_bytes()
    with pytest.raises(FrameProblem, match=says) as raised:
        bake_to_file(stage, out, **{f"max_{limit}": worst["value"] * (1 - 1e-9)})
    assert (raised.value.problem.prim, raised.value.problem.frame) == (MESH, worst["frame"])
    assert out.read_bytes() == before


@pytest.mark.parametrize("limit", ["max_stretch", "max_added_stretch"])
def test_limits_that_cannot_be(limit, tmp_path):
    stage, _mesh = stages.patched_stage()
    for bad in (-0.1, np.nan, np.inf):
        with pytest.raises(UsageError, match=f"{limit} is .*; it must be 0 or more"):
            bake_to_file(stage, tmp_path / "out.usda", **{limit: bad})
    with pytest.raises(UsageError, match="must be a number"):
        bake_to_file(stage, tmp_path / "out.usda", **{limit: "much"})


def test_a_limit_that_fails_is_a_problem(shot, tmp_path, capfd):
    assert main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--max-stretch", "0.001", "--json"]) == 1
    (problem,) = json.loads(capfd.readouterr().out)["problems"]
    assert (problem["severity"], problem["prim"], problem["patch"]) == ("error", MESH, PATCH)
