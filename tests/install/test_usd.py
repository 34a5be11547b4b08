"""The tool on other versions of USD than the one that all other tests run on: the oldest, and the newest."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from repository import ROOT

_WARNING = "ignore:skinslide's file format was built"
_OFFSETS = ("times: an offset and a scale of the sublayer", "times: a scale of a third")
# What is slid otherwise since USD reads it otherwise: samples through offsets, and between samples whose type is not
# that of the schema.
_READ_OTHERWISE = {
    "usd-core==25.5": (*_OFFSETS, "points: double", "points: half", "envelope: double samples"),
    "usd-core==26.11": _OFFSETS,
}


@pytest.fixture(scope="module", params=_READ_OTHERWISE, ids=["oldest", "newest"])
def usd(request) -> tuple[str, Path]:
    """What was asked for, and the folder that it is in, which stays for the next run of the tests."""
    folder = ROOT / "build" / "usd" / request.param.removeprefix("usd-core==")
    if not (folder / "pxr").is_dir():
        install = ["install", "--quiet", "--no-deps", "--disable-pip-version-check", "--target", folder]
        done = subprocess.run([sys.executable, "-m", "pip", *install, request.param], capture_output=True, text=True)
        if done.returncode:
            pytest.skip(f"{request.param} cannot be had: {done.stderr.strip().splitlines()[-1]}")
    return request.param, folder


def run(usd: Path, *words: str | Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(usd)}
    return subprocess.run([sys.executable, *words], cwd=ROOT, env=environment, capture_output=True, text=True)


def test_it_is_another(usd):
    said = run(
        usd[1], "-c", "import skinslide; from pxr import Usd; print(Usd.__file__, skinslide.registration.registered())"
    )
    assert str(usd[1]) in said.stdout and said.stdout.rstrip().endswith("False")
    assert "file format was built for USD" in said.stderr and "Baking works" in said.stderr


def test_it_does_what_it_does_with_the_pinned(usd):
    """Bytes of every good stage there is a row of, and what is written; but for what USD's own validators say."""
    rows = "tests/stage/test_digests.py"
    others = [f"--deselect={rows}::test_good_rows[{name}]" for name in _READ_OTHERWISE[usd[0]]]
    names = "good_rows or test_written and not usd_finds_nothing_wrong"
    words = ("-q", "-W", _WARNING, rows, "tests/tool/test_written.py", "-k", names, *others)
    done = run(usd[1], "-W", _WARNING, "-m", "pytest", *words)
    assert done.returncode == 0, done.stdout[-3000:]
