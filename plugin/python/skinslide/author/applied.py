"""What skinslide's applied schemas have in common whatever they declare, in the manner of pxr's schema classes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt
from pxr import Sdf, Usd, UsdGeom, Vt

from skinslide.arrays.fetched import Other, Value
from skinslide.arrays.schema import Input, can_name_patch, inputs
from skinslide.arrays.values import check_value
from skinslide.problems import NO_PATCH_NAME, Fault, Problem, StageProblems, UsageError
from skinslide.stage import schema
from skinslide.stage.given import given_array, given_faces, given_value
from skinslide.stage.values import count_of


@dataclass(frozen=True)
class CanApplyResult:
    """Whether a schema can be applied: false if it cannot.

    Attributes:
        whyNot: The reason; empty if it can.
    """

    whyNot: str = ""

    def __bool__(self) -> bool:
        return not self.whyNot


class _Declared(Usd.SchemaBase):
    """What a schema declares, by its name there, on a prim."""

    SCHEMA: ClassVar[str]
    NAMESPACE: ClassVar[str]
    APPLIES_TO: ClassVar[tuple[str, ...]]  # types of prims; none: all

    def __repr__(self) -> str:
        return f"skinslide.{type(self).__name__}({self.GetPrim()!r})"

    def _full(self, name: str) -> str:
        return f"{self.NAMESPACE}:{name}"

    def _declaration(self, name: str) -> Sdf.AttributeSpec:
        return schema.declaration(self.SCHEMA, self._full(name))

    def _attribute(self, name: str) -> Usd.Attribute:
        return self.GetPrim().GetAttribute(self._full(name))

    def _given(self, name: str, value: Any) -> Any:
        """A value as the attribute takes it. Raises UsageError."""
        given = given_value(name, value, self._declaration(name).typeName)
        for source in (*inputs("patch"), *inputs("live")):
            if source.prefix + source.name == f"{self.NAMESPACE}:{name}":
                _check(source, name, given)
        return given

    def _create_attribute(self, name: str, value: Any, sparsely: bool) -> Usd.Attribute:
        """As pxr's do."""
        declared, attribute = self._declaration(name), self._attribute(name)
        given = None if value is None else self._given(name, value)
        authored = attribute and attribute.HasAuthoredValue()
        if sparsely and (given is None or (given == declared.default and not authored)):
            return attribute
        attribute = self.GetPrim().CreateAttribute(self._full(name), declared.typeName, False, declared.variability)
        if given is not None:
            attribute.Set(given)
        return attribute

    @classmethod
    def _why_not_to(cls, given: Usd.Prim | Usd.SchemaBase) -> str:
        """Why a prim cannot have the schema; empty where it can."""
        if not isinstance(given, Usd.Prim | Usd.SchemaBase):
            return f"{cls.SCHEMA} does not apply to {given!r}, which is not a Usd.Prim"
        prim = given.GetPrim()
        if not prim:
            return f"{cls.SCHEMA} does not apply to an {prim!r}"
        if prim.IsInstanceProxy() or prim.IsInPrototype():
            return f"{cls.SCHEMA} does not apply to {prim.GetPath()}, which instances share"
        if cls.APPLIES_TO and not any(map(prim.IsA, cls.APPLIES_TO)):
            return f"{cls.SCHEMA} applies to {' or '.join(cls.APPLIES_TO)}, which {prim.GetPath()} is not"
        return ""


class AppliedSchema(_Declared):
    """A schema that a prim has once."""

    def __bool__(self) -> bool:
        return bool(self.GetPrim()) and self.SCHEMA in schema.applied_schemas(self.GetPrim())

    @classmethod
    def Get(cls, stage: Usd.Stage, path: Sdf.Path | str) -> Self:
        """The schema on a prim of a stage.

        Args:
            stage: The stage.
            path: The path of the prim.

        Returns:
            The schema; false where there is no such prim, or it is not applied to it.
        """
        return cls(stage.GetPrimAtPath(path))

    @classmethod
    def CanApply(cls, prim: Usd.Prim | Usd.SchemaBase) -> CanApplyResult:
        """Whether the schema can be applied to a prim.

        Args:
            prim: The prim.

        Returns:
            A result that is true if it can; if not, its whyNot says why.
        """
        return CanApplyResult(cls._why_not_to(prim))

    @classmethod
    def Apply(cls, prim: Usd.Prim | Usd.SchemaBase) -> Self:
        """Applies the schema to a prim, in the stage's edit target.

        Args:
            prim: The prim.

        Returns:
            The schema on the prim.

        Raises:
            UsageError: It does not apply to the prim.
        """
        _apply(prim, cls.SCHEMA, cls.CanApply(prim))
        return cls(prim)


class AppliedPatch(_Declared):
    """A schema that a mesh has once for each of its patches, under the patch's name."""

    def __init__(self, prim: Usd.Prim | Usd.SchemaBase, name: str):
        """Looks at a patch, which need not be there.

        Args:
            prim: The mesh.
            name: The patch's name, such as elbow_L.
        """
        super().__init__(prim)
        self._name = name

    def __bool__(self) -> bool:
        return bool(self.GetPrim()) and self._name in schema.patch_names(self.GetPrim())

    def __repr__(self) -> str:
        return f"skinslide.{type(self).__name__}({self.GetPrim()!r}, {self._name!r})"

    @classmethod
    def Get(cls, stage: Usd.Stage, path: Sdf.Path | str, name: str) -> Self:
        """A patch of a mesh of a stage.

        Args:
            stage: The stage.
            path: The path of the mesh.
            name: The patch's name.

        Returns:
            The patch; false where there is no such prim, or it has no patch of that name.
        """
        return cls(stage.GetPrimAtPath(path), name)

    @classmethod
    def GetAll(cls, prim: Usd.Prim | Usd.SchemaBase) -> list[Self]:
        """Every patch of a mesh.

        Args:
            prim: The mesh.

        Returns:
            The patches, in the order in which they are applied.
        """
        return [cls(prim, name) for name in schema.patch_names(prim.GetPrim())]

    @classmethod
    def CanApply(cls, prim: Usd.Prim | Usd.SchemaBase, name: str) -> CanApplyResult:
        """Whether a prim can have a patch of a name.

        Args:
            prim: The prim.
            name: The patch's name.

        Returns:
            A result that is true if it can; if not, its whyNot says why.
        """
        return CanApplyResult(_why_no_name(name) or cls._why_not_to(prim))

    @classmethod
    def Apply(cls, prim: Usd.Prim | Usd.SchemaBase, name: str) -> Self:
        """Makes a patch on a mesh, in the stage's edit target.

        Args:
            prim: The mesh.
            name: The patch's name.

        Returns:
            The patch.

        Raises:
            UsageError: The prim cannot have a patch of that name.
        """
        _apply(prim, f"{cls.SCHEMA}:{name}", cls.CanApply(prim, name))
        return cls(prim, name)

    def GetName(self) -> str:
        """The patch's name."""
        return self._name

    def SetFaces(self, faces: npt.ArrayLike) -> UsdGeom.Primvar:
        """Makes the patch of some faces of the mesh, in place of what the edit target said of them before.

        Args:
            faces: Their indices (n,), in any order, or a bool for each face of the mesh (F,).

        Returns:
            The primvar that chooses them, uniform.

        Raises:
            UsageError: The values are not faces.
            StageProblems: The mesh has no such face.
        """
        mesh = UsdGeom.Mesh(self.GetPrim())
        count = count_of(mesh.GetFaceVertexCountsAttr())
        try:
            chosen = given_faces("faces", faces, count)
        except Fault as fault:
            raise StageProblems([Problem("error", str(self.GetPath()), self._name, None, str(fault))]) from fault
        self._forget(f"primvars:{self._full('patch')}", f"primvars:{self._full('patch')}:indices")
        return self._create_primvar("patch", "bool[]", UsdGeom.Tokens.uniform, np.isin(np.arange(count), chosen))

    def SetEdges(self, edges: npt.ArrayLike, force_densities: npt.ArrayLike) -> None:
        """Gives edges of the patch force densities, in place of what the edit target said of them before.

        Args:
            edges: Point indices (k, 2), a pair for each edge.
            force_densities: A factor above 0 for each edge (k,), which multiplies what is painted.

        Raises:
            UsageError: The values are not edges or factors.
        """
        pairs = given_array("edges", edges, np.int32, (-1, 2))
        factors = given_array("force_densities", force_densities, np.float32, (len(pairs),))
        self._given("edges", pairs.ravel())
        self._forget(self._full("edges"), self._full("edgeForceDensities"))
        self._create_attribute("edges", pairs.ravel(), False)
        self._create_attribute("edgeForceDensities", factors, False)

    def _full(self, name: str) -> str:
        return f"{self.NAMESPACE}:{self._name}:{name}"

    def _declaration(self, name: str) -> Sdf.AttributeSpec:
        return schema.declared(name)

    def _primvar(self, name: str) -> UsdGeom.Primvar:
        return UsdGeom.PrimvarsAPI(self.GetPrim()).GetPrimvar(self._full(name))

    def _create_primvar(
        self, name: str, type_name: str, interpolation: str, values: npt.ArrayLike | None
    ) -> UsdGeom.Primvar:
        kind = Sdf.ValueTypeNames.Find(type_name)
        given = None if values is None else given_value(name, values, kind)
        primvar = UsdGeom.PrimvarsAPI(self.GetPrim()).CreatePrimvar(self._full(name), kind, interpolation)
        if given is not None:
            primvar.Set(given)
            if primvar.IsIndexed():
                primvar.BlockIndices()
        return primvar

    def _forget(self, *names: str) -> None:
        for name in names:
            self.GetPrim().RemoveProperty(name)


def _check(source: Input, name: str, given: Any) -> None:
    """Raises UsageError for what the core does not take."""
    value = Value(name, Other(), repr(given))
    if isinstance(given, str | Vt.IntArray):
        value = Value(name, given if isinstance(given, str) else np.asarray(given), source.type_name)
    try:
        check_value(source, value)
    except Fault as fault:
        raise UsageError(str(fault)) from fault


def _why_no_name(patch: str) -> str:
    """Why no patch can have a name; empty where one can."""
    if (
        not isinstance(patch, str)
        or not Sdf.Path.IsValidNamespacedIdentifier(patch)
        or not can_name_patch(patch)
        or patch.split(":")[-1] in schema.declared_names()  # USD does not allow those
    ):
        return f"{patch!r} {NO_PATCH_NAME}"
    return ""


def _apply(prim: Usd.Prim | Usd.SchemaBase, applied: str, can: CanApplyResult) -> None:
    if not can:
        raise UsageError(can.whyNot)
    # Not ApplyAPI, which knows only schemas that were registered before the first stage was opened.
    prim.GetPrim().AddAppliedSchema(applied)
