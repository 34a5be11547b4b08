"""Writes what schema.usda declares for the core, so that each name has one source: python tables.py [OUTPUT]"""

import re
import sys
from pathlib import Path

from pxr import Sdf

SCHEMA = Path(__file__).parent / "schema.usda"
OUTPUT = Path(__file__).parent.parent / "core" / "stage" / "schema.inc"
HEAD = """\
/* Made by schema/tables.py of schema/schema.usda. A property is its name, type, fallback and tokens, with which a
 * skinslide_stage_input begins; a fallback that is a number stands alone, too. */
"""


def tables() -> str:
    """The text of schema.inc."""
    layer = Sdf.Layer.OpenAsAnonymous(str(SCHEMA))
    space = layer.GetPrimAtPath("/SkinSlideAPI").customData["propertyNamespacePrefix"]
    names = f'#define SS_SCHEMA    "SkinSlideAPI"\n#define SS_NAMESPACE "{space}:"\n'
    parts = [
        _section(layer, "SkinSlideAPI", "SS_PATCH", ""),
        _section(layer, "SkinSlideMeshAPI", "SS_MESH", f"{space}:"),
        _section(layer, "SkinSlideLiveAPI", "SS_LIVE", f"{space}:live:"),
    ]
    return "\n".join([HEAD, names, *parts])


def _section(layer: Sdf.Layer, schema: str, prefix: str, space: str) -> str:
    """A macro for each property, in the order of the schema. space: what their names begin with."""
    attributes = layer.GetPrimAtPath(f"/{schema}").attributes
    lines = [_macro(each, prefix, each.name.removeprefix(space)) for each in attributes]
    return f"/* {schema} */\n#define {prefix}_COUNT {len(attributes)}\n{''.join(lines)}"


def _macro(attribute: Sdf.AttributeSpec, prefix: str, name: str) -> str:
    macro = prefix + "_" + re.sub("([A-Z])", r"_\1", name).upper()
    value, fallback = attribute.default, _fallback(attribute)
    number = f"#define {macro}_NUMBER {value:g}\n" if isinstance(value, bool | float) else ""
    return f'#define {macro} "{name}", "{attribute.typeName}", {fallback}, {_tokens(attribute)}\n{number}'


def _fallback(attribute: Sdf.AttributeSpec) -> str:
    value = attribute.default
    if value is None:
        return "NULL"
    return f'"{value}"' if isinstance(value, str) else f'"{value:g}"'


def _tokens(attribute: Sdf.AttributeSpec) -> str:
    if not attribute.allowedTokens:
        return "NULL"
    quoted = [f'"{token}"' for token in attribute.allowedTokens]
    return f"(const char *const[]){{{', '.join([*quoted, 'NULL'])}}}"


if __name__ == "__main__":
    (Path(sys.argv[1]) if len(sys.argv) > 1 else OUTPUT).write_text(tables())
