"""Plays the character: play.py FOLDER, with stage.usda, its bake slid.usdc, and its cache skinned.usdc

Prints, frame by frame, how far the skin slid that a live layer computes from the cache, and how long its points took;
then whether they are those of the bake, and what UsdSkel still skins where that lies above the character.
"""

import sys
import time
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdSkel

import skinslide  # noqa: F401 (registers the file format)

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers.stage import MESH_PATH

LIVE = """#usda 1.0
(defaultPrim = "World"; metersPerUnit = 0.01; upAxis = "Y"; timeCodesPerSecond = 24
subLayers = [@./skinned.usdc@, @./stage.usda@])
"""


def above(*layers: Path) -> Usd.Stage:
    root = Sdf.Layer.CreateAnonymous(".usda")
    root.subLayerPaths, root.timeCodesPerSecond = list(map(str, layers)), 24
    return Usd.Stage.Open(root)


def points(stage: Usd.Stage, frame: float) -> np.ndarray:
    return np.asarray(UsdGeom.Mesh(stage.GetPrimAtPath(MESH_PATH)).GetPointsAttr().Get(frame))


def skinned_count(stage: Usd.Stage) -> int:
    cache, root = UsdSkel.Cache(), UsdSkel.Root.Find(stage.GetPrimAtPath(MESH_PATH))
    cache.Populate(root, Usd.TraverseInstanceProxies())
    bindings = cache.ComputeSkelBindings(root, Usd.TraverseInstanceProxies())
    return sum(len(binding.GetSkinningTargets()) for binding in bindings)


def main() -> None:
    folder = Path(sys.argv[1]).absolute()
    (folder / "live.skinslide").write_text(LIVE)
    live = Usd.Stage.Open(str(folder / "live.skinslide"))
    character = folder / "stage.usda"
    skinned, baked = (above(folder / name, character) for name in ("skinned.usdc", "slid.usdc"))
    frames = UsdGeom.Mesh(baked.GetPrimAtPath(MESH_PATH)).GetPointsAttr().GetTimeSamples()
    same = 0
    for frame in frames:
        begin = time.perf_counter()
        slid = points(live, frame)
        took = 1e3 * (time.perf_counter() - begin)
        farthest = np.linalg.norm(slid.astype(float) - points(skinned, frame), axis=1).max()
        same += slid.tobytes() == points(baked, frame).tobytes()
        print(f"{frame:g}  {farthest:6.3f} cm  {took:6.2f} ms")
    before = skinned_count(Usd.Stage.Open(str(character)))
    print(f"live as baked, to the bit: {same} of {len(frames)} frames")
    print(f"skinned by UsdSkel: {before} mesh of the character, {skinned_count(baked)} below its bake")


if __name__ == "__main__":
    main()
