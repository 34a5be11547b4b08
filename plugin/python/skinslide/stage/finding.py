"""Finds the meshes of a stage that carry patches, and says of every other prim with one why it cannot be slid."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pxr import Sdf, Usd, UsdGeom

from skinslide.problems import Problem
from skinslide.stage import schema
from skinslide.stage.opening import is_live


def find_meshes(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> tuple[list[Usd.Prim], list[Problem]]:
    """The meshes with patches, and every prim that carries a patch where none can be slid.

    prim_paths  None: the whole stage; else prims that are looked at with everything below them
    """
    meshes, problems, seen = [], list(composition_problems(stage, prim_paths)), set()
    prototypes = _instancer_prototypes(stage)
    for root in _roots(stage, prim_paths, problems):
        for prim in _prims_below(root):
            if prim.GetPath() in seen:
                continue
            seen.add(prim.GetPath())
            problems += _misnamed(prim)
            if not schema.patch_names(prim):
                continue
            reason = _why_not(prim, prototypes)
            slid_by = None if reason else _slid_by(prim)
            if reason:
                problems.append(Problem("error", str(prim.GetPath()), None, None, reason))
            elif slid_by:
                message = f"is slid already, by {slid_by}; bake that file, or put the cache in its place"
                problems.append(Problem("warning", str(prim.GetPath()), None, None, message))
            else:
                meshes.append(prim)
    if not meshes and not any(problem.severity == "error" for problem in problems):
        problems.append(Problem("error", "", None, None, _nothing(prim_paths)))
    return meshes, problems


def patched_prims(stage: Usd.Stage) -> list[Usd.Prim]:
    """Every prim of a stage that carries a patch, whether it can be slid or not."""
    return [prim for prim in _prims_below(stage.GetPseudoRoot()) if schema.patch_names(prim)]


def composition_problems(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> Iterator[Problem]:
    """What USD could not compose: errors, for what is missing may be a mesh that should slide, or part of one.

    Warnings where it cannot be: away from the prims asked for, or where a prim is of a type that holds no meshes, such
    as a Material.
    """
    asked = [Sdf.Path(str(path)) for path in prim_paths or ["/"] if Sdf.Path.IsValidPathString(str(path))]
    for error in stage.GetCompositionErrors():
        path = error.rootSite.path
        near = any(path.HasPrefix(root) or root.HasPrefix(path) for root in asked)
        message = "USD could not compose this: " + " ".join(str(error).split())
        severity = "error" if near and _may_hold_meshes(stage.GetPrimAtPath(path)) else "warning"
        yield Problem(severity, "" if path.IsAbsoluteRootPath() else str(path), None, None, message)


def _may_hold_meshes(prim: Usd.Prim | None) -> bool:
    return not prim or not prim.GetTypeName() or prim.IsA(UsdGeom.Imageable)


def _roots(stage: Usd.Stage, prim_paths: Sequence[str] | None, problems: list[Problem]) -> Iterator[Usd.Prim]:
    if prim_paths is None:
        yield stage.GetPseudoRoot()
        return
    for path in prim_paths:
        valid = Sdf.Path.IsValidPathString(str(path)) and Sdf.Path(str(path)).IsAbsoluteRootOrPrimPath()
        prim = stage.GetPrimAtPath(str(path)) if valid else None
        if prim:
            yield prim
        else:
            message = "there is no such prim" if valid else "this is not the path of a prim, such as /World/char/geo"
            problems.append(Problem("error", str(path), None, None, message))


def _prims_below(root: Usd.Prim) -> Usd.PrimRange:
    """Active prims; with instance proxies and undefined prims, so that a patch there is not silently passed over."""
    return Usd.PrimRange(root, Usd.TraverseInstanceProxies(Usd.PrimIsActive & ~Usd.PrimIsAbstract))


def _instancer_prototypes(stage: Usd.Stage) -> dict[Sdf.Path, Sdf.Path]:
    """The prototype roots of point instancers, each with its instancer."""
    return {
        target: prim.GetPath()
        for prim in _prims_below(stage.GetPseudoRoot())
        if prim.IsA(UsdGeom.PointInstancer)
        for target in UsdGeom.PointInstancer(prim).GetPrototypesRel().GetForwardedTargets()
    }


def _misnamed(prim: Usd.Prim) -> Iterator[Problem]:
    path = str(prim.GetPath())
    if {schema.SCHEMA, f"{schema.SCHEMA}:"} & set(schema.applied_schemas(prim)):
        message = f"{schema.SCHEMA} is applied without a patch's name; apply {schema.SCHEMA}:NAME"
        yield Problem("error", path, None, None, message)
    if prim.IsA(UsdGeom.Mesh):
        for patch in schema.unapplied_patch_names(prim):
            message = f"has properties, but {schema.SCHEMA}:{patch} is not applied to the prim, so it does not slide"
            yield Problem("warning", path, patch, None, message)
        for patch, unknown in schema.unknown_settings(prim).items():
            for name in unknown:
                yield Problem("warning", path, patch, None, f"{name} is no setting of a patch, and counts for nothing")


def _why_not(prim: Usd.Prim, prototypes: dict[Sdf.Path, Sdf.Path]) -> str | None:
    """Why the patches of a prim cannot be slid, and what to do; None: they can."""
    if prim.IsInstanceProxy():
        instance = prim
        while not instance.IsInstance():
            instance = instance.GetParent()
        return f"is inside an instance, whose points are shared; author instanceable = false on {instance.GetPath()}"
    for prefix in prim.GetPath().GetPrefixes():
        if prefix in prototypes:
            return (
                f"is a prototype of the point instancer {prototypes[prefix]}, whose instances share its points; "
                "slide a mesh outside it, or put the baked mesh in its place"
            )
    if not prim.IsDefined():
        return "is not defined, there are only overs; is the path right, and does the cache below it open?"
    if not prim.IsA(UsdGeom.Mesh):
        return f"is a {prim.GetTypeName() or 'prim without a type'}; {schema.SCHEMA} applies to Mesh only"
    return None


def _slid_by(prim: Usd.Prim) -> str | None:
    """The `.skinslide` file that computes the points of a mesh."""
    for spec in UsdGeom.Mesh(prim).GetPointsAttr().GetPropertyStack():
        if spec.HasInfo("timeSamples") or spec.HasInfo("default"):
            return spec.layer.identifier if is_live(spec.layer) else None
    return None


def _nothing(prim_paths: Sequence[str] | None) -> str:
    where = "on the stage" if prim_paths is None else f"at or below {', '.join(map(str, prim_paths))}"
    return (
        f"nothing to slide: no mesh {where} has {schema.SCHEMA} applied; "
        "start with: skinslide setup STAGE -o X.skinslide --prim MESH --patch NAME --faces 0-120"
    )
