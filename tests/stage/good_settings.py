"""Controls and settings of a patch, every way they can be authored."""

import numpy as np
from pxr import Usd, Vt

import stages
from edits import (
    DENSITY,
    FARTHEST,
    INFINITY,
    NAN,
    PLACE,
    WEIGHT,
    Edit,
    Scene,
    Types,
    all_of,
    blocked,
    blocked_at,
    clips,
    floats,
    indexed,
    inherited,
    inherited_samples,
    over,
    painted,
    put,
    ramp,
    related,
    removed,
    retyped,
    sampled,
    setting,
    still,
    text,
)
from rows import CANNOT_READ, Good
from stages import FRAMES


def spline(scene: Scene) -> None:
    scene.prim.GetAttribute(f"{PLACE}:envelope").SetSpline(stages.linear_spline({1001: 0.0, 1003: 1.0}))


def clip_of_envelope(prim: Usd.Prim) -> None:
    attribute = prim.CreateAttribute(f"{PLACE}:envelope", Types.Float)
    for frame, value in zip(FRAMES, (0.0, 0.25, 0.5), strict=True):
        attribute.Set(value, frame)


def creases(scene: Scene) -> None:
    scene.mesh.GetSubdivisionSchemeAttr().Set("catmullClark")
    scene.mesh.CreateCreaseIndicesAttr([15, 16, 17, 31, 32])
    scene.mesh.CreateCreaseLengthsAttr([3, 2])
    scene.mesh.CreateCreaseSharpnessesAttr([2.5, 10.0])
    scene.mesh.CreateCornerIndicesAttr([24])
    scene.mesh.CreateCornerSharpnessesAttr([3.0])


def scheme(name: str, **tokens: str) -> Edit:
    def edit(scene: Scene) -> None:
        scene.mesh.GetSubdivisionSchemeAttr().Set(name)
        for attribute, token in tokens.items():
            scene.prim.GetAttribute(attribute).Set(token)

    return edit


def triangles() -> stages.Shape:
    shape = stages.grid()
    quads = shape.indices.reshape(-1, 4)
    return stages.from_faces(shape.points, [*quads[:, :3].tolist(), *quads[:, [0, 2, 3]].tolist()])


CONTROLS = [
    Good("envelope: half", setting("envelope", 0.5)),
    Good("envelope: 0", setting("envelope", 0.0), slides=False),
    Good(
        "envelope: above 1 and below 0",
        sampled("envelope", {1001: -1.0, 1003: 3.0}),
        warns="1 weight or envelope outside 0..1, clamped",
    ),
    Good("envelope: blocked", all_of(setting("envelope", 0.0), blocked(f"{PLACE}:envelope"))),
    Good(
        "envelope: blocked at a sample",
        all_of(sampled("envelope", {1001: 0.5, 1003: 0.25}), blocked_at(f"{PLACE}:envelope", 1002)),
    ),
    Good("envelope: double", retyped(f"{PLACE}:envelope", Types.Double, 0.3)),
    Good("envelope: half float", retyped(f"{PLACE}:envelope", Types.Half, 0.3)),
    Good("envelope: double samples", retyped(f"{PLACE}:envelope", Types.Double, None, {1001: 0.3, 1003: 0.7})),
    Good("envelope: int", retyped(f"{PLACE}:envelope", Types.Int, 0), slides=False),
    Good("envelope: bool", retyped(f"{PLACE}:envelope", Types.Bool, False), slides=False),
    Good(
        "envelope: blocked by the file",
        setting("envelope", 0.0),
        file=text(body=over(f"float {PLACE}:envelope = None")),
    ),
    Good("envelope: int samples are held", retyped(f"{PLACE}:envelope", Types.Int, None, {1001: 1, 1002.5: 0})),
    Good("envelope: between samples of points", sampled("envelope", {1001.25: 0.0, 1002.5: 1.0})),
    Good("envelope: beyond samples of points", sampled("envelope", {999: 0.0, 1005: 1.0})),
    Good("envelope: over points without samples", all_of(still, sampled("envelope", {1001: 0.0, 1003: 1.0}))),
    Good(
        "envelope: on an ancestor, which does not count",
        lambda scene: scene.parent.CreateAttribute(f"{PLACE}:envelope", Types.Float).Set(0.0),
    ),
    Good("envelope: a spline", spline, refuses=f"{PLACE}:envelope is a spline, {CANNOT_READ}, or sample it"),
    Good(
        "envelope: by value clips",
        clips(clip_of_envelope, lambda prim: prim.CreateAttribute(f"{PLACE}:envelope", Types.Float)),
        refuses=f"{PLACE}:envelope comes from value clips, {CANNOT_READ}",
    ),
    Good("weight: by vertex", painted(WEIGHT, "vertex", ramp(49, 0, 1))),
    Good(
        "weight: outside 0 to 1",
        painted(WEIGHT, "vertex", ramp(49, -1, 2)),
        warns="12 weights or envelopes outside 0..1, clamped",
    ),
    Good("weight: constant", painted(WEIGHT, "constant", [0.5])),
    Good("weight: a constant that is no array", put(WEIGHT, Types.Float, "constant", 0.5)),
    Good("weight: a relationship counts for nothing", related(f"primvars:{WEIGHT}")),
    Good("weight: indexed", all_of(painted(WEIGHT, "vertex", [0.2, 0.9]), indexed(WEIGHT, [0, 1] * 24 + [0]))),
    Good(
        "weight: indices over time",
        all_of(
            painted(WEIGHT, "vertex", [0.2, 0.9]),
            *(indexed(WEIGHT, [k, 1 - k] * 24 + [k], frame) for k, frame in ((0, 1001.0), (1, 1002.5))),
        ),
    ),
    Good(
        "weight: over time",
        all_of(painted(WEIGHT, "vertex", ramp(49, 0, 1), 1001.5), painted(WEIGHT, "vertex", ramp(49, 1, 0), 1003)),
    ),
    Good(
        "weight: constant over time",
        all_of(put(WEIGHT, Types.Float, "constant", 0.0, 1001), put(WEIGHT, Types.Float, "constant", 1.0, 1003)),
    ),
    Good("weight: inherited", inherited(WEIGHT, 0.25)),
    Good("weight: inherited, 0", inherited(WEIGHT, 0.0), slides=False),
    Good("weight: inherited, an array of one", inherited(WEIGHT, [0.25], type_name=Types.FloatArray)),
    Good("weight: inherited over time", inherited_samples(WEIGHT, {1001: 0.0, 1002.5: 1.0})),
    Good("weight: the mesh's own wins", all_of(inherited(WEIGHT, 0.0), painted(WEIGHT, "constant", [0.5]))),
    Good(
        "weight: blocked on the mesh",
        all_of(inherited(WEIGHT, 0.0), painted(WEIGHT, "constant", [0.5]), blocked(f"primvars:{WEIGHT}")),
        slides=False,
    ),
    Good(
        "weight: by vertex on an ancestor, which does not count",
        inherited(WEIGHT, [0.0] * 49, "vertex", Types.FloatArray),
    ),
    Good(
        "weight: not a number off the patch",
        painted(WEIGHT, "vertex", floats(49, 48, NAN)),
        faces=lambda: np.arange(30),
    ),
    Good("max distance: by vertex", painted(FARTHEST, "vertex", ramp(49, 0, 0.05))),
    Good("max distance: constant", painted(FARTHEST, "constant", [0.01])),
    Good("max distance: infinite", painted(FARTHEST, "vertex", floats(49, 24, INFINITY))),
    Good("max distance: inherited", inherited(FARTHEST, 0.01)),
    Good("max distance: inherited, 0", inherited(FARTHEST, 0.0), slides=False),
    Good(
        "max distance: over time",
        all_of(painted(FARTHEST, "vertex", [0.01] * 49, 1001), painted(FARTHEST, "vertex", [0.1] * 49, 1003)),
    ),
    Good("density: by vertex", painted(DENSITY, "vertex", ramp(49, 1, 5))),
    Good("density: by face", painted(DENSITY, "uniform", ramp(36, 1, 5))),
    Good("density: constant", painted(DENSITY, "constant", [5.0])),
    Good("density: inherited", inherited(DENSITY, 5.0)),
    Good("density: indexed", all_of(painted(DENSITY, "uniform", [1.0, 5.0]), indexed(DENSITY, [0, 1] * 18))),
    Good(
        "density: over time",
        all_of(painted(DENSITY, "vertex", ramp(49, 1, 5), 1001), painted(DENSITY, "vertex", ramp(49, 5, 1), 1002.5)),
    ),
    Good("density: 0 off the patch", painted(DENSITY, "vertex", floats(49, 48, 0.0)), faces=lambda: np.arange(30)),
    Good("edges", all_of(setting("edges", [16, 17, 24, 17]), setting("edgeForceDensities", [4.0, 0.5]))),
    Good(
        "edges: with paint",
        all_of(
            setting("edges", [16, 17]), setting("edgeForceDensities", [4.0]), painted(DENSITY, "vertex", ramp(49, 1, 5))
        ),
    ),
    Good(
        "edges: factors over time",
        all_of(
            setting("edges", [16, 17, 24, 17]), sampled("edgeForceDensities", {1001: [1.0, 1.0], 1002.5: [9.0, 0.1]})
        ),
    ),
    Good(
        "edges: factors as double",
        all_of(
            setting("edges", [16, 17]), retyped(f"{PLACE}:edgeForceDensities", Types.DoubleArray, Vt.DoubleArray([4.1]))
        ),
    ),
    Good(
        "edges: pairs that stay the same",
        all_of(sampled("edges", {1001: [16, 17], 1003: [16, 17]}), setting("edgeForceDensities", [4.0])),
    ),
]


SETTINGS = [
    Good("corners", setting("corners", [0, 6, 48, 42])),
    Good("corners: none", setting("corners", [])),
    Good("corners: as int64", retyped(f"{PLACE}:corners", Types.Int64Array, Vt.Int64Array([0, 6, 48, 42]))),
    Good("corners: as unsigned", retyped(f"{PLACE}:corners", Types.UIntArray, Vt.UIntArray([0, 6, 48, 42]))),
    Good("boundary: square", setting("boundary", "square")),
    Good("boundary: circle with corners", all_of(setting("boundary", "circle"), setting("corners", [0, 6, 48, 42]))),
    Good("boundary: a string", retyped(f"{PLACE}:boundary", Types.String, "square")),
    Good(
        "boundary: the first of samples",
        all_of(setting("boundary", "square", 1001), setting("boundary", "circle", 1003)),
    ),
    Good("holes: free", setting("holes", "free"), faces=stages.annulus),
    Good("rule: fast", setting("forceDensityRule", "fast")),
    Good("rule: relaxed", setting("forceDensityRule", "relaxed")),
    Good("rule: blocked", all_of(setting("forceDensityRule", "relaxed"), blocked(f"{PLACE}:forceDensityRule"))),
    Good("interpolation: linear", all_of(scheme("catmullClark"), setting("interpolation", "linear"))),
    Good("interpolation: meanValue", setting("interpolation", "meanValue")),
    Good("interpolation: limit", all_of(scheme("catmullClark"), setting("interpolation", "limit"))),
    Good("subdivision: catmullClark", scheme("catmullClark")),
    Good("subdivision: bilinear", scheme("bilinear")),
    Good("subdivision: loop", scheme("loop"), shape=triangles),
    Good("subdivision: the scheme's fallback", removed("subdivisionScheme")),
    Good("subdivision: the scheme is blocked", blocked("subdivisionScheme")),
    Good("subdivision: creases and corners", creases),
    Good(
        "subdivision: rules",
        scheme("catmullClark", interpolateBoundary="edgeOnly", triangleSubdivisionRule="smooth"),
        shape=triangles,
    ),
    Good(
        "subdivision: holes off the patch",
        all_of(scheme("catmullClark"), lambda scene: scene.mesh.CreateHoleIndicesAttr([34, 35])),
        faces=lambda: np.arange(30),
    ),
    Good(
        "subdivision: a bad one that nothing needs",
        all_of(retyped("subdivisionScheme", Types.Token, "butterfly"), setting("interpolation", "linear")),
    ),
]
