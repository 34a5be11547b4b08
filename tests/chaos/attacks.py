"""The attacks, each by a chance of its own: what is done to a folder, and sentences of what did not hold afterwards."""

import errno
import os
import random
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from chaos import races
from chaos.shot import COMMANDS, Command, lay_out, snapshot
from chaos.tool import Ended, Run, wait_until_begun
from chaos.verdict import Files, faults

_FAILURES = (errno.EIO, errno.ENOSPC)
_FILE_CALLS = {"open", "write", "sync", "rename", "close", "mkdir"}
_SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)


@dataclass(frozen=True)
class Unhurt:
    """A command that nobody attacks: what its folder holds before and after, how long it takes, what it calls."""

    before: Files
    whole: Files
    seconds: float
    calls: dict[str, int]


class Ground:
    """Where attacks are made: a folder that is copied for each, a library to preload, runs to compare with."""

    def __init__(self, work: Path, live_seconds: float):
        self.work, self.live_seconds = work, live_seconds
        self._unhurt: dict[tuple[Command, bool], Unhurt] = {}
        (work / "template").mkdir()
        lay_out(work / "template")
        self.failing = work / "failing.so"
        compile_ = ["g++", "-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o", self.failing]
        subprocess.run([*compile_, Path(__file__).with_name("failing.cpp"), "-ldl"], check=True)

    @contextmanager
    def folder(self, name: str, command: Command | None = None, fresh: bool = False) -> Iterator[Path]:
        """A copy of the template, for a moment; where it is fresh, without older outputs of the command."""
        folder = self.work / name
        folder.mkdir()
        try:
            self.fill(folder, command, fresh)
            yield folder
        finally:
            shutil.rmtree(folder)

    def fill(self, folder: Path, command: Command | None, fresh: bool) -> None:
        shutil.copytree(self.work / "template", folder, dirs_exist_ok=True)
        for pattern in command.outputs if command and fresh else ():
            for file in filter(Path.is_file, list(folder.glob(pattern))):
                file.unlink()

    def unhurt(self, command: Command, fresh: bool) -> Unhurt:
        if (command, fresh) not in self._unhurt:
            with self.folder(f"unhurt{len(self._unhurt)}", command, fresh) as folder:
                before = snapshot(folder)
                counted = Run(command, folder, self.preloaded(folder)).ended()
                assert counted.code == 0, counted.err
                calls = self.counts(folder)
                self._unhurt[command, fresh] = Unhurt(before, snapshot(folder), counted.seconds, calls)
        return self._unhurt[command, fresh]

    def preloaded(self, folder: Path, strike: str = "") -> dict[str, str]:
        names = {"FOLDER": folder, "STRIKE": strike, "COUNTS": self._counts_file(folder)}
        return {"LD_PRELOAD": str(self.failing), **{f"CHAOS_{name}": str(value) for name, value in names.items()}}

    def counts(self, folder: Path) -> dict[str, int]:
        words = (line.split() for line in self._counts_file(folder).read_text().splitlines())
        return {call: int(count) for call, count in words}

    def _counts_file(self, folder: Path) -> Path:
        return self.work / f"{folder.name}.counts"

    @cached_property
    def mounts(self) -> bool:
        """Whether a small disk can be had here."""
        (self.work / "disk").mkdir()
        mounted = (
            subprocess.run(["mount", "-t", "tmpfs", "none", self.work / "disk"], capture_output=True).returncode == 0
        )
        if mounted:
            subprocess.run(["umount", self.work / "disk"], check=True)
        return mounted


@dataclass
class Attack:
    """One attack: a name for its folder, and its chance."""

    ground: Ground
    name: str
    chance: random.Random

    @cached_property
    def command(self) -> Command:
        return self.chance.choice(COMMANDS)

    @cached_property
    def fresh(self) -> bool:
        return self.chance.random() < 0.5

    @cached_property
    def unhurt(self) -> Unhurt:
        return self.ground.unhurt(self.command, self.fresh)

    def verdict(self, ended: Ended, folder: Path, others: bool = False) -> list[str]:
        return list(faults(self.command, ended, folder, self.unhurt.before, self.unhurt.whole, others))


# ---- Kills ----


def kill(attack: Attack) -> list[str]:
    """A signal at a moment; one for Ctrl-C not before the tool's own code runs."""
    number = attack.chance.choice(_SIGNALS)
    moment = attack.chance.random() * 1.1 * attack.unhurt.seconds

    def strike(process: subprocess.Popen[str]) -> None:
        time.sleep(moment)
        if number == signal.SIGINT:
            wait_until_begun(process)
        process.send_signal(number)

    with attack.ground.folder(attack.name, attack.command, attack.fresh) as folder:
        return attack.verdict(Run(attack.command, folder).ended(strike), folder)


def kill_at_a_call(attack: Attack) -> list[str]:
    """Sends a signal when something is about to be opened, written, synced, renamed, closed or made."""
    return _strike(attack, _file_calls(attack), [-number for number in _SIGNALS])


def killed_job(attack: Attack) -> list[str]:
    """Kills the tasks of a job and tries them again until each has ended: the result is the bake of one machine."""
    with attack.ground.folder(attack.name) as folder:
        return races.killed_job(folder, attack.chance)


# ---- Calls that fail ----


def failing_call(attack: Attack) -> list[str]:
    return _strike(attack, _file_calls(attack), _FAILURES)


def failing_allocation(attack: Attack) -> list[str]:
    """Fails an allocation of skinslide's own libraries, or of those that they compute with."""
    return _strike(attack, ["ours"] if attack.unhurt.calls["ours"] else _file_calls(attack), [errno.ENOMEM])


def failing_allocation_of_anybody(attack: Attack) -> list[str]:
    """Fails an allocation, mostly Python's or USD's, once skinslide has computed."""
    return _strike(attack, ["any"] if attack.unhurt.calls["any"] else _file_calls(attack), [errno.ENOMEM], others=True)


def _file_calls(attack: Attack) -> list[str]:
    return [call for call, count in attack.unhurt.calls.items() if count and call in _FILE_CALLS]


def _strike(attack: Attack, calls: list[str], values: Sequence[int], others: bool = False) -> list[str]:
    call, value = attack.chance.choice(calls), attack.chance.choice(values)
    number = attack.chance.randint(1, attack.unhurt.calls[call])
    with attack.ground.folder(attack.name, attack.command, attack.fresh) as folder:
        strike = attack.ground.preloaded(folder, f"{call} {number} {value}")
        ended = Run(attack.command, folder, strike).ended()
        found = attack.verdict(ended, folder, others)
    return [f"{attack.command.words[0]}, {call} {number} {value}: {each}" for each in found]


# ---- Limits ----


def limited_file_size(attack: Attack) -> list[str]:
    return _limited(attack, resource.RLIMIT_FSIZE, attack.chance.randrange(0, 40_000))


def limited_open_files(attack: Attack) -> list[str]:
    return _limited(attack, resource.RLIMIT_NOFILE, attack.chance.randrange(5, 40))


def limited_memory(attack: Attack) -> list[str]:
    """Allows a little less memory than it takes, or a little more: with much less, USD and Python do not load."""
    most = round(attack.unhurt.calls["memory"] * 1024 * attack.chance.uniform(0.8, 1.05))
    return _limited(attack, resource.RLIMIT_AS, most, others=True)


def _limited(attack: Attack, kind: int, most: int, others: bool = False) -> list[str]:
    with attack.ground.folder(attack.name, attack.command, attack.fresh) as folder:
        ended = Run(attack.command, folder, limits=((kind, most),)).ended()
        found = attack.verdict(ended, folder, others)
    return [f"{attack.command.words[0]}, at most {most}: {each}" for each in found]


def full_disk(attack: Attack) -> list[str]:
    """Writes to a small disk or, if none can be mounted, under a limit on the size of files."""
    if not attack.ground.mounts:
        return limited_file_size(attack)
    disk = attack.ground.work / attack.name
    disk.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "none", disk], check=True)
    try:
        attack.ground.fill(disk, attack.command, attack.fresh)
        used = shutil.disk_usage(disk).used
        size = used + attack.chance.randrange(0, 40) * os.sysconf("SC_PAGESIZE")
        subprocess.run(["mount", "-o", f"remount,size={size}", disk], check=True)
        found = attack.verdict(Run(attack.command, disk).ended(), disk)
    finally:
        subprocess.run(["umount", disk], check=True)
        disk.rmdir()
    return [f"{attack.command.words[0]}, {size - used} bytes: {each}" for each in found]


# ---- Several at once ----


def two_bakes(attack: Attack) -> list[str]:
    with attack.ground.folder(attack.name) as folder:
        return races.two_bakes(folder, attack.chance)


def three_edits(attack: Attack) -> list[str]:
    with attack.ground.folder(attack.name) as folder:
        return races.three_edits(folder)


def saved_while_it_is_live(attack: Attack) -> list[str]:
    with attack.ground.folder(attack.name) as folder:
        return races.saved_while_it_is_live(folder, attack.chance, attack.ground.live_seconds)


def live_in_threads(attack: Attack) -> list[str]:
    with attack.ground.folder(attack.name) as folder:
        return races.live_in_threads(folder, attack.chance.choice([2, 3, 8]), attack.ground.live_seconds)


KINDS: dict[str, Callable[[Attack], list[str]]] = {
    each.__name__.replace("_", " "): each
    for each in (
        kill,
        kill_at_a_call,
        killed_job,
        failing_call,
        failing_allocation,
        failing_allocation_of_anybody,
        limited_file_size,
        limited_open_files,
        limited_memory,
        full_disk,
        two_bakes,
        three_edits,
        saved_while_it_is_live,
        live_in_threads,
    )
}
