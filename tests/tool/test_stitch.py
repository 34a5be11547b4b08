"""Stitched chunks are the bake of the whole; chunks that do not fit together are refused."""

import shutil

import numpy as np
import pytest
from pxr import Sdf, Usd

import skinslide
import stages
from skinslide import StageError, StageProblems, UsageError, bake_to_file, stitch
from skinslide.command.cli import main
from stages import FRAMES, MESH

NAMES = ("points", "extent", "velocities", "normals")
OTHER = "/World/prop/still_GEO"


@pytest.fixture
def shot(tmp_path):
    """A mesh with rates and normals, and one without samples, whose bake is a default."""
    stage, mesh = stages.patched_stage()
    for frame in FRAMES:
        mesh.CreateVelocitiesAttr().Set(stages.vectors(np.zeros((49, 3))), frame)
        mesh.CreateNormalsAttr().Set(stages.vectors(np.tile([0, 0, 1], (49, 1))), frame)
    mesh.SetNormalsInterpolation("vertex")
    still = stages.add_mesh(stage, stages.grid(), OTHER, frames=[], rest="Pref")
    still.GetPointsAttr().Set(stages.vectors(stages.grid().moved(FRAMES[2])))
    stages.add_patch(still, stages.annulus())
    return stages.save(stage, tmp_path / "shot.usda")


@pytest.fixture
def chunks(shot, tmp_path):
    paths = [tmp_path / f"chunk{i}.usdc" for i in range(2)]
    for path, frames in zip(paths, ("1001-1002", "1003"), strict=True):
        bake_to_file(shot, path, frames=frames)
    return paths


def arrays(path, name: str) -> dict[float, bytes]:
    layer, at = Sdf.Layer.OpenAsAnonymous(str(path)), f"{MESH}.{name}"
    return {time: np.array(layer.QueryTimeSample(at, time)).tobytes() for time in layer.ListTimeSamplesForPath(at)}


@pytest.mark.parametrize("extension", [".usda", ".usdc", ".usd"])
def test_stitched_chunks_are_the_whole(shot, chunks, tmp_path, extension):
    bake_to_file(shot, tmp_path / f"whole{extension}")
    report = stitch(chunks, tmp_path / f"stitched{extension}")
    assert (report.prims, report.frames, report.problems) == ([MESH, OTHER], list(FRAMES), [])
    for name in NAMES:
        whole = arrays(tmp_path / f"whole{extension}", name)
        assert len(whole) == 3 and arrays(tmp_path / f"stitched{extension}", name) == whole
    texts = [Sdf.Layer.OpenAsAnonymous(str(tmp_path / f"{name}{extension}")) for name in ("whole", "stitched")]
    assert texts[0].ExportToString() == texts[1].ExportToString()
    stage = Usd.Stage.Open(str(tmp_path / f"stitched{extension}"))
    assert stage.GetPrimAtPath(OTHER).GetAttribute("points").Get() is not None


def test_the_order_does_not_matter(chunks, tmp_path):
    stitch(chunks, tmp_path / "there.usdc")
    stitch(reversed(chunks), tmp_path / "back.usdc")
    for name in NAMES:
        assert arrays(tmp_path / "there.usdc", name) == arrays(tmp_path / "back.usdc", name)


def test_frames_that_chunks_share_must_be_equal(shot, chunks, tmp_path):
    bake_to_file(shot, tmp_path / "more.usdc", frames="1002-1003")
    stitch([*chunks, tmp_path / "more.usdc"], tmp_path / "out.usdc")
    layer = Sdf.Layer.FindOrOpen(str(tmp_path / "more.usdc"))
    points = np.array(layer.QueryTimeSample(f"{MESH}.points", 1002.0))
    points[20] += 1
    layer.SetTimeSample(f"{MESH}.points", 1002.0, stages.vectors(points))
    layer.Save()
    before = (tmp_path / "out.usdc").read_bytes()
    with pytest.raises(
        StageProblems, match=f"{MESH}: frame 1002: points differs between .*chunk0.usdc and .*more.usdc"
    ):
        stitch([*chunks, tmp_path / "more.usdc"], tmp_path / "out.usdc")
    assert (tmp_path / "out.usdc").read_bytes() == before


def test_what_one_chunk_blocks_is_blocked(shot, tmp_path):
    """A bake of all frames would block it too."""
    stage = Usd.Stage.Open(str(shot))
    velocities = stage.GetPrimAtPath(MESH).GetAttribute("velocities")
    velocities.Set(stages.vectors(np.zeros((5, 3))), FRAMES[2])
    stage.Save()
    paths = [tmp_path / f"chunk{i}.usda" for i in range(2)]
    bake_to_file(shot, paths[0], frames="1001-1002")
    bake_to_file(shot, paths[1], frames="1003")
    bake_to_file(shot, tmp_path / "whole.usda")
    report = stitch(paths, tmp_path / "stitched.usda")
    (problem,) = report.problems
    assert problem.message == f"velocities is blocked at all frames, as in {paths[1]}"
    assert (tmp_path / "stitched.usda").read_text() == (tmp_path / "whole.usda").read_text()


def spoil_clock(layer: Sdf.Layer) -> None:
    layer.timeCodesPerSecond = 25


def spoil_prims(layer: Sdf.Layer) -> None:
    del layer.GetPrimAtPath("/World/prop").nameChildren["still_GEO"]


def spoil_default(layer: Sdf.Layer) -> None:
    layer.GetAttributeAtPath(f"{OTHER}.points").default = stages.vectors(np.zeros((49, 3)))


@pytest.mark.parametrize(
    ("spoil", "says"),
    [(spoil_clock, "timeCodesPerSecond"), (spoil_prims, f"{OTHER}: extent is in"), (spoil_default, "points differs")],
)
def test_chunks_of_different_stages(spoil, says, chunks, tmp_path):
    layer = Sdf.Layer.FindOrOpen(str(chunks[1]))
    spoil(layer)
    layer.Save()
    with pytest.raises(StageProblems, match=says):
        stitch(chunks, tmp_path / "out.usdc")
    assert not (tmp_path / "out.usdc").exists()


def test_chunks_that_are_none(shot, chunks, tmp_path):
    words = tmp_path / "words.usda"
    words.write_text("words")
    for bad in (tmp_path / "gone.usdc", words):
        with pytest.raises(StageError, match=f"cannot open {bad}"):
            stitch([chunks[0], bad], tmp_path / "out.usdc")
    with pytest.raises(UsageError, match="is not a layer that skinslide bake has written"):
        stitch([chunks[0], shot], tmp_path / "out.usdc")
    with pytest.raises(UsageError, match="is one of the chunks"):
        stitch(chunks, chunks[0])
    link = tmp_path / "link.usdc"
    link.symlink_to(chunks[0])
    for again, message in ((chunks[0], "is given twice$"), (link, f"is given twice, as {chunks[0]}")):
        with pytest.raises(UsageError, match=f"chunk {again}: {message}"):
            stitch([*chunks, again], tmp_path / "out.usdc")
    for bad in (3, None, chunks[0], str(chunks[0]), [3]):
        with pytest.raises(UsageError, match=r"chunks is .*; it must be paths of layers"):
            stitch(bad, tmp_path / "out.usdc")
    with pytest.raises(UsageError, match="no chunks"):
        stitch([], tmp_path / "out.usdc")
    with pytest.raises(UsageError, match="must end in"):
        stitch(chunks, tmp_path / "out.abc")
    assert not (tmp_path / "out.usdc").exists()


def test_a_bake_does_not_slide_what_was_stitched(shot, chunks, tmp_path):
    stitch(chunks, tmp_path / "stitched.usdc")
    shutil.copy(shot, tmp_path / "cache.usda")
    (tmp_path / "top.usda").write_text("#usda 1.0\n(\n    subLayers = [@./stitched.usdc@, @./cache.usda@]\n)\n")
    assert skinslide.check(tmp_path / "top.usda").failed


def test_command(chunks, tmp_path, capfd):
    assert main(["stitch", *map(str, chunks), "-o", str(tmp_path / "out.usdc")]) == 0
    said = capfd.readouterr().out.splitlines()
    assert said[0] == "2 meshes, 3 frames, 1001 to 1003" and said[-1].startswith(f"{tmp_path / 'out.usdc'}: written")
    assert main(["stitch", str(chunks[0]), "-o", str(chunks[0])]) == 2
    assert "is one of the chunks" in capfd.readouterr().err
