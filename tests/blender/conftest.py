"""Blender as a Python module, in an environment of its own, with the extension installed as a user does."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
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
PACKAGES = ("bpy==5.0.1", "pytest>=8")
INSIDE = Path(__file__).parent / "inside"
SIDE = 12  # of the sheet inside


@dataclass(frozen=True)
class Blender:
    """The environment, the folder that stands for a user's, and the one for what tests leave."""

    python: Path
    user: Path
    out: Path

    def run(self, *arguments: str, timeout: float = 300) -> subprocess.CompletedProcess[str]:
        """Runs Blender's Python."""
        environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        environment |= {"BLENDER_USER_RESOURCES": str(self.user), "SKINSLIDE_BLENDER_OUT": str(self.out)}
        command = [str(self.python), *map(str, arguments)]
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=timeout)


@pytest.fixture(scope="session")
def environment() -> Path:
    """The environment's Python, made once. Skips where it cannot be had."""
    if sys.version_info[:2] != (3, 11):
        pytest.skip("bpy 5.0.1 is for Python 3.11 alone")
    python, stamp = HOME / "env" / "bin" / "python", HOME / "packages"
    if stamp.is_file() and stamp.read_text() == str(PACKAGES):
        return python
    HOME.mkdir(parents=True, exist_ok=True)
    subprocess.run([sys.executable, "-m", "venv", "--clear", HOME / "env"], check=True)
    pip = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check", *PACKAGES]
    made = subprocess.run(pip, capture_output=True, text=True, timeout=1800)
    if made.returncode:
        pytest.skip(f"bpy cannot be had: {made.stderr.strip().splitlines()[-1]}")
    loaded = subprocess.run([python, "-c", "import bpy"], capture_output=True, text=True, timeout=120)
    if loaded.returncode:  # it wants libraries of a desktop
        pytest.skip(f"bpy cannot be loaded: {loaded.stderr.strip().splitlines()[-1]}")
    stamp.write_text(str(PACKAGES))
    return python


def _sources() -> str:
    """What goes into the extension."""
    folders = ("core", "plugin", "schema")
    files = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file()]
    files = sorted(path for path in files if "__pycache__" not in path.parts)
    return hashlib.sha256(b"".join(str(path).encode() + path.read_bytes() for path in files)).hexdigest()


@pytest.fixture(scope="session")
def extension(environment) -> Path:
    """The zip, built by its one command where its sources have changed."""
    archive, stamp, sources = HOME / "skinslide.zip", HOME / "sources", _sources()
    if not (archive.is_file() and stamp.is_file() and stamp.read_text() == sources):
        build = ROOT / "plugin" / "blender" / "build.py"
        subprocess.run(
            [sys.executable, build, "-o", archive, "--build-dir", ROOT / "build" / "wheel"], check=True, timeout=600
        )
        stamp.write_text(sources)
    return archive


@pytest.fixture(scope="session")
def blender(environment, extension, tmp_path_factory) -> Blender:
    """Blender with the extension installed from its zip."""
    found = Blender(environment, tmp_path_factory.mktemp("user"), tmp_path_factory.mktemp("out"))
    done = found.run(INSIDE / "install.py", extension)
    assert done.returncode == 0, done.stdout + done.stderr
    return found


@pytest.fixture(scope="session")
def results(blender) -> dict[str, str]:
    """Of each test inside what went wrong, or nothing."""
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
    """A set-up of the tool's, of the faces of the sheet inside."""
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
