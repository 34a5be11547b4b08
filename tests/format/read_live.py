"""Opens a `.skinslide` file, reads every frame, drops it, and does so again: read_live.py FILE SECONDS [DIGEST...]

What it reads must have one of the digests; without any, it prints the one that it has.
"""

import hashlib
import sys
import time

import numpy as np
from pxr import Usd

from stages import MESH


def digest(path: str) -> str:
    stage = Usd.Stage.Open(path)
    points = stage.GetAttributeAtPath(f"{MESH}.points")
    read = hashlib.sha256()
    for frame in points.GetTimeSamples():
        read.update(f"{frame} ".encode() + np.asarray(points.Get(frame)).tobytes())
    return read.hexdigest()


def main(path: str, seconds: str, *expected: str) -> None:
    end, count = time.monotonic() + float(seconds), 0
    while count == 0 or time.monotonic() < end:
        found, count = digest(path), count + 1
        if expected and found not in expected:
            sys.exit(f"reading {count} gave neither version")
    print(found)


if __name__ == "__main__":
    main(*sys.argv[1:])
