"""The edit target of a stage: whether it takes opinions, and what it held before some were authored."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pxr import Sdf, Usd

from skinslide.problems import UsageError
from skinslide.stage.opening import check_clocks

_SCHEMAS = "apiSchemas"


def check_target(stage: Usd.Stage) -> None:
    """Raises TypeError for what is no stage, and UsageError where nothing can be authored into its edit target.

    StageError as `check_clocks`.
    """
    if not isinstance(stage, Usd.Stage):
        raise TypeError(f"stage is {stage!r}; it must be a Usd.Stage, or see the function that writes a file")
    check_clocks(stage)
    layer = stage.GetEditTarget().GetLayer()
    if not layer.permissionToEdit or stage.IsLayerMuted(layer.identifier):
        fault = "not editable" if not layer.permissionToEdit else "muted"
        raise UsageError(f"the edit target {layer.identifier} is {fault}")


def spec_path(target: Usd.EditTarget, prim: Sdf.Path) -> Sdf.Path:
    """Where the target's layer has opinions on a prim. Raises UsageError where it can have none."""
    path = target.MapToSpecPath(prim)
    if not path:
        raise UsageError(f"the edit target {target.GetLayer().identifier} cannot hold opinions on {prim}")
    return path


class Before:
    """Attributes of a layer as they were before they were edited."""

    def __init__(self, layer: Sdf.Layer):
        self._layer, self._store = layer, Sdf.Layer.CreateAnonymous(".usda")
        self._specs: dict[Sdf.Path, Sdf.AttributeSpec | None] = {}  # None where there was none

    def __iter__(self) -> Iterator[Sdf.Path]:
        return iter(self._specs)

    def keep(self, path: Sdf.Path) -> None:
        """Keeps an attribute, or that there is none, unless that was done before."""
        if path in self._specs:
            return
        self._specs[path] = None
        if self._layer.GetAttributeAtPath(path):
            place = Sdf.CreatePrimInLayer(self._store, "/before").path.AppendProperty(f"at{len(self._specs)}")
            Sdf.CopySpec(self._layer, path, self._store, place)
            self._specs[path] = self._store.GetAttributeAtPath(place)

    def bring_back(self) -> None:
        """Makes them as they were, and leaves no prim that is without opinions."""
        with Sdf.CleanupEnabler(), Sdf.ChangeBlock():
            for path, before in self._specs.items():
                if before:
                    Sdf.CopySpec(self._store, before.path, self._layer, path)
                else:
                    remove(self._layer, path)


def remove(layer: Sdf.Layer, attribute: Sdf.Path) -> None:
    """Removes an attribute where it is there."""
    spec = layer.GetAttributeAtPath(attribute)
    if spec:
        spec.owner.RemoveProperty(spec)


@contextmanager
def whole_or_not_at_all(target: Usd.EditTarget, prim: Sdf.Path, ours: Callable[[str], bool]) -> Iterator[None]:
    """What the block authors on a prim: its schemas, and attributes whose names are `ours`. An exception undoes it."""
    layer, path = target.GetLayer(), spec_path(target, prim)
    spec, before = layer.GetPrimAtPath(path), Before(layer)
    schemas = spec.GetInfo(_SCHEMAS) if spec and spec.HasInfo(_SCHEMAS) else None
    for each in _names(layer, path, ours):
        before.keep(each)
    try:
        yield
    except BaseException:
        with Sdf.CleanupEnabler(), Sdf.ChangeBlock():
            for each in set(_names(layer, path, ours)).difference(before):
                remove(layer, each)
            _set_schemas(layer.GetPrimAtPath(path), schemas)
        before.bring_back()
        raise


def _names(layer: Sdf.Layer, prim: Sdf.Path, ours: Callable[[str], bool]) -> list[Sdf.Path]:
    spec = layer.GetPrimAtPath(prim)
    return [each.path for each in spec.properties if ours(each.name)] if spec else []


def _set_schemas(spec: Sdf.PrimSpec | None, schemas: Sdf.TokenListOp | None) -> None:
    if spec and schemas:
        spec.SetInfo(_SCHEMAS, schemas)
    elif spec:
        spec.ClearInfo(_SCHEMAS)
