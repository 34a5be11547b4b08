"""Value clips over chunks of a bake: a layer in which USD reads the samples of all, and which holds none of them.

for each mesh: the chunks that have it, each active from the first frame that it has and the one before has not
manifest: every attribute that has samples; the layer: all that does not vary
put the manifest in place, under a name of its content, which no other layer means; then the layer
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from pxr import Gf, Sdf, UsdUtils, Vt

from skinslide.write.place import asset_path
from skinslide.write.record import Record, joined
from skinslide.write.replacing import replacing, saved, writing

_SAMPLES = "timeSamples"
_BYTES = 4  # of a digest


class Clip(NamedTuple):
    """A chunk that stays where it is."""

    path: Path
    layer: Sdf.Layer
    record: Record


def block(layer: Sdf.Layer, attributes: Iterable[Sdf.Path]) -> None:
    """Gives attributes no value at any time."""
    for path in attributes:
        spec = layer.GetAttributeAtPath(path)
        spec.ClearInfo(_SAMPLES)
        spec.default = Sdf.ValueBlock()


def manifest_of(output: Path, content: str = "") -> Path:
    """What is written beside a layer of clips: each content under a name of its own, as long as any other's."""
    token = hashlib.blake2b(content.encode(), digest_size=_BYTES).hexdigest()
    return output.with_name(f"{output.stem}.manifest.{token}.usda")


class ClipLayer:
    """A layer of clips and its manifest, before they are written."""

    def __init__(self, clips: Sequence[Clip], blocked: Sequence[Sdf.Path], output: Path):
        """Clips come in the order of their frames."""
        self._output, self._layer = output, Sdf.Layer.CreateAnonymous(".usda")
        manifest = Sdf.Layer.CreateAnonymous(".usda")
        for clip in clips:
            UsdUtils.StitchLayers(self._layer, _still(clip.layer, manifest))
        block(self._layer, blocked)
        self._manifest = manifest.ExportToString()
        self.manifest_file = manifest_of(output, self._manifest)
        record = joined([clip.record for clip in clips])
        for path in record.meshes:
            own = [clip for clip in clips if path in clip.record.meshes and clip.record.meshes[path].frames]
            if own:
                _author(self._layer, path, own, self.manifest_file, output)
        record.write(self._layer)

    @contextmanager
    def in_place(self) -> Iterator[None]:
        """Writes both; puts them in place when the block ends. An exception leaves the output as it was."""
        with replacing(self._output) as partial:
            with writing(self._output):
                saved(self._layer.Export(str(partial)))
            with replacing(self.manifest_file) as partial_manifest:
                with writing(self.manifest_file):
                    partial_manifest.write_text(self._manifest, encoding="utf-8")
                yield


def _still(chunk: Sdf.Layer, manifest: Sdf.Layer) -> Sdf.Layer:
    """A chunk without its samples, whose attributes the manifest then has."""
    still = Sdf.Layer.CreateAnonymous(".usda")

    def take(path: Sdf.Path) -> None:
        spec = chunk.GetObjectAtPath(path)
        if path.IsPrimPath():
            _copy_fields(spec, Sdf.CreatePrimInLayer(still, path), ("properties", "primChildren", "specifier"))
        elif isinstance(spec, Sdf.RelationshipSpec):
            Sdf.CopySpec(chunk, path, still, path)
        elif isinstance(spec, Sdf.AttributeSpec):
            _copy_fields(spec, _attribute(still, spec), (_SAMPLES,))
            if spec.HasInfo(_SAMPLES):
                _attribute(manifest, spec)

    for field in set(chunk.pseudoRoot.ListInfoKeys()) - {"primChildren", "customLayerData"}:
        still.pseudoRoot.SetInfo(field, chunk.pseudoRoot.GetInfo(field))
    chunk.Traverse(Sdf.Path.absoluteRootPath, take)
    return still


def _attribute(layer: Sdf.Layer, like: Sdf.AttributeSpec) -> Sdf.AttributeSpec:
    prim = Sdf.CreatePrimInLayer(layer, like.path.GetPrimPath())
    there = layer.GetAttributeAtPath(like.path)
    return there or Sdf.AttributeSpec(prim, like.name, like.typeName, like.variability)


def _copy_fields(spec: Sdf.Spec, target: Sdf.Spec, but: Sequence[str]) -> None:
    for field in set(spec.ListInfoKeys()) - {*but, "typeName", "variability"}:
        target.SetInfo(field, spec.GetInfo(field))


def _author(layer: Sdf.Layer, path: str, clips: Sequence[Clip], manifest: Path, output: Path) -> None:
    """The clip set of one mesh."""
    frames = sorted({frame for clip in clips for frame in clip.record.meshes[path].frames})
    ends = sorted({frames[0], frames[-1]})
    layer.GetPrimAtPath(path).SetInfo(
        "clips",
        {
            "default": {
                "assetPaths": Sdf.AssetPathArray([Sdf.AssetPath(asset_path(clip.path, output)) for clip in clips]),
                "manifestAssetPath": Sdf.AssetPath(asset_path(manifest, output)),
                "primPath": path,
                "active": _pairs(_active(path, frames, clips)),
                "times": _pairs([(end, end) for end in ends]),
            }
        },
    )


def _active(path: str, frames: Sequence[float], clips: Sequence[Clip]) -> list[tuple[float, float]]:
    """From which frame on which clip is read: one as long as it has the frames, then the one that goes on longest."""
    held = [set(clip.record.meshes[path].frames) for clip in clips]
    found: list[tuple[float, float]] = []
    now: int | None = None
    for frame in frames:
        if now is None or frame not in held[now]:
            now = max((i for i, own in enumerate(held) if frame in own), key=lambda i: max(held[i]))
            found.append((frame, now))
    return found


def _pairs(pairs: Sequence[tuple[float, float]]) -> Vt.Vec2dArray:
    return Vt.Vec2dArray([Gf.Vec2d(*pair) for pair in pairs])
