"""The edit target of a stage: whether it takes opinions, and what it held before some were authored."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pxr import Sdf, Usd

from skinslide.problems import UsageError
from skinslide.stage.marks import has_values
from skinslide.stage.opening import check_clocks, is_live

_SCHEMAS = "apiSchemas"
_ANOTHER = "choose another by stage.SetEditTarget, such as stage.GetSessionLayer()"


def check_target(stage: Usd.Stage) -> None:
    """Raises TypeError for what is no stage, and UsageError where nothing can be authored into its edit target.

    StageError as `check_clocks`.
    """
    if not isinstance(stage, Usd.Stage):
        raise TypeError(f"stage is {stage!r}; it must be a Usd.Stage, or see the function that writes a file")
    check_clocks(stage)
    layer = stage.GetEditTarget().GetLayer()
    if not layer:
        raise UsageError(f"the edit target is gone; {_ANOTHER}")
    fault = _fault(stage, layer)
    if fault:
        raise UsageError(f"the edit target {layer.identifier} {fault} {_ANOTHER}")


def _fault(stage: Usd.Stage, layer: Sdf.Layer) -> str | None:
    """Why a layer takes no opinions, and what to do about it other than to choose another."""
    if stage.IsLayerMuted(layer.identifier):
        return "is muted; unmute it by stage.UnmuteLayer, or"
    if layer not in stage.GetUsedLayers():
        return "is not a layer of the stage;"
    if is_live(layer):
        return "is computed; give its path to functions that write files, such as bake_to_file, or"
    return None if layer.permissionToEdit else "is not editable;"


def spec_path(stage: Usd.Stage, prim: Sdf.Path) -> Sdf.Path:
    """The path at which the edit target has opinions on a prim. Raises UsageError if none there would count."""
    target = stage.GetEditTarget()
    path, layer = target.MapToSpecPath(prim), target.GetLayer().identifier
    if not path:
        raise UsageError(f"the edit target {layer} cannot hold opinions on {prim}; {_ANOTHER}")
    for variant in filter(Sdf.Path.IsPrimVariantSelectionPath, path.GetPrefixes()):
        (name, chosen), owner = variant.GetVariantSelection(), target.GetMapFunction().MapSourceToTarget(variant)
        selected = stage.GetPrimAtPath(owner).GetVariantSet(name).GetVariantSelection()
        if selected != chosen:
            where = f"the variant {chosen} of {name} in {layer}, but {selected or 'none'} is selected on {owner}"
            raise UsageError(f"the edit target is {where}; select {chosen}, or {_ANOTHER}")
    return path


def hidden_by(attribute: Usd.Attribute) -> str | None:
    """Where the value is that hides the edit target's; None if that is the strongest."""
    target = attribute.GetStage().GetEditTarget()
    own = target.GetLayer(), target.MapToSpecPath(attribute.GetPath())
    valued = [spec for spec in attribute.GetPropertyStack() if has_values(spec)]
    hidden = own in [(spec.layer, spec.path) for spec in valued[1:]]
    return f"{valued[0].layer.identifier}<{valued[0].owner.path}>" if hidden else None


class Before:
    """Properties of a layer as they were before they were edited."""

    def __init__(self, layer: Sdf.Layer):
        self._layer, self._store = layer, Sdf.Layer.CreateAnonymous(".usda")
        self._specs: dict[Sdf.Path, Sdf.PropertySpec | None] = {}  # None where there was none

    def __iter__(self) -> Iterator[Sdf.Path]:
        return iter(self._specs)

    def keep(self, path: Sdf.Path) -> None:
        """Keeps a property, or that there is none, unless that was done before."""
        if path in self._specs:
            return
        self._specs[path] = None
        if self._layer.GetPropertyAtPath(path):
            place = Sdf.CreatePrimInLayer(self._store, "/before").path.AppendProperty(f"at{len(self._specs)}")
            Sdf.CopySpec(self._layer, path, self._store, place)
            self._specs[path] = self._store.GetPropertyAtPath(place)

    def bring_back(self) -> None:
        """Restores them, and removes prims that are left without opinions."""
        with Sdf.CleanupEnabler(), Sdf.ChangeBlock():
            for path, before in self._specs.items():
                if before:
                    Sdf.CopySpec(self._store, before.path, self._layer, path)
                else:
                    remove(self._layer, path)


def remove(layer: Sdf.Layer, path: Sdf.Path) -> None:
    """Removes a property where it is there."""
    spec = layer.GetPropertyAtPath(path)
    if spec:
        spec.owner.RemoveProperty(spec)


@contextmanager
def whole_or_not_at_all(stage: Usd.Stage, prim: Sdf.Path, ours: Callable[[str], bool]) -> Iterator[None]:
    """What the block authors in the edit target: schemas of a prim, and attributes whose names are `ours`.

    An exception undoes it.
    """
    layer, path = stage.GetEditTarget().GetLayer(), spec_path(stage, prim)
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
