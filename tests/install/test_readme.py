"""Every command and snippet of the README runs as it stands there."""

import re
import shlex
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdGeom

from repository import ROOT

README = (ROOT / "README.md").read_text()
SCRIPTS = Path(sysconfig.get_path("scripts"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What a reader has: a cached character with masks painted on it, a rigged one, and a stage with a patch set up."""
    folder = tmp_path_factory.mktemp("readme")
    subprocess.run([sys.executable, ROOT / "examples/elbow/make.py", folder], check=True, capture_output=True)
    stage = Usd.Stage.Open(str(folder / "stage.usda"))
    mesh = stage.GetPrimAtPath("/World/char/geo/body_GEO")
    painted = mesh.GetAttribute("primvars:skinSlide:elbow_L:patch").Get()
    character = Usd.Stage.CreateNew(str(folder / "character.usd"))
    character.GetRootLayer().TransferContent(stage.GetRootLayer())
    mesh = character.GetPrimAtPath(mesh.GetPath())
    mask = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("elbowMask", Sdf.ValueTypeNames.BoolArray, UsdGeom.Tokens.uniform)
    mask.Set(painted)
    tendon = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("tendon", Sdf.ValueTypeNames.FloatArray, UsdGeom.Tokens.vertex)
    tendon.Set([1.0] * len(UsdGeom.Mesh(mesh).GetPointsAttr().Get()))
    mesh.ClearMetadata("apiSchemas")
    character.Save()
    subprocess.run(
        [sys.executable, ROOT / "examples/character/make.py", folder / "rig"], check=True, capture_output=True
    )
    Sdf.Layer.FindOrOpen(str(folder / "rig" / "character.usdc")).Export(str(folder / "rigged.usd"))
    return folder


def python_snippets():
    return re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def shell_commands():
    """The lines of indented blocks, and inline code, that call the tool."""
    return re.findall(
        r"(?:^    |`)(skinslide (?:setup|mirror|paint|check|preview|bake|cache|maps|stitch|farm) [^`\n]*)",
        README,
        re.MULTILINE,
    )


def test_readme_is_short():
    assert len(README.splitlines()) < 150


def test_links_lead_somewhere():
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in link]
    assert links and all((ROOT / link).exists() for link in links)


@pytest.mark.parametrize("snippet", python_snippets())
def test_python_snippet(snippet, folder):
    subprocess.run([sys.executable, "-c", snippet], cwd=folder, check=True, capture_output=True, text=True)


def test_shell_commands_in_order(folder):
    commands = shell_commands()
    assert len(commands) >= 8
    for command in commands:
        words = shlex.split(command.replace("STAGE", "stage.usda"))
        subprocess.run([SCRIPTS / words[0], *words[1:]], cwd=folder, check=True, capture_output=True, text=True)
