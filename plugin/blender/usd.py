"""Set-ups in `.skinslide` files, by the USD that comes with Blender. Does not use bpy's data; for any thread.

A set-up is read as the stage means it, of whatever layers that is made; it is written into the one layer of its file,
in which all stays that Blender does not hold.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from skinslide.arrays.fetched import NOTHING, Asset, Other, Value
from skinslide.arrays.meaning import MeshMeaning, PatchMeaning
from skinslide.arrays.schema import SCHEMA, Input, input_of, inputs
from skinslide.problems import Fault, StageError, StageProblems, UsageError

from .reading import Fetched, FetchedPatch

Keys = dict[tuple[str, str], list[tuple[float, float]]]  # by patch and setting: times and numbers


def import_usd() -> None:
    """Imports pxr, with the schema. The file format was built for another USD, so such files are read as text."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        from pxr import Usd  # noqa: F401


@contextmanager
def as_fault() -> Iterator[None]:
    """Raises Fault for whatever cannot be opened, read or written."""
    try:
        yield
    except (UsageError, StageError, StageProblems, OSError) as error:
        raise Fault(str(error)) from error


@dataclass
class Read:
    """A set-up as it is in a file."""

    prim: str
    rest: np.ndarray  # (V, 3)
    values: list[Value] = field(default_factory=list)  # of the mesh
    primvars: list[Value] = field(default_factory=list)  # under the schema's names
    patches: list[FetchedPatch] = field(default_factory=list)
    keys: Keys = field(default_factory=dict)
    left: list[str] = field(default_factory=list)  # what Blender does not hold


def read_setup(path: str, prim_path: str, counts: np.ndarray, indices: np.ndarray) -> Read:
    """The set-up in a file of a mesh with these faces. Raises Fault.

    prim_path: where the mesh is; empty: wherever its faces are.
    """
    import_usd()
    from skinslide.stage.finding import patched_prims
    from skinslide.stage.opening import open_stage, read_text_layer
    from skinslide.stage.schema import patch_names
    from skinslide.stage.taking import take_mesh

    with as_fault():
        stage = open_stage(path)
        text = read_text_layer(Path(path)) if path.endswith(".skinslide") else stage.GetRootLayer()
    found = [each for each in patched_prims(stage) if prim_path in ("", str(each.GetPath()))]
    matching = [(prim, mesh) for prim in found if (mesh := _with_faces(take_mesh(prim), counts, indices))]
    if len(matching) != 1:
        raise Fault(_none_or_many(path, found, matching))
    ((prim, mesh),) = matching
    read = Read(str(prim.GetPath()), mesh.rest_points())
    read.values = [
        value for value in map(_first(prim), inputs("mesh")) if value and value.name.startswith("skinSlide:")
    ]
    for name in patch_names(prim):
        _read_patch(prim, mesh, name, read, text)
    return read


def _with_faces(taken: tuple[MeshMeaning, list[str]], counts: np.ndarray, indices: np.ndarray) -> MeshMeaning | None:
    mesh, faults = taken
    same = mesh.has_faces and np.array_equal(mesh.face_counts, counts) and np.array_equal(mesh.face_indices, indices)
    return mesh if same and not faults else None


def _none_or_many(path: str, found: Sequence[Any], matching: Sequence[Any]) -> str:
    listed = ", ".join(str(prim.GetPath()) for prim in found) or "none"
    if matching:
        return f"{path} has several meshes with these faces, of which one must be named: {listed}"
    return f"{path} has no mesh with a patch and the faces of this one; with patches: {listed}"


def _first(prim: Any) -> Any:
    from skinslide.stage.values import Source

    return lambda source: _authored(Source(prim, source).first())


def _authored(value: Value) -> Value | None:
    return None if value.value is NOTHING or value.value is None else value


def _written(text: Any, path: Any, asset: Asset) -> Asset:
    """A path as it is written, if it is in the file itself; as USD resolves it, if in weaker layers."""
    attribute = text.GetAttributeAtPath(path)
    return Asset(attribute.default.path) if attribute and attribute.HasInfo("default") else asset


def _read_patch(prim: Any, mesh: MeshMeaning, name: str, read: Read, text: Any) -> None:
    from pxr import Usd

    from skinslide.stage.patch import paint_sources, read_chosen, read_patch

    for fault in read_patch(prim, name, mesh)[1]:
        raise Fault(f"patch {name}: {fault}")
    meaning, patch = PatchMeaning(mesh, name), FetchedPatch(name, {})
    wanted = (*inputs("patch"), *inputs("controls"))
    for source, held in zip(wanted, paint_sources(prim, wanted, meaning), strict=True):
        value = _authored(held.first())
        times = held.times()
        if times and source.type_name == "float":
            samples = [(time, held.at(Usd.TimeCode(time))) for time in times]
            read.keys[name, source.name] = [(time, float(sample.value)) for time, sample in samples if sample]
        elif times:
            read.left.append(f"{held.name} varies over time: its first value is taken")
        if value and isinstance(value.value, Other):
            read.left.append(f"{held.name} is {value.type_name}, which is left out")
        elif value and source.is_primvar:
            read.primvars.append(_expanded(value._replace(name=source.property(name)), mesh))
        elif value and isinstance(value.value, Asset):
            patch.values[source.name] = value._replace(value=_written(text, held.attribute.GetPath(), value.value))
        elif value and np.size(value.value):
            patch.values[source.name] = value
    faces = input_of("patch", "patch").property(name)
    if not any(value.name == faces for value in read.primvars):
        chosen = np.isin(np.arange(len(mesh.face_counts)), read_chosen(prim, name, mesh))
        read.primvars.append(Value(faces, chosen, "bool[]", "uniform"))
    read.patches.append(patch)


def _expanded(value: Value, mesh: MeshMeaning) -> Value:
    """Without indices, and by point if it is constant."""
    array = np.asarray(value.value)
    if value.indices is not None:
        array = array[np.asarray(value.indices.value)]
    if value.interpolation in (None, "constant"):
        array = np.repeat(array.reshape(1, *array.shape[1:]), mesh.shape.vertex_count, axis=0)
        return value._replace(value=array, interpolation="vertex", indices=None)
    return value._replace(value=array, indices=None)


# ---- Writing ----


def write_setup(path: str, cache: str, prim_path: str, fetched: Fetched, rest: np.ndarray, keys: Keys) -> str:
    """Writes a set-up beside a cache, and gives the path of the mesh in it. Raises Fault, having written nothing."""
    import_usd()
    from skinslide.author.layer import author_layer

    with as_fault():
        return author_layer(cache, path, False, lambda stage: _author(stage, prim_path, fetched, rest, keys))


def _author(stage: Any, prim_path: str, fetched: Fetched, rest: np.ndarray, keys: Keys) -> str:
    from skinslide.author.api import SkinSlideAPI

    prim = _mesh_prim(stage, prim_path, fetched)
    _author_mesh(prim, fetched, rest)
    names = [patch.name for patch in fetched.patches]
    for gone in [each.GetName() for each in SkinSlideAPI.GetAll(prim) if each.GetName() not in names]:
        _forget(prim, gone, (*inputs("patch"), *inputs("controls")))
        _unapply(prim, f"{SCHEMA}:{gone}")
    for patch in fetched.patches:
        SkinSlideAPI.Apply(prim, patch.name)
        _author_patch(prim, fetched, patch, keys)
    return str(prim.GetPath())


def _mesh_prim(stage: Any, prim_path: str, fetched: Fetched) -> Any:
    """The mesh of the cache that has the faces, and the name if there are several. Raises Fault."""
    from pxr import UsdGeom

    if prim_path and stage.GetPrimAtPath(prim_path):
        return stage.GetPrimAtPath(prim_path)
    found = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh) and _has_faces(prim, fetched)]
    named = [prim for prim in found if _named_after(prim) == fetched.name]
    if len(named or found) != 1:
        raise Fault(f"the cache has {len(found)} meshes with the faces of {fetched.name}; name the prim of one")
    return (named or found)[0]


def _has_faces(prim: Any, fetched: Fetched) -> bool:
    from pxr import UsdGeom

    indices = UsdGeom.Mesh(prim).GetFaceVertexIndicesAttr().Get() or ()
    return np.array_equal(np.asarray(indices), fetched.indices)


def _named_after(prim: Any) -> str | None:
    """The object that Blender exported a mesh of."""
    attribute = prim.GetParent().GetAttribute("userProperties:blender:object_name")
    return attribute.Get() if attribute else None


def _author_mesh(prim: Any, fetched: Fetched, rest: np.ndarray) -> None:
    from skinslide.author.api import SkinSlideMeshAPI

    for source in (each for each in inputs("mesh") if each.prefix == "skinSlide:"):
        prim.RemoveProperty(source.property())
    own = SkinSlideMeshAPI(prim)
    own.CreateRestPointsAttr(rest)
    for name, value in fetched.values.items():
        if name != "skinSlide:restPoints":
            own._create_attribute(name.removeprefix("skinSlide:"), value.value, False)


def _author_patch(prim: Any, fetched: Fetched, patch: FetchedPatch, keys: Keys) -> None:
    from pxr import Usd

    from skinslide.author.api import SkinSlideAPI

    own = SkinSlideAPI(prim, patch.name)
    sources = (*inputs("patch"), *inputs("controls"))
    _forget(prim, patch.name, sources)
    for source in sources:
        if source.is_primvar:
            _author_primvar(prim, fetched.primvars.get(source.property(patch.name)))
        elif (patch.name, source.name) in keys:
            attribute = own._create_attribute(source.name, None, False)
            for time, number in keys[patch.name, source.name]:
                attribute.Set(number, Usd.TimeCode(time))
        elif source.name in patch.values:
            own._create_attribute(source.name, patch.values[source.name].value, False)


def _unapply(prim: Any, schema: str) -> None:
    """Removes a schema from the layer, and from the prim too if the cache has it."""
    from pxr import Sdf

    spec = prim.GetStage().GetEditTarget().GetLayer().GetPrimAtPath(prim.GetPath())
    held = spec.GetInfo("apiSchemas") if spec and spec.HasInfo("apiSchemas") else Sdf.TokenListOp()
    kept = [each for each in held.prependedItems if each != schema]
    if spec and not held.isExplicit:
        spec.SetInfo("apiSchemas", Sdf.TokenListOp.Create(kept, held.appendedItems, held.deletedItems))
    if schema in prim.GetPrimTypeInfo().GetAppliedAPISchemas():
        prim.RemoveAppliedSchema(schema)


def _author_primvar(prim: Any, value: Value | None) -> None:
    from pxr import Sdf, UsdGeom

    if value is None:
        return
    kind = Sdf.ValueTypeNames.Find(value.type_name)
    primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(value.name, kind, value.interpolation)
    primvar.Set(kind.type.pythonClass.FromNumpy(np.ascontiguousarray(value.value)))


def _forget(prim: Any, patch: str, sources: Sequence[Input]) -> None:
    """Removes the layer's inputs, except paint that varies over time, of which Blender holds only the first value."""
    layer = prim.GetStage().GetEditTarget().GetLayer()
    for source in sources:
        name = source.property(patch)
        if not (source.is_primvar and layer.ListTimeSamplesForPath(prim.GetPath().AppendProperty(name))):
            prim.RemoveProperty(name)
