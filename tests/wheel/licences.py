"""Puts the licences of the libraries inside a wheel beside its own: licences.py FOLDER_OF_AN_UNPACKED_WHEEL"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

_HEADERS_ALONE = ("libglm-dev",)  # compiled in, with no library of its own
_FOLDERS = [Path("/usr/lib/x86_64-linux-gnu"), Path("/lib/x86_64-linux-gnu")]


def main() -> None:
    wheel = Path(sys.argv[1])
    (licences,) = wheel.glob("*.dist-info/licenses")
    inside = sorted(wheel.glob("*.libs/*"))
    assert inside, "no library is inside"
    for package in sorted({*map(package_of, inside), *_HEADERS_ALONE}):
        shutil.copy(Path("/usr/share/doc") / package / "copyright", licences / f"{package}.txt")


def package_of(library: Path) -> str:
    """The Debian package that a library comes from, whose name has a hash in it here."""
    name = re.sub(r"-[0-9a-f]{8}(?=\.so)", "", library.name)
    found = next(folder / name for folder in _FOLDERS if (folder / name).exists())
    for path in (found, Path("/usr") / found.relative_to("/"), Path("/") / found.relative_to("/usr")):
        done = subprocess.run(["dpkg", "-S", path], capture_output=True, text=True)
        if done.returncode == 0:
            return done.stdout.partition(":")[0]
    raise SystemExit(f"{name}: of no package")


if __name__ == "__main__":
    main()
