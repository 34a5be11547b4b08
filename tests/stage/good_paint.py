"""Paint as tools leave it: names, types, channels, face corners."""

from pxr import Sdf, UsdGeom, Vt

import stages
from edits import DENSITY, FACES, FARTHEST, HOLD, WEIGHT, Edit, Scene, Types, all_of, even, put, ramp, retyped, setting
from rows import Good

CORNERS = 144  # of the 6 x 6 quads


def underscored(name: str) -> str:
    return name.replace(":", "_")


def colours(name: str, type_name: Sdf.ValueTypeName, interpolation: str, numbers: list[float], channel: int) -> Edit:
    """Numbers as one channel of vectors, whose others are noise that counts for nothing."""
    vector = type_name.scalarType.type.pythonClass

    def element(number: float) -> object:
        return vector(*(number if k == channel else -7.5 for k in range(vector.dimension)))

    values = type_name.type.pythonClass([element(number) for number in numbers])
    return all_of(put(name, type_name, interpolation, values), setting("paintChannel", "rgba"[channel]))


def inherited_as(name: str) -> Edit:
    """A constant on an ancestor."""

    def edit(scene: Scene) -> None:
        UsdGeom.PrimvarsAPI(scene.parent).CreatePrimvar(name, Types.Double, "constant").Set(0.25)

    return edit


def chosen_by(name: str, type_name: Sdf.ValueTypeName, interpolation: str, numbers: list[float]) -> Edit:
    """The faces, in place of the primvar that has them."""

    def edit(scene: Scene) -> None:
        scene.prim.RemoveProperty(f"primvars:{FACES}")
        stages.set_primvar(scene.mesh, name, type_name, interpolation, type_name.type.pythonClass(numbers))

    return edit


FOLDED = retyped("skinSlide:foldCase", Types.Bool, True)
INNER = [0.0] * 6 + [1.0] * 30

PAINT = [
    Good("paint: underscores", put(underscored(WEIGHT), Types.FloatArray, "vertex", ramp(49, 0, 1))),
    Good("paint: underscores, varying", put(underscored(WEIGHT), Types.FloatArray, "varying", ramp(49, 0, 1))),
    Good("paint: underscores choose faces", chosen_by(underscored(FACES), Types.FloatArray, "uniform", INNER)),
    Good(
        "paint: underscores of a patch with colons",
        all_of(
            lambda scene: scene.prim.SetMetadata("apiSchemas", Sdf.TokenListOp.CreateExplicit(["SkinSlideAPI:a:b"])),
            chosen_by("skinSlide_a_b_patch", Types.FloatArray, "uniform", INNER),
            put("skinSlide_a_b_weight", Types.FloatArray, "vertex", ramp(49, 0, 1)),
        ),
    ),
    Good("paint: underscores, inherited", inherited_as(underscored(WEIGHT))),
    Good(
        "paint: the schema's name counts before one with underscores",
        all_of(
            put(underscored(WEIGHT), Types.FloatArray, "vertex", [0.0] * 49),
            put(WEIGHT, Types.FloatArray, "vertex", ramp(49, 0, 1)),
        ),
    ),
    Good(
        "paint: underscores on the mesh count before the schema's name above it",
        all_of(inherited_as(WEIGHT), put(underscored(WEIGHT), Types.FloatArray, "vertex", ramp(49, 0, 1))),
    ),
    Good(
        "paint: a blocked name counts, and says that there is none",
        all_of(
            put(WEIGHT, Types.FloatArray, "vertex", ramp(49, 0, 1)),
            lambda scene: scene.prim.GetAttribute(f"primvars:{WEIGHT}").Block(),
            put(underscored(WEIGHT), Types.FloatArray, "vertex", [0.0] * 49),
        ),
    ),
    Good(
        "paint: case folded",
        all_of(FOLDED, put(underscored(WEIGHT).lower(), Types.FloatArray, "vertex", ramp(49, 0, 1))),
    ),
    Good(
        "paint: case folded, with colons",
        all_of(FOLDED, put(WEIGHT.upper(), Types.FloatArray, "constant", [0.0])),
        slides=False,
    ),
    Good("paint: another case counts for nothing", put(WEIGHT.upper(), Types.FloatArray, "constant", [0.0])),
    Good("paint: weight, double", put(WEIGHT, Types.DoubleArray, "vertex", Vt.DoubleArray(ramp(49, 0, 1)))),
    Good("paint: density, half", put(DENSITY, Types.HalfArray, "vertex", Vt.HalfArray(ramp(49, 1, 5)))),
    Good("paint: density, double by face", put(DENSITY, Types.DoubleArray, "uniform", Vt.DoubleArray(ramp(36, 1, 5)))),
    Good("paint: max distance, half", put(FARTHEST, Types.HalfArray, "vertex", Vt.HalfArray(ramp(49, 0, 0.05)))),
    Good("paint: hold, double", all_of(even, put(HOLD, Types.DoubleArray, "vertex", Vt.DoubleArray(ramp(49, 1, 5))))),
    Good("paint: faces, double", chosen_by(FACES, Types.DoubleArray, "uniform", INNER)),
    Good("paint: weight, red", colours(WEIGHT, Types.Color3fArray, "vertex", ramp(49, 0, 1), 0)),
    Good("paint: weight, blue of four", colours(WEIGHT, Types.Color4fArray, "vertex", ramp(49, 0, 1), 2)),
    Good("paint: weight, alpha by corner", colours(WEIGHT, Types.Color4fArray, "faceVarying", ramp(CORNERS, 0, 1), 3)),
    Good("paint: weight, a pair", colours(WEIGHT, Types.Float2Array, "vertex", ramp(49, 0, 1), 1)),
    Good("paint: weight, a pair of halves", colours(WEIGHT, Types.Half2Array, "vertex", ramp(49, 0, 1), 1)),
    Good("paint: density, green by face", colours(DENSITY, Types.Color3dArray, "uniform", ramp(36, 1, 5), 1)),
    Good("paint: faces, red", colours(FACES, Types.Color3fArray, "uniform", INNER, 0)),
    Good("paint: weight by corner", put(WEIGHT, Types.FloatArray, "faceVarying", ramp(CORNERS, 0, 1))),
    Good("paint: density by corner", put(DENSITY, Types.FloatArray, "faceVarying", ramp(CORNERS, 1, 5))),
    Good("paint: faces by corner, bool", chosen_by(FACES, Types.BoolArray, "faceVarying", [False] * 24 + [True] * 120)),
    Good("paint: faces by corner", chosen_by(FACES, Types.FloatArray, "faceVarying", [0.0] * 24 + [1.0] * 120)),
    Good(
        "paint: weight by corner, indexed, over time",
        all_of(
            put(WEIGHT, Types.FloatArray, "faceVarying", [0.25, 0.75], 1001),
            put(WEIGHT, Types.FloatArray, "faceVarying", [1.0, 0.5], 1003),
            lambda scene: (
                UsdGeom.PrimvarsAPI(scene.prim).GetPrimvar(WEIGHT).SetIndices(Vt.IntArray([0, 1] * (CORNERS // 2)))
            ),
        ),
    ),
]
