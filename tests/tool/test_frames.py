"""Frame specs."""

import time

import pytest

from skinslide.problems import MOST_FRAMES, FrameSpecError, UsageError
from skinslide.shot.frames import parse_frames


@pytest.mark.parametrize(
    ("spec", "frames"),
    [
        ("101", [101]),
        ("101:104", [101, 102, 103, 104]),
        ("101-104", [101, 102, 103, 104]),
        ("101:109x2", [101, 103, 105, 107, 109]),
        ("101-109x2", [101, 103, 105, 107, 109]),
        ("101:108x3", [101, 104, 107]),
        ("104:101", [101, 102, 103, 104]),
        ("104:101x2", [102, 104]),
        ("104:101x-2", [102, 104]),
        ("-5", [-5]),
        ("-5--3", [-5, -4, -3]),
        ("-5:-3", [-5, -4, -3]),
        ("-1-1", [-1, 0, 1]),
        ("1--1", [-1, 0, 1]),
        ("1.5", [1.5]),
        (".5,1.", [0.5, 1]),
        ("1:2x0.25", [1, 1.25, 1.5, 1.75, 2]),
        ("7,1-3, 2:4 ,7", [1, 2, 3, 4, 7]),
        ("5:5", [5]),
        ("+5", [5]),
    ],
)
def test_frames(spec, frames):
    assert parse_frames(spec) == frames


def test_fractional_steps_do_not_drift():
    # A tenth is no binary fraction: adding it up 10,000 times would miss both the end and every whole frame.
    frames = parse_frames("0:1000x0.1")
    assert len(frames) == 10001
    assert frames == [i / 10 for i in range(10001)]


@pytest.mark.parametrize(
    ("spec", "named"),
    [
        ("", "empty"),
        ("  ", "empty"),
        ("1,,2", "empty"),
        ("1,", "empty"),
        ("one", "'one'"),
        ("1,2..3", "'2..3'"),
        ("1:", "'1:'"),
        (":5", "':5'"),
        ("1:5x", "'1:5x'"),
        ("5x2", "'5x2'"),
        ("1:5x0", "'1:5x0'"),
        ("1:5x-1", "'1:5x-1'"),
        ("1:5:2", "'1:5:2'"),
        ("1 2", "'1 2'"),
        ("nan", "'nan'"),
        ("inf", "'inf'"),
        ("1:inf", "'1:inf'"),
        ("1e3", "'1e3'"),
        ("٣", "'٣'"),
        ("9" * 400, "too long"),
        (f"1:{MOST_FRAMES + 1}", "10000000"),
        ("1:1000000000000x0.001", "10000000"),
        ("1:6000000,1:6000000", "10000000"),
    ],
)
def test_what_is_not_a_spec_is_named(spec, named):
    start = time.monotonic()
    with pytest.raises(FrameSpecError, match="frames") as error:
        parse_frames(spec)
    assert named in str(error.value)
    assert isinstance(error.value, UsageError)
    assert time.monotonic() - start < 30  # an absurd range is refused before it is counted out
