"""Tries an installed wheel: inside.py [--pictures]. Beside it is stages.py, of the tests."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom

import skinslide
import stages
from skinslide.command.start import main


def points(layer: Path, frame: float) -> bytes:
    stage = Usd.Stage.Open(str(layer))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(stages.MESH))
    return np.array(mesh.GetPointsAttr().Get(frame)).tobytes()


def run(*words: str | Path) -> int:
    sys.argv = ["skinslide", *map(str, words)]
    return main()


def tried(folder: Path, pictures: bool) -> None:
    shot, live, slid = folder / "shot.usda", folder / "live.skinslide", folder / "slid.usdc"
    stage, mesh = stages.patched_stage()
    stages.set_property(mesh, "forceDensityRule", "even")
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.catmullClark)
    stages.save(stage, shot)
    live.write_text("#usda 1.0\n(timeCodesPerSecond = 24; subLayers = [@./shot.usda@])\n")
    assert run("check", shot) == 0
    assert run("bake", shot, "-o", slid) == 0
    for number in (1, 2):
        assert run("bake", shot, "-o", folder / f"{number}.usdc", "--chunk", f"{number}/2") == 0
    assert run("stitch", folder / "1.usdc", folder / "2.usdc", "-o", folder / "stitched.usdc") == 0
    for frame in stages.FRAMES:
        assert points(live, frame) == points(slid, frame) == points(folder / "stitched.usdc", frame)
    assert points(slid, stages.FRAMES[-1]) != points(shot, stages.FRAMES[-1])
    # Where nothing draws, that is said.
    assert (run("preview", shot, "-o", folder / "pictures", "--size", "64x64") == 0) == pictures
    assert bool(list(folder.glob("pictures/*.png"))) == pictures


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        tried(Path(name), "--pictures" in sys.argv)
    print("skinslide", skinslide.__version__, "with USD", *Usd.GetVersion())
