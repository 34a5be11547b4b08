"""Writes what schema.usda declares as Python classes, like pxr's for its schemas: python methods.py [OUTPUT]"""

import re
import subprocess
import sys
from pathlib import Path
from textwrap import fill

from pxr import Sdf

SCHEMA = Path(__file__).parent / "schema.usda"
OUTPUT = SCHEMA.parent.parent / "plugin" / "python" / "skinslide" / "author" / "api.py"
HEAD = '''"""The schemas of skinslide, as classes like pxr's. Made by schema/methods.py from schema/schema.usda."""

from __future__ import annotations

import os
from typing import Literal

import numpy.typing as npt
from pxr import Sdf, Usd, UsdGeom

from skinslide.author.applied import AppliedPatch, AppliedSchema
'''
CLASS = '''

class {schema}({base}):
    """{doc}
    """

    SCHEMA = "{schema}"
    NAMESPACE = "{namespace}"
    APPLIES_TO = {types}
'''
ATTRIBUTE = '''
    def Get{Name}Attr(self) -> Usd.Attribute:
        """{doc}

        Returns:
            The attribute {full}, {kind}; invalid if there is none.
        """
        return self._attribute("{name}")

    def Create{Name}Attr(self, defaultValue: {type} | None = None, writeSparsely: bool = False) -> Usd.Attribute:
        """Authors {full} in the edit target.

        Args:
            defaultValue: Its default value, {kind}; None: none is authored.
            writeSparsely: Authors nothing if that is the fallback, and no other value is authored.

        Returns:
            The attribute.

        Raises:
            UsageError: The value is of another type.
        """
        return self._create_attribute("{name}", defaultValue, writeSparsely)
'''
PRIMVAR = '''
    def Get{Name}Primvar(self) -> UsdGeom.Primvar:
        """{doc}

        Returns:
            The primvar {full}; invalid if there is none.
        """
        return self._primvar("{name}")

    def Create{Name}Primvar(
        self, interpolation: str = "{interpolation}", defaultValue: npt.ArrayLike | None = None
    ) -> UsdGeom.Primvar:
        """Authors {full} in the edit target.

        Args:
            interpolation: Which elements of the mesh have a value each.
            defaultValue: Its default value, {kind}, not indexed; None: none is authored.

        Returns:
            The primvar.

        Raises:
            UsageError: The values are of another type.
        """
        return self._create_primvar("{name}", "{type_name}", interpolation, defaultValue)
'''
PYTHON_TYPES = {"bool": "bool", "float": "float", "token": "str", "asset": "Sdf.AssetPath | str | os.PathLike[str]"}
# What a schema says of a primvar, which it cannot declare. Authored is the first of its types and interpolations.
PAINTED = re.compile(r"^- primvars:(\S+):(\w+): (.*)$", re.MULTILINE)


def classes() -> str:
    """The text of api.py."""
    layer = Sdf.Layer.OpenAsAnonymous(str(SCHEMA))
    text = HEAD + "".join(_class(prim) for prim in layer.rootPrims if "className" in prim.customData)
    command = [sys.executable, "-m", "ruff", "format", "--stdin-filename", OUTPUT, "-"]
    return subprocess.run(command, input=text, check=True, capture_output=True, text=True, cwd=OUTPUT.parent).stdout


def _class(prim: Sdf.PrimSpec) -> str:
    data = prim.customData
    text, namespace = data["userDocBrief"], data.get("propertyNamespacePrefix")
    base, space = ("AppliedPatch", f"{namespace}:NAME") if namespace else ("AppliedSchema", _common_space(prim))
    head = CLASS.format(
        schema=prim.name,
        base=base,
        namespace=namespace or space,
        types=tuple(data.get("apiSchemaCanOnlyApplyTo", ())),
        doc=_doc(text, 4),
    )
    attributes = (_attribute(each, space) for each in prim.attributes)
    return head + "".join([*attributes, *(_primvar(*found) for found in PAINTED.findall(text))])


def _common_space(prim: Sdf.PrimSpec) -> str:
    (space,) = {each.name.rpartition(":")[0] for each in prim.attributes}
    return space


def _attribute(attribute: Sdf.AttributeSpec, space: str) -> str:
    name = attribute.name.removeprefix(f"{space}:")
    kind = f"{attribute.typeName}, uniform" if attribute.variability == Sdf.VariabilityUniform else attribute.typeName
    return ATTRIBUTE.format(
        Name=_capital(name),
        name=name,
        full=f"{space}:{name}",
        kind=kind,
        type=_python_type(attribute),
        doc=_doc(attribute.customData["userDocBrief"], 8),
    )


def _python_type(attribute: Sdf.AttributeSpec) -> str:
    if attribute.allowedTokens:
        return f"Literal[{', '.join(map(repr, attribute.allowedTokens))}]"
    return "npt.ArrayLike" if attribute.typeName.isArray else PYTHON_TYPES[str(attribute.typeName)]


def _primvar(space: str, name: str, text: str) -> str:
    type_name = re.search(r"\b(bool|float)\b", text)[0] + "[]"
    return PRIMVAR.format(
        Name=_capital(name),
        name=name,
        full=f"primvars:{space}:{name}",
        kind=type_name,
        type_name=type_name,
        interpolation=re.search(r"\b(uniform|vertex)\b", text)[0],
        doc=_doc(text, 8),
    )


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _doc(text: str, indent: int) -> str:
    """A docstring's text: one sentence that fits a line, then whatever more there is."""
    width = 117 - indent
    first, _, more = text.partition("\n")[0].partition(". ")
    if len(first) >= width:
        first, _, rest = first.partition(": ")
        more = f"{_capital(rest.rstrip('.'))}. {more}".strip()
    lines = [*([more] if more else []), *text.splitlines()[1:]]
    filled = [
        fill(line, width, subsequent_indent="  " * line.startswith("- "), break_on_hyphens=False) for line in lines
    ]
    paragraphs = re.sub(r"\n{3,}", "\n\n", "\n".join([f"{_capital(first.rstrip('.'))}.", "", *filled])).strip()
    return paragraphs.replace("\n", "\n" + indent * " ").replace("\n" + indent * " " + "\n", "\n\n")


if __name__ == "__main__":
    (Path(sys.argv[1]) if len(sys.argv) > 1 else OUTPUT).write_text(classes())
