"""What an installed skinslide holds."""

import importlib.metadata
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from pxr import Plug, Usd

import skinslide
from repository import ROOT

PACKAGE = Path(skinslide.__file__).parent


def test_one_version():
    declared = re.search(r"project\(skinslide VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert skinslide.__version__ == importlib.metadata.version("skinslide") == declared


def test_public_names_exist():
    assert [name for name in skinslide.__all__ if not hasattr(skinslide, name)] == []


def test_the_schema_is_registered_on_import():
    plugin = Plug.Registry().GetPluginWithName("skinslide")
    assert Path(plugin.MakeResourcePath("generatedSchema.usda")).is_file()
    assert Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("SkinSlideAPI")


@pytest.mark.parametrize("command", [["skinslide"], ["python", "-m", "skinslide"]])
def test_the_command_is_installed(command):
    program = Path(sys.executable).parent / command[0]
    done = subprocess.run([program, *command[1:], "--version"], capture_output=True, text=True, check=True)
    assert skinslide.__version__ in done.stdout


def test_an_interruption_while_the_command_is_loaded(tmp_path):
    code = """
        import os, signal, sys
        from skinslide_command import main
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        os.kill(os.getpid(), signal.SIGINT)  # comes as soon as it is let through
        sys.exit(main())
    """
    command = [sys.executable, "-c", textwrap.dedent(code), "check", tmp_path / "shot.usda"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


@pytest.mark.parametrize("header", ["skinslide.h", "picture.h"])
def test_the_headers_are_the_manual(header):
    installed = PACKAGE / "include" / "skinslide" / header
    assert installed.read_text() == (ROOT / "core" / "include" / "skinslide" / header).read_text()


def test_a_project_in_c_or_cpp_builds_against_the_package(tmp_path):
    assert shutil.which("cmake")
    configure = ["cmake", "-S", ROOT / "tests" / "consumer", "-B", tmp_path, f"-Dskinslide_DIR={skinslide.cmake_dir()}"]
    subprocess.run(configure, capture_output=True, check=True)
    subprocess.run(["cmake", "--build", tmp_path], capture_output=True, check=True)
    for program in ("consumer_c", "consumer_cpp"):
        done = subprocess.run([tmp_path / program], capture_output=True, text=True, check=True)
        version, middle = done.stdout.split()
        assert version == skinslide.__version__
        # From 1.5, where it was pulled to, it goes most of the way back to 1.
        assert 1 <= float(middle) < 1.25
