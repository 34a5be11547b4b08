"""What is written on pictures."""

import numpy as np
import pytest

from skinslide.arrays.canvas import Viewport
from skinslide.picture.lettering import write_scale


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
