"""Meshes that cannot be slid, and patches without good faces."""

from collections.abc import Callable

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

import stages
from edits import (
    FACES,
    INFINITY,
    NAN,
    PLACE,
    Edit,
    Scene,
    Types,
    all_of,
    blocked,
    blocked_at,
    floats,
    indexed,
    inherited,
    nothing,
    on_subset,
    painted,
    point,
    put,
    removed,
    rest_changed,
    retyped,
    shuffled,
    subset,
    topology,
)
from good_meshes import above, in_world, squashed
from rows import Bad
from stages import FRAMES, MESH, PATCH


def no_faces_anywhere(scene: Scene) -> None:
    scene.prim.RemoveProperty(f"primvars:{FACES}")


def child_that_is_no_subset(scene: Scene) -> None:
    no_faces_anywhere(scene)
    UsdGeom.Xform.Define(scene.stage, f"{MESH}/{PATCH}")


def as_over(prim: Usd.Prim) -> None:
    prim.SetSpecifier(Sdf.SpecifierOver)
    prim.GetStage().GetRootLayer().GetPrimAtPath(prim.GetPath()).ClearInfo("typeName")


def faces_that_change(scene: Scene) -> None:
    for frame, last in ((FRAMES[0], True), (FRAMES[2], False)):
        put(FACES, Types.BoolArray, "uniform", [True] * 35 + [last], frame)(scene)


def ages_apart(scene: Scene) -> None:
    scene.points.Set(scene.points.Get(FRAMES[-1]), 2e7)


def fewer_points(scene: Scene) -> None:
    scene.points.Set(stages.vectors(np.zeros((48, 3))), FRAMES[1])


def rest_points(count: int) -> Edit:
    def edit(scene: Scene) -> None:
        attribute = scene.prim.CreateAttribute("skinSlide:restPoints", Types.Point3fArray, False)
        attribute.Set(stages.vectors(np.zeros((count, 3))))

    return edit


def topology_that_changes(scene: Scene) -> None:
    attribute = scene.mesh.GetFaceVertexIndicesAttr()
    indices = list(attribute.Get())
    attribute.Set(indices, FRAMES[0])
    attribute.Set([*indices[4:], *indices[:4]], FRAMES[1])


def topology_unlike_its_default(scene: Scene) -> None:
    indices = list(scene.mesh.GetFaceVertexIndicesAttr().Get())
    scene.mesh.GetFaceVertexIndicesAttr().Set([*indices[4:], *indices[:4]], FRAMES[1])


def rest_that_changes(frame: float | None) -> Edit:
    """From there on; None: from the default to a sample."""
    rest = stages.grid().points
    values = {frame: rest, FRAMES[1]: 2 * rest}
    return all_of(*(put("Pref", Types.Point3fArray, "vertex", stages.vectors(values[at]), at) for at in values))


def indices_end_with(*last: int) -> Edit:
    return topology(indices=lambda indices: [*indices[: -len(last)], *last])


def counts_end_with(count: int) -> Edit:
    return topology(counts=lambda counts: [*counts[:-1], count])


def without_type(scene: Scene) -> None:
    scene.stage.GetRootLayer().GetPrimAtPath(MESH).ClearInfo("typeName")


def in_point_instancer(scene: Scene) -> None:
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/World/crowd")
    instancer.CreatePrototypesRel().SetTargets([scene.prim.GetParent().GetPath()])


def baked_already(scene: Scene) -> None:
    scene.points.SetCustomDataByKey("skinslide", "baked")


def missing_payload(scene: Scene) -> None:
    scene.prim.GetPayloads().AddPayload("./gone.usdc")


def triangle_and(*face: int) -> Callable[[], stages.Shape]:
    return lambda: stages.from_faces([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), face])


NEITHER = f"has no faces: there is neither primvars:{FACES} nor a GeomSubset {PATCH} under the mesh"
UNDEFINED = "is not defined, there are only overs; is the path right, and does the cache below it open?"

FINDING = [
    Bad(
        "prim: not a mesh",
        lambda scene: scene.prim.SetTypeName("Points"),
        "is a Points; SkinSlideAPI applies to Mesh only",
        None,
    ),
    Bad("prim: without a type", without_type, "is a prim without a type; SkinSlideAPI applies to Mesh only", None),
    Bad("prim: an over", lambda scene: scene.prim.SetSpecifier(Sdf.SpecifierOver), UNDEFINED, None),
    Bad("prim: below an over", lambda scene: scene.prim.GetParent().SetSpecifier(Sdf.SpecifierOver), UNDEFINED, None),
    Bad(
        "prim: in an instance",
        nothing,
        "is inside an instance, whose points are shared; author instanceable = false on /World",
        None,
        file='#usda 1.0\n(defaultPrim = "World")\ndef "World" (references = @./cache.usda@; instanceable = true) {}\n',
    ),
    Bad(
        "prim: point instancer",
        in_point_instancer,
        "is a prototype of the point instancer /World/crowd, whose instances share its points; "
        "slide a mesh outside it, or put the baked mesh in its place",
        None,
    ),
    Bad(
        "prim: no patch name",
        lambda scene: scene.prim.AddAppliedSchema("SkinSlideAPI"),
        "SkinSlideAPI is applied without a patch's name; apply SkinSlideAPI:NAME",
        None,
    ),
    Bad(
        "prim: empty patch name",
        lambda scene: scene.prim.AddAppliedSchema("SkinSlideAPI:"),
        "SkinSlideAPI is applied without a patch's name; apply SkinSlideAPI:NAME",
        None,
    ),
    Bad(
        "payload: missing",
        missing_payload,
        "USD could not compose this: Could not open asset @{folder}/gone.usdc@ for payload introduced by "
        f"@{{folder}}/cache.usda@<{MESH}>.",
        None,
        may_slide=True,
    ),
    Bad(
        "nothing to slide",
        lambda scene: scene.prim.RemoveAPI("SkinSlideAPI", PATCH),
        "nothing to slide: no mesh...",
        None,
        prim="",
    ),
]


CHOSEN = [
    Bad(
        "faces: none chosen",
        put(FACES, Types.BoolArray, "uniform", [False] * 36),
        f"has no faces: primvars:{FACES} is above 0 on no face",
    ),
    Bad(
        "faces: none chosen by points",
        painted(FACES, "vertex", [0.0, 1.0] * 24 + [0.0]),
        f"has no faces: primvars:{FACES} is above 0 on all points of no face",
    ),
    Bad("faces: nowhere", no_faces_anywhere, NEITHER),
    Bad("faces: blocked", blocked(f"primvars:{FACES}"), NEITHER),
    Bad(
        "faces: on an ancestor",
        all_of(no_faces_anywhere, inherited(FACES, [True] * 36, "constant", Types.BoolArray)),
        NEITHER,
    ),
    Bad(
        "faces: blocked at the first sample",
        all_of(
            no_faces_anywhere,
            put(FACES, Types.BoolArray, "uniform", [True] * 36, FRAMES[1]),
            blocked_at(f"primvars:{FACES}", FRAMES[0]),
        ),
        f"primvars:{FACES} has no value",
    ),
    Bad(
        "faces: empty",
        put(FACES, Types.BoolArray, "uniform", []),
        f"primvars:{FACES} has 0 values, but the mesh has 36 faces",
    ),
    Bad(
        "faces: uniform length",
        put(FACES, Types.BoolArray, "uniform", [True] * 35),
        f"primvars:{FACES} has 35 values, but the mesh has 36 faces",
    ),
    Bad(
        "faces: vertex length",
        painted(FACES, "vertex", [1.0] * 36),
        f"primvars:{FACES} has 36 values, but the mesh has 49 points",
    ),
    Bad(
        "faces: type",
        put(FACES, Types.Color3fArray, "uniform", [Gf.Vec3f(1)] * 36),
        f"primvars:{FACES} is color3f[]; it must be bool[], int[] or float[], or "
        f"{PLACE}:paintChannel must name the channel that counts",
    ),
    Bad(
        "faces: unsigned",
        put(FACES, Types.UIntArray, "uniform", Vt.UIntArray([1] * 36)),
        f"primvars:{FACES} is uint[]; it must be bool[], int[] or float[]",
    ),
    Bad(
        "faces: no array",
        put(FACES, Types.Bool, "uniform", True),
        f"primvars:{FACES} is bool; it must be bool[], int[] or float[]",
    ),
    Bad(
        "faces: interpolation",
        put(FACES, Types.BoolArray, "constant", [True]),
        f"primvars:{FACES} has interpolation constant; it must be uniform (by face), vertex or faceVarying",
    ),
    Bad(
        "faces: no interpolation",
        put(FACES, Types.BoolArray, "constant", [True] * 36),
        f"primvars:{FACES} has interpolation constant; it must be uniform (by face), vertex or faceVarying",
    ),
    Bad(
        "faces: interpolation of another case",
        all_of(
            put(FACES, Types.BoolArray, "uniform", [True] * 36),
            lambda scene: scene.prim.GetAttribute(f"primvars:{FACES}").SetMetadata("interpolation", "Uniform"),
        ),
        f"primvars:{FACES} has interpolation Uniform; it must be uniform (by face), vertex or faceVarying",
    ),
    Bad("faces: not a number", painted(FACES, "uniform", floats(36, 7, NAN)), f"primvars:{FACES}[7] is nan"),
    Bad(
        "faces: indexed badly",
        all_of(put(FACES, Types.BoolArray, "uniform", [False, True]), indexed(FACES, [1] * 35 + [7])),
        f"primvars:{FACES}:indices[35] is 7, but primvars:{FACES} has 2 values",
    ),
    Bad(
        "faces: indexed below 0",
        all_of(put(FACES, Types.BoolArray, "uniform", [False, True]), indexed(FACES, [-1] * 36)),
        f"primvars:{FACES}:indices[0] is -1, but primvars:{FACES} has 2 values",
    ),
    Bad("faces: change", faces_that_change, f"primvars:{FACES} chooses other faces at frame 1003; patches are fixed"),
    Bad(
        "faces: indices change",
        all_of(
            put(FACES, Types.BoolArray, "uniform", [False, True]),
            indexed(FACES, [1] * 36, FRAMES[0]),
            indexed(FACES, [0] + [1] * 35, FRAMES[1]),
        ),
        f"primvars:{FACES} chooses other faces at frame 1002; patches are fixed",
    ),
    Bad(
        "subset: points",
        subset([0, 1], "point"),
        f"the GeomSubset {MESH}/{PATCH} has elementType point; it must be face",
    ),
    Bad(
        "subset: element of another case",
        all_of(subset([0, 1]), on_subset(lambda it: it.GetElementTypeAttr().Set("Face"))),
        f"the GeomSubset {MESH}/{PATCH} has elementType Face; it must be face",
    ),
    Bad("subset: index", subset([0, 1, 36]), f"the GeomSubset {MESH}/{PATCH} has face 36, but the mesh has 36 faces"),
    Bad(
        "subset: negative index",
        subset([0, -1]),
        f"the GeomSubset {MESH}/{PATCH} has face -1, but the mesh has 36 faces",
    ),
    Bad("subset: empty", subset([]), f"has no faces: the GeomSubset {MESH}/{PATCH} is empty"),
    Bad(
        "subset: changes",
        all_of(
            subset([0]),
            on_subset(lambda it: [it.GetIndicesAttr().Set([face], frame) for face, frame in ((0, 1001), (1, 1002))]),
        ),
        f"{MESH}/{PATCH}.indices changes at frame 1002; it must stay the same over time",
    ),
    Bad("subset: another prim", child_that_is_no_subset, f"has no faces: {MESH}/{PATCH} is a Xform, not a GeomSubset"),
    Bad("subset: inactive", all_of(subset([0]), on_subset(lambda it: it.GetPrim().SetActive(False))), NEITHER),
    Bad(
        "subset: of a name that no prim has",
        lambda scene: stages.add_patch(scene.mesh, None, "left:elbow"),
        "has no faces: there is neither primvars:skinSlide:left:elbow:patch nor a GeomSubset left:elbow under the mesh",
        "left:elbow",
    ),
    Bad(
        "subset: an over",
        all_of(subset([0]), on_subset(lambda it: as_over(it.GetPrim()))),
        f"has no faces: {MESH}/{PATCH} is a prim without a type, not a GeomSubset",
    ),
]


GEOMETRY = [
    Bad(
        "patch: closed",
        nothing,
        "the patch is closed; rules unit and fast need a boundary to hold on to, relaxed and even do not",
        shape=stages.box,
    ),
    Bad("patch: three faces at an edge", nothing, "edge 0-1 has 3 faces", shape=stages.fin),
    Bad(
        "patch: pinched",
        nothing,
        "the boundary touches itself at vertex 5",
        shape=lambda: stages.grid(3, 3),
        faces=stages.pinched,
    ),
    Bad("patch: in one place", nothing, "all its rest points are in one place", shape=lambda: stages.grid(size=0)),
    Bad("face: two vertices", nothing, "face 1 has 2 vertices; a face needs 3", shape=triangle_and(0, 2)),
    Bad("face: repeated vertex", nothing, "face 1 has vertex 2 more than once", shape=triangle_and(0, 2, 2, 3)),
    Bad("mesh: no counts", blocked("faceVertexCounts"), "faceVertexCounts has no value", None),
    Bad("mesh: no indices", topology(indices=lambda _: []), "faceVertexIndices has no value", None),
    Bad("mesh: index too large", indices_end_with(49), "face 35 has point 49, but the mesh has 49 points", None),
    Bad("mesh: negative index", indices_end_with(-1), "face 35 has point -1, but the mesh has 49 points", None),
    Bad(
        "mesh: counts", counts_end_with(5), "faceVertexCounts add up to 145, but faceVertexIndices has 144 values", None
    ),
    Bad(
        "mesh: counts beyond int",
        topology(counts=lambda _: [2**31 - 1] * 36),
        "faceVertexCounts add up to 77309411292, but faceVertexIndices has 144 values",
        None,
    ),
    Bad(
        "times: samples ages apart",
        ages_apart,
        "by frame 20000000 there are more than 10000000 frames between samples; name the frames that are wanted",
        None,
    ),
    Bad("mesh: negative count", counts_end_with(-4), "face 35 has -4 vertices", None),
    Bad(
        "mesh: topology is not its default",
        topology_unlike_its_default,
        "faceVertexIndices changes at frame 1002; it must stay the same over time",
        None,
    ),
    Bad(
        "mesh: orientation changes",
        retyped("orientation", Types.Token, None, {FRAMES[0]: "leftHanded", FRAMES[1]: "rightHanded"}),
        "orientation changes at frame 1002; it must stay the same over time",
        None,
    ),
    Bad(
        "mesh: weld changes",
        retyped("skinSlide:weld", Types.Bool, None, {FRAMES[0]: True, FRAMES[2]: False}),
        "skinSlide:weld changes at frame 1003; it must stay the same over time",
        None,
    ),
    Bad(
        "rest: changes",
        rest_that_changes(FRAMES[0]),
        "primvars:Pref changes at frame 1002; it must stay the same over time",
        None,
        rest="",
    ),
    Bad(
        "rest: a sample is not the default",
        rest_that_changes(None),
        "primvars:Pref changes at frame 1002; it must stay the same over time",
        None,
        rest="",
    ),
    Bad(
        "rest: is blocked at a frame",
        all_of(rest_that_changes(None), blocked_at("primvars:Pref", FRAMES[2])),
        "primvars:Pref changes at frame 1002; it must stay the same over time",
        None,
        rest="",
    ),
    Bad(
        "subset: elementType changes",
        all_of(
            subset([0]),
            on_subset(lambda it: [it.GetElementTypeAttr().Set(*each) for each in (("face", 1001), ("point", 1002))]),
        ),
        "elementType changes at frame 1002; it must stay the same over time",
    ),
    Bad(
        "mesh: topology changes",
        topology_that_changes,
        "faceVertexIndices changes at frame 1002; it must stay the same over time",
        None,
    ),
    Bad("points: none", removed("points"), "points has no value", None),
    Bad("points: blocked", blocked("points"), "points has no value", None),
    Bad("points: blocked at a frame", blocked_at("points", FRAMES[1]), "points has no value", None, "1002"),
    Bad(
        "points: another count",
        fewer_points,
        "points has 48 values, but 49 at first; the count must stay the same",
        None,
        "1002",
    ),
    Bad(
        "points: nan at a frame",
        point(12, NAN, FRAMES[2]),
        "points: vertex 12 is not finite: (0.388889, nan, 0.284059)",
        None,
        "1003",
    ),
    Bad(
        "points: infinite at a frame",
        point(12, INFINITY, FRAMES[2]),
        "points: vertex 12 is not finite: (0.388889, inf, 0.284059)",
        None,
        "1003",
    ),
    Bad(
        "points: baked already",
        baked_already,
        "points are slid already, by the bake in {folder}/cache.usda; slide the cache instead: "
        "open the stage without that layer, or remove the baked attributes from it",
        None,
    ),
    Bad("rest: nan", point(12, NAN), "rest points: points (default)[12] is (0.333333, nan, 0.061837)", None),
    Bad("rest: infinite", point(12, INFINITY), "rest points: points (default)[12] is (0.333333, inf, 0.061837)", None),
    Bad(
        "rest: larger than a float",
        put("rest", Types.Double3Array, "vertex", [(1e300, 0, 0)] * 49),
        "rest points: primvars:rest[0] is (inf, 0, 0)",
        None,
    ),
    Bad(
        "rest: by corner",
        put("rest", Types.Point3fArray, "faceVarying", [(0, 0, 0)] * 144),
        "rest points: primvars:rest has interpolation faceVarying; it must be vertex",
        None,
    ),
    Bad(
        "rest: by face",
        put("rest", Types.Point3fArray, "uniform", [(0, 0, 0)] * 49),
        "rest points: primvars:rest has interpolation uniform; it must be vertex",
        None,
    ),
    Bad(
        "rest: constant",
        put("rest", Types.Point3fArray, "constant", [(0, 0, 0)] * 49),
        "rest points: primvars:rest has interpolation constant; it must be vertex",
        None,
    ),
    Bad("rest: length", rest_points(48), "rest points: skinSlide:restPoints has 48 values, but points has 49", None),
    Bad("rest: empty", rest_points(0), "rest points: skinSlide:restPoints has 0 values, but points has 49", None),
    Bad(
        "rest: default of another length",
        lambda scene: scene.points.Set(stages.vectors(np.zeros((3, 3)))),
        "rest points: points (default) has 3 values, but points has 49",
        None,
    ),
    Bad(
        "rest: indexed badly",
        all_of(put("pref", Types.Point3fArray, "vertex", [(0, 0, 0)]), indexed("pref", [0] * 48 + [1])),
        "primvars:pref:indices[48] is 1, but primvars:pref has 1 values",
        None,
    ),
    Bad(
        "rest: nowhere",
        lambda scene: scene.points.ClearDefault(),
        "has no rest points: points has samples but no default value, so author the rest pose as "
        "skinSlide:restPoints or primvars:rest (point3f[], vertex)",
        None,
    ),
    Bad(
        "rest: in another order",
        rest_changed(shuffled),
        "rest is not that of the cache: lengths of edges differ by a factor of ...",
        rest="rest",
    ),
    Bad(
        "rest: compared by a word",
        retyped("skinSlide:compareRest", Types.Token, "no"),
        "skinSlide:compareRest is 'no'; it must be a bool",
        None,
    ),
    Bad(
        "space: a word",
        retyped("skinSlide:worldSpace", Types.Token, "no"),
        "skinSlide:worldSpace is 'no'; it must be a bool",
        None,
    ),
    Bad(
        "space: squashed over time",
        all_of(in_world, above(squashed)),
        "skinSlide:worldSpace: the transforms above scale it otherwise at frame 1002 than at first; only their size "
        "may change",
        None,
    ),
    Bad(
        "space: flattened",
        all_of(in_world, above(lambda xform: xform.AddScaleOp().Set((1, 0, 1)))),
        "skinSlide:worldSpace: the transforms above flatten it, so that it has no lengths in the world",
        None,
    ),
    Bad("points: blocked at the first frame", blocked_at("points", FRAMES[0]), "points has no value", None),
    Bad(
        "weld: a word",
        retyped("skinSlide:weld", Types.Token, "yes"),
        "skinSlide:weld is 'yes'; it must be a bool",
        None,
    ),
    Bad(
        "weld: a tolerance below 0",
        retyped("skinSlide:weldTolerance", Types.Float, -1.0),
        "skinSlide:weldTolerance is -1; it must be 0 or more",
        None,
    ),
    Bad(
        "weld: a tolerance that holds half the mesh",
        retyped("skinSlide:weldTolerance", Types.Float, 0.5),
        "weld: the tolerance is 0.5; it must be 0 to ...",
        None,
    ),
]
