"""Outputs: where one may not be, above all not on what the stage reads, and how it is put in place."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdGeom

import stages
from skinslide import StageError, UsageError, bake_to_file, setup_to_file
from skinslide.command.cli import main
from skinslide.write import overs
from stages import FRAMES, MESH


@pytest.fixture
def shot(tmp_path):
    stage, _mesh = stages.patched_stage()
    return stages.save(stage, tmp_path / "shot.usda")


def refused(shot: Path, output: Path, message: str = "the stage reads this file") -> None:
    """Asserts that neither a bake nor a set-up replaces the output."""
    before = output.read_bytes() if os.path.isfile(output) else None
    with pytest.raises(UsageError, match=message):
        bake_to_file(shot, output)
    with pytest.raises(UsageError, match=message):
        setup_to_file(shot, output, MESH, "another", faces="0-3", force=True)
    assert before == (output.read_bytes() if os.path.isfile(output) else None)


# ---- What the stage reads ----


@pytest.mark.parametrize("template", [False, True])
@pytest.mark.parametrize("name", ["shot.usda", "shot.skinslide"])
def test_value_clips(template, name, tmp_path):
    stage, api = stages.clipped_stage(tmp_path)
    if template:
        stages.use_clip_template(api)
    else:
        api.SetClipAssetPaths([Sdf.AssetPath(f"./clip.{frame:.0f}.usda") for frame in FRAMES])
        api.SetClipActive([(frame, index) for index, frame in enumerate(FRAMES)])
        api.SetClipTimes([(frame, frame) for frame in FRAMES])
    (tmp_path / name).write_text(stage.GetRootLayer().ExportToString())
    for read in ("clip.1001.usda", "clip.1003.usda", "manifest.usda"):
        before = (tmp_path / read).read_bytes()
        with pytest.raises(UsageError, match="the stage reads this file"):
            bake_to_file(tmp_path / name, tmp_path / read)
        assert (tmp_path / read).read_bytes() == before
    # Not of the template, for all that it looks like it: twice, since the second time it is there.
    for _ in range(2):
        bake_to_file(tmp_path / name, tmp_path / "clip.slid.usda")


def test_variants_that_are_not_selected(tmp_path):
    stage, _mesh = stages.patched_stage()
    cache = stages.save(stage, tmp_path / "a.usda")
    stages.save(stage, tmp_path / "b.usda")
    below = stages.save(stage, tmp_path / "c#1.usda")
    text = cache.read_text().replace("#usda 1.0\n(", f"#usda 1.0\n(\n    subLayers = [@{below.name}@]", 1)
    (tmp_path / "b.usda").write_text(text)
    (tmp_path / "shot.usda").write_text(
        '#usda 1.0\n(\n    timeCodesPerSecond = 24\n)\ndef "World" (\n    variants = { string take = "a" }\n'
        '    variantSets = "take"\n)\n{\n    variantSet "take" = {\n'
        '        "a" ( payload = @./a.usda@ ) { }\n        "b" ( payload = @./b.usda@ ) { }\n    }\n}\n'
    )
    for read in ("a", "b", "c#1"):
        refused(tmp_path / "shot.usda", tmp_path / f"{read}.usda")


@pytest.mark.parametrize("texture", ["skin.<UDIM>.png", "gone.<UDIM>.png", "gone.png"])
def test_nothing_is_said_of_textures(texture, tmp_path, capfd):
    """Textures are often not where the shot is, and do not concern a bake."""
    stage, _mesh = stages.patched_stage()
    shader = stage.DefinePrim("/World/skin", "Shader")
    shader.CreateAttribute("inputs:file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(f"./{texture}"))
    shot = stages.save(stage, tmp_path / "shot.usda")
    (tmp_path / "skin.1001.png").touch()
    for _ in range(2):  # the second time it might be what the stage reads
        assert main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 0
    assert capfd.readouterr() == ("", "")


def test_an_input_that_appears_while_it_is_read(shot, tmp_path, monkeypatch):
    """A file that does not exist when the bake starts can still be a clip that the stage reads at the end."""
    output = tmp_path / "late.usda"

    def read_late(_done: int, _total: int) -> None:
        if not output.exists():
            stages.save(Usd.Stage.CreateInMemory(), output)
            read.append(Sdf.Layer.FindOrOpen(str(output)))

    read: list[Sdf.Layer] = []
    used = Usd.Stage.GetUsedLayers
    monkeypatch.setattr(Usd.Stage, "GetUsedLayers", lambda stage: [*used(stage), *read])
    with pytest.raises(UsageError, match="the stage reads this file"):
        bake_to_file(shot, output, progress=read_late)
    assert output.read_text().startswith("#usda")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["late.usda", "shot.usda"]


def test_a_set_up_that_is_in_the_way(shot, tmp_path):
    setup_to_file(shot, tmp_path / "patches.usda", MESH, "more", faces="0-3")
    (tmp_path / "top.usda").write_text("#usda 1.0\n(\n    subLayers = [@./patches.usda@]\n)\n")
    refused(tmp_path / "top.usda", tmp_path / "patches.usda")
    # The stage that it sits on does not read it.
    setup_to_file(shot, tmp_path / "patches.usda", MESH, "again", faces="0-3")


# ---- What is no place for a file ----


def test_names(shot, tmp_path):
    refused(shot, tmp_path / ("n" * 300 + ".usda"), "name too long|too long")
    refused(shot, tmp_path / ("n" * 245 + ".usda"), "the name is too long")
    for extension in (".usda", ".usdc"):  # the longest that can be
        longest = tmp_path / ("n" * (238 - len(extension)) + extension)
        bake_to_file(shot, longest)
        setup_to_file(shot, longest, MESH, "more", faces="0-3", force=True)
        refused(shot, longest.with_name(f"n{longest.name}"), "the name is too long")
    refused(shot, tmp_path / "a\0b.usda", "null")
    refused(shot, Path(""), "must end in")
    bake_to_file(shot, tmp_path / "OUT.USDA")
    assert (tmp_path / "OUT.USDA").read_text().startswith("#usda")
    bake_to_file(shot, tmp_path / "OUT.UsdC")
    assert Sdf.Layer.FindOrOpen(str(tmp_path / "OUT.UsdC")).GetFileFormat().formatId == "usdc"


def test_links(shot, tmp_path):
    (tmp_path / "circle.usda").symlink_to("circle.usda")
    refused(shot, tmp_path / "circle.usda", "loop|links")
    (tmp_path / "format.usda").symlink_to("real.usdc")
    refused(shot, tmp_path / "format.usda", "another format")
    (tmp_path / "way.usda").symlink_to("gone/real.usda")
    refused(shot, tmp_path / "way.usda", "does not exist")


def test_pipes(shot, tmp_path):
    os.mkfifo(tmp_path / "pipe.usda")
    refused(shot, tmp_path / "pipe.usda", "not a regular file")
    with pytest.raises(StageError, match="not a regular file"):
        bake_to_file(tmp_path / "pipe.usda", tmp_path / "out.usda")


def sublayer(file):
    return f"#usda 1.0\n(\n    subLayers = [@./{file}@]\n)\n"


def prim(metadata):
    return f'#usda 1.0\n(\n    defaultPrim = "World"\n)\ndef "World" (\n{metadata}\n)\n{{\n}}\n'


def with_clips(files):
    return prim(f'clips = {{\ndictionary default = {{\n{files}\nstring primPath = "/World"\n}}\n}}')


PIPE = "pipe.1.usda"
VARIANT = f'{{\n"a" {{\n}}\n"b" (\nreferences = @./{PIPE}@\n) {{\n}}\n}}'
# What a stage names, and what is below.usda.
NAMED = {
    "sublayer": (sublayer(PIPE), ""),
    "sublayer of a sublayer": (sublayer("below.usda"), sublayer(PIPE)),
    "reference": (prim(f"references = @./{PIPE}@"), ""),
    "payload": (prim(f"payload = @./{PIPE}@"), ""),
    "sublayer of a payload": (prim("payload = @./below.usda@"), sublayer(PIPE)),
    "payload of a reference": (prim("references = @./below.usda@"), prim(f"payload = @./{PIPE}@")),
    "reference in a variant": (
        prim('variants = {\nstring v = "a"\n}\nadd variantSets = "v"').replace(
            "{\n}\n", f'{{\nvariantSet "v" = {VARIANT}\n}}\n'
        ),
        "",
    ),
    "expression": (
        '#usda 1.0\n(\nexpressionVariables = {\nstring X = "1"\n}\nsubLayers = [@`"./pipe.${X}.usda"`@]\n)\n',
        "",
    ),
    "clip": (with_clips(f"asset[] assetPaths = [@./{PIPE}@]\ndouble2[] active = [(0, 0)]"), ""),
    "clip of a reference": (prim("references = @./below.usda@"), with_clips(f"asset[] assetPaths = [@./{PIPE}@]")),
    "clip of a template": (with_clips('string templateAssetPath = "./pipe.#.usda"'), ""),
    "manifest": (with_clips(f"asset manifestAssetPath = @./{PIPE}@"), ""),
}


@pytest.mark.parametrize(
    "entry",
    [
        'string default = "here"',
        "dictionary default = {\nint assetPaths = 3\n}",
        'dictionary default = {\nstring[] assetPaths = ["here.usda"]\n}',
        'dictionary default = {\nstring manifestAssetPath = "here.usda"\n}',
        "dictionary default = {\nasset templateAssetPath = @./here.#.usda@\n}",
    ],
)
def test_clips_of_other_types_name_nothing(shot, entry):
    """USD opens such a stage, and reads none of these clips."""
    layer = shot.with_name("clips.usda")
    layer.write_text(f'{sublayer(shot.name)}over "World" (\nclips = {{\n{entry}\n}}\n)\n{{\n}}\n')
    assert main(["check", str(layer)]) == 0


@pytest.mark.parametrize("arc", NAMED)
@pytest.mark.parametrize("extension", ["usda", "skinslide"])
def test_pipes_that_a_stage_leads_to(arc, extension, tmp_path):
    """Opening one would wait for ever, so another process looks."""
    os.mkfifo(tmp_path / PIPE)
    top = tmp_path / f"top.{extension}"
    text, below = NAMED[arc]
    top.write_text(text)
    (tmp_path / "below.usda").write_text(below)
    command = [sys.executable, "-m", "skinslide", "check", str(top)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    named_by = "below.usda" if below else top.name
    assert done.returncode == 1
    assert done.stderr.startswith(f"error: cannot open {tmp_path / PIPE}, which ")
    assert done.stderr.endswith(f"{named_by} names: it is not a regular file\n")


def test_a_folder_that_may_not_be_looked_into(public_folder):
    stage, _mesh = stages.patched_stage()
    shot = stages.save(stage, public_folder / "shot.usda")
    closed, mine = public_folder / "closed", public_folder / "mine.usda"
    closed.mkdir()
    (closed / "in.usda").touch()
    mine.touch()
    mine.chmod(0o444)
    closed.chmod(0)
    with stages.as_nobody():
        refused(shot, closed / "out.usda", "denied")
        refused(shot, mine, "not writable")
        with pytest.raises(StageError, match="cannot open"):
            bake_to_file(closed / "in.usda", public_folder / "out.usda")
    closed.chmod(0o700)


def test_a_working_folder_that_is_gone(shot, tmp_path, monkeypatch, capfd):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert main(["bake", str(shot), "-o", "out.usda"]) == 2
    assert main(["check", "shot.skinslide"]) == 1
    assert all(line.startswith("error: ") for line in capfd.readouterr().err.splitlines())


def test_a_working_folder_deeper_than_a_path_can_be(shot, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    for _ in range(25):
        os.mkdir("d" * 200)
        os.chdir("d" * 200)
    shutil.copy(shot, "shot.usda")
    assert main(["check", str(shot)]) == 0
    assert main(["bake", str(shot), "-o", "out.usda"]) == 2
    assert main(["check", "shot.usda"]) == 1
    for _ in range(25):
        os.chdir("..")
    bake, check = capfd.readouterr().err.splitlines()
    assert bake == "error: output out.usda: its path from the root is too long"
    assert check == "error: cannot open shot.usda: its path from the root is too long"


# ---- Putting it in place ----


def test_bytes_are_on_the_disk_before_the_name_is(shot, tmp_path, monkeypatch):
    calls = []
    fsync, replace = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda number: (calls.append("fsync"), fsync(number)))
    monkeypatch.setattr(os, "replace", lambda *names: (calls.append("replace"), replace(*names)))
    bake_to_file(shot, tmp_path / "out.usda")
    setup_to_file(shot, tmp_path / "patches.skinslide", MESH, "more", faces="0-3")
    assert calls == ["fsync", "replace"] * 2


def test_a_system_that_cannot_be_advised(shot, tmp_path, monkeypatch):
    """Such as macOS."""
    monkeypatch.delattr(os, "posix_fadvise")
    monkeypatch.delattr(os, "POSIX_FADV_DONTNEED")
    bake_to_file(shot, tmp_path / "slid.usdc")
    assert Sdf.Layer.FindOrOpen(str(tmp_path / "slid.usdc"))


def test_the_disk_begins_with_what_is_saved_while_the_rest_is_baked(shot, tmp_path, monkeypatch):
    """Each part where the last one ended, so that nothing is said of bytes twice, and little is left for the end."""
    asked = []
    monkeypatch.setattr(overs, "_UNSAVED_BYTES", 1)
    monkeypatch.setattr(os, "posix_fadvise", lambda file, start, _count, _what: asked.append((start, os.fstat(file))))
    bake_to_file(shot, tmp_path / "out.usdc")
    starts, ends = zip(*((start, file.st_size) for start, file in asked), strict=True)
    assert len(starts) > 2 and starts == (0, *ends[:-1])
    assert {file.st_ino for _, file in asked} == {(tmp_path / "out.usdc").stat().st_ino}


@pytest.mark.parametrize("extension", ["skinslide", "usda", "usdc"])
def test_a_set_up_keeps_the_mode(shot, tmp_path, extension):
    output = tmp_path / f"patches.{extension}"
    output.touch()
    output.chmod(0o640)
    setup_to_file(shot, output, MESH, "more", faces="0-3", force=True)
    assert output.stat().st_mode & 0o777 == 0o640


def test_what_killed_bakes_left_is_removed_after_a_day(shot, tmp_path):
    names = [
        ".out.0123abcd.usdc",
        ".out.0123abcd.usdc.tmpXY",
        ".out.0123abcd.rbsRVw",
        ".out.89abcdef.usdc",
        ".out.words.usdc",
        ".out.20260101.backup",
        ".other.0123abcd.usdc",
    ]
    for name in names:
        (tmp_path / name).touch()
    for name in [*names[:3], *names[4:]]:
        os.utime(tmp_path / name, (0, time.time() - 2 * 24 * 3600))
    bake_to_file(shot, tmp_path / "out.usdc")
    assert sorted(path.name for path in tmp_path.iterdir() if path.name.startswith(".")) == sorted(names[3:])


def test_a_fault_of_the_stage_is_not_blamed_on_the_output(shot, tmp_path, monkeypatch):
    """USD raises the same kind of error, whichever file it is about."""

    def fail(*_arguments):
        Sdf.Layer.CreateAnonymous(".usda").ImportFromString("words")

    monkeypatch.setattr(UsdGeom.PointBased, "GetExtentAttr", fail)
    with pytest.raises(Exception) as raised:
        bake_to_file(shot, tmp_path / "out.usda")
    assert "out.usda" not in str(raised.value)


def test_usd_errors_are_messages(shot, tmp_path, monkeypatch, capfd):
    def fail(*_arguments):
        Sdf.Layer.CreateAnonymous(".usda").ImportFromString("words")

    monkeypatch.setattr(UsdGeom.PointBased, "GetExtentAttr", fail)
    assert main(["bake", str(shot), "-o", str(tmp_path / "out.usda"), "--quiet"]) == 1
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith("error: USD: ") and "out.usda" not in line


@pytest.mark.parametrize("output", ["words.usda", "words.skinslide", "bytes.skinslide", "empty.usda", "image.usdc"])
def test_a_set_up_over_what_is_no_layer(shot, tmp_path, output):
    content = {"words": b"words", "bytes": b"\xff\xfe\x00", "empty": b"", "image": b"PXR-USDC\x00\x00\x00"}
    (tmp_path / output).write_bytes(content[output.split(".")[0]])
    with pytest.raises(UsageError, match="--force replaces it"):
        setup_to_file(shot, tmp_path / output, MESH, "more", faces="0-3")
    setup_to_file(shot, tmp_path / output, MESH, "more", faces="0-3", force=True)
