"""Every stage of the tables through both readers: a bake and a .skinslide file hold the same bytes, or say the same."""

from pathlib import Path

import pytest

from bad_stages import BAD
from digests import BLOCKED, Contents, differences
from good_stages import GOOD
from readers import Sentence, baked, cached, command, opened
from rows import Bad, made, named
from stages import MESH


@pytest.fixture(autouse=True)
def no_device(monkeypatch):
    """No stage needs one, and check takes a tenth of a second to look for it."""
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "")


def test_each_row_has_a_name_of_its_own():
    names = [row.name for row in [*GOOD, *BAD]]
    assert len(names) == len(set(names))


def moved(bake: Contents, cache: Contents) -> bool:
    """Whether any point is elsewhere than in the cache, at the samples of the cache."""
    return any(
        cache[path].at.get(time, cache[path].at.get("default", value)) != value
        for path in cache
        for time, value in bake[path].at.items()
    )


@pytest.mark.parametrize("row", named(GOOD))
def test_a_layer_holds_what_a_bake_does(row, tmp_path):
    path = made(row, tmp_path)
    bake, warned = baked(path)
    live = opened(path)
    assert moved(bake, cached(path)) == row.slides
    if row.refuses:
        assert [each.text for each in live.said] == [row.refuses] and not live.layer
        return
    assert differences(bake, live.layer) == differences(live.flat, live.layer) == []
    assert {path for path, values in bake.items() if BLOCKED in values.at.values()} == {
        f"{MESH}.{name}" for name in row.blocked
    }
    if row.warns:
        for sentences in (warned, live.said):
            assert any(row.warns in each.text for each in sentences), sentences
    else:
        assert not live.said


def is_said(row: Bad, folder: Path, said: list[Sentence]) -> bool:
    """Whether this is all that is said: what the row says."""
    text = row.says.replace("{folder}", str(folder))
    begins = text.endswith("...")
    found = [each._replace(text=text if begins and each.text.startswith(text[:-3]) else each.text) for each in said]
    return found == [Sentence(row.prim, row.patch, row.frame, text)]


@pytest.mark.parametrize("row", named(BAD))
def test_the_tool_refuses(row, tmp_path, capfd):
    path = made(row, tmp_path)
    code, said = command(capfd, "check", path)
    assert code == 3 and is_said(row, tmp_path, said), said
    before, output = set(tmp_path.iterdir()), tmp_path / "out.usda"
    output.write_text("what was there before")
    code, said = command(capfd, "bake", path, "-o", output, "--quiet", "--jobs", "1")
    assert code == (1 if row.frame else 3) and is_said(row, tmp_path, said), said
    assert output.read_text() == "what was there before" and set(tmp_path.iterdir()) == {*before, output}


@pytest.mark.parametrize("row", named(BAD))
def test_a_layer_refuses(row, tmp_path):
    """It opens, says why, and gives the points of the cache: of the frame, or of all."""
    path = made(row, tmp_path)
    live, cache = opened(path), cached(path)
    said = [each if row.frame else each._replace(frame=None) for each in live.said]
    assert is_said(row, tmp_path, said), said
    for name in live.layer.keys() & cache.keys() if not row.may_slide else ():
        for time, value in live.layer[name].at.items():
            assert value == cache[name].at[time] or (row.frame and float(row.frame) != time)
