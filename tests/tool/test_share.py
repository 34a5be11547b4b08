"""The share of the stretch that can be removed: what a bake reports of it, where it is asked for."""

import json

import numpy as np
import pytest

from repository import load
from shots import COUNTS, FACES, INDICES, OFFSET, REST, pose
from skinslide import PatchSetup, Slider, bake_to_file, check
from skinslide.command.cli import main


def test_shares_are_told_where_they_are_asked_for(shot, out, capsys):
    assert main(["bake", str(shot.save().path), "-o", str(out), "--json", "--quiet", "--share"]) == 0
    (mesh,) = json.loads(capsys.readouterr().out)["meshes"]
    (patch,) = mesh["patches"]
    for frame in patch["frames"]:
        before, after, least = (frame[name] for name in ("stretch_before", "stretch_after", "least_stretch"))
        assert 0 < least <= before
        assert frame["share"] == pytest.approx((before - after) / (before - min(least, after)))
    shares = [frame["share"] for frame in patch["frames"]]
    assert (patch["least_share"], patch["median_share"]) == (min(shares), np.median(shares))
    assert 0 < patch["least_share"] < 1


def test_nothing_is_searched_for_unasked(shot, out):
    report = bake_to_file(shot.save().path, out)
    patch = report.meshes[0].patches[0].as_dict()
    assert patch["least_share"] is patch["median_share"] is patch["frames"][0]["share"] is None
    assert "can be removed" not in report.text()
    assert "of the stretch that can be removed" in bake_to_file(shot.path, out, share=True).text()


def test_a_check_says_the_same_of_shares(shot, out, capsys):
    baked = bake_to_file(shot.save().path, out, share=True).meshes[0].patches[0]
    assert main(["check", str(shot.path), "--share", "--json", "--jobs", "2"]) == 0
    (found,) = json.loads(capsys.readouterr().out)["shares"]
    assert found["patch"] == baked.label
    assert (found["least"], found["median"]) == (min(baked.shares), np.median(baked.shares))
    assert "of the stretch that can be removed, 0." in check(shot.path, share=True).text()
    assert check(shot.path).shares == []


def test_points_and_jobs_do_not_depend_on_it(shot, out):
    bake_to_file(shot.save().path, out)
    plain = out.read_bytes()
    found = [bake_to_file(shot.path, out, share=True, jobs=jobs).meshes[0].patches[0].least for jobs in (1, 4)]
    assert found[0] == found[1] and list(found[0]) == [OFFSET + frame for frame in range(1, 6)]
    assert out.read_bytes() == plain


def test_another_search_finds_as_little():
    """By closest points in space, where the core walks over the pose: both end where no step leads down."""
    share = load("measure/share.py")
    slider = Slider(COUNTS, INDICES, REST, [PatchSetup("sheet", np.arange(FACES), rule="relaxed")])
    points = pose(3)
    polygons = INDICES.reshape(-1, 4)
    sides = np.sort(np.concatenate([polygons[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    fans = np.concatenate([polygons[:, [0, 1, 2]], polygons[:, [0, 2, 3]]])
    free = np.setdiff1d(np.arange(len(REST)), edges[uses == 1])
    skin = share.Skin(REST.astype(float), np.arange(len(REST)), edges, fans, free)
    deformed, slid = points.astype(float), slider.slide(points).points.astype(float)
    expected = min(share.Search(skin).lowest(start, deformed) for start in (deformed, slid))
    cache = skin.stretch(deformed)
    (least,) = slider.least_stretch(points)
    assert cache - least == pytest.approx(cache - expected, rel=0.02)
