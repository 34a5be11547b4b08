"""What the measures print: rows of cells, each column as wide as its widest cell."""

from collections.abc import Iterable, Sequence


def lines(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A line for each, the headings first."""
    table = [headings, *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return "".join("  ".join(map(str.rjust, cells, widths)) + "\n" for cells in table)
