"""Makes a root folder with the Python that runs this, what it is linked to, and nothing else: clean_root.py FOLDER"""

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

# What manylinux takes to be on every machine, and Python itself may not be linked to.
_OF_THE_SYSTEM = (
    "libstdc++.so.6",
    "libgcc_s.so.1",
    "libm.so.6",
    "libdl.so.2",
    "libpthread.so.0",
    "librt.so.1",
    "libutil.so.1",
)


def main() -> None:
    root = Path(sys.argv[1])
    home, standard = root / "python", Path(sysconfig.get_path("stdlib"))
    executable = Path(sys.executable).resolve()
    place(executable, home / "bin" / "python")
    there = home / "lib" / standard.name
    shutil.copytree(
        standard, there, ignore=shutil.ignore_patterns("site-packages", "dist-packages", "test", "__pycache__")
    )
    place(Path("/usr/bin/env"), root / "usr" / "bin" / "env")
    binaries = [executable, Path("/usr/bin/env"), *there.rglob("*.so")]
    for library in sorted({each for binary in binaries for each in needed(binary)} | set(of_the_system())):
        place(library.resolve(), root / library.relative_to("/"))
    (root / "tmp").mkdir()


def place(file: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(file, target)


def needed(binary: Path) -> list[Path]:
    said = subprocess.run(["ldd", binary], capture_output=True, text=True).stdout
    return [Path(os.path.normpath(path)) for path in re.findall(r"(/\S+) \(0x", said)]


def of_the_system() -> list[Path]:
    known = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True, check=True).stdout
    found = dict(re.findall(r"^\s+(\S+) \(libc6,x86-64.*\) => (\S+)$", known, re.MULTILINE))
    return [Path(found[name]) for name in _OF_THE_SYSTEM if name in found]


if __name__ == "__main__":
    main()
