"""Joins exports of single frames to the USD cache that one export of all would be. No Blender here; for any thread.

Of each attribute the first frame's value is the default, and what differs from it at any frame has time samples at all.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from .usd import as_fault, import_usd


class Joined:
    """The cache, in memory until it is put in place. `part` is the file for the next frame, in the same folder."""

    def __init__(self, cache: str):
        """Raises Fault if no file can be put there."""
        import_usd()
        from pxr import Sdf

        from skinslide.author.layer import EXTENSIONS
        from skinslide.stage.sources import EXTENSION
        from skinslide.write.place import check_output
        from skinslide.write.replacing import partial_name

        with as_fault():
            check_output(Path(cache), [each for each in EXTENSIONS if each != EXTENSION])
        self._cache, self._frames = Path(cache).resolve(), list[int]()
        self._layer = Sdf.Layer.CreateAnonymous(".usdc")
        self._kept = self._cache.with_name(partial_name(self._cache))
        self.part = str(self._cache.with_name(partial_name(self._cache.with_suffix(".usdc"))))

    def __enter__(self) -> Joined:
        return self

    def __exit__(self, *_: Any) -> None:
        Path(self.part).unlink(missing_ok=True)

    def add(self, frame: int) -> None:
        """Adds a frame from its file, and deletes the file."""
        from pxr import Sdf, UsdUtils

        part = Sdf.Layer.OpenAsAnonymous(self.part)
        Path(self.part).unlink()
        part.Traverse(Sdf.Path.absoluteRootPath, lambda path: self._take(part.GetAttributeAtPath(path), frame))
        UsdUtils.StitchLayers(self._layer, part)  # adds what no earlier frame has
        self._frames.append(frame)

    def _take(self, attribute: Any, frame: int) -> None:
        if not attribute:
            return
        for value in (attribute.GetInfo("timeSamples") if attribute.HasInfo("timeSamples") else {}).values():
            attribute.default = value
            attribute.ClearInfo("timeSamples")
        held = self._layer.GetAttributeAtPath(attribute.path)
        if not held or attribute.default is None:
            return
        varies = held.HasInfo("timeSamples")
        if not varies and held.default == attribute.default:
            return
        for each in () if varies else self._frames:
            self._layer.SetTimeSample(held.path, each, held.default)
        self._layer.SetTimeSample(held.path, frame, attribute.default)

    def put(self, write: Callable[[], str]) -> str:
        """Puts the cache in place, and calls write for the rest."""
        from skinslide.write.replacing import replacing, saved

        self._layer.startTimeCode, self._layer.endTimeCode = self._frames[0], self._frames[-1]
        with as_fault(), self._put_back():
            with replacing(self._cache) as partial:
                saved(self._layer.Export(str(partial)))
            return write()

    @contextmanager
    def _put_back(self) -> Iterator[None]:
        """If anything is raised, restores what was there before."""
        if self._cache.exists():
            try:
                os.link(self._cache, self._kept)
            except OSError:  # not every file system has links
                shutil.copy2(self._cache, self._kept)
        try:
            yield
        except BaseException:
            if self._kept.exists():
                os.replace(self._kept, self._cache)
            else:
                self._cache.unlink(missing_ok=True)
            raise
        finally:
            self._kept.unlink(missing_ok=True)
