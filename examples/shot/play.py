"""Plays shot.usda: play.py SHOT.USDA

Prints for each frame how far the skin of the arm that slides is from that of the arm that does not, and how long its
points took. Then sets the envelope of the other arm to a half while the stage is open, and plays the last frame.
"""

import sys
import time

import numpy as np
from pxr import Usd, UsdGeom

import skinslide  # noqa: F401 (registers the file format)

MESH = "char/geo/body_GEO"


def points(stage: Usd.Stage, character: str, frame: float) -> np.ndarray:
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(f"/World/{character}/{MESH}"))
    return np.asarray(mesh.GetPointsAttr().Get(frame))


def farthest(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a.astype(float) - b, axis=1).max())


def main() -> None:
    stage = Usd.Stage.Open(sys.argv[1])
    first, last = int(stage.GetStartTimeCode()), int(stage.GetEndTimeCode())
    for frame in range(first, last + 1):
        begin = time.perf_counter()
        slid = points(stage, "slid", frame)
        took = 1e3 * (time.perf_counter() - begin)
        print(f"{frame}  {farthest(slid, points(stage, 'stuck', frame)):6.3f} cm  {took:6.2f} ms")
    stage.GetPrimAtPath("/World/stuck").GetAttribute("skinSlide:live:envelope").Set(0.5)
    half = farthest(points(stage, "slid", last), points(stage, "stuck", last))
    print(f"{last}  {half:6.3f} cm  with the envelope of the stuck arm at 0.5")


if __name__ == "__main__":
    main()
