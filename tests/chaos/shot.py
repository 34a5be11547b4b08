"""What is attacked: a folder with a shot, and the commands of the tool with what each of them writes there."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Tf, UsdGeom, Vt

import skinslide
from stages import MESH, PATCH, add_mesh, add_patch, new_stage, quads, save, vectors

SIDE, FRAMES = 16, range(1001, 1009)
LEFT = [row * SIDE + column for row in range(3, SIDE - 3) for column in range(1, SIDE // 2)]
_SETUP = ("shot.usda", "-o", "patches.skinslide", "--prim", MESH, "--patch")
_QUICK = ("--lookup", "exact", "--quiet")
_SMALL = ("--size", "96x64", "--frames", "1001,1008")
_PICTURES = ("--pictures", "pictures", "--html", "page.html")


@dataclass(frozen=True)
class Command:
    """A command of the tool: its words, and patterns of the files and folders that it writes in its working folder."""

    words: tuple[str, ...]
    outputs: tuple[str, ...]

    @property
    def name(self) -> str:
        return self.words[0]


COMMANDS = [
    Command(("bake", "shot.usda", "-o", "out.usdc", *_QUICK), ("out.usdc",)),
    Command(("bake", "patches.skinslide", "-o", "out.usda", "--diagnostics", *_QUICK), ("out.usda",)),
    Command(
        ("bake", "shot.usda", "-o", "out.usdc", *_PICTURES, "--maps", "maps", "--map-size", "32", *_SMALL, *_QUICK),
        ("out.usdc", "pictures", "page.html", "maps"),
    ),
    Command(("setup", *_SETUP, "more", "--faces", "100-120"), ("patches.skinslide",)),
    Command(("paint", *_SETUP, PATCH, "--subset", "tendon", "--value", "3"), ("patches.skinslide",)),
    Command(("mirror", *_SETUP, PATCH), ("patches.skinslide",)),
    Command(("stitch", "a.usdc", "b.usdc", "-o", "out.usdc"), ("out.usdc",)),
    Command(("maps", "shot.usda", "-o", "maps", "--size", "32", *_QUICK), ("maps",)),
    Command(
        ("preview", "shot.usda", "-o", "pictures", "--html", "page.html", *_SMALL, *_QUICK), ("pictures", "page.html")
    ),
    Command(
        ("stitch", "a.usdc", "b.usdc", "-o", "clips.usda", "--clips", "--quiet"),
        ("clips.usda", "clips.manifest.*.usda"),
    ),
    Command(("farm", "shot.usda", "-o", "job.usdc", "--chunk", "3", "--quiet"), ("job.openjd.json",)),
]


def sheet_of(frame: float) -> np.ndarray:
    """Points of a sheet that is the same on both sides of x = 0, as the mirror wants it, and bulges to one side."""
    y, x = np.divmod(np.arange((SIDE + 1) ** 2), SIDE + 1) / np.float64(SIDE)
    bulge = (frame - FRAMES[0]) * 0.05 * np.sin(np.pi * x) ** 2 * np.sin(np.pi * y) ** 2 * (1.5 - x)
    return np.stack([x - 0.5 + bulge, y - 0.5, 3 * bulge], axis=1)


def lay_out(folder: Path) -> None:
    """The shot, a set-up, chunks of bakes, and older files where commands write."""
    stage = new_stage()
    stage.SetEndTimeCode(FRAMES[-1])
    mesh = add_mesh(stage, quads(sheet_of(FRAMES[0]), SIDE, SIDE), frames=())
    for frame in FRAMES:
        mesh.GetPointsAttr().Set(vectors(sheet_of(frame)), frame)
    add_patch(mesh, np.array(LEFT))
    _add_tendon_and_st(mesh)
    shot = save(stage, folder / "shot.usda")
    skinslide.setup_to_file(shot, folder / "patches.skinslide", MESH, "other", faces="200-215")
    skinslide.bake_to_file(shot, folder / "a.usdc", frames="1001-1004")
    skinslide.bake_to_file(shot, folder / "b.usdc", frames="1005-1008")
    for older in ("out.usdc", "out.usda"):
        skinslide.bake_to_file(shot, folder / older, frames="1001")
    skinslide.bake_to_file(shot, folder / "c.usdc", frames="1001", diagnostics=True)
    skinslide.stitch([folder / "c.usdc"], folder / "clips.usda", clips=True)
    (folder / "page.html").write_text("an older page")


def _add_tendon_and_st(mesh: UsdGeom.Mesh) -> None:
    tendon = UsdGeom.Subset.Define(mesh.GetPrim().GetStage(), f"{MESH}/tendon")
    tendon.CreateElementTypeAttr("edge")
    first = 6 * (SIDE + 1) + 3
    tendon.CreateIndicesAttr(Vt.IntArray([first, first + 1, first + 1, first + 2]))
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "vertex")
    st.Set(Vt.Vec2fArray([Gf.Vec2f(x + 0.5, y + 0.5) for x, y, _ in sheet_of(FRAMES[0]).tolist()]))


def content(file: Path) -> str | bytes:
    """What a file promises to hold: values of a crate file, whose bytes tell when it was saved; of a page, its end.

    Of a crate file that is not whole, its bytes.
    """
    data = file.read_bytes()
    if file.suffix == ".usdc":
        try:
            return Sdf.Layer.OpenAsAnonymous(str(file)).ExportToString()
        except Tf.ErrorException:
            return data
    if file.suffix == ".html" and data.rstrip().endswith(b"</html>"):
        return "a whole page"
    return data


def snapshot(folder: Path) -> dict[str, str | bytes]:
    """The content of every file below a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): content(path) for path in files}
