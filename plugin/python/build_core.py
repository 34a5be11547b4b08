"""Writes the C source of `skinslide._core` from the preprocessed public headers: build_core.py DECLARATIONS OUTPUT."""

from __future__ import annotations

import sys
from pathlib import Path

from cffi import FFI


def main(declarations: Path, output: Path) -> None:
    """Emits a module that gives every function, struct and enum of the headers; calls release the GIL."""
    ffi = FFI()
    ffi.cdef(declarations.read_text())
    ffi.set_source("skinslide._core", "#include <skinslide/picture.h>")
    ffi.emit_c_code(str(output))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
