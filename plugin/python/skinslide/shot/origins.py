"""What a layer is baked from, as its record says it: meshes in a few digests, and frames.

Two bakes of which a digest differs do not belong into one shot.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Tf, Usd

from skinslide.arrays.fetched import Value
from skinslide.arrays.setups import Controls
from skinslide.problems import Fault, FrameProblem
from skinslide.shot.derived import Cached, Derived
from skinslide.shot.diagnostics import texture_coordinates
from skinslide.shot.frames import Chunk
from skinslide.shot.plan import Plan, PlannedMesh
from skinslide.stage.mesh import PatchedMesh
from skinslide.write.overs import clock_for, clock_of
from skinslide.write.record import MeshRecord, Record

_BYTES = 8


def record_of(plan: Plan, chunk: Chunk | None, options: dict[str, Any]) -> Record:
    """The record of a layer with all that is planned, but for poses, which are known as they are slid."""
    diagnostics = bool(options.get("diagnostics"))
    meshes = {each.mesh.path: MeshRecord(origins_of(each, diagnostics), tuple(each.frames)) for each in plan.meshes}
    record = Record(meshes, options, asked=tuple(sorted(plan.paths)))
    if chunk:
        record = replace(record, chunk=str(chunk), wanted=tuple(plan.wanted))
    frames = record.frames
    if not frames:
        return record
    before = max((frame for frame in plan.own if frame < frames[0]), default=None)
    after = min((frame for frame in plan.own if frame > frames[-1]), default=None)
    return replace(record, before=before, after=after)


def is_whole(file: Path, record: Record, plan: Plan) -> bool:
    """Whether a file holds all that its record says, and that is the record of the plan, with the poses of today."""
    if not file.is_file():
        return False
    try:
        layer = Sdf.Layer.OpenAsAnonymous(str(file))
        found = Record.read(layer)
        poses = {path: mesh.poses for path, mesh in found.meshes.items()}
        same = record.posed(poses) == found and not found.lacking(layer) and _clock(plan) == clock_of(layer)
        return same and all(poses[each.mesh.path] == tuple(_frames_of(each)) for each in plan.meshes)
    except (Tf.ErrorException, Fault, FrameProblem):
        return False


def _clock(plan: Plan) -> dict[str, Any]:
    prims = [planned.mesh.prim for planned in plan.meshes]
    return clock_for(prims[0].GetStage(), [prim.GetPath() for prim in prims])


def _frames_of(planned: PlannedMesh) -> Iterator[int]:
    mesh, derived = planned.mesh, Derived(planned.mesh, between=planned.between)
    for time in map(Usd.TimeCode, planned.frames):
        poses = (mesh.points_at(needed) for needed in sorted(derived.times_needed(time)))
        yield frame_digest(poses, mesh.controls_at(time), derived.cached(time))


def frame_digest(poses: Iterable[np.ndarray], controls: Sequence[Controls] | None, cached: Iterable[Cached]) -> int:
    """Of all that the samples at a frame come of.

    Args:
        poses: Of the cache (V, 3), in the order of their times.
        controls: Of each patch at the frame; None where none is animated.
        cached: What is derived comes of, beside poses.
    """
    digest = _digest(*poses, controls, *(each.value for each in cached))
    return int.from_bytes(bytes.fromhex(digest), "little", signed=True)


def origins_of(planned: PlannedMesh, with_coordinates: bool) -> dict[str, str]:
    """A digest of topology, of rest, of settings and paint at every time, and of some samples of what is cached."""
    mesh = planned.mesh
    found = {
        "topology": _digest(mesh.face_counts, mesh.face_indices, mesh.left_handed, mesh.subdivision),
        "rest": _digest(mesh.rest_points, mesh.weld.vertices, mesh.space),
        "setup": _digest(mesh.patches, *_animated(mesh)),
        "cache": _digest(mesh.points_times(), *_poses(mesh)),
        "vectors": _digest(*_vectors(planned)),
    }
    return {**found, "coordinates": _digest(_coordinates(mesh))} if with_coordinates else found


def _animated(mesh: PatchedMesh) -> Iterator[Any]:
    """What is animated on the patches, wherever in the shot."""
    for index, times in enumerate(mesh.animated_times()):
        for time in times:
            with suppress(FrameProblem):  # said of that frame, where it is slid
                yield time, mesh.patch_controls_at(index, Usd.TimeCode(time))


def _poses(mesh: PatchedMesh) -> Iterator[np.ndarray]:
    for time in map(Usd.TimeCode, _some(mesh.points_times())) if mesh.points_times() else [Usd.TimeCode.Default()]:
        with suppress(FrameProblem):
            yield mesh.points_at(time)


def _vectors(planned: PlannedMesh) -> Iterator[Any]:
    derived = Derived(planned.mesh, between=planned.between)
    yield from derived.outline()
    for each in derived.cached_at(_some if planned.frames else list):
        yield each.value


def _some(times: Sequence[float]) -> list[float]:
    """The first, the middle and the last: to read all would take each chunk as long as the shot."""
    return [times[0], times[len(times) // 2], times[-1]] if times else []


def _coordinates(mesh: PatchedMesh) -> Value | None:
    with suppress(Fault):  # which stops the bake
        return texture_coordinates(mesh)
    return None


def _digest(*values: Any) -> str:
    digest = hashlib.blake2b(digest_size=_BYTES)
    for part in _parts(values):
        digest.update(memoryview(part).nbytes.to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def _parts(value: Any) -> Iterator[bytes | memoryview]:
    if isinstance(value, np.ndarray):
        yield f"{value.dtype.str}{value.shape}".encode()
        yield np.ascontiguousarray(value).data
    elif is_dataclass(value):
        yield type(value).__name__.encode()
        for each in fields(value):
            yield each.name.encode()
            yield from _parts(getattr(value, each.name))
    elif isinstance(value, Sequence) and not isinstance(value, str):
        yield f"{len(value)}".encode()
        for each in value:
            yield from _parts(each)
    else:
        plain = value.item() if isinstance(value, np.generic) else value  # numpy's versions spell theirs differently
        yield repr(plain).encode(errors="backslashreplace")
