"""A few attacks of each kind, and those that once found something; and that the verdict sees what it is to see."""

import errno
import random
import signal
from pathlib import Path

import pytest

from chaos.attacks import KINDS, Attack, Ground
from chaos.shot import COMMANDS, Command
from chaos.tool import Ended, Run
from chaos.verdict import faults

SEED = "short"


@pytest.fixture(scope="module")
def ground(tmp_path_factory) -> Ground:
    return Ground(tmp_path_factory.mktemp("chaos"), 1)


@pytest.mark.parametrize("kind", KINDS)
def test_attacks(ground, kind):
    assert KINDS[kind](Attack(ground, "short", random.Random(f"{SEED} {kind}"))) == []


# Frame after frame, so that there are as many allocations each time.
ALONE = Command((*COMMANDS[0].words, "--jobs", "1"), COMMANDS[0].outputs)

# Each with the command, and the call that fails: its kind, its number (below 0: from the last) and errno, or a signal
# below 0.
FOUND = {
    "USD's own file beside ours": (COMMANDS[1], ("rename", 2, errno.ENOSPC)),
    "a job that is beside its layer": (COMMANDS[-1], ("rename", 1, -signal.SIGTERM)),
    "a manifest that is beside its clips": (COMMANDS[-2], ("rename", -1, -signal.SIGTERM)),
    "a manifest that comes before its clips": (COMMANDS[-2], ("rename", -2, -signal.SIGTERM)),
    **{f"roughness, {-number} before the last": (ALONE, ("ours", number, errno.ENOMEM)) for number in range(-8, 0)},
}


@pytest.mark.parametrize("found", FOUND)
def test_what_was_found(ground, found):
    command, (call, number, value) = FOUND[found]
    unhurt = ground.unhurt(command, True)
    number += unhurt.calls[call] + 1 if number < 0 else 0
    with ground.folder("found", command, True) as folder:
        ended = Run(command, folder, ground.preloaded(folder, f"{call} {number} {value}")).ended()
        assert ground.counts(folder)["struck"] == 1
        assert list(faults(command, ended, folder, unhurt.before, unhurt.whole)) == []


BAKE = Command(("bake",), ("out.usda",))
OLD, NEW = {"out.usda": b"old"}, {"out.usda": b"new"}


def say(code: int | None, err: str = "error: so\n") -> Ended:
    return Ended(code, "", err, 1)


@pytest.mark.parametrize(
    ("files", "ended", "said"),
    [
        ({"out.usda": "old"}, say(1), []),
        ({"out.usda": "new"}, say(0, ""), []),
        ({"out.usda": "old", ".out.0123abcd.usda": ""}, say(-9, ""), []),
        ({"out.usda": "old", ".out.0123abcd.usdc": ""}, say(-9, ""), []),
        ({"out.usda": "old", ".out.0123abcd.0freSl": ""}, say(-9, ""), []),
        ({"out.usda": "old"}, say(-15, ""), []),
        ({"out.usda": "old"}, say(0, ""), ["exit code 0 and no new out.usda"]),
        ({"out.usda": "ne"}, say(-9, ""), ["out.usda is neither what it was nor whole"]),
        ({}, say(1), ["out.usda is gone"]),
        ({"out.usda": "old", ".out.0123abcd.usda": ""}, say(1), [".out.0123abcd.usda is left behind"]),
        ({"out.usda": "old"}, say(1, ""), ["ended with 1, and nothing is said"]),
        ({"out.usda": "old"}, say(1, "Traceback\n"), ["says 'Traceback'"]),
        ({"out.usda": "old"}, say(-11, "error: so\n"), ["ended with -11: 'error: so\\n'"]),
        ({"out.usda": "old"}, say(None), ["hung"]),
        (
            {"out.usda": "new"},
            say(130, "error: interrupted; nothing was written\n"),
            ["says that nothing was written, but out.usda was"],
        ),
        (
            {"out.usda": "old"},
            say(130, "error: interrupted after out.usda was written\n"),
            ["says that something was written, but nothing was"],
        ),
        ({"out.usda": "new"}, say(1), ["exit code 1, and out.usda is another"]),
    ],
)
def test_the_verdict(tmp_path: Path, files, ended, said):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert list(faults(BAKE, ended, tmp_path, OLD, NEW)) == said
