"""What a bake writes: a layer of `over`s with nothing but what was slid, or the same in a stage's edit target."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdSkel, Vt

from skinslide.arrays.attributes import extent
from skinslide.stage.marks import mark
from skinslide.write.earlier import EarlierBake
from skinslide.write.inputs import check_not_read
from skinslide.write.replacing import begin_flush, replacing, saved, writing

EXTENSIONS = (".usda", ".usdc", ".usd")
_TEXT = ".usda"
_INFLUENCES = (
    UsdSkel.Tokens.primvarsSkelJointIndices,
    UsdSkel.Tokens.primvarsSkelJointWeights,
    UsdSkel.Tokens.skelBlendShapes,
)
_OWN_FIELDS = {"primChildren", "comment", "customLayerData"}  # of a layer, that say what is in it
_UNSAVED_BYTES = 8 << 20  # a crate file takes what is saved out of memory


class OverLayer:
    """Collects values for attributes of a stage in a layer of overs, typed as the stage has them."""

    def __init__(self, layer: Sdf.Layer, output: Path | None = None, *, marked: bool = True):
        """A crate file, saved in parts, with the output whose fault it is when that fails; or an anonymous layer.

        What is in it is marked as a bake's, unless it is a cache.
        """
        self.layer, self._output, self._marked = layer, output, marked
        self._unsaved = self._flushed = 0

    def set(self, attribute: Usd.Attribute, value: Any, time: Usd.TimeCode) -> None:
        """Authors a sample, or the default value where time is the default time."""
        self._set(self._spec(attribute), value, time)

    def set_points(self, prim: Usd.Prim, points: np.ndarray, time: Usd.TimeCode) -> None:
        """Authors points of a mesh, float32 (V, 3), and their extent."""
        geometry = UsdGeom.PointBased(prim)
        self.set(geometry.GetPointsAttr(), Vt.Vec3fArray.FromNumpy(points), time)
        # USD would find it on threads of its own, which then wait busily beside those that slide.
        self.set(geometry.GetExtentAttr(), Vt.Vec3fArray.FromNumpy(extent(points)), time)

    def set_primvar(
        self, prim: Sdf.Path, name: str, kind: tuple[Sdf.ValueTypeName, str], values: Any, time: Usd.TimeCode
    ) -> None:
        """Authors a primvar of a type and an interpolation, which the stage need not have."""
        spec = self.layer.GetAttributeAtPath(prim.AppendProperty(name))
        if not spec:
            spec = self._new_spec(prim, name, kind[0], Sdf.VariabilityVarying)
            spec.SetInfo("interpolation", kind[1])
        self._set(spec, values, time)

    def block(self, attribute: Usd.Attribute) -> None:
        """Makes the attribute have no value at any time."""
        spec = self._spec(attribute)
        spec.ClearInfo("timeSamples")
        spec.default = Sdf.ValueBlock()

    def end_skinning(self, prim: Usd.Prim) -> None:
        """Unbinds a prim from its skeleton: UsdSkel then leaves its points as they are, and others' alone.

        Its influences go too: flattened, a stage keeps no unbinding, and what is bound above would hold again.
        """
        spec = Sdf.CreatePrimInLayer(self.layer, prim.GetPath())
        if not prim.HasAPI(UsdSkel.BindingAPI):  # without it a binding does not count
            spec.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=["SkelBindingAPI"]))
        binding = Sdf.RelationshipSpec(spec, UsdSkel.Tokens.skelSkeleton, custom=False)
        binding.targetPathList.ClearEditsAndMakeExplicit()
        self._mark(binding)
        for name in _INFLUENCES:
            if prim.GetAttribute(name).HasAuthoredValue():
                self.block(prim.GetAttribute(name))

    def save(self) -> None:
        self._check(self.layer.Save)
        self._unsaved, self._flushed = 0, begin_flush(self.layer.realPath, self._flushed)

    def export(self, file: Path) -> None:
        """Writes the layer into another file, in the format of that file's name."""
        self._check(lambda: self.layer.Export(str(file)))

    def _check(self, write: Callable[[], bool]) -> None:
        with writing(self._output) if self._output else nullcontext():
            saved(write())

    def _set(self, spec: Sdf.AttributeSpec, value: Any, time: Usd.TimeCode) -> None:
        if time.IsDefault():
            spec.default = value
        else:
            self.layer.SetTimeSample(spec.path, time.GetValue(), value)
        self._unsaved += np.asarray(value).nbytes
        if not self.layer.anonymous and self._unsaved > _UNSAVED_BYTES:
            self.save()

    def _spec(self, attribute: Usd.Attribute) -> Sdf.AttributeSpec:
        spec = self.layer.GetAttributeAtPath(attribute.GetPath())
        kind = (attribute.GetTypeName(), attribute.GetVariability())
        return spec or self._new_spec(attribute.GetPrimPath(), attribute.GetName(), *kind)

    def _new_spec(
        self, prim: Sdf.Path, name: str, type_name: Sdf.ValueTypeName, variability: Sdf.Variability
    ) -> Sdf.AttributeSpec:
        spec = Sdf.AttributeSpec(Sdf.CreatePrimInLayer(self.layer, prim), name, type_name, variability)
        self._mark(spec)
        return spec

    def _mark(self, spec: Sdf.PropertySpec) -> None:
        if self._marked:
            mark(spec)


@contextmanager
def layer_in_place(output: Path, stage: Usd.Stage, comment: str, *, marked: bool = True) -> Iterator[OverLayer]:
    """A layer that becomes `output` when the block ends. An exception or a signal leaves `output` as it was.

    Text cannot be saved in parts: it is collected in a crate file beside it, and written from there at the end.
    """
    with replacing(output) as partial:
        text = partial.suffix.lower() == _TEXT
        with writing(output):
            crate = partial.with_name(f"{partial.name}.usdc") if text else partial
            overs = OverLayer(Sdf.Layer.CreateNew(str(crate)), output, marked=marked)
        yield overs
        overs.layer.comment = comment
        _describe(overs.layer, stage)
        overs.save()
        if text:
            overs.export(partial)
        check_not_read(output, stage)  # some layers, such as value clips, are not opened before they are needed


def author_on_stage(overs: OverLayer, stage: Usd.Stage, earlier: EarlierBake) -> None:
    """Copies every value into the stage's edit target, through the target's time offset; and every unbinding."""
    paths: list[Sdf.Path] = []
    overs.layer.Traverse(Sdf.Path.absoluteRootPath, paths.append)
    for path in filter(Sdf.Path.IsPropertyPath, paths):
        times = overs.layer.ListTimeSamplesForPath(path)
        earlier.replace(path, samples=bool(times))
        spec = overs.layer.GetPropertyAtPath(path)
        earlier.mark(_unbind(path, stage) if isinstance(spec, Sdf.RelationshipSpec) else _copy(spec, times, stage))


def _copy(spec: Sdf.AttributeSpec, times: Sequence[float], stage: Usd.Stage) -> Usd.Attribute:
    attribute = _attribute_for(spec, stage)
    for time in times:
        attribute.Set(spec.layer.QueryTimeSample(spec.path, time), time)
    if isinstance(spec.default, Sdf.ValueBlock):
        attribute.Block()
    elif spec.default is not None:
        attribute.Set(spec.default)
    return attribute


def _unbind(path: Sdf.Path, stage: Usd.Stage) -> Usd.Relationship:
    binding = UsdSkel.BindingAPI(stage.GetPrimAtPath(path.GetPrimPath()))
    if not binding.GetPrim().HasAPI(UsdSkel.BindingAPI):
        UsdSkel.BindingAPI.Apply(binding.GetPrim())
    binding.CreateSkeletonRel().SetTargets([])
    return binding.GetSkeletonRel()


def _attribute_for(spec: Sdf.AttributeSpec, stage: Usd.Stage) -> Usd.Attribute:
    """The stage's attribute; of a primvar that it need not have, made in the edit target."""
    if not spec.HasInfo("interpolation"):
        return stage.GetAttributeAtPath(spec.path)
    prim, name = stage.GetPrimAtPath(spec.path.GetPrimPath()), spec.name.removeprefix("primvars:")
    return UsdGeom.PrimvarsAPI(prim).CreatePrimvar(name, spec.typeName, spec.GetInfo("interpolation")).GetAttr()


def clock_of(layer: Sdf.Layer) -> dict[str, Any]:
    """Everything that says how a layer is to be read."""
    root = layer.pseudoRoot
    return {field: root.GetInfo(field) for field in sorted(set(root.ListInfoKeys()) - _OWN_FIELDS)}


def clock_for(stage: Usd.Stage, prims: Iterable[Sdf.Path]) -> dict[str, Any]:
    """That of a layer with overs of prims, as a bake writes it."""
    layer = Sdf.Layer.CreateAnonymous()
    for prim in prims:
        Sdf.CreatePrimInLayer(layer, prim)
    _describe(layer, stage)
    return clock_of(layer)


def _describe(layer: Sdf.Layer, stage: Usd.Stage) -> None:
    """Gives the layer the stage's clock and units, so that it reads the same alone and sublayered."""
    layer.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
    layer.framesPerSecond = stage.GetFramesPerSecond()
    if stage.HasAuthoredTimeCodeRange():
        layer.startTimeCode, layer.endTimeCode = stage.GetStartTimeCode(), stage.GetEndTimeCode()
    root = layer.pseudoRoot
    root.SetInfo(UsdGeom.Tokens.upAxis, UsdGeom.GetStageUpAxis(stage))
    root.SetInfo(UsdGeom.Tokens.metersPerUnit, UsdGeom.GetStageMetersPerUnit(stage))
    default = stage.GetDefaultPrim()  # invalid where the stage names none, or one that is not there
    if default and layer.GetPrimAtPath(default.GetPath()):
        layer.defaultPrim = stage.GetRootLayer().defaultPrim
    elif layer.rootPrims:
        layer.defaultPrim = layer.rootPrims[0].name
