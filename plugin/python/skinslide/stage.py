"""Opens a stage and finds the meshes on it that carry patches."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Iterator, Sequence
from pathlib import Path

from pxr import Ar, Sdf, Tf, Usd, UsdGeom, UsdUtils

from skinslide import fileformat, names
from skinslide.problems import Problem, StageError, usd_message

EXTENSION = ".skinslide"


def open_stage(path: str | Path) -> Usd.Stage:
    """Opens a stage with its payloads. A `.skinslide` file opens as its text, with the points of the cache."""
    path = str(path)
    try:
        if os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path):
            raise StageError(f"cannot open {path}: it is not a regular file")
        return Usd.Stage.Open(_text_of(Path(path)) if path.endswith(EXTENSION) else path)
    except (Tf.ErrorException, OSError, ValueError) as error:
        raise StageError(f"cannot open {path}: {why_not_opened(path, error)}") from error


def _text_of(path: Path) -> Sdf.Layer:
    """The text of a `.skinslide` file as a layer; where USD has no format for it, as an anonymous one."""
    text = read_text_layer(path)  # whose errors are the better ones
    if fileformat.registered():
        return Sdf.Layer.FindOrOpen(str(path), fileformat.TEXT_ONLY)
    anchor_assets(text, path)
    return text


def why_not_opened(path: str, error: Exception) -> str:
    """The cause of an exception that opening a file raised."""
    if not path:
        return "the name is empty"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    if isinstance(error, Tf.ErrorException):
        if os.path.isdir(path):
            return "it is a folder"
        try:
            os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
        except PermissionError as denied:
            return denied.strerror
        except OSError:
            pass  # a resolver may know it under this name
        if not Ar.GetResolver().Resolve(path):
            return "there is no such file"
        return usd_message(error)
    return "it is not text"


def read_text_layer(path: Path) -> Sdf.Layer:
    """The USDA text of a file in an anonymous layer, as it stands."""
    text = path.read_text(encoding="utf-8")
    layer = Sdf.Layer.CreateAnonymous(f"{path.name}.usda")
    if not text.startswith("#usda"):
        raise StageError(f"cannot open {path}: it is not USDA text (the first line must be #usda 1.0)")
    layer.ImportFromString(text)
    return layer


def anchor_assets(layer: Sdf.Layer, path: Path) -> None:
    """Makes the relative asset paths of a layer mean what they mean in the file at `path`."""
    resolver, anchor = Ar.GetResolver(), Ar.ResolvedPath(str(path.absolute()))

    def anchored(asset: str) -> str:
        # An expression is evaluated first and anchored by USD, or names a full path.
        return asset if not asset or asset.startswith("`") else resolver.CreateIdentifier(asset, anchor)

    UsdUtils.ModifyAssetPaths(layer, anchored)
    layer.Traverse(Sdf.Path.absoluteRootPath, lambda at: _anchor_clip_template(layer, at, path.absolute().parent))


def _anchor_clip_template(layer: Sdf.Layer, at: Sdf.Path, folder: Path) -> None:
    """The template of value clips is a plain string, which UsdUtils passes over."""
    spec = layer.GetPrimAtPath(at) if at.IsPrimPath() else None
    if spec is None or not spec.HasInfo("clips"):
        return
    clips = dict(spec.GetInfo("clips"))
    for name, clip_set in clips.items():
        template = clip_set.get("templateAssetPath", "")
        if template.startswith("."):
            clips[name] = {**clip_set, "templateAssetPath": posixpath.normpath(folder.as_posix() + "/" + template)}
    spec.SetInfo("clips", clips)


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
            if not names.patch_names(prim):
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
    return [prim for prim in _prims_below(stage.GetPseudoRoot()) if names.patch_names(prim)]


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
    if {names.SCHEMA, f"{names.SCHEMA}:"} & set(names.applied_schemas(prim)):
        message = f"{names.SCHEMA} is applied without a patch's name; apply {names.SCHEMA}:NAME"
        yield Problem("error", path, None, None, message)
    if prim.IsA(UsdGeom.Mesh):
        for patch in names.unapplied_patch_names(prim):
            message = f"has properties, but {names.SCHEMA}:{patch} is not applied to the prim, so it does not slide"
            yield Problem("warning", path, patch, None, message)
        for patch, unknown in names.unknown_settings(prim).items():
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
        return f"is a {prim.GetTypeName() or 'prim without a type'}; {names.SCHEMA} applies to Mesh only"
    return None


def _slid_by(prim: Usd.Prim) -> str | None:
    """The `.skinslide` file that computes the points of a mesh."""
    for spec in UsdGeom.Mesh(prim).GetPointsAttr().GetPropertyStack():
        if spec.HasInfo("timeSamples") or spec.HasInfo("default"):
            return spec.layer.identifier if fileformat.is_live(spec.layer) else None
    return None


def _nothing(prim_paths: Sequence[str] | None) -> str:
    where = "on the stage" if prim_paths is None else f"at or below {', '.join(map(str, prim_paths))}"
    return (
        f"nothing to slide: no mesh {where} has {names.SCHEMA} applied; "
        "start with: skinslide setup STAGE -o X.skinslide --prim MESH --patch NAME --faces 0-120"
    )
