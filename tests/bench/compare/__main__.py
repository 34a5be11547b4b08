"""Tables of what frames cost, and as ratios: python -m compare --python OURS --eigen LIBRARY, by the peers' Python."""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from compare.contest import Cost, Entry, contest
from compare.patches import KINDS, papers, patch_of, quads

SIZES = (289, 1024, 10_000, 99_856)
PEERS = (
    ("scikit-sparse, igl's tree", "cholmod", "igl"),
    ("scikit-sparse, embree", "cholmod", "embree"),
    ("splu, igl's tree", "splu", "igl"),
    ("spsolve, trifinder", "spsolve", "trifinder"),
)
RULES = ("unit", "even", "relaxed")
INTERPOLATIONS = ("linear", "limit")


class Field:
    """Who takes part, from the command line."""

    def __init__(self, options: argparse.Namespace, folder: Path):
        self.options, self.folder = options, folder

    def ours(self, *arguments: str, name: str = "skinslide") -> list[Entry]:
        """The entries of this tree, and of the other revision."""
        words = ("ours", "Ours", *arguments)
        other = [Entry(f"{name}, {self.options.revision}", self.options.python, words, self.options.against)]
        return [Entry(name, self.options.python, words), *(other if self.options.against else [])]

    def points_alone(self) -> Entry:
        """The entry of this tree that does as much as peers do: they measure no stretch."""
        return Entry("skinslide, points alone", self.options.python, ("ours", "PointsAlone"))

    def rounds(self, size: int) -> int:
        """How many rounds: fewer if frames of the slowest contestant take seconds."""
        return self.options.rounds if size < 50_000 else max(2, self.options.rounds // 2)

    def peers(self) -> list[Entry]:
        python = sys.executable
        return [
            Entry("Eigen's LDLT, a walk", python, ("peers", "Eigen", self.options.eigen)),
            *(Entry(name, python, ("peers", "Peer", *parts)) for name, *parts in PEERS),
        ]


def main() -> None:
    parser = argparse.ArgumentParser(prog="tests/bench.sh", description="What a frame costs beside other libraries.")
    parser.add_argument("--python", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--eigen", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--against", default="", help=argparse.SUPPRESS)
    parser.add_argument("--revision", default="", help=argparse.SUPPRESS)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="N", help="vertices of the patches")
    parser.add_argument("--kinds", nargs="+", default=KINDS, choices=KINDS, help="how their points lie")
    parser.add_argument(
        "--rounds", type=int, default=6, metavar="N", help="how often each slides, in turn with the others"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        field = Field(options, Path(folder))
        for kind in options.kinds:
            for size in options.sizes:
                compare_peers(field, kind, size)
        for size in options.sizes:
            compare_rules(field, size)
        compare_lookups(field)


def compare_peers(field: Field, kind: str, size: int) -> None:
    patch = patch_of(kind, size)
    costs = contest(
        [*field.ours(), field.points_alone(), *field.peers()], patch, field.folder, field.rounds(size), two=True
    )
    show(f"{patch.name} vertices, by the rule unit, linear", costs, ("embed", "locate", "interpolate"))


def compare_rules(field: Field, size: int) -> None:
    """Compares each rule with the other revision's; frames of both may differ if the rule has changed."""
    patch = quads(size)
    costs = {}
    for rule in RULES:
        for interpolation in INTERPOLATIONS:
            entries = field.ours(rule, interpolation, name=f"{rule}, {interpolation}")
            costs |= contest(entries, patch, field.folder, field.rounds(size), agree=False)
    show(f"{patch.name} vertices, by each rule", costs, ("embed", "relax", "locate", "interpolate"))


def compare_lookups(field: Field) -> None:
    """Compares both lookups, one of which waits for a device, on patches of the sizes in the paper's table."""
    for patch in papers():
        entries = [entry for lookup in ("exact", "egl") for entry in field.ours("unit", "linear", lookup, name=lookup)]
        costs = contest(entries, patch, field.folder, field.options.rounds)
        stages = ("embed", "locate", "interpolate", "by the clock")
        show(f"{patch.name} vertices and edges, as in the paper's table", costs, stages)


def show(title: str, costs: Mapping[str, Cost], stages: Sequence[str]) -> None:
    """Prints milliseconds of a thread for the median frame, their ratio to the first contestant's, and memory."""
    first = next(iter(costs.values()))
    two = any(cost.two for cost in costs.values())
    print(f"\n### {title}\n")
    _print_row(
        "",
        "set-up",
        *stages,
        "frame",
        "set-up, times",
        "embed, times",
        "frame, times",
        *(["two threads"] if two else []),
        "MB",
    )
    _print_row(*["---"] * (len(stages) + 7 + two))
    for name, cost in costs.items():
        times = [
            _ratio(cost.setup, first.setup),
            *(_ratio(cost.stage(each), first.stage(each)) for each in ("embed", "frame")),
        ]
        milliseconds = [f"{1e3 * each:.3g}" for each in (cost.setup, *map(cost.stage, (*stages, "frame")))]
        _print_row(name, *milliseconds, *times, *([f"{1e3 * cost.two:.3g}"] if two else []), f"{cost.memory:.0f}")


def _ratio(one: float, other: float) -> str:
    return f"{one / other:.2f}" if other else ""


def _print_row(*cells: str) -> None:
    print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
