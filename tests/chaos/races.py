"""Several at once: bakes and edits into one file, and live layers whose source is saved again."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import skinslide
from chaos.shot import Command, content, snapshot
from chaos.tool import LATE, Ended, Run, end_of
from repository import ROOT
from stages import MESH, PATCH

_LIVE = (sys.executable, ROOT / "tests" / "format" / "read_live.py")
_THREADS = (sys.executable, ROOT / "tests" / "format" / "open_and_drop.py")
_CHUNKS = 3
_ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT / "tests" / "support"), str(ROOT / "tests")])}


def two_bakes(folder: Path, chance: random.Random) -> list[str]:
    """The output is that of the bake that ends last, whole."""
    ranges = ("1001-1004", "1003-1008")
    whole = [_baked(folder, frames) for frames in ranges]
    before = set(snapshot(folder))
    bakes = [Command(("bake", "shot.usda", "-o", "out.usdc", "--frames", frames), ("out.usdc",)) for frames in ranges]
    found = _all_at_once(folder, bakes, [0, chance.random() * 0.1])
    if content(folder / "out.usdc") not in whole:
        found.append("out.usdc is neither bake")
    return found + [f"{name} is left behind" for name in set(snapshot(folder)) - before]


def _baked(folder: Path, frames: str) -> str | bytes:
    skinslide.bake_to_file(folder / "shot.usda", folder / "whole.usdc", frames=frames)
    try:
        return content(folder / "whole.usdc")
    finally:
        (folder / "whole.usdc").unlink()


def killed_job(folder: Path, chance: random.Random) -> list[str]:
    """Each task is killed at a moment of its own, and tried again as a queue does, at most so often."""
    skinslide.bake_to_file(folder / "shot.usda", folder / "whole.usdc")
    chunks = [f"job.chunk{number}.usdc" for number in range(1, _CHUNKS + 1)]
    tasks = [
        ("bake", "shot.usda", "-o", chunk, "--chunk", f"{number}/{_CHUNKS}", "--resume", "--quiet")
        for number, chunk in enumerate(chunks, 1)
    ]
    for task in (*tasks, ("stitch", *chunks, "-o", "job.usdc")):
        left = chance.randint(1, 2)
        while (ended := _killed(folder, task, chance.random() if left else None)).code != 0:
            if ended.code != -signal.SIGKILL:
                return [f"{task[0]} ended with {ended.code}: {ended.err[-300:]}"]
            left -= 1
    same = content(folder / "job.usdc") == content(folder / "whole.usdc")
    return [] if same else ["job.usdc is not the bake of one machine"]


def _killed(folder: Path, task: tuple[str, ...], moment: float | None) -> Ended:
    """Runs a task that is killed after a moment; None: it is not killed."""

    def strike(process: subprocess.Popen[str]) -> None:
        if moment is not None:
            time.sleep(moment)
            process.send_signal(signal.SIGKILL)

    return Run(Command(task, ()), folder).ended(strike)


def three_edits(folder: Path) -> list[str]:
    """Each of the edits is in the file."""
    words = ("shot.usda", "-o", "patches.skinslide", "--prim", MESH, "--patch")
    edits = [
        ("setup", *words, "more", "--faces", "100-120"),
        ("paint", *words, PATCH, "--subset", "tendon", "--value", "3"),
        ("mirror", *words, PATCH),
    ]
    before = set(snapshot(folder))
    found = _all_at_once(folder, [Command(edit, ("patches.skinslide",)) for edit in edits], [0, 0, 0])
    text = (folder / "patches.skinslide").read_text()
    for made in ("skinSlide:other:patch", "skinSlide:more:patch", f"{PATCH}:edgeForceDensities", "elbow_R:patch"):
        if made not in text:
            found.append(f"{made} is lost")
    return found + [f"{name} is left behind" for name in set(snapshot(folder)) - before]


def _all_at_once(folder: Path, commands: list[Command], pauses: list[float]) -> list[str]:
    begun, processes = time.monotonic(), []
    for command, pause in zip(commands, pauses, strict=True):
        time.sleep(pause)
        processes.append(Run(command, folder).start())
    ends = [end_of(process, begun) for process in processes]
    return [
        f"{command.name} ended with {end.code}: {end.err}"
        for command, end in zip(commands, ends, strict=True)
        if end.code != 0
    ]


def live_in_threads(folder: Path, threads: int, seconds: float) -> list[str]:
    words = [*_THREADS, folder, str(threads), str(seconds), "--listen"]
    return _failures([_started(words)], seconds)


def saved_while_it_is_live(folder: Path, chance: random.Random, seconds: float) -> list[str]:
    """Two processes read one or the other version of a source that is replaced meanwhile, as tools replace files."""
    versions = [folder / "shot.usda", folder / "slower.usda"]
    versions[1].write_text(versions[0].read_text().replace("1008: [", "1009: ["))
    digests = [_digest(folder, version) for version in versions]
    assert digests[0] != digests[1]
    readers = [_started([*_LIVE, folder / "live.skinslide", str(seconds), *digests]) for _ in range(2)]
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        _replace(folder, chance.choice(versions))
        time.sleep(chance.random() * 0.05)
    return _failures(readers, seconds)


def _replace(folder: Path, version: Path) -> None:
    shutil.copy(version, folder / "source.new")
    os.replace(folder / "source.new", folder / "source.usda")


def _digest(folder: Path, version: Path) -> str:
    _replace(folder, version)
    (folder / "live.skinslide").write_text(
        '#usda 1.0\n(defaultPrim = "World"; timeCodesPerSecond = 24; subLayers = [@./source.usda@])\n'
    )
    return subprocess.run(
        [*_LIVE, folder / "live.skinslide", "0"], env=_ENVIRONMENT, capture_output=True, text=True, check=True
    ).stdout.strip()


def _started(words: list) -> subprocess.Popen[str]:
    return subprocess.Popen(words, env=_ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _failures(processes: list[subprocess.Popen[str]], seconds: float) -> list[str]:
    ends: list[Ended] = [end_of(process, time.monotonic()) for process in processes]
    return [f"ended with {end.code} within {seconds + LATE:.0f} s: {end.err[-300:]}" for end in ends if end.code != 0]
