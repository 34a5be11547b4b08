"""What a bake costs as a shot grows: set-up, time a frame, memory, against points, patches and frames.

tests/bench.sh --scale [--rule RULE] [--jobs N] [--large]        a line for each shot, as Markdown
    --large     also 250,000 points in 100 patches, over ever more frames: memory must not follow them

Each shot is baked by a process of its own. Memory is anonymous, and at most: what is mapped of files is not counted.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pxr import Sdf, Usd, UsdGeom, Vt

import skinslide

MESH = "/World/sheet"
_BETWEEN = 0.01  # seconds between looks at the memory


class Shot(NamedTuple):
    """A square sheet with square patches side by side, whose number is a square."""

    points: int
    patches: int
    frames: int


SHOTS = [
    *(Shot(points, 1, 8) for points in (1_000, 10_000, 100_000)),
    *(Shot(100_000, patches, 8) for patches in (9, 100, 225, 400, 900)),
    *(Shot(10_000, 1, frames) for frames in (32, 128, 512)),
]
LARGE = [Shot(250_000, 100, frames) for frames in (10, 40, 160)]


def make(shot: Shot, rule: str, path: Path) -> None:
    """A stage with the cache in it, saved as it is made."""
    side = round(shot.points**0.5)
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetTimeCodesPerSecond(24)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    mesh = UsdGeom.Mesh.Define(stage, MESH)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    faces = np.stack([corner, corner + 1, corner + side + 1, corner + side], axis=1)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 4, np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(faces.ravel().astype(np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    y, x = np.divmod(np.arange(side * side), side) / np.float64(side - 1)
    rest = np.stack([x, y, 0 * x], axis=1)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(rest.astype(np.float32)))
    across = round(shot.patches**0.5)
    row, column = np.divmod(np.arange(len(faces)), side - 1)
    of = row * across // (side - 1) * across + column * across // (side - 1)
    names = [f"p{number}" for number in range(across * across)]
    schemas = Sdf.TokenListOp.Create(prependedItems=[f"SkinSlideAPI:{name}" for name in names])
    mesh.GetPrim().SetMetadata("apiSchemas", schemas)  # at once: by one, USD composes all there are each time
    for number, name in enumerate(names):
        patch = skinslide.SkinSlideAPI(mesh, name)
        patch.SetFaces(of == number)
        patch.CreateForceDensityRuleAttr(rule)
    for frame in range(1, shot.frames + 1):
        bulge = 0.2 * frame / shot.frames * np.sin(np.pi * across * x) ** 2 * np.sin(np.pi * across * y) ** 2 / across
        points = rest + np.stack([bulge * x, 0 * x, bulge], axis=1)
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points.astype(np.float32)), frame)
        if frame % 16 == 0:
            stage.Save()
    stage.Save()


def anonymous() -> int:
    """The bytes of memory of this process."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(status.partition("RssAnon:")[2].split()[0])


def measure(stage: Path, jobs: int) -> dict[str, float]:
    """Bakes the shot in this process."""
    most, ended, first = anonymous(), threading.Event(), 0.0

    def watch() -> None:
        nonlocal most
        while not ended.wait(_BETWEEN):
            most = max(most, anonymous())

    def progress(done: int, _total: int) -> None:
        nonlocal first
        if done == 1:
            first = time.perf_counter()

    watching = threading.Thread(target=watch)
    watching.start()
    begun = time.perf_counter()
    with tempfile.TemporaryDirectory(dir=stage.parent) as folder:
        report = skinslide.bake_to_file(stage, Path(folder) / "slid.usdc", jobs=jobs, progress=progress)
        over = time.perf_counter()
    ended.set()
    watching.join()
    frames = report.meshes[0].frame_count
    a_frame = (over - first) / max(frames - 1, 1)
    return {"setup": first - begun - a_frame, "frame": a_frame, "memory": most}


def in_a_process(shot: Shot, rule: str, jobs: int) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder) / "shot.usdc"
        make(shot, rule, stage)
        words = [sys.executable, __file__, "--stage", str(stage), "--jobs", str(jobs)]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="tests/bench.sh --scale", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rule", default="even")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--stage", type=Path, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.stage:
        print(json.dumps(measure(given.stage, given.jobs)))
        return
    print("| points | patches | frames | set-up, s | a frame, ms | memory, MB |\n|---|---|---|---|---|---|")
    for shot in SHOTS + LARGE * given.large:
        cost = in_a_process(shot, given.rule, given.jobs)
        sizes = " | ".join(f"{number:,}" for number in shot)
        print(f"| {sizes} | {cost['setup']:.2f} | {1e3 * cost['frame']:.1f} | {cost['memory'] / 1e6:.0f} |", flush=True)


if __name__ == "__main__":
    main()
