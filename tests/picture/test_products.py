"""A bake that makes pictures, a page and maps too: of frames slid once, each product as by the command of its own."""

import json
import re

import pytest
from pxr import UsdGeom

import skinslide
import stages
from sheets import PATCH, SIZE, sheet
from skinslide import Maps, Pictures, Slider, StageProblems, UsageError, bake, bake_to_file
from skinslide.command import cli
from stages import FRAMES, MESH

PICTURES = {"size": SIZE, "views": "chequer", "squares": 16}


@pytest.fixture
def shot(tmp_path):
    return stages.save(sheet()[0], tmp_path / "shot.usda")


@pytest.fixture
def slides(monkeypatch):
    """How often a mesh was slid."""
    counted = []
    slide = Slider.slide

    def count(*arguments, **options):
        counted.append(arguments)
        return slide(*arguments, **options)

    monkeypatch.setattr(Slider, "slide", count)
    return counted


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def untimed(page):
    """A page without what differs from run to run: milliseconds, as numbers and as curves."""
    return re.sub(
        r"<details>.*?</details>|<td>[\d.]+</td></tr>|<figure class=\"chart\".*?</figure>", "", page, flags=re.S
    )


def test_every_product_is_that_of_its_command(shot, tmp_path, slides):
    apart, together = tmp_path / "apart", tmp_path / "together"
    apart.mkdir()
    together.mkdir()
    bake_to_file(shot, apart / "slid.usdc", diagnostics=True)
    skinslide.preview(str(shot), apart / "pictures", html=apart / "page.html", **PICTURES)
    skinslide.maps(shot, apart / "maps", size=64)
    assert len(slides) == 3 * len(FRAMES)
    slides.clear()
    report = bake_to_file(
        shot,
        together / "slid.usdc",
        diagnostics=True,
        jobs=2,
        also=[
            Pictures(together / "pictures", together / "page.html", **PICTURES),
            Maps(together / "maps", size=64),
        ],
    )
    assert len(slides) == len(FRAMES)
    assert (apart / "slid.usdc").read_bytes() == (together / "slid.usdc").read_bytes()
    for folder in ("pictures", "maps"):
        assert contents(apart / folder) == contents(together / folder)
    pages = [untimed((folder / "page.html").read_text()) for folder in (apart, together)]
    assert pages[0] == pages[1] and len(pages[0]) > 10_000
    document = json.loads(json.dumps(report.as_dict()))
    assert document["pictures"] == len(FRAMES) and len(document["maps"]) == 4 * len(FRAMES)
    assert len(document["files"]) == len(FRAMES) + 2 and document["meshes"][0]["frames"] == list(FRAMES)


def test_frames_beside_those_asked_for_are_slid_once_and_not_drawn(shot, tmp_path, slides):
    """Velocities need the samples on either side."""
    stage, mesh = sheet()
    for frame in FRAMES:
        mesh.GetVelocitiesAttr().Set(mesh.GetPointsAttr().Get(frame), frame)
    report = bake_to_file(
        stages.save(stage, tmp_path / "moving.usda"),
        tmp_path / "slid.usda",
        frames=[FRAMES[1]],
        also=[Pictures(tmp_path / "pictures", **PICTURES), Maps(tmp_path / "maps", size=16)],
    )
    assert len(slides) == 3 and report.frame_count == 1
    assert len(contents(tmp_path / "pictures")) == 2 and len(contents(tmp_path / "maps")) == 4


def test_products_of_a_bake_into_the_stage(tmp_path, slides):
    stage, mesh = sheet()
    stages.save(stage, tmp_path / "shot.usda")
    before = mesh.GetPointsAttr().Get(FRAMES[-1])
    bake(stage, also=[Maps(tmp_path / "maps", size=16)])
    assert len(slides) == len(FRAMES) and len(contents(tmp_path / "maps")) == 4 * len(FRAMES)
    assert mesh.GetPointsAttr().Get(FRAMES[-1]) != before


def test_meshes_of_which_some_products_make_nothing(tmp_path, slides):
    stage, _mesh = sheet()
    other = stages.add_mesh(stage, stages.grid(4, 4), "/World/char/geo/other_GEO")
    stages.add_patch(other, range(16), "knee")
    shot = stages.save(stage, tmp_path / "shot.usda")
    also = [Pictures(tmp_path / "pictures", patches=PATCH, **PICTURES)]
    report = bake_to_file(shot, tmp_path / "slid.usda", also=also)
    assert [mesh.path for mesh in report.meshes] == [MESH, "/World/char/geo/other_GEO"]
    slid = len(slides)
    skinslide.preview(str(shot), tmp_path / "pictures", patches=PATCH, **PICTURES)
    assert len(slides) - slid == len(FRAMES) < slid  # the other mesh is not slid for nothing


def test_all_problems_are_told_and_nothing_is_written(shot, tmp_path):
    stage, mesh = sheet(st=False)
    mesh.GetPrim().CreateRelationship("primvars:skinSlide:slide")
    also = [Pictures(tmp_path / "pictures", camera="/World/none"), Maps(tmp_path / "maps")]
    with pytest.raises(StageProblems) as raised:
        bake_to_file(stages.save(stage, tmp_path / "bad.usda"), tmp_path / "slid.usda", diagnostics=True, also=also)
    found = [problem.message for problem in raised.value.problems if problem.severity == "error"]
    assert len(found) == 3
    for message, part in zip(found, ("a relationship", "no such prim", "has no primvars:st"), strict=True):
        assert part in message
    assert {file.name for file in tmp_path.iterdir()} == {"shot.usda", "bad.usda"}


def test_a_product_that_fails_leaves_the_layer_as_it_was(shot, tmp_path):
    (tmp_path / "slid.usda").write_text("before")
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / f"skin_GEO.slide.{FRAMES[0]:g}.exr").mkdir()
    with pytest.raises(UsageError, match="is a folder"):
        bake_to_file(shot, tmp_path / "slid.usda", also=[Maps(tmp_path / "maps", size=16)])
    assert (tmp_path / "slid.usda").read_text() == "before"
    assert {file.name for file in tmp_path.iterdir()} == {"shot.usda", "slid.usda", "maps"}


# ---- The command ----


def run(shot, tmp_path, *words):
    return cli.main(["bake", str(shot), "-o", str(tmp_path / "slid.usda"), *map(str, words)])


def test_the_command_writes_all_and_says_so(shot, tmp_path, capsys, slides):
    places = [tmp_path / name for name in ("pictures", "page.html", "maps")]
    words = ["--pictures", places[0], "--html", places[1], "--maps", places[2]]
    options = ["--size", "480x270", "--view", "chequer", "--squares", "16", "--map-size", "64"]
    assert run(shot, tmp_path, *words, *options) == 0
    said = capsys.readouterr().out
    for line in [f"{places[0]}: written", f"{places[1]}: written", "64 x 64 texels written", "sublayer it above"]:
        assert line in said
    assert len(slides) == len(FRAMES)
    skinslide.preview(str(shot), tmp_path / "apart", **PICTURES)
    assert contents(places[0]) == contents(tmp_path / "apart")
    assert run(shot, tmp_path, *words, *options, "--json", "--quiet") == 0
    document = json.loads(capsys.readouterr().out)
    assert document["output"] == str(tmp_path / "slid.usda") and len(document["maps"]) == 4 * len(FRAMES)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--view", "chequer"], "no folder (--pictures) and no page (--html)"),
        (["--patch", PATCH], "no folder (--pictures) and no page (--html)"),
        (["--follow", "--maps", "maps"], "no folder (--pictures) and no page (--html)"),
        (["--map-size", "16", "--html", "page.html"], "no folder (--maps)"),
        (["--maps", "maps", "--map-size", "0"], "must be at least 1"),
        (["--maps", "maps", "--map-size", "16385"], "error: --map-size is 16385; it must be at most 16384"),
    ],
)
def test_options_of_what_is_not_asked_for(words, message, shot, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(shot, tmp_path, *words) == 2
    assert message in capsys.readouterr().err
    assert [file.name for file in tmp_path.iterdir()] == ["shot.usda"]


def test_options_that_maps_and_pictures_share(shot, tmp_path):
    """--patch and --st are of both, and maps alone may have them."""
    assert run(shot, tmp_path, "--maps", tmp_path / "maps", "--map-size", "16", "--patch", PATCH, "--st", "st") == 0
    assert len(contents(tmp_path / "maps")) == 4 * len(FRAMES)


@pytest.mark.parametrize(
    ("where", "left"), [("take", "; every file in {0} and {1} is whole"), ("end", " after {2} was written")]
)
def test_what_an_interrupted_command_left(where, left, shot, tmp_path, monkeypatch, capsys):
    def interrupt(*_arguments):
        raise KeyboardInterrupt

    target = {"take": "skinslide.shot.bake._MeshBake.take", "end": "skinslide.write.overs._describe"}[where]
    monkeypatch.setattr(target, interrupt)
    pictures, maps, page = (tmp_path / name for name in ("pictures", "maps", "page.html"))
    words = ["--pictures", pictures, "--maps", maps, "--html", page, "--size", "64x32", "--map-size", "16", "--quiet"]
    assert run(shot, tmp_path, *words) == 130
    assert capsys.readouterr().err == f"error: interrupted{left.format(pictures, maps, page)}\n"
    assert not (tmp_path / "slid.usda").exists()


def test_a_bad_frame_stops_all(shot, tmp_path, capsys):
    stage, mesh = sheet()
    points = UsdGeom.Mesh(mesh).GetPointsAttr().Get(FRAMES[1])
    points[312] = (float("nan"), 0, 0)
    mesh.GetPointsAttr().Set(points, FRAMES[1])
    bad = stages.save(stage, tmp_path / "bad.usda")
    assert run(bad, tmp_path, "--maps", tmp_path / "maps", "--map-size", "16", "--quiet") == 1
    assert f"frame {FRAMES[1]:g}:" in capsys.readouterr().err
    assert not (tmp_path / "slid.usda").exists() and len(contents(tmp_path / "maps")) == 4  # of the frame before
