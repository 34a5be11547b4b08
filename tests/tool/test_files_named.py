"""Each file that a command writes is named once it is done: by itself, or by the folder that was asked for."""

import numpy as np
import pytest
from pxr import Sdf, Vt

import stages
from skinslide.command.cli import main
from stages import MESH, PATCH

BAKE = "bake shot.usda --frames 1001:1002"
CHUNKS = [f"{BAKE} -o {k}.usda --chunk {k}/2" for k in (1, 2)]
SETUP = f"setup shot.usda -o live.skinslide --prim {MESH} --patch other --faces 0-8"
DRAWN = "--size 32x16 --view stretch"
# Commands, of which the last is looked at, and how the files begin that this one writes.
COMMANDS = {
    "bake": ([f"{BAKE} -o a.usda"], ["a.usda"]),
    "bake with all": (
        [f"{BAKE} -o a.usda --html page.html --pictures drawn --maps maps --map-size 16 {DRAWN}"],
        ["a.usda", "drawn", "maps", "page.html"],
    ),
    "preview": ([f"preview shot.usda -o drawn --html page.html --frames 1001 {DRAWN}"], ["drawn", "page.html"]),
    "maps": (["maps shot.usda -o maps --size 16 --strain --frames 1001"], ["maps"]),
    "setup": ([SETUP], ["live.skinslide"]),
    "setup with a payload": ([f"{SETUP} --payload hero.usda"], ["hero.usda", "live.skinslide"]),
    "paint": ([f"paint shot.usda -o p.usda --prim {MESH} --patch {PATCH} --primvar mask --value 2"], ["p.usda"]),
    "mirror": (
        [f"mirror shot.usda -o m.usda --prim {MESH} --patch {PATCH} --to other --axis z --tolerance 9"],
        ["m.usda"],
    ),
    "stitch": ([*CHUNKS, "stitch 1.usda 2.usda -o a.usda"], ["a.usda"]),
    "stitch with clips": ([*CHUNKS, "stitch 1.usda 2.usda -o a.usda --clips"], ["a.manifest.", "a.usda"]),
    "farm": (["farm shot.usda -o a.usda --chunk 1"], ["a.openjd.json"]),
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    stage, mesh = stages.patched_stage()
    stages.set_primvar(mesh, "mask", Sdf.ValueTypeNames.FloatArray, "vertex", np.ones(49, np.float32))
    st = Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(stages.grid().points[:, :2] + 0.5))
    stages.set_primvar(mesh, "st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex", st)
    stages.save(stage, tmp_path / "shot.usda")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(folder):
    return {each.name for each in folder.iterdir()}


@pytest.mark.parametrize(("commands", "begin"), COMMANDS.values(), ids=COMMANDS)
def test_each_file_is_named_once(commands, begin, folder, capsys):
    for command in commands[:-1]:
        assert main(command.split()) == 0
    before = names(folder)
    capsys.readouterr()
    assert main(commands[-1].split()) == 0
    written, lines = sorted(names(folder) - before), capsys.readouterr().out.splitlines()
    assert len(written) == len(begin) and all(map(str.startswith, written, begin))
    for name in written:
        assert sum(line.startswith(f"{name}: ") and "written" in line for line in lines) == 1, lines


def test_a_page_of_shots_is_named(folder, capsys):
    assert main([*f"{BAKE} -o a.usda --quiet --json".split()]) == 0
    (folder / "a.json").write_text(capsys.readouterr().out)
    assert main(["report", "."]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "shots.html: written"
