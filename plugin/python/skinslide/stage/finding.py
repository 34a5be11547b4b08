"""Finds the meshes of a stage that carry patches, and says of every other prim with one why it cannot be slid."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeAlias

from pxr import Pcp, Sdf, Usd, UsdGeom, UsdSkel

from skinslide.arrays.fetched import PrimFacts
from skinslide.arrays.finding import Finding, find, nothing_to_slide
from skinslide.arrays.schema import SCHEMA
from skinslide.problems import Problem, StageProblems
from skinslide.stage import schema
from skinslide.stage.binding import skel_root, skeleton_target
from skinslide.stage.marks import baked_layer, has_values
from skinslide.stage.names import no_such_prim
from skinslide.stage.opening import is_live

_Variant: TypeAlias = tuple[str, str]  # its set, its name


class FoundMesh(NamedTuple):
    """A mesh that can be slid."""

    prim: Usd.Prim
    patches: list[str]
    is_skinned: bool  # UsdSkel moves its points


def find_meshes(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> tuple[list[FoundMesh], list[Problem]]:
    """The meshes with patches, and what there is to say of every prim that carries a patch.

    Of the whole stage, or of the prims at `prim_paths` and everything below them.
    """
    meshes, problems, own = [], list(composition_problems(stage, prim_paths)), list[Problem]()
    prototypes = _instancer_prototypes(stage)
    for prim in _prims(stage, prim_paths, problems):
        finding = find(_facts(prim, prototypes))
        own += _problems(prim, finding)
        if finding.patches and finding.slides:
            meshes.append(FoundMesh(prim, finding.patches, finding.is_skinned))
    problems += own
    if not meshes and not any(problem.severity == "error" for problem in problems):
        nothing = nothing_to_slide(_where(prim_paths))
        message = nothing if own else f"{nothing}; start with: {_first_command(stage)}"
        problems.append(Problem("error", "", None, None, message))
    return meshes, problems


def find_skinned(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> tuple[list[FoundMesh], list[Problem]]:
    """The meshes that UsdSkel skins, and what there is to say of each mesh with joints or blend shapes."""
    meshes, problems = [], list(composition_problems(stage, prim_paths))
    prototypes = _instancer_prototypes(stage)
    for prim in filter(UsdGeom.Mesh, _prims(stage, prim_paths, problems)):
        # What keeps a mesh with a patch from being slid keeps the points of this one from being replaced.
        facts = _facts(prim, prototypes, [f"{SCHEMA}:any"])
        if facts.has_joint_indices or facts.blend_shape_count:
            finding = find(facts)
            problems += _problems(prim, finding)
            meshes += [FoundMesh(prim, [], True)] if finding.is_skinned and finding.slides else []
    if not meshes and not any(problem.severity == "error" for problem in problems):
        problems.append(Problem("error", "", None, None, f"UsdSkel skins no mesh {_where(prim_paths)}"))
    return meshes, problems


def find_slidable(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> list[FoundMesh]:
    """The meshes that would be slid if they carried a patch."""
    return slidable(stage, filter(UsdGeom.Mesh, _prims(stage, prim_paths, [])))[0]


def slidable(stage: Usd.Stage, prims: Iterable[Usd.Prim]) -> tuple[list[FoundMesh], list[Problem]]:
    """Those of some meshes that would be slid if they carried a patch, and what there is to say of the others."""
    prototypes, found, problems = _instancer_prototypes(stage), list[FoundMesh](), list[Problem]()
    for prim in prims:
        finding = find(_facts(prim, prototypes, [f"{SCHEMA}:any"]))
        if finding.slides:
            found.append(FoundMesh(prim, [], finding.is_skinned))
        else:
            problems += _problems(prim, finding)
    return found, problems


def is_skinned(prim: Usd.Prim) -> bool:
    """Whether UsdSkel moves the points of a mesh."""
    return find(_facts(prim, {}, [f"{SCHEMA}:any"])).is_skinned


def _problems(prim: Usd.Prim, finding: Finding) -> Iterator[Problem]:
    for problem in finding.problems:
        yield Problem(problem.severity, str(prim.GetPath()), problem.patch, None, problem.message)


def patched_prims(stage: Usd.Stage) -> list[Usd.Prim]:
    """Every prim of a stage that carries a patch, whether it can be slid or not."""
    return [prim for prim in _prims_below(stage.GetPseudoRoot()) if schema.patch_names(prim)]


def prims_at(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> list[Usd.Prim]:
    """Every prim of a stage, or those at paths and below, each once. Raises StageProblems for a path of none."""
    problems: list[Problem] = []
    found = list(_prims(stage, prim_paths, problems))
    if problems:
        raise StageProblems(problems)
    return found


def composition_problems(stage: Usd.Stage, prim_paths: Sequence[str] | None = None) -> Iterator[Problem]:
    """What USD could not compose: errors, for what is missing may be a mesh that should slide, or part of one.

    Warnings where it cannot be: away from the prims asked for, or where a prim is of a type that holds no meshes, such
    as a Material.
    """
    asked = [Sdf.Path(str(path)) for path in prim_paths or ["/"] if Sdf.Path.IsValidPathString(str(path))]
    for error in stage.GetCompositionErrors():
        path = error.rootSite.path
        near = any(path.HasPrefix(root) or root.HasPrefix(path) for root in asked)
        severity = "error" if near and _may_hold_meshes(stage.GetPrimAtPath(path)) else "warning"
        for problem in find(PrimFacts(uncomposed=" ".join(str(error).split()))).problems:
            yield Problem(severity, "" if path.IsAbsoluteRootPath() else str(path), None, None, problem.message)


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
            named = "this" if str(path) else "an empty name"
            message = f"{named} is not the path of a prim, such as /World/char/geo"
            message = no_such_prim(stage, str(path)) if valid else message
            problems.append(Problem("error", str(path), None, None, message))


def _prims(stage: Usd.Stage, prim_paths: Sequence[str] | None, problems: list[Problem]) -> Iterator[Usd.Prim]:
    """Each prim that is asked for, once."""
    seen = set()
    for root in _roots(stage, prim_paths, problems):
        for prim in _prims_below(root):
            if prim.GetPath() not in seen:
                seen.add(prim.GetPath())
                yield prim


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


def _facts(prim: Usd.Prim, prototypes: dict[Sdf.Path, Sdf.Path], schemas: Sequence[str] | None = None) -> PrimFacts:
    """What of a prim decides whether it can be slid; of one that carries no patch little is asked.

    Args:
        prim: The prim.
        prototypes: Of point instancers, each with its instancer.
        schemas: Those that are applied to it, as far as this goes; None: those that are.
    """
    names = schema.applied_schemas(prim) if schemas is None else schemas
    spaces = schema.SPACES if schemas is None else ()
    properties = [prop for space in spaces for prop in prim.GetAuthoredPropertiesInNamespace(space)]
    facts = PrimFacts(
        type_name=str(prim.GetTypeName()),
        is_mesh=prim.IsA(UsdGeom.Mesh),
        is_defined=prim.IsDefined(),
        schemas=names,
        properties=[prop.GetName() for prop in properties],
    )
    if not any(name.startswith(SCHEMA) for name in names):
        return facts
    variant_set, variant = _variant_of(prim) or (None, None)
    points, baked = UsdGeom.PointBased(prim).GetPointsAttr(), baked_layer(prim)
    return replace(
        facts,
        instance=_instance_of(prim),
        instancer=next((str(prototypes[each]) for each in prim.GetPath().GetPrefixes() if each in prototypes), None),
        slid_by=_slid_by(prim),
        baked_by=baked.identifier if baked else None,
        point_samples=points.GetNumTimeSamples() if points else 0,
        has_joint_indices=_is_authored(prim, "skel:jointIndices"),
        has_joint_weights=_is_authored(prim, "skel:jointWeights"),
        blend_shape_count=len(UsdSkel.BindingAPI(prim).GetBlendShapeTargetsRel().GetTargets()),
        skel_root=_path(skel_root(prim)),
        skeleton=_path(skeleton_target(prim)),
        reads_skinning=True,
        variant_set=variant_set,
        variant=variant,
    )


def _is_authored(prim: Usd.Prim, primvar: str) -> bool:
    found = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(primvar)
    return bool(found and found.HasAuthoredValue())


def _path(prim: Usd.Prim | None) -> str | None:
    return str(prim.GetPath()) if prim else None


def _instance_of(prim: Usd.Prim) -> str | None:
    """The instance that a prim is inside of."""
    if not prim.IsInstanceProxy():
        return None
    while not prim.IsInstance():
        prim = prim.GetParent()
    return str(prim.GetPath())


def _variant_of(prim: Usd.Prim) -> _Variant | None:
    """The variant that the points of a mesh come from, unless the edit target is in it."""
    strongest = _strongest_points(prim)
    found = _variant_below(prim.GetPrimIndex().rootNode, strongest) if strongest else None
    target = prim.GetStage().GetEditTarget().MapToSpecPath(prim.GetPath())
    edited = [path.GetVariantSelection() for path in target.GetPrefixes() if path.IsPrimVariantSelectionPath()]
    return None if found in edited else found


def _variant_below(node: Pcp.NodeRef, spec: Sdf.PropertySpec, variant: _Variant | None = None) -> _Variant | None:
    """The last variant on the way to the node that an opinion is from."""
    if node.arcType == Pcp.ArcTypeVariant:
        variant = node.GetPathAtIntroduction().GetVariantSelection()
    if node.path == spec.owner.path and spec.layer in node.layerStack.layers:
        return variant
    return next(filter(None, (_variant_below(child, spec, variant) for child in node.children)), None)


def _slid_by(prim: Usd.Prim) -> str | None:
    """The `.skinslide` file that computes the points of a mesh."""
    strongest = _strongest_points(prim)
    return strongest.layer.identifier if strongest and is_live(strongest.layer) else None


def _strongest_points(prim: Usd.Prim) -> Sdf.PropertySpec | None:
    """The opinion that the points of a mesh come from."""
    points = UsdGeom.PointBased(prim).GetPointsAttr()
    return next(filter(has_values, points.GetPropertyStack() if points else []), None)


def _first_command(stage: Usd.Stage) -> str:
    root = stage.GetRootLayer()
    return f"skinslide setup {'STAGE' if root.anonymous else shlex.quote(root.identifier)} -o X.skinslide --whole"


def _where(prim_paths: Sequence[str] | None) -> str:
    return "on the stage" if prim_paths is None else f"at or below {', '.join(map(str, prim_paths))}"
