"""The names of SkinSlideAPI on the stage, and the fallbacks and tokens that its schema declares."""

from __future__ import annotations

from functools import cache

from pxr import Plug, Sdf, Usd, UsdGeom

from skinslide.arrays.fetched import PrimFacts
from skinslide.arrays.finding import find
from skinslide.arrays.schema import SCHEMA

NAMESPACE = "skinSlide"
SPACES = (NAMESPACE, "primvars")
# Values of the cache that a bake into the same layer has taken the place of.
CACHED = f"{NAMESPACE}:cached"

# Primvars that a bake writes when it is asked for diagnostics.
STRETCH, SLIDE = f"primvars:{NAMESPACE}:stretch", f"primvars:{NAMESPACE}:slide"
LARGEST, SMALLEST = f"primvars:{NAMESPACE}:largestStretch", f"primvars:{NAMESPACE}:smallestStretch"
AREA, DIRECTION = f"primvars:{NAMESPACE}:areaRatio", f"primvars:{NAMESPACE}:stretchDirection"
DIAGNOSTICS = (STRETCH, SLIDE, LARGEST, SMALLEST, AREA, DIRECTION)


def applied_schemas(prim: Usd.Prim) -> list[str]:
    """What `apiSchemas` composes to.

    Usd.Prim.GetAppliedSchemas leaves out a schema that the registry did not know at its start, which is when the first
    stage was opened.
    """
    return list(prim.GetPrimTypeInfo().GetAppliedAPISchemas())


def patch_names(prim: Usd.Prim) -> list[str]:
    """The patches applied to a prim, in order."""
    names = applied_schemas(prim)
    return find(PrimFacts(schemas=names)).patches if any(name.startswith(SCHEMA) for name in names) else []


def property_name(patch: str, name: str) -> str:
    return f"{NAMESPACE}:{patch}:{name}"


def is_of_patch(name: str, patch: str) -> bool:
    """Whether a property of a mesh is one of a patch."""
    space, _, _own = name.removeprefix("primvars:").removesuffix(":indices").rpartition(":")
    return space == f"{NAMESPACE}:{patch}"


def child(prim: Usd.Prim, name: str) -> Usd.Prim | None:
    """The child of any name, be it that of a prim or none."""
    found = prim.GetChild(name) if Sdf.Path.IsValidIdentifier(name) else None
    return found or None


def primvar(prim: Usd.Prim, patch: str, name: str) -> UsdGeom.Primvar:
    """The primvar of a patch; invalid where there is none."""
    return UsdGeom.PrimvarsAPI(prim).GetPrimvar(property_name(patch, name))


def attribute(prim: Usd.Prim, patch: str, name: str) -> Usd.Attribute:
    """The attribute of a patch; invalid where there is none."""
    return prim.GetAttribute(property_name(patch, name))


def declared(name: str) -> Sdf.AttributeSpec:
    """The schema's own declaration of a property of a patch."""
    return declaration(SCHEMA, Usd.SchemaRegistry.MakeMultipleApplyNameTemplate(NAMESPACE, name))


def declaration(schema: str, name: str) -> Sdf.AttributeSpec:
    """The declaration of a property of one of the schemas, by its name there."""
    return _schema_layer().GetAttributeAtPath(f"/{schema}.{name}")


def declared_names() -> list[str]:
    """The properties of a patch that the schema declares, such as envelope."""
    return [spec.name.rpartition(":")[2] for spec in _schema_layer().GetPrimAtPath(f"/{SCHEMA}").attributes]


@cache
def _schema_layer() -> Sdf.Layer:
    """The generated schema, read as a file since the registry may have started before skinslide was imported."""
    plugin = Plug.Registry().GetPluginWithName("skinslide")
    return Sdf.Layer.FindOrOpen(plugin.MakeResourcePath("generatedSchema.usda"))
