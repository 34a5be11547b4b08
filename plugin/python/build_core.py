"""Writes what Python has of the public headers: build_core.py DECLARATIONS SOURCE RECORDS.

DECLARATIONS are the headers, preprocessed, with their comments; SOURCE is the C source of `skinslide._core`, RECORDS
the module `skinslide.arrays.records`.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from textwrap import fill

from cffi import FFI

# What the tool gives to its callers, and the structs that it has the fields of.
RECORDS = {
    "PatchInfo": ["skinslide_patch_info"],
    "PatchResult": ["skinslide_patch_result"],
    "Roughness": ["skinslide_roughness"],
    "WeldInfo": ["skinslide_weld_info"],
    "DeviceInfo": ["skinslide_device_info"],
    "LookupInfo": ["skinslide_lookup_info", "skinslide_device_info"],
}
HEAD = '''"""What the core says of patches, frames and devices. Made by build_core.py of the public headers."""

from __future__ import annotations

from typing import NamedTuple
'''


def main(declarations: Path, source: Path, records: Path) -> None:
    """Emits a module that gives every function, struct and enum of the headers; calls release the GIL."""
    text, ffi = declarations.read_text(), FFI()
    ffi.cdef(text)
    source_text = "#include <skinslide/picture.h>\n#include <skinslide/stage.h>\n"
    for struct in sized_structs(ffi):
        declaration = f"void {struct}_default({struct} *out)"
        ffi.cdef(f"{declaration};")
        source_text += f"static {declaration} {{ const {struct} made = {struct.upper()}_DEFAULT; *out = made; }}\n"
    ffi.set_source("skinslide._core", source_text)
    ffi.emit_c_code(str(source))
    records.write_text(HEAD + "".join(record(ffi, text, *names) for names in RECORDS.items()))


def sized_structs(ffi: FFI) -> list[str]:
    """Those that may grow, of which the headers have defaults."""
    kinds = {name: ffi.typeof(name) for name in ffi.list_types()[0]}
    complete = {name: kind.fields for name, kind in kinds.items() if kind.kind == "struct" and kind.fields}
    return [name for name, fields in complete.items() if fields[0][0] == "size" and fields[0][1].type.cname == "size_t"]


def record(ffi: FFI, text: str, name: str, structs: list[str]) -> str:
    """A named tuple with the fields of structs and the words of their comments; the first says what it is."""
    comments = [
        _comment(rf"/\*((?:(?!\*/).)*)\*/\s*typedef struct {struct} \{{(.*?)\}} {struct};", text) for struct in structs
    ]
    above, body = comments[0][0], "".join(body for _, body in comments)
    fields = [(field, each.type) for struct in structs for field, each in ffi.typeof(struct).fields if field != "size"]
    summary, _, more = re.sub(r"\s*Start from \w+\.", "", _plain(above)).partition(". ")
    return "\n".join(
        [
            f"\n\nclass {name}(NamedTuple):",
            f'    """{summary.rstrip(".")}.',
            *(["", _filled(more, 4, 4)] if more else []),
            "\n    Attributes:",
            *(_filled(f"{field}: {_behind(field, body)}", 8, 12) for field, _ in fields),
            '    """\n',
            *(f"    {field}: {_python_type(ctype)}" for field, ctype in fields),
            "",
        ]
    )


def _behind(field: str, body: str) -> str:
    return _plain(*_comment(rf"\b{field}(?:\[\w+\])?;\s*/\*(.*?)\*/", body))


def _comment(pattern: str, text: str) -> tuple[str, ...]:
    found = re.search(pattern, text, re.DOTALL)
    if not found:
        raise SystemExit(f"the headers have no comment that is like {pattern}")
    return found.groups()


def _plain(comment: str) -> str:
    """A comment in one line."""
    return " ".join(line.strip().removeprefix("* ") for line in comment.splitlines()).strip()


def _filled(paragraph: str, indent: int, hanging: int) -> str:
    return fill(paragraph, 120, initial_indent=indent * " ", subsequent_indent=hanging * " ", break_on_hyphens=False)


def _python_type(ctype: FFI.CType) -> str:
    """Of text and tokens, real numbers, whole numbers."""
    if ctype.kind in ("array", "pointer", "enum"):
        return "str"
    return "float" if ctype.cname in ("float", "double") else "int"


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
