"""Numbers of many frames in little memory: sequences and mappings of named tuples, each kept as its bytes.

Whole numbers take four bytes, until there is one that needs eight.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from struct import Struct, error
from typing import Any, TypeVar, get_type_hints, overload

import numpy as np

Row = TypeVar("Row", bound="tuple[Any, ...]")  # a named tuple of int and float

_WHOLE, _LARGE, _REAL = "i", "q", "d"


class Rows(Sequence[Row]):
    """Named tuples of whole and real numbers, in the order in which they come."""

    def __init__(self, kind: type[Row], rows: Iterable[Row] = ()):
        self._kind: Any = kind
        self._lay_out(_WHOLE, rows)

    def append(self, row: Row) -> None:
        try:
            self._bytes += self._struct.pack(*row)
        except error:
            self._lay_out(_LARGE, list(self))
            self._bytes += self._struct.pack(*row)

    def column(self, name: str) -> np.ndarray:
        """A field of all of them (n,), int64 or float64."""
        column = np.frombuffer(self._bytes, self._dtype)[name]
        return column.astype(np.int64 if np.issubdtype(column.dtype, np.integer) else np.float64)

    def __len__(self) -> int:
        return len(self._bytes) // self._struct.size

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> list[Row]: ...
    def __getitem__(self, index: int | slice) -> Row | list[Row]:
        places = range(len(self))[index]
        return self._at(places) if isinstance(places, int) else [self._at(place) for place in places]

    def __iter__(self) -> Iterator[Row]:
        return map(self._at, range(len(self)))

    def __eq__(self, other: object) -> bool:
        return list(self) == list(other) if isinstance(other, Sequence) else NotImplemented

    def _lay_out(self, whole: str, rows: Iterable[Row]) -> None:
        formats = {int: whole, float: _REAL}
        fields = {name: formats[each] for name, each in get_type_hints(self._kind).items()}
        self._struct, self._bytes = Struct("=" + "".join(fields.values())), bytearray()
        self._dtype = np.dtype([(name, f"={each}") for name, each in fields.items()])
        for row in rows:
            self.append(row)

    def _at(self, place: int) -> Row:
        row: Row = self._kind._make(self._struct.unpack_from(self._bytes, place * self._struct.size))
        return row


class Moments(Mapping["float | None", Row]):
    """The same by stage time; of a default time, which is None, there is none."""

    def __init__(self, kind: type[Row]):
        self._times, self.rows = list[float](), Rows(kind)

    def add(self, time: float | None, row: Row) -> None:
        """Times ascend."""
        if time is not None:
            self._times.append(time)
            self.rows.append(row)

    def __getitem__(self, time: float | None) -> Row:
        place = len(self) if time is None else bisect_left(self._times, time)
        if place == len(self) or self._times[place] != time:
            raise KeyError(time)
        return self.rows[place]

    def __iter__(self) -> Iterator[float | None]:
        return iter(self._times)

    def __len__(self) -> int:
        return len(self._times)
