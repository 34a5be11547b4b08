"""Value clips over chunks: USD reads through them what it reads of the layer that copies all samples."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdUtils
from test_chunks import FRAMES, SHORT, STILL, parts, ranges, saved_shot

import stages
from skinslide import StageProblems, UsageError, bake_to_file, check, stitch
from skinslide.command.cli import main
from stages import MESH

MESHES = (MESH, SHORT, STILL)


@pytest.fixture
def shot(tmp_path):
    return saved_shot(tmp_path / "shot.usda")


def above(layer, shot) -> Usd.Stage:
    root = Sdf.Layer.CreateAnonymous(".usda")
    root.timeCodesPerSecond = 24
    root.subLayerPaths = [str(layer), str(shot)]
    stage = Usd.Stage.Open(root)
    stage.held = root
    return stage


def values(stage: Usd.Stage) -> dict:
    """The samples of every attribute of every mesh, and its values at, between and beyond them."""
    found = {}
    times = [FRAMES[0] - 1, *FRAMES, *(frame + 0.25 for frame in FRAMES)]
    for path in MESHES:
        for attribute in stage.GetPrimAtPath(path).GetAttributes():
            read = [attribute.Get(Usd.TimeCode(time)) for time in times]
            contents = [None if value is None else np.array(value).tobytes() for value in read]
            found[f"{path}.{attribute.GetName()}"] = (attribute.GetTimeSamples(), contents)
    return found


def assert_same(chunks, shot, folder) -> None:
    stitch(chunks, folder / "joined.usdc")
    report = stitch(chunks, folder / "out.usda", clips=True)
    assert report.frames == FRAMES
    assert values(above(folder / "out.usda", shot)) == values(above(folder / "joined.usdc", shot))
    assert not Sdf.Layer.OpenAsAnonymous(str(folder / "out.usda")).ListAllTimeSamples()


@pytest.mark.parametrize("count", [1, 3, 8])
def test_clips_are_the_joined_layer(count, shot, tmp_path):
    chunks = parts(shot, tmp_path, count, diagnostics=True)
    assert_same(chunks[::-1], shot, tmp_path)


def test_overlaps(shot, tmp_path):
    assert_same(ranges(shot, tmp_path, "1001-1005", "1004", "1003-1008"), shot, tmp_path)


def test_what_is_blocked(tmp_path):
    def edit(stage):
        velocities = stage.GetPrimAtPath(MESH).GetAttribute("velocities")
        velocities.Set(stages.vectors(np.zeros((5, 3))), FRAMES[-1])

    shot = saved_shot(tmp_path / "shot.usda", edit)
    assert_same(ranges(shot, tmp_path, "1001-1004", "1005-1008"), shot, tmp_path)


def test_they_are_moved_together(shot, tmp_path):
    (tmp_path / "a").mkdir()
    stitch(parts(shot, tmp_path / "a"), tmp_path / "a" / "out.usda", clips=True)
    expected = values(above(tmp_path / "a" / "out.usda", shot))
    (tmp_path / "a").rename(tmp_path / "b")
    assert values(above(tmp_path / "b" / "out.usda", shot)) == expected


def test_a_bake_does_not_slide_clips_of_a_bake(shot, tmp_path):
    stitch(parts(shot, tmp_path), tmp_path / "out.usda", clips=True)
    stage = above(tmp_path / "out.usda", shot)
    assert check(stage).failed
    with pytest.raises(StageProblems, match=r"out\.usda"):
        bake_to_file(stage, tmp_path / "again.usda")


def test_what_does_not_fit_is_refused(shot, tmp_path):
    chunks = parts(shot, tmp_path)
    with pytest.raises(StageProblems, match="2 frames are in none"):
        stitch(chunks[1:], tmp_path / "out.usda", clips=True)
    assert not list(tmp_path.glob("out.*"))
    stitch(chunks, tmp_path / "out.usda", clips=True)
    with pytest.raises((StageProblems, UsageError), match=r"out\.usda"):
        stitch([tmp_path / "out.usda"], tmp_path / "more.usda")


# Ends the process at once, as a machine that goes down would, when files were put in place so many times.
KILLED = """
import os, signal, sys
from skinslide import stitch

count, output, *chunks = sys.argv[1:]
left, replace = [int(count)], os.replace

def replacing(*names):
    replace(*names)
    left[0] -= 1
    if not left[0]:
        os.kill(os.getpid(), signal.SIGKILL)

os.replace = replacing
stitch(chunks, output, clips=True)
"""


@pytest.mark.parametrize("count", [1, 2])
def test_a_kill_leaves_all_as_it_was_or_whole(count, shot, tmp_path):
    """The older layer has attributes that the manifest of the new one does not list."""
    folders = [tmp_path / name for name in ("older", "newer")]
    older, newer = (parts(shot, make(folder), diagnostics=folder.name == "older") for folder in folders)
    read = []
    for chunks in (newer, older):
        stitch(chunks, tmp_path / "out.usda", clips=True)
        read.append(values(above(tmp_path / "out.usda", shot)))
    words = [str(count), str(tmp_path / "out.usda"), *map(str, newer)]
    killed = subprocess.run([sys.executable, "-c", KILLED, *words], capture_output=True)
    assert killed.returncode == -signal.SIGKILL, killed.stderr
    assert values(above(tmp_path / "out.usda", shot)) == read[count == 1]
    stitch(newer, tmp_path / "out.usda", clips=True)
    assert values(above(tmp_path / "out.usda", shot)) == read[0] != read[1]


def make(folder):
    folder.mkdir()
    return folder


@pytest.mark.parametrize("clips", [True, False])
def test_a_chunk_that_is_being_written(clips, shot, tmp_path, monkeypatch):
    chunks = parts(shot, tmp_path)
    stitch_layers = UsdUtils.StitchLayers

    def meanwhile(*layers):
        os.utime(chunks[0], (1, 1))
        stitch_layers(*layers)

    monkeypatch.setattr(UsdUtils, "StitchLayers", meanwhile)
    with pytest.raises(StageProblems, match=f"{chunks[0]} is being written"):
        stitch(chunks, tmp_path / "out.usda", clips=clips)
    assert not list(tmp_path.glob("out.*"))


def test_a_chunk_called_as_the_manifest_stays(shot, tmp_path):
    stitch(parts(shot, tmp_path), tmp_path / "out.usda", clips=True)
    (manifest,), rest = tmp_path.glob("out.manifest.*.usda"), tmp_path / "rest.usda"
    (tmp_path / "out.usda").unlink()
    bake_to_file(shot, manifest, chunk="1/2")
    bake_to_file(shot, rest, chunk="2/2")
    before = manifest.read_bytes()
    with pytest.raises(UsageError, match=f"output {manifest}: is one of the chunks"):
        stitch([manifest, rest], tmp_path / "out.usda", clips=True)
    assert manifest.read_bytes() == before and not (tmp_path / "out.usda").exists()


def test_command(shot, tmp_path, capfd):
    chunks = parts(shot, tmp_path)
    out = tmp_path / "out.usda"
    assert main(["stitch", *map(str, chunks), "-o", str(out), "--clips", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["frames"] == FRAMES
    (manifest,) = tmp_path.glob("out.manifest.*")
    assert sorted(tmp_path.glob("out.*")) == [manifest, out] and manifest.name in out.read_text()


def test_an_earlier_manifest_stays(shot, tmp_path):
    """A copy of the earlier layer names it, and whoever has that open reads it when it first needs it."""
    out, copy = tmp_path / "out.usda", tmp_path / "copy.usda"
    older, newer = (parts(shot, make(tmp_path / name), diagnostics=name == "older") for name in ("older", "newer"))
    stitch(older, out, clips=True)
    copy.write_bytes(out.read_bytes())
    read = values(above(copy, shot))
    stitch(newer, out, clips=True)
    assert values(above(copy, shot)) == read != values(above(out, shot))
    manifests = sorted(tmp_path.glob("out.manifest.*"))
    stitch(newer, out, clips=True)
    assert sorted(tmp_path.glob("out.manifest.*")) == manifests and len(manifests) == 2
