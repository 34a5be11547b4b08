"""What a cache has beside its points: normals, velocities, accelerations."""

import numpy as np
from pxr import Gf, Vt

from edits import (
    DENSITY,
    FARTHEST,
    WEIGHT,
    Scene,
    Types,
    all_of,
    blocked_at,
    half_way,
    indexed,
    normals,
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


def everything_that_varies(scene: Scene) -> None:
    """Everything that a bake writes, and controls that vary beside the points."""
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
    Good("normals: without samples", normals("vertex", 49, [None])),
    Good("normals: samples of their own", normals("vertex", 49, [1001, 1001.5])),
    Good("normals: over points without samples", all_of(still, normals("vertex", 49))),
    Good("normals: a primvar", put("normals", Types.Normal3fArray, "vertex", [(0, 0, 1)] * 49)),
    Good(
        "normals: an indexed primvar",
        all_of(
            put("normals", Types.Normal3fArray, "faceVarying", [(0, 0, 1), (0, 1, 0)]), indexed("normals", [0, 1] * 72)
        ),
        blocked=("primvars:normals:indices",),
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
    ),
    Good("normals: double", all_of(retyped("normals", Types.Normal3dArray, Vt.Vec3dArray([(0, 0, 1)] * 49)))),
    Good("normals: half", all_of(retyped("normals", Types.Normal3hArray, Vt.Vec3hArray([Gf.Vec3h(0, 0, 1)] * 49)))),
    Good(
        "normals: an indexed primvar over time",
        all_of(
            put("normals", Types.Normal3fArray, "faceVarying", [(0, 0, 1), (0, 1, 0)]),
            indexed("normals", [0, 1] * 72, 1001),
            indexed("normals", [1, 0] * 72, 1002.5),
        ),
        blocked=("primvars:normals:indices",),
    ),
    Good("normals: a primvar of doubles", put("normals", Types.Normal3dArray, "vertex", [(0, 0, 1)] * 49)),
    Good("normals: a primvar of another kind", put("normals", Types.Float3Array, "vertex", [(0, 0, 1)] * 49)),
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
        all_of(lambda scene: scene.points.ClearAtTime(1002), vectors("accelerations", 49, FRAMES[::2])),
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
    Good("everything that varies", everything_that_varies, blocked=("primvars:normals:indices",)),
    Good("everything that varies, relaxed", relaxed, blocked=("primvars:normals:indices",)),
]
