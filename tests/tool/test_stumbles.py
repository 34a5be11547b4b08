"""Small mistakes end in one line that names the option, or the argument, and says what it must be."""

import json
import shlex

import numpy as np
import pytest

import skinslide
import stages
from skinslide.command.cli import main
from stages import MESH, PATCH


@pytest.fixture
def shot(tmp_path):
    return stages.save(stages.patched_stage()[0], tmp_path / "shot.usda")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--max-roughness", "-1"], "--max-roughness is -1; it must be above 0, from "),
        (["--max-stretch", "-1"], "--max-stretch is -1; "),
        (["--squares", "0", "--html", "p.html"], "--squares is 0; it must be above 0, from "),
        (["--html", ""], "html is an empty name"),
        (
            ["--html", "p.html", "--compare", "unit,evn"],
            "--compare: rule 'evn' is not one of unit, fast, relaxed, even",
        ),
        (["--html", "/proc/p.html", "--size", "64x32"], "output /proc/p.html: "),
    ],
)
def test_a_command_names_the_flag(words, says, shot, tmp_path, capfd):
    assert main(["bake", str(shot), "-o", str(tmp_path / "out.usdc"), *words]) in (1, 2)
    said = capfd.readouterr().err
    assert said.startswith(f"error: {says}"), said
    assert [each.name for each in tmp_path.iterdir()] == ["shot.usda"]


@pytest.mark.parametrize(
    ("words", "flag"),
    [
        (["preview", "--stretch-scale", "0"], "--stretch-scale"),
        (["preview", "--most-stretch=0"], "--most-stretch"),
        (["bake", "--html", "p.html", "--most-stretch", "0"], "--most-stretch"),
        (["maps", "--map-size", "16385"], "--map-size"),
        (["maps", "--size", "16385"], "--size"),
        (["bake", "--html", "p.html", "--size", "64x32", "--maps", "m", "--map-size", "16385"], "--map-size"),
    ],
)
def test_a_flag_has_the_name_that_was_typed(words, flag, shot, tmp_path, capfd):
    """Flags of before are understood, and are not in the help."""
    assert main([words[0], str(shot), "-o", str(tmp_path / "out.usda"), *words[1:]]) == 2
    assert capfd.readouterr().err.startswith(f"error: {flag} is ")
    assert main([words[0], "--help"]) == 0
    said = capfd.readouterr().out
    assert "--stretch-scale" in said or words[0] == "maps"
    assert "--most-stretch" not in said and ("--size" in said) == (words[0] != "maps")


ON = ["--prim", MESH, "--patch", "other"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["setup", *ON, "--faces", "x"], "--faces 'x': 'x' is neither a face nor a range such as 0-120"),
        (["setup", *ON, "--faces", "3", "--reach", "2"], "--reach and --mirror go with --joint"),
        (["setup", *ON, "--joint", "arm", "--reach", "-2"], "--reach is -2; it must be above 0, from "),
        (["setup", *ON, "--faces", "3", "--grow", "-1"], "--grow is -1; it must be 0 or more, "),
        (["setup", *ON, "--faces", "3", "--frames", "1"], "--frames goes with --whole"),
        (["setup", *ON[2:], "--faces", "3"], "--prim and --patch are needed, unless --whole is asked for"),
        (["paint", *ON, "--value", "-2", "--primvar", "a"], "--value is -2; it must be above 0, from "),
        (["paint", *ON, "--value", "2", "--curve", "/a"], "--curve needs --within, in the mesh's units"),
        (["paint", *ON, "--value", "2", "--primvar", "a", "--within", "1"], "--within and --direction go with --curve"),
        (
            ["paint", *ON, "--value", "2", "--primvar", "a", "--threshold", "nan"],
            "--threshold is nan; it must be finite",
        ),
        (["mirror", *ON, "--plane", "inf"], "--plane is inf; it must be finite"),
        (["mirror", *ON, "--tolerance", "-1"], "--tolerance is -1; it must be 0 or more, "),
    ],
)
def test_commands_that_author_name_the_flag(words, says, shot, tmp_path, capfd):
    assert main([words[0], str(shot), "-o", str(tmp_path / "out.usda"), *words[1:]]) == 2
    assert capfd.readouterr().err.startswith(f"error: {says}")
    assert [each.name for each in tmp_path.iterdir()] == ["shot.usda"]


def test_any_direction_is_no_choice(shot, tmp_path, capfd):
    """An option that is given its default asks for nothing."""
    words = [*ON[:2], "--patch", PATCH, "--value", "2", "--primvar", "none", "--direction", "any"]
    assert main(["paint", str(shot), "-o", str(tmp_path / "out.usda"), *words]) == 3


@pytest.mark.parametrize("command", ["bake", "cache"])
def test_an_empty_output_is_none(command, shot, capfd):
    assert main([command, str(shot), "-o", ""]) == 2
    assert capfd.readouterr().err == "error: output is an empty name\n"


CALLS = {
    "frames": (lambda stage, mesh: skinslide.parse_frames(3), "frames 3: must be a spec such as 101:109x2"),
    "to": (lambda stage, mesh: skinslide.mirror(stage, mesh, PATCH, to=3), "to is 3; it must be a text"),
    "patch": (lambda stage, mesh: skinslide.mirror(stage, mesh, 3), "patch is 3; it must be a text"),
    "plane": (lambda stage, mesh: skinslide.mirror(stage, mesh, PATCH, plane="x"), "plane is 'x'; it must be a number"),
    "tolerance": (
        lambda stage, mesh: skinslide.mirror(stage, mesh, PATCH, tolerance="x"),
        "tolerance is 'x'; it must be a number",
    ),
    "value": (
        lambda stage, mesh: skinslide.paint(stage, mesh, PATCH, "x", edges=[[0, 1]]),
        "value is 'x'; it must be a number",
    ),
    "primvar": (
        lambda stage, mesh: skinslide.paint(stage, mesh, PATCH, 2, primvar=3),
        "primvar is 3; it must be a text",
    ),
    "subset": (lambda stage, mesh: skinslide.paint(stage, mesh, PATCH, 2, subset=3), "subset is 3; it must be a text"),
    "views": (lambda stage, mesh: skinslide.preview(stage, "p", views=3), "views is 3; it must be a text, or several"),
    "patches": (
        lambda stage, mesh: skinslide.preview(stage, "p", patches=3),
        "patches is 3; it must be a text, or several",
    ),
    "faces": (
        lambda stage, mesh: skinslide.SkinSlideAPI(mesh, PATCH).SetFaces(np.ones(36)),
        "faces are floats; they must be indices, or a bool for each face, such as mask > 0",
    ),
}


@pytest.mark.parametrize(("call", "says"), CALLS.values(), ids=CALLS.keys())
def test_a_function_names_the_argument(call, says):
    stage, mesh = stages.patched_stage()
    with pytest.raises(skinslide.UsageError) as raised:
        call(stage, mesh.GetPrim())
    assert str(raised.value) == says


def test_one_is_no_several():
    """One edge of no length at rest, and a patch that shares one point with another."""
    stage, mesh = stages.patched_stage(faces=stages.block(6, range(3), range(3)))
    rest = np.array(mesh.GetPointsAttr().Get())
    rest[8] = rest[9]
    mesh.GetPointsAttr().Set(stages.vectors(rest))
    said = [problem.message for problem in skinslide.check(stage, MESH).problems]
    assert "1 edge has no length at rest" in said


def test_a_long_list_is_summed_up(tmp_path, capfd):
    """Of 40 patches none has faces: 20 lines, and how many more there are; JSON has all."""
    stage, mesh = stages.patched_stage()
    for number in range(40):
        stages.add_patch(mesh, None, f"patch_{number}")
    shot = stages.save(stage, tmp_path / "shot.usda")
    assert main(["bake", str(shot), "-o", str(tmp_path / "out.usdc")]) == 3
    said = capfd.readouterr().err.splitlines()
    assert len(said) == 21 and said[-1] == "error: and 20 more like these; --json has all"
    assert main(["check", str(shot)]) == 3
    printed = capfd.readouterr().out.splitlines()
    assert sum(line.startswith("error: ") for line in printed) == 21 and ": 40 errors" in printed[-1]
    assert main(["check", str(shot), "--json"]) == 3
    assert len(json.loads(capfd.readouterr().out)["problems"]) >= 40


@pytest.mark.parametrize("name", ["cache.usda", "the cache's.usda"])
def test_what_to_do_first_is_a_command_that_runs(name, tmp_path, monkeypatch, capfd):
    """Of a stage on which nothing is set up: as it stands, but for the name of what it is to write."""
    stage = stages.new_stage()
    mesh = stages.add_mesh(stage, stages.grid())
    mesh.GetPointsAttr().Set(stages.vectors(2 * stages.grid().points), stages.FRAMES[-1])
    stages.save(stage, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    assert main(["bake", name, "-o", "out.usda"]) == 3
    command = capfd.readouterr().err.strip().partition("start with: ")[2]
    assert command == f"skinslide setup {shlex.quote(name)} -o X.skinslide --whole"
    assert main(shlex.split(command)[1:]) == 0


def test_a_chunk_is_to_be_stitched(shot, tmp_path, capfd):
    for words, what in (([], "sublayer it above the character"), (["--chunk", "1/2"], "part 1/2; skinslide stitch ")):
        assert main(["bake", str(shot), "-o", str(tmp_path / "out.usdc"), *words]) == 0
        assert what in capfd.readouterr().out.splitlines()[-1]


def test_a_set_up_says_how_it_slides_and_not_by_which_lookup(shot, tmp_path, capfd):
    assert main(["setup", str(shot), "-o", str(tmp_path / "out.usda"), *ON, "--faces", "0-8"]) == 0
    said = capfd.readouterr().out
    assert "  other: even, linear, vertices " in said and "lookup" not in said
    assert main(["check", str(tmp_path / "out.usda")]) == 0
    assert "lookup " in capfd.readouterr().out


def test_resume_is_named_as_it_is_typed(shot, tmp_path, capfd):
    words = ["bake", str(shot), "-o", str(tmp_path / "out.usdc"), "--resume", "--html", str(tmp_path / "p.html")]
    assert main(words) == 2
    assert capfd.readouterr().err == "error: --resume is for a layer alone, without pictures and maps\n"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (
            ["bake", "--max-strech", "3"],
            "there is no option --max-strech; there are --max-stretch, --max-added-stretch, ",
        ),
        (["setup", "--primvr=mask"], "there is no option --primvr; there are --primvar, --prim, "),
        (["maps", "--sise", "8"], "there is no option --sise; there are "),
    ],
)
def test_an_option_that_is_misspelt(words, says, shot, tmp_path, capfd):
    """The likest of the command's are named; those of before are not."""
    rest = ["--whole"] if words[0] == "setup" else []
    assert main([words[0], str(shot), "-o", str(tmp_path / "out.usda"), *words[1:], *rest]) == 2
    said = capfd.readouterr().err.splitlines()
    assert said[0].startswith(f"usage: skinslide {words[0]} ") and said[-1].startswith(f"error: {says}")
    assert "--size" not in said[-1] and not (tmp_path / "out.usda").exists()


def test_where_a_mesh_is_slid_already_nothing_is_to_be_set_up(shot, tmp_path, capfd):
    hero = tmp_path / "hero.usda"
    words = ["setup", str(shot), "-o", str(tmp_path / "x.skinslide"), *ON, "--faces", "0-8", "--payload", str(hero)]
    assert main(words) == 0
    assert main(["bake", str(hero), "-o", str(tmp_path / "out.usda")]) == 3
    said = capfd.readouterr().err
    assert "is slid already, by " in said and "error: nothing to slide" in said and "start with" not in said
