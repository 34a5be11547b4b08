"""What a cache has beside its points: normals, velocities, accelerations."""

import numpy as np
from pxr import Gf, Vt

from edits import (
    CARRIED,
    DENSITY,
    FARTHEST,
    LEFT,
    NAN,
    RATES,
    WEIGHT,
    Scene,
    Types,
    all_of,
    blocked_at,
    directions,
    half_way,
    indexed,
    normals,
    of_size,
    one_of,
    painted,
    put,
    ramp,
    retyped,
    sampled,
    setting,
    still,
    vectors,
)
from rows import Good
from stages import FRAMES

ROLES = (
    Types.Normal3fArray,
    Types.Normal3hArray,
    Types.Normal3dArray,
    Types.Vector3fArray,
    Types.Vector3hArray,
    Types.Vector3dArray,
)


def everything_that_varies(scene: Scene) -> None:
    """Everything that a bake writes varies, and controls do, beside the points."""
    put("normals", Types.Normal3fArray, "faceVarying", [(0, 0, 1)])(scene)
    indexed("normals", [0] * 144)(scene)
    vectors("velocities", 49, FRAMES, (1, 1, 1))(scene)
    vectors("accelerations", 49, FRAMES, (0, 0, 0))(scene)
    sampled("envelope", {1001: 0.25, 1002.5: 1.0})(scene)
    painted(WEIGHT, "vertex", ramp(49, 0, 1))(scene)
    for frame, scale in ((1001, 1), (1003, 2)):
        painted(DENSITY, "uniform", (np.linspace(1, 3, 36) ** scale).tolist(), frame)(scene)


def relaxed(scene: Scene) -> None:
    everything_that_varies(scene)
    setting("forceDensityRule", "relaxed")(scene)
    for frame, limit in ((1001, 0.05), (1003, 0.2)):
        painted(FARTHEST, "vertex", [limit] * 49, frame)(scene)


DERIVED = [
    *(
        Good(f"normals: {interpolation}", normals(interpolation, count))
        for interpolation, count in (("vertex", 49), ("varying", 49), ("uniform", 36), ("faceVarying", 144))
    ),
    Good("normals: constant, which are left", normals("constant", 1)),
    Good("normals: interpolation of the fallback", normals(None, 49)),
    Good("normals: without samples", normals("vertex", 49, [None]), warns="normals has one value for all frames"),
    Good("normals: samples of their own", normals("vertex", 49, [1001, 1001.5])),
    Good("normals: over points without samples", all_of(still, normals("vertex", 49))),
    Good(
        "normals: a primvar",
        put("normals", Types.Normal3fArray, "vertex", [(0, 0, 1)] * 49),
        warns="has one value for all frames",
    ),
    Good(
        "normals: an indexed primvar",
        all_of(
            put("normals", Types.Normal3fArray, "faceVarying", [(0, 0, 1), (0, 1, 0)]), indexed("normals", [0, 1] * 72)
        ),
        blocked=("primvars:normals:indices",),
        warns="has one value for all frames",
    ),
    Good("normals: a constant primvar, which is left", put("normals", Types.Normal3fArray, "constant", [(0, 0, 1)])),
    Good(
        "normals: a primvar without interpolation, which is left",
        all_of(
            put("normals", Types.Normal3fArray, "constant", [(0, 0, 1)] * 49),
            lambda scene: scene.prim.GetAttribute("primvars:normals").ClearMetadata("interpolation"),
        ),
    ),
    Good(
        "normals: of a wrong length at a frame",
        all_of(normals("vertex", 49, [1001, 1003]), normals("vertex", 3, [1002])),
        blocked=("normals",),
        warns="normals",
    ),
    Good(
        "normals: the primvar wins",
        all_of(normals("uniform", 36), put("normals", Types.Normal3fArray, "vertex", [(0, 0, 1)] * 49)),
        warns="has one value for all frames",
    ),
    Good(
        "normals: double",
        all_of(retyped("normals", Types.Normal3dArray, Vt.Vec3dArray([(0, 0, 1)] * 49))),
        warns="has one value for all frames",
    ),
    Good(
        "normals: half",
        all_of(retyped("normals", Types.Normal3hArray, Vt.Vec3hArray([Gf.Vec3h(0, 0, 1)] * 49))),
        warns="has one value for all frames",
    ),
    Good(
        "normals: an indexed primvar over time",
        all_of(
            put("normals", Types.Normal3fArray, "faceVarying", [(0, 0, 1), (0, 1, 0)]),
            indexed("normals", [0, 1] * 72, 1001),
            indexed("normals", [1, 0] * 72, 1002.5),
        ),
        blocked=("primvars:normals:indices",),
    ),
    Good(
        "normals: a primvar of doubles",
        put("normals", Types.Normal3dArray, "vertex", [(0, 0, 1)] * 49),
        warns="has one value for all frames",
    ),
    Good(
        "normals: a primvar of another kind",
        put("normals", Types.Float3Array, "vertex", [(0, 0, 1)] * 49),
        warns="has one value for all frames",
    ),
    Good(
        "normals: indexed badly",
        all_of(put("normals", Types.Normal3fArray, "faceVarying", [(0, 0, 1)]), indexed("normals", [0, 9] * 72)),
        blocked=("primvars:normals", "primvars:normals:indices"),
        warns="normals",
    ),
    Good(
        "normals: blocked at a frame",
        all_of(normals("vertex", 49), blocked_at("normals", 1002)),
        blocked=("normals",),
        warns="normals",
    ),
    Good("normals: of a wrong length", normals("vertex", 3), blocked=("normals",), warns="normals"),
    Good(
        "normals: a primvar of a wrong length",
        all_of(normals("vertex", 49), put("normals", Types.Normal3fArray, "vertex", [(0, 0, 1)] * 3)),
        blocked=("normals", "primvars:normals"),
        warns="normals",
    ),
    Good(
        "normals: of no interpolation",
        all_of(
            normals(None, 49), lambda scene: scene.prim.GetAttribute("normals").SetMetadata("interpolation", "bumpy")
        ),
        blocked=("normals",),
        warns="normals",
    ),
    *(Good(f"carried: {name}", directions(name, Types.Float3Array)) for name in CARRIED[1:-1]),
    *(
        Good(f"carried: {interpolation}", directions("tangents", interpolation=interpolation, count=count))
        for interpolation, count in (("varying", 49), ("uniform", 36), ("faceVarying", 144))
    ),
    *(Good(f"carried: by its role, {type_name}", directions("flow", type_name)) for type_name in ROLES),
    Good("carried: several", all_of(*(directions(name) for name in CARRIED))),
    Good(
        "carried: indexed over time",
        all_of(
            directions("tangents", interpolation="faceVarying", count=2, times=[None]),
            indexed("tangents", [0, 1] * 72, 1001),
            indexed("tangents", [1, 0] * 72, 1002.5),
        ),
        blocked=("primvars:tangents:indices",),
    ),
    Good("carried: over points without samples", all_of(still, directions("tangents"))),
    Good(
        "carried: of one pose",
        directions("tangents", times=[None]),
        warns="primvars:tangents has one value for all frames",
    ),
    Good(
        "carried: of a wrong length",
        directions("tangents", count=3),
        blocked=("primvars:tangents",),
        warns="primvars:tangents has 3 values, but the mesh has 49 points",
    ),
    Good(
        "carried: of a wrong length at a frame",
        all_of(directions("tangents", times=[1001, 1003]), directions("tangents", count=3, times=[1002])),
        blocked=("primvars:tangents",),
        warns="primvars:tangents",
    ),
    Good(
        "carried: blocked at a frame",
        all_of(directions("flow"), blocked_at("primvars:flow", 1002)),
        blocked=("primvars:flow",),
        warns="primvars:flow",
    ),
    Good(
        "carried: indexed badly",
        all_of(
            directions("tangents", interpolation="faceVarying", count=1, times=[None]), indexed("tangents", [0, 9] * 72)
        ),
        blocked=("primvars:tangents", "primvars:tangents:indices"),
        warns="primvars:tangents",
    ),
    Good(
        "carried: not finite at a frame",
        all_of(directions("tangents"), one_of("primvars:tangents", 17, (NAN, 0, 0), FRAMES[1])),
        warns="primvars:tangents has 1 value that is not finite, which passes as it is: number 17 is (nan, 0, 0)",
    ),
    Good(
        "carried: too long at a frame",
        all_of(directions("tangents"), one_of("primvars:tangents", 17, (3e38, 0, 0), FRAMES[1])),
        blocked=("primvars:tangents",),
        warns="vector 17 is too long to be carried: (3e+38, 0, 0)",
    ),
    Good("left: a constant vector", directions("flow", interpolation="constant", count=1)),
    Good("left: floats without a role", directions("width", Types.Float3Array)),
    *(Good(f"left: {name}, of rest", directions(name, times=[None])) for name in LEFT[:3]),
    Good(
        "left: tangents with a sign",
        directions("tangents", Types.Float4Array),
        warns="primvars:tangents is float4[] and stays as it is while the skin slides: make it normal3f[]",
    ),
    Good(
        "left: normals by their name alone",
        directions("bentNormals", Types.Float3Array),
        warns="primvars:bentNormals is float3[] and stays as it is",
    ),
    Good(
        "left: two vectors an element",
        all_of(directions("tangents", count=98), of_size("tangents", 2)),
        warns="primvars:tangents has elementSize 2 and stays as it is",
    ),
    Good(
        "left: rates of faces' corners",
        directions("v", interpolation="faceVarying", count=144),
        warns="primvars:v has interpolation faceVarying and stays as it is",
    ),
    Good("left: another v", put("v", Types.FloatArray, "vertex", [0.5] * 49)),
    *(Good(f"rates: primvars:{name}", directions(name)) for name in RATES),
    Good(
        "rates: a primvar at other times",
        directions("v", times=FRAMES[:1]),
        blocked=("primvars:v",),
        warns="primvars:v cannot be recomputed",
    ),
    Good(
        "rates: a primvar and the attribute",
        all_of(vectors("velocities", 49, FRAMES), directions("velocities", Types.Float3Array)),
    ),
    Good("velocities", vectors("velocities", 49, FRAMES)),
    Good(
        "velocities: and accelerations", all_of(vectors("velocities", 49, FRAMES), vectors("accelerations", 49, FRAMES))
    ),
    Good(
        "velocities: on sub-frames",
        all_of(half_way, vectors("velocities", 49, sorted([*FRAMES, 1001.25, 1001.5, 1002.75]))),
    ),
    Good(
        "velocities: double",
        retyped("velocities", Types.Vector3dArray, None, {frame: Vt.Vec3dArray([(0, 0, 1)] * 49) for frame in FRAMES}),
    ),
    Good(
        "velocities: a control between samples",
        all_of(vectors("velocities", 49, FRAMES), sampled("envelope", {1001.5: 0.5, 1002.5: 1.0})),
    ),
    Good(
        "velocities: at other times",
        vectors("velocities", 49, FRAMES[:1]),
        blocked=("velocities",),
        warns="velocities cannot be recomputed",
    ),
    Good(
        "velocities: without samples",
        vectors("velocities", 49, [None]),
        blocked=("velocities",),
        warns="velocities cannot be recomputed",
    ),
    Good(
        "velocities: blocked at a frame",
        all_of(vectors("velocities", 49, FRAMES), blocked_at("velocities", 1002)),
        blocked=("velocities",),
        warns="velocities",
    ),
    Good(
        "velocities: of a still cache",
        all_of(still, vectors("velocities", 49, [None])),
        blocked=("velocities",),
        warns="velocities cannot be recomputed",
    ),
    Good(
        "velocities: of a wrong length", vectors("velocities", 3, FRAMES), blocked=("velocities",), warns="velocities"
    ),
    Good(
        "accelerations: of two samples",
        all_of(lambda scene: scene.points.ClearAtTime(1003), vectors("accelerations", 49, FRAMES[:2])),
        blocked=("accelerations",),
        warns="accelerations cannot be recomputed",
    ),
    Good(
        "velocities: no time codes per second",
        all_of(vectors("velocities", 49, FRAMES), lambda scene: scene.stage.SetTimeCodesPerSecond(0)),
        file=None,
        blocked=("velocities",),
        warns="velocities cannot be recomputed",
    ),
    Good(
        "everything that varies",
        everything_that_varies,
        blocked=("primvars:normals:indices",),
        warns="has one value for all frames",
    ),
    Good(
        "everything that varies, relaxed",
        relaxed,
        blocked=("primvars:normals:indices",),
        warns="has one value for all frames",
    ),
]
