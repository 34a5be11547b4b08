"""Attacks the tool, counts, and prints what did not hold: python -m chaos [--seed N] [--minutes M]

Attack K of a seed is the same whenever it is made, but for the moments at which signals and races come.
"""

import argparse
import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from chaos.attacks import KINDS, Attack, Ground


def attacks(
    seed: int, ground: Ground, numbers: Iterator[int], kinds: list[str]
) -> Iterator[tuple[int, str, list[str]]]:
    """The number, the kind and the faults of each attack, kind by kind."""
    for number in numbers:
        kind = kinds[number % len(kinds)]
        yield number, kind, KINDS[kind](Attack(ground, f"{number}", random.Random(f"{seed} {number}")))


def for_minutes(minutes: float) -> Iterator[int]:
    end, number = time.monotonic() + 60 * minutes, 0
    while time.monotonic() < end:
        yield number
        number += 1


def table(runs: Counter[str], failed: Counter[str]) -> str:
    rows = [f"{kind:24} {runs[kind]:6} {failed[kind]:6}" for kind in KINDS if runs[kind]]
    return "\n".join(
        [f"{'attack':24} {'runs':>6} {'faults':>6}", *rows, f"{'':24} {runs.total():6} {failed.total():6}"]
    )


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests/chaos.sh", description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=5)
    parser.add_argument("--only", type=int, metavar="K", help="attack K of the seed")
    parser.add_argument("--kind", choices=KINDS, action="append", help="attacks of this kind; may be given again")
    given = parser.parse_args()
    runs, failed = Counter(), Counter()
    numbers = for_minutes(given.minutes) if given.only is None else iter([given.only])
    with tempfile.TemporaryDirectory(prefix="chaos.") as work:
        for number, kind, found in attacks(given.seed, Ground(Path(work), 10), numbers, given.kind or list(KINDS)):
            runs[kind] += 1
            failed[kind] += bool(found)
            for fault in found:
                print(f"{kind}: {fault}\n    again: tests/chaos.sh --seed {given.seed} --only {number}", flush=True)
    print(table(runs, failed))
    return 1 if failed.total() else 0


if __name__ == "__main__":
    sys.exit(main())
