"""A layer that sits on a stage and carries set-ups: made, or taken up again, and put in place in one step."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, Usd, UsdGeom

from skinslide.problems import Fault, Problem, StageError, StageProblems, UsageError, errors
from skinslide.shot.check import CheckReport, check
from skinslide.stage import schema
from skinslide.stage.mesh import read_points
from skinslide.stage.opening import EXTENSION, anchor_assets, open_stage, read_text_layer
from skinslide.stage.topology import Topology, read_topology
from skinslide.stage.values import FIRST
from skinslide.write.place import check_not_input, check_not_read, check_output, replacing, writing

EXTENSIONS = (EXTENSION, ".usda", ".usdc", ".usd")
# Fields of a root layer that say what is in that layer, not how the stage is to be read.
OWN_FIELDS = {"subLayers", "subLayerOffsets", "primChildren", "comment", "documentation", "customLayerData"}


@dataclass(frozen=True)
class SetupLayer:
    """A layer to be written to `output`, and one mesh of the stage that it sits on."""

    layer: Sdf.Layer
    output: Path
    prim: str

    @classmethod
    def start(cls, stage: str | os.PathLike, output: str | os.PathLike, prim: str, force: bool) -> SetupLayer:
        """The layer at `output`, where it sits on the stage, else a new one. Raises UsageError, StageError."""
        stage, output = Path(stage), Path(output)
        _check_arguments(stage, output, prim)
        return cls(_starting_layer(stage, output, force), output, prim)

    def composed(self) -> Usd.Stage:
        """The stage that the layer will be once it is written."""
        copy = Sdf.Layer.CreateAnonymous(".usda")
        copy.TransferContent(self.layer)
        anchor_assets(copy, self.output)
        return Usd.Stage.Open(copy)

    def problems(self, patch: str, message: str) -> StageProblems:
        return StageProblems([Problem("error", self.prim, patch, None, message)])

    def read_mesh(self, stage: Usd.Stage, patch: str) -> tuple[Usd.Prim, Topology]:
        prim = stage.GetPrimAtPath(self.prim)
        try:
            if not prim:
                raise Fault("there is no such prim")
            if not prim.IsA(UsdGeom.Mesh):
                raise Fault(f"is a {prim.GetTypeName() or 'prim without a type'}, not a Mesh")
            return prim, read_topology(UsdGeom.Mesh(prim), len(read_points(prim, FIRST)))
        except Fault as fault:
            raise self.problems(patch, str(fault)) from fault

    def apply(self, patch: str) -> None:
        """Applies the schema of a patch to the mesh."""
        spec = Sdf.CreatePrimInLayer(self.layer, self.prim)
        applied = spec.GetInfo("apiSchemas") or Sdf.TokenListOp()
        name = f"{schema.SCHEMA}:{patch}"
        if applied.isExplicit:
            applied.explicitItems = [*(item for item in applied.explicitItems if item != name), name]
        else:
            applied.prependedItems = [*(item for item in applied.prependedItems if item != name), name]
            applied.deletedItems = [item for item in applied.deletedItems if item != name]
        spec.SetInfo("apiSchemas", applied)

    def attribute(
        self, name: str, type_name: Sdf.ValueTypeName, variability: Sdf.Variability = Sdf.VariabilityVarying
    ) -> Sdf.AttributeSpec:
        """An attribute of the mesh, without what the layer said of it before."""
        spec = Sdf.CreatePrimInLayer(self.layer, self.prim)
        if name in spec.properties:
            del spec.properties[name]
        return Sdf.AttributeSpec(spec, name, type_name, variability)

    def primvar(self, name: str, type_name: Sdf.ValueTypeName, interpolation: str, value: Any) -> None:
        """Writes `primvars:name`."""
        attr = self.attribute(f"primvars:{name}", type_name)
        attr.default = value
        attr.SetInfo("interpolation", interpolation)

    def finish(self, patch: str) -> CheckReport:
        """Writes the layer; StageProblems, and nothing written, where the patch could not be slid."""
        stage = self.composed()
        report = check(stage, [self.prim])
        bad = [problem for problem in errors(report.problems) if problem.patch in (patch, None)]
        if bad:
            raise StageProblems(bad)
        check_not_read(self.output, stage)
        _write(self.layer, self.output)
        return replace(report, stage=str(self.output))


def check_patch_name(patch: str) -> None:
    if not Sdf.Path.IsValidNamespacedIdentifier(patch) or patch.split(":")[0] in schema.NOT_PATCHES:
        raise UsageError(f"{patch!r} cannot name a patch; use letters, digits and _, such as elbow_L")


def _check_arguments(stage: Path, output: Path, prim: str) -> None:
    if stage.suffix == EXTENSION:
        raise UsageError(f"{stage} is a set-up itself; give the stage that it sits on, and it as output to add to it")
    check_output(output, EXTENSIONS)
    if not (Sdf.Path.IsValidPathString(prim) and Sdf.Path(prim).IsAbsolutePath() and Sdf.Path(prim).IsPrimPath()):
        raise UsageError(f"{prim!r} is not the path of a prim, such as /World/char/geo/body_GEO")


def _starting_layer(stage_path: Path, output: Path, force: bool) -> Sdf.Layer:
    """The layer at `output`, where it sits on the stage, else a new one; anonymous, with asset paths as in the file."""
    stage = open_stage(stage_path)
    check_not_input(output, stage, stage_path)
    if output.exists() and not force:
        layer = _existing_layer(output)
        sublayers = [Path(output.absolute().parent, path) for path in layer.subLayerPaths]
        if not any(path.exists() and path.samefile(stage_path) for path in sublayers):
            raise UsageError(f"output {output}: exists and does not sublayer {stage_path}; --force replaces it")
        return layer
    return _new_layer(stage, stage_path, output)


def _existing_layer(output: Path) -> Sdf.Layer:
    try:
        layer = read_text_layer(output) if output.suffix == EXTENSION else Sdf.Layer.OpenAsAnonymous(str(output))
    except (Tf.ErrorException, OSError, UnicodeDecodeError, StageError) as error:
        raise UsageError(f"output {output}: exists and is not a layer; --force replaces it") from error
    return layer


def _new_layer(stage: Usd.Stage, stage_path: Path, output: Path) -> Sdf.Layer:
    """A layer that sublayers the stage and is read with the same units, time and default prim."""
    layer, root = Sdf.Layer.CreateAnonymous(".usda"), stage.GetRootLayer().pseudoRoot
    for field in set(root.ListInfoKeys()) - OWN_FIELDS:
        layer.pseudoRoot.SetInfo(field, root.GetInfo(field))
    # Without these a layer counts as 24, whatever it sublayers, and its sublayers' times are scaled to that.
    layer.timeCodesPerSecond, layer.framesPerSecond = stage.GetTimeCodesPerSecond(), stage.GetFramesPerSecond()
    layer.subLayerPaths.append(_asset_path(stage_path, output))
    return layer


def _asset_path(stage_path: Path, output: Path) -> str:
    relative = os.path.relpath(stage_path.resolve(), output.resolve().parent)
    return relative if relative.startswith("..") else f"./{relative}"


def _write(layer: Sdf.Layer, output: Path) -> None:
    """Puts the layer in place in one step."""
    with replacing(output) as partial, writing(output):
        if partial.suffix == EXTENSION:
            partial.write_text(layer.ExportToString(), encoding="utf-8")
        elif not layer.Export(str(partial)):
            raise OSError("USD could not save it")
