"""Runs the tool as a queue does, and kills it."""

import os
import signal
import subprocess
import sysconfig
import time
from collections.abc import Callable
from pathlib import Path

from pxr import Sdf

SCRIPTS = Path(sysconfig.get_path("scripts"))
LATE = 120  # seconds


def content(layer: Path) -> str:
    return Sdf.Layer.OpenAsAnonymous(str(layer)).ExportToString()


def tool(*words: str | Path, code: int = 0) -> str:
    """Runs the tool, and returns its output."""
    done = subprocess.run([SCRIPTS / "skinslide", *words], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done.stdout + done.stderr


def wait_until(found: Callable[[], object], what: str, pause: float = 0.002) -> None:
    end = time.monotonic() + LATE
    while not found():
        assert time.monotonic() < end, f"no {what} after {LATE} seconds"
        time.sleep(pause)


def kill_baking(folder: Path, chunk: str) -> None:
    """Kills the bake of a chunk while it writes, like a machine that goes down."""
    stem = chunk.removesuffix(".usdc")
    wait_until(lambda: list(folder.glob(f".{stem}.*.usdc")), f"bake of {chunk}")
    for process in baking(folder / chunk):
        os.kill(process, signal.SIGKILL)


def baking(output: Path) -> list[int]:
    """The processes of the tool that write a layer."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = entry.read_bytes().decode(errors="replace").split("\0")
        except OSError:  # it has ended
            continue
        if "bake" in words and str(output) in words:
            found.append(int(entry.parent.name))
    return found
