"""Value clips over chunks of a bake: a layer in which USD reads the samples of all, and which holds none of them.

for each mesh: the chunks that have it, each active from the first frame that it has and the one before has not
manifest: every attribute that has samples; the layer: all that does not vary
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from pxr import Gf, Sdf, UsdUtils, Vt

from skinslide.write.place import asset_path, replacing, saved, writing
from skinslide.write.record import Record, joined

_SAMPLES = "timeSamples"


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


def manifest_of(output: Path) -> Path:
    """What is written beside a layer of clips."""
    return output.with_name(f"{output.stem}.manifest.usda")


def write_clips(clips: Sequence[Clip], blocked: Sequence[Sdf.Path], output: Path) -> None:
    """Writes the layer and its manifest. Clips come in the order of their frames."""
    manifest_file = manifest_of(output)
    layer, manifest = Sdf.Layer.CreateAnonymous(".usda"), Sdf.Layer.CreateAnonymous(".usda")
    for clip in clips:
        UsdUtils.StitchLayers(layer, _still(clip.layer, manifest))
    block(layer, blocked)
    for path in joined([clip.record for clip in clips]).meshes:
        own = [clip for clip in clips if path in clip.record.meshes and clip.record.meshes[path].frames]
        if own:
            _author(layer, path, own, manifest_file, output)
    joined([clip.record for clip in clips]).write(layer)
    for each, file in ((manifest, manifest_file), (layer, output)):
        with replacing(file) as partial, writing(file):
            saved(each.Export(str(partial)))


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
