"""Fixtures of several folders."""

import signal
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

import skinslide  # noqa: F401 (registers the file format before any test opens a layer, when USD takes no more)
from repository import load


def pytest_configure() -> None:
    # A shell's jobs in the background ignore SIGINT, and those of nohup SIGHUP. So would all processes that tests start
    # and signal, but for a handler here, which is not handed down.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if signal.getsignal(signal.SIGHUP) == signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda *_: None)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--record", action="store_true", help="record the digests of what is baked")


@pytest.fixture
def public_folder():
    """A folder that every user can reach, unlike pytest's."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


@pytest.fixture(scope="session")
def example_stage(tmp_path_factory) -> Callable[[str], Path]:
    """Makes each example once, when a test first asks for it by name: the stage, which is for reading only."""
    made = {}

    def make(name: str) -> Path:
        if name not in made:
            made[name] = load(f"{name}/make.py").make(tmp_path_factory.mktemp(name) / "made" / "here")
        return made[name]

    return make
