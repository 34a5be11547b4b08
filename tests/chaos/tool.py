"""Runs the tool, and says how it ended."""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from chaos.shot import Command

LATE = 60  # seconds, after which a run is said to hang
TOOL = (sys.executable, "-m", "skinslide")


@dataclass(frozen=True)
class Ended:
    """How a run ended: its exit code, below 0 the signal that ended it, None where it hung; what it said."""

    code: int | None
    out: str
    err: str
    seconds: float


@dataclass
class Run:
    """A run of a command in a folder."""

    command: Command
    folder: Path
    variables: dict[str, str] = field(default_factory=dict)
    limits: tuple[tuple[int, int], ...] = ()

    def start(self) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [*TOOL, *self.command.words],
            cwd=self.folder,
            env={**os.environ, **self.variables},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=self._limit if self.limits else None,
        )

    def _limit(self) -> None:
        for kind, most in self.limits:
            resource.setrlimit(kind, (most, most))

    def ended(self, then: Callable[[subprocess.Popen[str]], None] = lambda process: None) -> Ended:
        """Runs it to its end; `then` is called once it has started."""
        begun = time.monotonic()
        process = self.start()
        then(process)
        return end_of(process, begun)


def end_of(process: subprocess.Popen[str], begun: float) -> Ended:
    try:
        out, err = process.communicate(timeout=LATE)
        code: int | None = process.returncode
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        code = None
    return Ended(code, out, err, time.monotonic() - begun)


def wait_until_begun(process: subprocess.Popen[str]) -> None:
    """Waits for the tool's own code, which blocks Ctrl-C first of all, or for its end."""
    while process.poll() is None:
        words = Path(f"/proc/{process.pid}/status").read_text().split("SigBlk:\t")[-1].split()
        if int(words[0], 16) >> (signal.SIGINT - 1) & 1:
            return
        time.sleep(0.002)
