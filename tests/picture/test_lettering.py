"""Text on pictures: every name can be told from another, whatever letters it has."""

import numpy as np
import pytest

import skinslide
import stages
from skinslide.arrays.canvas import Viewport
from skinslide.picture import lettering
from skinslide.picture.lettering import write_scale, write_text


def drawn(text: str) -> np.ndarray:
    pixels = np.zeros((420, 640, 4), np.uint8)
    write_text(pixels, [text], Viewport(0, 0, 640, 420))
    return pixels


@pytest.fixture
def no_other_font(monkeypatch):
    monkeypatch.setattr(lettering, "_OTHER_FONTS", ())
    lettering._lettered.cache_clear()
    yield
    lettering._lettered.cache_clear()


@pytest.mark.parametrize("names", [("肘_L", "膝_L"), ("Жук", "Лук"), ("é", "è")])
def test_names_of_any_letters_differ(names):
    assert (drawn(names[0]) != drawn(names[1])).any()


def test_a_machine_without_fonts_writes_numbers(no_other_font):
    assert (drawn("肘_L") == drawn(r"\u8098_L")).all()


def test_plain_names_are_in_the_font_that_is_everywhere(request):
    here = drawn("elbow_L, frame 1012")
    request.getfixturevalue("no_other_font")
    assert (here == drawn("elbow_L, frame 1012")).all()


def test_japanese_names_are_letters():
    """In a font that has them, which the tests install."""
    line, font = lettering._lettered("肘_L", 20)
    assert line == "肘_L" and font.getname()[0] in ("VL Gothic", "Noto Sans CJK JP", "IPAGothic")


def test_a_character_of_japanese_names_is_drawn(tmp_path):
    stage, mesh = stages.patched_stage()
    stages.add_patch(mesh, stages.block(6, range(1, 5), range(1, 5)), "肘_L")
    report = skinslide.preview(
        stages.save(stage, tmp_path / "人.usda"), tmp_path / "絵", patches="肘_L", views="chequer", size=(320, 180)
    )
    assert [patch.info.name for mesh in report.meshes for patch in mesh.patches] == [stages.PATCH, "肘_L"]
    assert (tmp_path / "絵" / "skin_GEO.肘_L.chequer.1003.png").exists()


def scale_of(title, height):
    pixels = np.zeros((height, 2 * height, 4), np.uint8)
    write_scale(pixels, title, ("0", "1", "2"), Viewport(0, 0, 2 * height, height))
    return pixels.astype(int)


@pytest.mark.parametrize("height", [64, 320, 480, 640, 1080, 2160])
def test_the_title_of_a_scale_is_above_its_colours(height):
    """Of what is coloured, nothing changes with the title, whose letters have descenders; they are grey."""
    without, titled = scale_of(" ", height), scale_of("gypsy", height)
    coloured = np.ptp(without[..., :3], axis=-1) > 40
    assert coloured.any() and (without != titled).any()
    np.testing.assert_array_equal(titled[coloured], without[coloured])
