"""Prints how a bake changes authored normals: one line for each example.

usage: normals.py STAGE...
A mesh without normals is given smooth ones by corner, as an exporter would write them. `turned by` is the largest angle
at any frame between a normal in the cache and the same normal in the bake; `jump` is the same for a bake that slides by
5e-6 units at most. `seams` is the largest angle between two normals at one place, of those within a degree of each
other in the cache, there and in the bake. Angles are in degrees.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, Vt

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines

import skinslide
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

HEADINGS = ("example", "largest slide", "turned by", "jump", "seams, cache", "slid")
TINY = 5e-6  # units
SMOOTH = 1.0  # degrees

Normals = dict[float, np.ndarray]  # at a time, (n, 3)


def angles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Between vectors (n, 3), in degrees; exact where they are small."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


def smooth_normals(points: np.ndarray, counts: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """Means of face normals by area, (V, 3)."""
    starts, sums = np.concatenate([[0], np.cumsum(counts)[:-1]]), np.zeros(points.shape)
    for size in np.unique(counts):
        corners = indices[starts[counts == size][:, None] + np.arange(size)]
        around = points[corners].astype(float)
        normals = np.cross(around, np.roll(around, -1, axis=1)).sum(axis=1)
        np.add.at(sums, corners, normals[:, None])
    return sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-30)[:, None]


def author_normals(mesh: PatchedMesh) -> None:
    """By corner, at each sample of points, where the stage's edit target is."""
    normals = UsdGeom.Mesh(mesh.prim).CreateNormalsAttr()
    UsdGeom.Mesh(mesh.prim).SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    for time in mesh.points_times():
        points = mesh.points_at(Usd.TimeCode(time))
        of_corners = smooth_normals(points, mesh.face_counts, mesh.face_indices)[mesh.face_indices]
        normals.Set(Vt.Vec3fArray.FromNumpy(of_corners.astype(np.float32)), time)


def read_normals(prim: Usd.Prim, times: list[float]) -> Normals:
    """Of the primvar where there is one, which wins; none where the mesh has none."""
    primvar, attribute = UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals"), UsdGeom.Mesh(prim).GetNormalsAttr()
    read = primvar.ComputeFlattened if primvar.HasAuthoredValue() else attribute.Get
    there = primvar.HasAuthoredValue() or attribute.HasAuthoredValue()
    return {time: np.array(read(time), float) for time in times if there}


def cached_normals(mesh: PatchedMesh, times: list[float]) -> Normals:
    """Of a mesh that UsdSkel skins as it skins them; of another as they are authored or, for none, made."""
    for skinned in mesh.skinned_vectors() if mesh.skinning else []:
        if skinned.attribute:
            return {time: skinned.skinned(Usd.TimeCode(time)).astype(float) for time in times}
    if not read_normals(mesh.prim, times):
        author_normals(mesh)
    return read_normals(mesh.prim, times)


def with_envelope(mesh: PatchedMesh, envelope: float) -> None:
    for patch in mesh.patches:
        mesh.prim.GetAttribute(f"skinSlide:{patch.name}:envelope").Set(envelope)


def baked(stage: Usd.Stage, mesh: PatchedMesh, times: list[float]) -> tuple[Normals, float]:
    """The normals of a bake, and the largest slide in it."""
    with tempfile.TemporaryDirectory() as folder:
        report = skinslide.bake_to_file(stage, Path(folder) / "slid.usdc", prims=mesh.prim)
        above = Usd.Stage.Open(str(Path(folder) / "slid.usdc"))
        found = read_normals(above.GetPrimAtPath(mesh.path), times)
    largest = max(patch.column("largest_slide").max() for each in report.meshes for patch in each.patches)
    return found, largest


def pairs_in_place(mesh: PatchedMesh, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of the elements that normals are of, of which both are in one place."""
    points = mesh.points_at(Usd.TimeCode(mesh.points_times()[0]))
    places = np.unique(points, axis=0, return_inverse=True)[1].ravel()
    of_elements = places if count == len(points) else places[mesh.face_indices]
    order = np.argsort(of_elements, kind="stable")
    same = np.flatnonzero(np.diff(of_elements[order]) == 0)
    return order[same], order[same + 1]


def largest_seam(cached: Normals, found: Normals, pairs: tuple[np.ndarray, np.ndarray]) -> float:
    first, second = pairs
    worst = 0.0
    for time, before in cached.items():
        smooth = angles(before[first], before[second]) < SMOOTH
        between = angles(found[time][first[smooth]], found[time][second[smooth]])
        worst = max(worst, float(between.max(initial=0)))
    return worst


def largest_turn(cached: Normals, found: Normals) -> float:
    return max(float(angles(before, found[time]).max()) for time, before in cached.items())


def row(path: Path) -> list[str]:
    """The cells of one example."""
    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    mesh = read_meshes(stage)[0][0]
    times = mesh.sample_times()
    cached = cached_normals(mesh, times)
    slid, largest = baked(stage, mesh, times)
    with_envelope(mesh, TINY / largest)
    tiny, _ = baked(stage, mesh, times)
    pairs = pairs_in_place(mesh, len(cached[times[0]]))
    turns = [largest_turn(cached, found) for found in (slid, tiny)]
    seams = [largest_seam(cached, found, pairs) for found in (cached, slid)]
    return [path.parent.name, f"{largest:.3f}", *(f"{angle:.2f}" for angle in (*turns, *seams))]


def main() -> None:
    print(lines(HEADINGS, (row(Path(path)) for path in sys.argv[1:])), end="")


if __name__ == "__main__":
    main()
