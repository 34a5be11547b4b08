"""The names of SkinSlideAPI on the stage, and the fallbacks and tokens that its schema declares."""

from __future__ import annotations

from functools import cache

from pxr import Plug, Sdf, Usd, UsdGeom

from skinslide.problems import Fault

SCHEMA = "SkinSlideAPI"
NAMESPACE = "skinSlide"
REST_POINTS = f"{NAMESPACE}:restPoints"
# Names directly under the namespace that are not patches.
NOT_PATCHES = ("restPoints", "live", "cached")
# What is painted, which a schema of attributes cannot declare.
PRIMVARS = ("patch", "forceDensity", "weight", "maxDistance")
# Values of the cache that a bake into the same layer has taken the place of.
CACHED = f"{NAMESPACE}:cached"

# Primvars that a bake writes when it is asked for diagnostics.
STRETCH, SLIDE = f"primvars:{NAMESPACE}:stretch", f"primvars:{NAMESPACE}:slide"


def applied_schemas(prim: Usd.Prim) -> list[str]:
    """What `apiSchemas` composes to.

    Usd.Prim.GetAppliedSchemas leaves out a schema that the registry did not know at its start, which is when the first
    stage was opened.
    """
    return list(prim.GetPrimTypeInfo().GetAppliedAPISchemas())


def patch_names(prim: Usd.Prim) -> list[str]:
    """The patches applied to a prim, in order."""
    prefix = f"{SCHEMA}:"
    found = [name.removeprefix(prefix) for name in applied_schemas(prim) if name.startswith(prefix)]
    return [name for name in found if name]


def unapplied_patch_names(prim: Usd.Prim) -> list[str]:
    """The patches that have properties on a prim but are not applied to it."""
    names = {name for prefix in (NAMESPACE, f"primvars:{NAMESPACE}") for name in _names_under(prim, prefix)}
    return sorted(name for name in names.difference(patch_names(prim)) if name.split(":")[0] not in NOT_PATCHES)


def unknown_settings(prim: Usd.Prim) -> dict[str, list[str]]:
    """Properties in the place of a patch's settings that are none, such as a misspelt one, by patch."""
    found: dict[str, list[str]] = {}
    for patch in patch_names(prim):
        for prefix, known in ((NAMESPACE, declared_names()), (f"primvars:{NAMESPACE}", PRIMVARS)):
            space = f"{prefix}:{patch}:"
            own = [prop.GetName() for prop in prim.GetAuthoredPropertiesInNamespace(space)]
            unknown = [name for name in own if name.removeprefix(space).removesuffix(":indices") not in known]
            found.setdefault(patch, []).extend(unknown)
    return found


def _names_under(prim: Usd.Prim, prefix: str) -> set[str]:
    inside = (prop.GetName().removeprefix(f"{prefix}:") for prop in prim.GetAuthoredPropertiesInNamespace(prefix))
    return {name.removesuffix(":indices").rpartition(":")[0] for name in inside} - {""}


def property_name(patch: str, name: str) -> str:
    return f"{NAMESPACE}:{patch}:{name}"


def is_of_patch(name: str, patch: str) -> bool:
    """Whether a property of a mesh is one of a patch."""
    space, _, _own = name.removeprefix("primvars:").removesuffix(":indices").rpartition(":")
    return space == f"{NAMESPACE}:{patch}"


def primvar(prim: Usd.Prim, patch: str, name: str) -> UsdGeom.Primvar:
    """The primvar of a patch; invalid where there is none."""
    return UsdGeom.PrimvarsAPI(prim).GetPrimvar(property_name(patch, name))


def inherited_primvar(prim: Usd.Prim, patch: str, name: str) -> UsdGeom.Primvar:
    """The primvar of a patch, or a constant one of that name that the prim inherits; invalid where there is neither."""
    return UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(property_name(patch, name))


def attribute(prim: Usd.Prim, patch: str, name: str) -> Usd.Attribute:
    """The attribute of a patch; invalid where there is none."""
    return prim.GetAttribute(property_name(patch, name))


def value(prim: Usd.Prim, patch: str, name: str, time: Usd.TimeCode):
    """The value of an attribute of a patch; where there is none, the schema's fallback, which may be None."""
    attr = attribute(prim, patch, name)
    found = attr.Get(time) if attr else None
    return declared(name).default if found is None else found


def token(prim: Usd.Prim, patch: str, name: str) -> str:
    found, allowed = value(prim, patch, name, Usd.TimeCode.EarliestTime()), declared(name).allowedTokens
    if found not in allowed:
        raise Fault(f"{property_name(patch, name)} is {str(found)!r}; it must be one of {', '.join(allowed)}")
    return found


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
