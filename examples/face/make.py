"""Face: a smile, then the jaw opens, then the cheeks puff, over 24 frames, under one patch over the whole face.

The eyes, the nostrils and the mouth are pinned holes in the patch. Nothing folds over at them, even with the lips wide
open. The stretch falls as the jaw opens, and hardly changes as the cheeks puff; in the smile it rises a little with the
rule `unit`, since the skin between holes that do not move has little room.
The rest pose is `primvars:Pref`; the patch is a GeomSubset.
"""

import itertools
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import makehuman, regions, stage
from makers.command import main

RADIUS = 10.0  # cm over the skin, from the tip of the nose
NOSTRIL_PITS, NOSTRIL_RADIUS = (393, 7153), 0.6  # point ids of the base mesh; cm
SMILE = {"faceunits/mouthSmileLeft": 1.0, "faceunits/mouthSmileRight": 1.0}
JAW_OPEN = {"faceunits/jawOpen": 1.0}
CHEEK_PUFF = {"faceunits/cheekPuff": 1.0}
# Cache frame and amount of each key; between keys the amount eases in and out.
TRACKS = (
    (SMILE, [(1, 0), (7, 1), (11, 0)]),
    (JAW_OPEN, [(8, 0), (14, 1), (19, 0)]),
    (CHEEK_PUFF, [(17, 0), (22, 1), (24, 1)]),
)


def amount(keys: list[tuple[int, float]], frame: int) -> float:
    """The eased value of a track at a frame; before its first and after its last key it holds."""
    for (start, before), (end, after) in itertools.pairwise(keys):
        if start <= frame <= end:
            share = (frame - start) / (end - start)
            return before + (after - before) * share * share * (3 - 2 * share)
    return keys[0][1] if frame < keys[0][0] else keys[-1][1]


def expression(frame: int) -> np.ndarray:
    """Offsets (19158, 3), cm, of the face at a cache frame."""
    return sum(amount(keys, frame) * makehuman.read_offsets(targets) for targets, keys in TRACKS)


def cavities(mesh: makehuman.Mesh, body: np.ndarray, nose: int) -> np.ndarray:
    """The faces (F,) inside the eye sockets, the mouth and the nostrils, and all that is not the head."""
    islands = makehuman.texture_islands(mesh)
    away = islands != islands[regions.face_at(mesh.faces, nose)]
    for pit in NOSTRIL_PITS:
        away |= regions.oval(body, mesh.faces, pit, np.array([0.0, 1.0, 0.0]), NOSTRIL_RADIUS, slimness=1.0)
    return away


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    mesh = makehuman.read_mesh()
    points = mesh.points + makehuman.read_offsets(makehuman.YOUNG_MAN)
    body = points[: mesh.body_size]
    frames = (body + expression(frame)[: mesh.body_size] for frame in range(1, stage.FRAME_COUNT + 1))
    cache = stage.Cache(body, frames, mesh.faces, mesh.st, mesh.st_faces, rest_source="Pref")

    nose = int(np.where(body[:, 1] > 70, body[:, 2], -np.inf).argmax())
    disk = regions.below(regions.geodesic(body, mesh.faces, [nose]), mesh.faces, RADIUS)
    start = regions.face_at(mesh.faces, nose)
    region = regions.tidy(mesh.faces, disk, start, outside=cavities(mesh, body, nose))
    return stage.write(folder, cache, stage.Patch("face", region, store="subset"))


if __name__ == "__main__":
    main(make, __doc__)
