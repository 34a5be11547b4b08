"""The workspaces of a slider: one for each thread that slides at once."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from skinslide._core import ffi, lib
from skinslide.arrays.apart import apart
from skinslide.arrays.idle import Idle
from skinslide.arrays.native import Handle, call


class Workspaces:
    """Workspaces, the first of which is made at once, so that its errors show early."""

    def __init__(self, slider: Handle, options: Any):
        make = partial(_make, slider, options)
        self._idle, self._busy = Idle(make, apart(make)), list[Handle]()
        self._stopped, self._lock = False, threading.Lock()

    @contextmanager
    def taken(self) -> Iterator[Handle]:
        """A workspace for the calling thread alone."""
        workspace = self.take()
        try:
            yield workspace
        finally:
            self.give_back(workspace)

    def take(self) -> Handle:
        """The same, until it is given back: what each frame does, since a context of its own takes longer."""
        workspace = self._idle.take()
        with self._lock:
            self._busy.append(workspace)
            if self._stopped:
                lib.skinslide_workspace_interrupt(workspace.pointer)
        return workspace

    def give_back(self, workspace: Handle) -> None:
        with self._lock:
            self._busy.remove(workspace)
        self._idle.give_back(workspace)

    def stop(self) -> None:
        """Makes what is done with any of them, now or later, fail soon."""
        with self._lock:
            self._stopped = True
            for workspace in self._busy:
                lib.skinslide_workspace_interrupt(workspace.pointer)


def _make(slider: Handle, options: Any) -> Handle:
    out = ffi.new("skinslide_workspace **")
    call(lib.skinslide_workspace_create, slider.pointer, options, out)
    return Handle(out[0], lib.skinslide_workspace_destroy, slider)
