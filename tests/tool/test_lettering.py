"""Text on pictures: every name can be told from another, whatever letters it has."""

import numpy as np
import pytest

from skinslide.arrays.canvas import Viewport
from skinslide.picture import lettering
from skinslide.picture.lettering import write_text


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
