"""What an earlier bake left on a stage: its values are marked, so that none is taken for a cache and slid twice.

A bake into an edit target takes the place of the earlier one there:

set aside the marked values            the stage is as if it had never been baked
read, slide                            any error: bring the earlier bake back
author                                 values of a cache in that layer move to skinSlide:cached:*, for the next time
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from pxr import Sdf, Usd

from skinslide.stage import schema
from skinslide.stage.marks import MARK, VALUES, has_values, is_marked, mark
from skinslide.write.target import Before, remove


class EarlierBake:
    """The edit target of a stage, without what an earlier bake left there."""

    def __init__(self, target: Usd.EditTarget):
        self._target, self._layer = target, target.GetLayer()
        self._before = Before(self._layer)

    def set_aside(self, prims: Sequence[str] | None) -> None:
        """Gives the properties that are marked, everywhere or at and below `prims`, the values they had before."""
        with Sdf.ChangeBlock():
            for path in self._marked(prims):
                self._before.keep(path)
                self._revert(path)

    def replace(self, on_stage: Sdf.Path, samples: bool) -> None:
        """Makes room for the values of a bake, or its targets; those that are the cache's are kept beside them.

        Args:
            on_stage: An attribute or a relationship, which the stage need not have.
            samples: Whether samples will be authored; the default value, which may be the rest pose, then stays.
        """
        path = self._target.MapToSpecPath(on_stage)
        self._before.keep(path)
        spec = self._layer.GetPropertyAtPath(path)
        if not spec:
            return
        if has_values(spec):
            self._before.keep(_cached(path))
            Sdf.CopySpec(self._layer, path, self._layer, _cached(path))
        _clear(spec, VALUES[1:] if samples else VALUES)

    def mark(self, authored: Usd.Property) -> None:
        mark(self._layer.GetPropertyAtPath(self._target.MapToSpecPath(authored.GetPath())))

    def bring_back(self) -> None:
        """Undoes everything."""
        self._before.bring_back()

    def tidy(self) -> None:
        """Removes what the new bake did not need again."""
        with Sdf.ChangeBlock():
            for path in self._before:
                spec = self._layer.GetPropertyAtPath(path)
                if not spec or is_marked(spec):
                    continue
                remove(self._layer, _cached(path))
                if spec.hasOnlyRequiredFields:
                    remove(self._layer, path)

    def _marked(self, prims: Sequence[str] | None) -> list[Sdf.Path]:
        """Where there are marked values that the target would author, for prims at and below `prims`."""
        roots = [Sdf.Path("/")] if prims is None else [Sdf.Path(prim) for prim in prims if _is_path(prim)]
        found: list[Sdf.Path] = []

        def look(path: Sdf.Path) -> None:
            spec = self._layer.GetPropertyAtPath(path) if path.IsPropertyPath() else None
            if spec and is_marked(spec) and any(map(self._on_stage(path).HasPrefix, roots)):
                found.append(path)

        self._layer.Traverse(Sdf.Path.absoluteRootPath, look)
        return found

    def _on_stage(self, path: Sdf.Path) -> Sdf.Path:
        """The attribute of a spec that is where the target authors it: the layer may have others, as in variants."""
        there = self._target.GetMapFunction().MapSourceToTarget(path)
        is_there = not there.ContainsPrimVariantSelection() and self._target.MapToSpecPath(there) == path
        return there if is_there else Sdf.Path.emptyPath

    def _revert(self, path: Sdf.Path) -> None:
        spec = self._layer.GetPropertyAtPath(path)
        if self._layer.GetPropertyAtPath(_cached(path)):
            self._before.keep(_cached(path))
            Sdf.CopySpec(self._layer, _cached(path), self._layer, path)
            return
        _clear(spec, (*VALUES, "interpolation") if spec.name in schema.DIAGNOSTICS else VALUES)
        data = dict(spec.GetInfo("customData"))
        del data[MARK]
        if data:
            spec.SetInfo("customData", data)
        else:
            spec.ClearInfo("customData")


@contextmanager
def replacing_earlier_bake(stage: Usd.Stage, prims: Sequence[str] | None) -> Iterator[EarlierBake]:
    """The stage without the earlier bake in its edit target, which an exception brings back as it was."""
    earlier = EarlierBake(stage.GetEditTarget())
    try:
        earlier.set_aside(prims)
        yield earlier
        earlier.tidy()
    except BaseException:
        earlier.bring_back()
        raise


@contextmanager
def without_earlier_bake(stage: Usd.Stage, prims: Sequence[str] | None) -> Iterator[None]:
    """The stage as if it had never been baked into its edit target, for as long as the block lasts."""
    earlier = EarlierBake(stage.GetEditTarget())
    try:
        earlier.set_aside(prims)
        yield
    finally:
        earlier.bring_back()


def _is_path(prim: str) -> bool:
    return Sdf.Path.IsValidPathString(prim) and Sdf.Path(prim).IsAbsoluteRootOrPrimPath()


def _cached(path: Sdf.Path) -> Sdf.Path:
    """Where the values of a property are kept that a bake into the same layer replaces."""
    return path.GetPrimOrPrimVariantSelectionPath().AppendProperty(f"{schema.CACHED}:{path.name}")


def _clear(spec: Sdf.PropertySpec, fields: Sequence[str]) -> None:
    if isinstance(spec, Sdf.RelationshipSpec):
        spec.targetPathList.ClearEdits()
        return
    for field in fields:
        spec.ClearInfo(field)
