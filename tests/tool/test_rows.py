"""Rows and moments are lists and dictionaries of named tuples, that take the bytes of their numbers."""

import struct
import sys
from typing import NamedTuple

import numpy as np
import pytest

from skinslide.shot.rows import Moments, Rows


class Number(NamedTuple):
    whole: int
    real: float


NUMBERS = [Number(3, 0.1), Number(-1, -0.0), Number(0, 5e-324), Number(2**31 - 1, float("inf"))]
LARGE = [Number(2**31, 0.1), Number(-(2**63), 1.0), Number(2**63 - 1, 2.0)]


@pytest.fixture(params=[NUMBERS, LARGE, NUMBERS + LARGE], ids=["small", "large", "both"])
def numbers(request):
    return request.param


def test_rows_are_a_sequence(numbers):
    rows = Rows(Number)
    assert rows == [] and not rows
    for number in numbers:
        rows.append(number)
    assert rows == numbers and numbers == rows and list(rows) == numbers and len(rows) == len(numbers)
    assert rows == Rows(Number, numbers) and rows != numbers[1:] and rows != 3
    for index in range(-len(numbers), len(numbers)):
        assert rows[index] == numbers[index] and type(rows[index]) is Number
        assert rows[index:] == numbers[index:] and rows[:index:-1] == numbers[:index:-1]
    assert numbers[-1] in rows and rows.index(numbers[1]) == 1
    for index in (len(numbers), -len(numbers) - 1):
        with pytest.raises(IndexError):
            rows[index]


def test_numbers_keep_their_bits():
    for number in (-0.0, float("nan"), 5e-324):
        (row,) = Rows(Number, [Number(0, number)])
        assert np.float64(row.real).tobytes() == np.float64(number).tobytes()


def test_a_column_is_a_field_of_all(numbers):
    rows = Rows(Number, numbers)
    for name in Number._fields:
        column, expected = rows.column(name), np.array([getattr(number, name) for number in numbers])
        assert column.dtype == expected.dtype and (column == expected).all()
        column[:] = 7
        assert rows == numbers


def test_what_no_eight_bytes_hold_is_refused():
    rows = Rows(Number, NUMBERS)
    with pytest.raises(struct.error):
        rows.append(Number(2**63, 0.1))
    assert rows == NUMBERS


def test_moments_are_a_mapping(numbers):
    moments, expected = Moments(Number), {}
    assert moments == {} and not moments
    for frame, number in enumerate(numbers):
        moments.add(frame + 0.5, number)
        expected[frame + 0.5] = number
    assert moments == expected and list(moments) == list(expected) and moments.rows == numbers
    for time in (None, 0.0, 0.75, len(numbers) + 0.5):
        assert moments.get(time) is None and time not in moments
        with pytest.raises(KeyError):
            moments[time]


def test_the_default_time_is_no_moment():
    moments = Moments(Number)
    moments.add(None, NUMBERS[0])
    assert not moments and None not in moments


def test_a_number_takes_its_bytes():
    count = 10_000
    rows = Rows(Number, [Number(frame, 0.1) for frame in range(count)])
    assert sys.getsizeof(rows._bytes) < 1.25 * (4 + 8) * count
