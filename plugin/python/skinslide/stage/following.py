"""What of a mesh follows from its points beside them: the core is asked of each primvar."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Usd, UsdGeom

from skinslide.arrays.derived import DerivedMeaning
from skinslide.arrays.meaning import MeshMeaning
from skinslide.arrays.schema import Input
from skinslide.stage.values import Source


def offered(prim: Usd.Prim, meaning: DerivedMeaning) -> Iterator[Input]:
    """The primvars of a mesh that follow from its points."""
    for name in sorted(prim.GetAuthoredPropertyNames(lambda name: name.startswith("primvars:"))):
        primvar = UsdGeom.Primvar(prim.GetAttribute(name))
        if primvar and primvar.HasAuthoredValue():
            interpolation = primvar.GetAttr().GetMetadata("interpolation")
            wanted = meaning.offer(name, str(primvar.GetTypeName()), interpolation, primvar.GetElementSize())
            yield from [wanted] if wanted else []


def carried(prim: Usd.Prim, mesh: MeshMeaning) -> list[Input]:
    """Those that turn as the skin does."""
    meaning = DerivedMeaning(mesh, [], 1.0)
    wanted = list(offered(prim, meaning))
    for each in wanted:
        meaning.take(each, Source(prim, each).first(), [])
    names = {output.name for output in meaning.outputs() if output.is_carried}
    return [each for each in wanted if each.property() in names]
