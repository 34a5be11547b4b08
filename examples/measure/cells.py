"""Tables, as the scripts here print them: each column is as wide as its widest cell."""

from collections.abc import Iterable, Sequence


def lines(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """One line for the headings, then one for each row."""
    table = [headings, *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return "".join("  ".join(map(str.rjust, cells, widths)) + "\n" for cells in table)
