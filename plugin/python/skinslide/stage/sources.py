"""What a layer leads to, looked at before USD opens it: to open a pipe is to wait for somebody who writes into it."""

from __future__ import annotations

import glob
import os
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

from pxr import Ar, Sdf, Tf

from skinslide.arrays.schema import phrase
from skinslide.problems import StageError

EXTENSION = ".skinslide"
# Has the file format read the text of a `.skinslide` file and compute nothing.
TEXT_ONLY = {"live": "0"}


def not_opened(what: object, why: str) -> StageError:
    return StageError(f"cannot open {what}: {why}")


def check_regular(file: str, named: str = "") -> None:
    """Raises StageError for a file that is irregular; `named` says where it stands."""
    if is_irregular(file):
        raise not_opened(f"{file}{named}", f"it {phrase('irregular')}")


def is_irregular(file: str) -> bool:
    """Whether a pipe, a socket or a device is there, which may be waited for without end once it is opened."""
    outer = Ar.SplitPackageRelativePathOuter(file)[0]
    return os.path.exists(outer) and not os.path.isfile(outer) and not os.path.isdir(outer)


def open_sources(root: Sdf.Layer, name: str) -> list[Sdf.Layer]:
    """The root layer and all that it leads to, be it in a variant that is not selected.

    Args:
        root: The layer.
        name: What it is called in messages.

    Returns:
        The layers, for as long as which each is read once.

    Raises:
        StageError: What one of them leads to is there and is neither a file nor a folder.
    """
    found: dict[str, Sdf.Layer] = {root.identifier: root}
    waiting = [(root, name, dict(root.expressionVariables))]
    seen: defaultdict[str, list[dict[str, Any]]] = defaultdict(list)  # variables, by layer
    while waiting:
        layer, name, variables = waiting.pop()
        if variables in seen[layer.identifier]:
            continue
        seen[layer.identifier].append(variables)
        for file in _clips(layer):
            _look_at(layer, name, file)
        for asset in layer.GetCompositionAssetDependencies():
            identifier = _identifier(layer, asset, variables)
            _look_at(layer, name, identifier)
            below = found.get(identifier) or _open(identifier)
            if below:
                found[identifier] = below
                # Variables of what refers to a layer are stronger than its own.
                waiting.append((below, identifier, {**below.expressionVariables, **variables}))
    return list(found.values())


def _identifier(layer: Sdf.Layer, asset: str, variables: Mapping[str, Any]) -> str:
    """Of what a layer names; empty for an expression that gives nothing."""
    if Sdf.VariableExpression.IsExpression(asset):
        value = Sdf.VariableExpression(asset).Evaluate(dict(variables)).value
        asset = value if isinstance(value, str) else ""
    return Sdf.ComputeAssetPathRelativeToLayer(layer, asset) if asset else ""


def _look_at(layer: Sdf.Layer, name: str, identifier: str) -> None:
    """Raises StageError for what cannot be opened without waiting."""
    file = Ar.GetResolver().Resolve(Sdf.Layer.SplitIdentifier(identifier)[0]).GetPathString() if identifier else ""
    check_regular(file, f", which {name} names")


def _open(identifier: str) -> Sdf.Layer | None:
    """None for what does not open: a problem of the stage, reported where it matters."""
    with suppress(Tf.ErrorException):
        path = Sdf.Layer.SplitIdentifier(identifier)[0]
        return Sdf.Layer.FindOrOpen(path, TEXT_ONLY) if path.endswith(EXTENSION) else Sdf.Layer.FindOrOpen(identifier)
    return None


# ---- Value clips ----


def _clips(layer: Sdf.Layer) -> Iterator[str]:
    """The files of all value clips of a layer, as identifiers."""
    waiting = list(layer.rootPrims)
    while waiting:
        prim = waiting.pop()
        waiting += [*prim.nameChildren, *_variants(prim)]
        sets = prim.GetInfo("clips") if prim.HasInfo("clips") else {}
        for clips in sets.values():
            yield from _files(layer, clips) if isinstance(clips, Mapping) else ()


def _variants(prim: Sdf.PrimSpec) -> Iterator[Sdf.PrimSpec]:
    for variants in prim.variantSets if prim.HasInfo("variantSetNames") else ():
        yield from (variant.primSpec for variant in variants.variants)


def _files(layer: Sdf.Layer, clips: Mapping[str, Any]) -> Iterator[str]:
    """As USD, passes over what is of another type than it should be."""
    listed, template = clips.get("assetPaths"), clips.get("templateAssetPath")
    for asset in [*(listed if isinstance(listed, Sdf.AssetPathArray) else ()), clips.get("manifestAssetPath")]:
        if isinstance(asset, Sdf.AssetPath) and asset.path:
            yield Sdf.ComputeAssetPathRelativeToLayer(layer, asset.path)
    if isinstance(template, str) and template:
        pattern = glob.escape(Sdf.ComputeAssetPathRelativeToLayer(layer, template))
        yield from glob.iglob(re.sub("#+", "*", pattern))
