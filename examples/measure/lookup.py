"""Looks the examples up by colour-ID rendering: how many vertices the texture finds, and pictures of it.

usage: lookup.py OUTDIR
Slides every frame of OUTDIR/*/stage.usda with the lookups egl and exact, checks that their points are the same bytes,
and prints a line for each example. Writes OUTDIR/id_buffers.png: the textures of the elbow, the face with its holes and
the chequer, at the frame where the cache has most stretch, with one colour for each face.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image
from pxr import Usd

from skinslide import Frame, Lookup, choose_lookup
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

EXAMPLES = ("elbow", "bicep", "face", "finger", "sleeve", "chequer")
PICTURED = ("elbow", "face", "chequer")
SIDE, GAP = 512, 16
FOUND = ("found_in_centre", "found_in_3x3", "walked_vertices", "searched_vertices")


def open_mesh(stage_path: Path) -> PatchedMesh:
    """The one mesh of an example."""
    (mesh,), _problems = read_meshes(Usd.Stage.Open(str(stage_path)))
    return mesh


def frames(mesh: PatchedMesh, lookup: str | Lookup) -> Iterator[Frame]:
    """Every frame of the cache, slid."""
    slider = mesh.slider(lookup)
    for time in mesh.sample_times():
        time = Usd.TimeCode(time)
        yield slider.slide(mesh.points_at(time), mesh.controls_at(time))


def shares(mesh: PatchedMesh, lookup: Lookup) -> tuple[np.ndarray, bool]:
    """How many vertices were found in each way over all frames, and whether lookup exact gives the same bytes."""
    found, same = np.zeros(len(FOUND), int), True
    for egl, exact in zip(frames(mesh, lookup), frames(mesh, "exact"), strict=True):
        found += [sum(getattr(patch, name) for patch in egl.patches) for name in FOUND]
        same &= egl.points.tobytes() == exact.points.tobytes()
    return found, same


def picture(mesh: PatchedMesh) -> np.ndarray:
    """The texture where the cache has most stretch: uint8 (SIDE, SIDE, 3), v upwards, white where there is no face."""
    times = [Usd.TimeCode(time) for time in mesh.sample_times()]
    stretch = [frame.patches[0].stretch_before for frame in frames(mesh, "exact")]
    points = mesh.points_at(times[int(np.argmax(stretch))])
    texels = mesh.slider(Lookup("egl", resolution=SIDE)).id_buffer(points, 0)
    colours = np.random.default_rng(1).integers(40, 230, (int(texels.max()) + 1, 3), np.uint8)
    colours[0] = 255
    return colours[texels[::-1]]


def main() -> None:
    """Prints the shares, then where the picture is."""
    folder = Path(sys.argv[1])
    device = choose_lookup("egl")
    print(f"{device.device_name}: {device.renderer}, {device.driver}")
    print("example   centre      3x3   walked  searched  same bytes as exact")
    differing = []
    for example in EXAMPLES:
        found, same = shares(open_mesh(folder / example / "stage.usda"), Lookup("egl"))
        cells = "  ".join(f"{100 * count / max(found.sum(), 1):5.2f} %" for count in found)
        print(f"{example:8} {cells}   {'yes' if same else 'NO'}")
        differing += [] if same else [example]
    print("In the paper, the 3x3 texels suffice; vertices that walked are those they missed.")
    gap = np.full((SIDE, GAP, 3), 255, np.uint8)
    panels = [part for name in PICTURED for part in (gap, picture(open_mesh(folder / name / "stage.usda")))][1:]
    Image.fromarray(np.hstack(panels)).save(folder / "id_buffers.png", optimize=True)
    print(f"\n{folder}/id_buffers.png: the textures of {', '.join(PICTURED)}")
    if differing:
        sys.exit(f"error: the lookups differ on {', '.join(differing)}")


if __name__ == "__main__":
    main()
