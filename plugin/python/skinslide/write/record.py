"""What a baked layer says about itself in its customLayerData: what it was made from, and which frames it must hold.

It shows that chunks belong together, are complete, and leave no frame out between them. Layers of sublayers do
not compose it, and no sample depends on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pxr import Sdf, UsdGeom, Vt

from skinslide.arrays.native import version
from skinslide.problems import Fault

_KEY = "skinslide"  # in customLayerData
_FORM = 1  # of the record itself


@dataclass(frozen=True)
class MeshRecord:
    """One mesh of a layer.

    origins  a digest of each of: its topology, its rest, its set-up, its cache, and what else it is baked from
    frames   that its points have samples at, ascending; none: they have a default
    poses    a digest of what was read for each of them
    """

    origins: Mapping[str, str]
    frames: tuple[float, ...]
    poses: tuple[int, ...] = ()


@dataclass(frozen=True)
class Record:
    """A layer.

    meshes   those that were slid, by their paths
    options  of the bake, those that are not as they are by default
    before   the frame of the shot before the first in the layer; None: there is none
    after    the one after the last
    asked    the paths of all meshes that were asked for, be they in this layer or in other chunks
    chunk    which of how many parts of `wanted` it is, such as 3/8; empty: it is all that was asked for
    wanted   all frames that were asked for, of which it is a part
    """

    meshes: Mapping[str, MeshRecord]
    options: Mapping[str, Any] = field(default_factory=dict)
    before: float | None = None
    after: float | None = None
    asked: tuple[str, ...] = ()
    chunk: str = ""
    wanted: tuple[float, ...] = ()
    version: str = field(default_factory=version)

    @property
    def frames(self) -> list[float]:
        """Of all meshes, ascending."""
        return sorted({frame for mesh in self.meshes.values() for frame in mesh.frames})

    def whole(self) -> Record:
        """That of a layer which is no part."""
        return replace(self, chunk="", wanted=())

    def posed(self, poses: Mapping[str, Sequence[int]]) -> Record:
        """With poses of meshes, by their paths; none of others."""
        posed = {path: replace(mesh, poses=tuple(poses.get(path, ()))) for path, mesh in self.meshes.items()}
        return replace(self, meshes=posed)

    def lacking(self, layer: Sdf.Layer) -> dict[str, list[float]]:
        """The meshes that a layer does not hold whole, each with the frames that it lacks; none of a default value."""
        found: dict[str, list[float]] = {}
        for path, mesh in self.meshes.items():
            points = Sdf.Path(path).AppendProperty(UsdGeom.Tokens.points)
            lost = sorted(set(mesh.frames).difference(layer.ListTimeSamplesForPath(points)))
            if lost or not (mesh.frames or layer.GetAttributeAtPath(points)):
                found[path] = lost
        return found

    def write(self, layer: Sdf.Layer) -> None:
        meshes = {
            path: {**mesh.origins, "frames": _array(mesh.frames), "poses": Vt.Int64Array(list(mesh.poses))}
            for path, mesh in self.meshes.items()
        }
        stored: dict[str, Any] = {
            "form": _FORM,
            "version": self.version,
            "meshes": meshes,
            "options": dict(self.options),
        }
        stored["asked"] = Vt.StringArray(list(self.asked))
        stored |= {name: at for name in ("before", "after") if (at := getattr(self, name)) is not None}
        if self.chunk:
            stored |= {"chunk": self.chunk, "wanted": _array(self.wanted)}
        layer.customLayerData = {**layer.customLayerData, _KEY: stored}

    @classmethod
    def read(cls, layer: Sdf.Layer) -> Record:
        """Raises Fault where there is none, or one of another kind."""
        stored = layer.customLayerData.get(_KEY)
        if not isinstance(stored, dict):
            raise Fault("does not say what it was baked from: it is not finished, or older than skinslide 0.2")
        if stored.get("form") != _FORM:
            raise Fault(f"was baked by skinslide {stored.get('version')}, whose record this one cannot read")
        try:
            return cls._of(stored)
        except (AttributeError, KeyError, TypeError, ValueError) as bad:
            raise Fault("says what it was baked from in a way that cannot be read") from bad

    @classmethod
    def _of(cls, stored: Mapping[str, Any]) -> Record:
        meshes = {_prim(path): _mesh(dict(mesh)) for path, mesh in stored["meshes"].items()}
        before, after = (None if stored.get(end) is None else float(stored[end]) for end in ("before", "after"))
        asked, wanted = tuple(map(str, stored["asked"])), _frames(stored.get("wanted", ()))
        part = (asked, str(stored.get("chunk", "")), wanted)
        return cls(meshes, dict(stored["options"]), before, after, *part, str(stored["version"]))


def joined(records: Sequence[Record]) -> Record:
    """That of one bake of all frames."""
    meshes: dict[str, MeshRecord] = {}
    for record in records:
        for path, mesh in record.meshes.items():
            known = meshes.get(path, mesh)
            poses = {**_posed(known), **_posed(mesh)}
            meshes[path] = replace(known, frames=tuple(sorted(poses)), poses=tuple(poses[at] for at in sorted(poses)))
    common = [record.options for record in records]
    options = {name: value for name, value in common[0].items() if all(each.get(name) == value for each in common)}
    framed = [record for record in records if record.frames]
    before = min(framed, key=lambda record: record.frames[0]).before if framed else None
    after = max(framed, key=lambda record: record.frames[-1]).after if framed else None
    return replace(records[0].whole(), meshes=dict(sorted(meshes.items())), options=options, before=before, after=after)


def _mesh(stored: dict[str, Any]) -> MeshRecord:
    frames, poses = _frames(stored.pop("frames")), tuple(map(int, stored.pop("poses")))
    if len(poses) != len(frames):
        raise ValueError(poses)
    return MeshRecord(stored, frames, poses)


def _posed(mesh: MeshRecord) -> dict[float, int]:
    return dict(zip(mesh.frames, mesh.poses, strict=True))


def _prim(path: str) -> str:
    if not Sdf.Path.IsValidPathString(path) or not Sdf.Path(path).IsPrimPath():
        raise ValueError(path)
    return path


def _frames(stored: Sequence[float]) -> tuple[float, ...]:
    return tuple(map(float, stored))


def _array(frames: Sequence[float]) -> Vt.DoubleArray:
    return Vt.DoubleArray(list(frames))
