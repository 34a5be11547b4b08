"""Meshes, patches, rest poses and clocks of every kind that slides."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

import rigs
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
    clips,
    floats,
    half_way,
    indexed,
    inherited,
    normals,
    on_subset,
    over,
    painted,
    point,
    points_as,
    put,
    ramp,
    rest_changed,
    retyped,
    sampled,
    setting,
    shuffled,
    still,
    subset,
    text,
    topology,
    vectors,
)
from layers import CLOCK, HEAD
from rows import CANNOT_READ, Good
from stages import FRAMES, PATCH

SKINNED = (
    "points are skinned by UsdSkel, which a .skinslide file cannot do; bake the stage instead, or write the skinned "
    "points into a layer to sublayer: skinslide cache STAGE -o cache.usdc"
)
NOT_SKINNED = "UsdSkel does not skin it"
UNTIMED = f'defaultPrim = "World"; metersPerUnit = 0.01; upAxis = "Y"; {CLOCK}'


def clip_of_points(prim: Usd.Prim) -> None:
    attribute = prim.CreateAttribute("points", Types.Point3fArray, False)
    for frame in FRAMES:
        attribute.Set(stages.vectors(stages.grid().moved(frame)), frame)


def clip_of_split_points(prim: Usd.Prim) -> None:
    whole = np.sort(stages.grid().indices)
    attribute = prim.CreateAttribute("points", Types.Point3fArray, False)
    for frame in FRAMES:
        attribute.Set(stages.vectors(stages.grid().moved(frame)[whole]), frame)


def with_loose_points() -> stages.Shape:
    """Three points that no face has."""
    shape = stages.grid()
    return replace(shape, points=np.concatenate([shape.points, np.zeros((3, 3), np.float32)]))


def points_are_unsampled(scene: Scene) -> None:
    for frame in FRAMES:
        scene.points.ClearAtTime(frame)


def two_overlapping(scene: Scene) -> None:
    stages.add_patch(scene.mesh, np.arange(24), "lower")
    stages.set_property(scene.mesh, "envelope", 0.5, patch="lower")
    put("skinSlide:lower:weight", Types.FloatArray, "vertex", ramp(49, 1, 0))(scene)


def two_meshes(scene: Scene) -> None:
    other = stages.add_mesh(scene.stage, stages.grid(5, 4), "/World/char/geo/other_GEO")
    stages.add_patch(other, np.arange(20))


def split_grid() -> stages.Shape:
    return stages.split(stages.grid())


def subdivided(scene: Scene) -> None:
    scene.mesh.GetSubdivisionSchemeAttr().Set("catmullClark")


def apart(scene: Scene) -> None:
    """Moves copies of points a little apart, at rest and in every frame."""
    noise = np.random.default_rng(1).uniform(-1e-5, 1e-5, (144, 3))
    for time in (Usd.TimeCode.Default(), *FRAMES):
        scene.points.Set(stages.vectors(np.array(scene.points.Get(time)) + noise), time)


def parting(scene: Scene) -> None:
    """The copies of one point inside the sheet go their own ways in the last frame."""
    points = np.array(scene.points.Get(FRAMES[-1]))
    rest = np.array(scene.points.Get())
    copies = np.flatnonzero((rest == stages.grid().points[24]).all(axis=1))
    points[copies] += 0.01 * np.arange(4)[:, None]
    scene.points.Set(stages.vectors(points), FRAMES[-1])


def inactive_neighbour(scene: Scene) -> None:
    other = stages.add_mesh(scene.stage, stages.grid(), "/World/prop/bad_GEO")
    stages.add_patch(other, None)
    scene.stage.GetPrimAtPath("/World/prop").SetActive(False)


def class_with_opinions(scene: Scene) -> None:
    source = scene.stage.CreateClassPrim("/_class_skin")
    source.CreateAttribute(f"{PLACE}:envelope", Types.Float).Set(0.5)
    scene.prim.GetInherits().AddInherit("/_class_skin")


def variants(scene: Scene) -> None:
    chosen = scene.prim.GetVariantSets().AddVariantSet("skin")
    for name, envelope in (("full", 1.0), ("half", 0.5)):
        chosen.AddVariant(name)
        chosen.SetVariantSelection(name)
        with chosen.GetVariantEditContext():
            stages.set_property(scene.mesh, "envelope", envelope)


def points_of_a_variant(scene: Scene) -> None:
    """Each variant of the parent has its own cache, behind a payload."""
    chosen = scene.parent.GetVariantSets().AddVariantSet("lod")
    for name, size in (("low", 0.5), ("high", 1.0)):
        cache = Usd.Stage.CreateNew(str(scene.folder / f"{name}.usda"))
        points = cache.OverridePrim("/char/geo/skin_GEO").CreateAttribute("points", Types.Point3fArray, False)
        for time in (Usd.TimeCode.Default(), *FRAMES):
            points.Set(stages.vectors(size * np.array(scene.points.Get(time))), time)
        cache.Save()
        chosen.AddVariant(name)
        chosen.SetVariantSelection(name)
        with chosen.GetVariantEditContext():
            scene.parent.GetPayloads().AddPayload(f"./{name}.usda", "/char")
    scene.prim.RemoveProperty("points")


SPARSE = (1001.0, 1004.5, 1008.0)


def far_apart(scene: Scene) -> None:
    """Samples of points more than one time code apart."""
    points = [scene.points.Get(frame) for frame in FRAMES]
    for frame in FRAMES:
        scene.points.ClearAtTime(frame)
    for frame, value in zip(SPARSE, points, strict=True):
        scene.points.Set(value, frame)


def skinned_earlier(scene: Scene) -> None:
    """The skinning was baked: there are samples."""
    UsdSkel.BindingAPI.Apply(scene.prim).CreateJointIndicesPrimvar(False, 1).Set([0] * 49)


def skinned(*edits: Callable[[Scene], object]) -> Edit:
    """UsdSkel moves the points, which have no samples."""

    def edit(scene: Scene) -> None:
        rigs.skeleton(scene.stage)
        rigs.bind(scene.mesh)
        for each in edits:
            each(scene)

    return edit


def skinned_in_samples(scene: Scene) -> None:
    scene.points.Set(stages.vectors(stages.grid().moved(1002)), 1002)


def skinned_by_usd(scene: Scene) -> None:
    assert UsdSkel.BakeSkinning(Usd.PrimRange(scene.stage.GetPseudoRoot()))


def bound_above(scene: Scene) -> None:
    scene.prim.RemoveProperty("skel:skeleton")
    UsdSkel.BindingAPI.Apply(scene.prim.GetParent()).CreateSkeletonRel().SetTargets([rigs.SKELETON])


def unbound_below(scene: Scene) -> None:
    bound_above(scene)
    UsdSkel.BindingAPI(scene.prim).CreateSkeletonRel().SetTargets([])


def bound_above_the_skel_root(scene: Scene) -> None:
    scene.prim.RemoveProperty("skel:skeleton")
    UsdSkel.BindingAPI.Apply(scene.stage.GetPrimAtPath("/World")).CreateSkeletonRel().SetTargets([rigs.SKELETON])


def blend_shapes_alone(scene: Scene) -> None:
    rigs.blend_shape(scene.mesh)
    for name in ("jointIndices", "jointWeights"):
        scene.prim.RemoveProperty(f"primvars:skel:{name}")


def joints_off_the_mesh(scene: Scene) -> None:
    """Of a skinned neighbour's parent: only a constant is inherited."""
    still(scene)
    inherited("skel:jointIndices", [0] * 49, "vertex", Types.IntArray)(scene)


def blend_shapes_without_targets(scene: Scene) -> None:
    still(scene)
    UsdSkel.BindingAPI.Apply(scene.prim).CreateBlendShapeTargetsRel()


def moved_below(scene: Scene) -> None:
    """A layer between the file and its cache, which moves it in time."""
    head = "timeCodesPerSecond = 24; subLayers = [@./cache.usda@ (offset = 5.5; scale = 2)]"
    (scene.folder / "between.usda").write_text(f"#usda 1.0\n({head})\n")


def inactive_instancer(scene: Scene) -> None:
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/World/crowd")
    instancer.CreatePrototypesRel().SetTargets([scene.prim.GetParent().GetPath()])
    instancer.GetPrim().SetActive(False)


def rest_as(type_name: Sdf.ValueTypeName, name: str = "rest", interpolation: str = "vertex") -> Edit:
    vector = type_name.scalarType.type.pythonClass
    values = [vector(*map(float, point)) for point in stages.grid().points]
    return put(name, type_name, interpolation, values)


def rest_points(scene: Scene) -> None:
    attribute = scene.prim.CreateAttribute("skinSlide:restPoints", Types.Point3fArray, False)
    attribute.Set(stages.vectors(stages.grid().points))
    put("rest", Types.Point3fArray, "vertex", [(0, 0, 0)] * 49)(scene)  # which it wins over


def rest_by_indices(scene: Scene) -> None:
    order = np.arange(49)[::-1]
    put("Pref", Types.Point3fArray, "vertex", stages.vectors(stages.grid().points[order]), 7)(scene)
    indexed("Pref", order.tolist())(scene)


def in_samples_alone(*names: str) -> Edit:
    """Attributes that are the same at every frame, and have no default."""

    def edit(scene: Scene) -> None:
        for name in names:
            attribute = scene.prim.GetAttribute(name)
            value = attribute.Get()
            attribute.Clear()
            for frame in FRAMES:
                attribute.Set(value, frame)

    return edit


def subset_in_samples_alone(scene: Scene) -> None:
    child = UsdGeom.Subset(scene.stage.GetPrimAtPath(f"{scene.prim.GetPath()}/{PATCH}"))
    for attribute in (child.GetElementTypeAttr(), child.GetIndicesAttr()):
        value = attribute.Get()
        attribute.Clear()
        attribute.Set(value, FRAMES[0])


CHOSEN = [
    Good("plain"),
    Good("faces: int", put(FACES, Types.IntArray, "uniform", [0] * 6 + [3] * 29 + [-1])),
    Good("faces: float by vertex", painted(FACES, "vertex", [*floats(49, 0, 0.0)])),
    Good(
        "faces: indexed",
        all_of(put(FACES, Types.BoolArray, "uniform", [False, True]), indexed(FACES, [0] * 6 + [1] * 30)),
    ),
    Good(
        "faces: indices are blocked",
        all_of(
            put(FACES, Types.BoolArray, "uniform", [True] * 36),
            indexed(FACES, [7] * 36),
            blocked(f"primvars:{FACES}:indices"),
        ),
    ),
    Good(
        "faces: values vary, faces do not",
        all_of(*(painted(FACES, "uniform", [frame] * 36, frame) for frame in FRAMES)),
    ),
    Good("faces: subset", subset([*range(30), 3, 3])),
    Good("faces: subset in samples alone", all_of(subset([*range(30)]), subset_in_samples_alone)),
    Good("faces: subset without elementType", subset([*range(30)], None)),
    Good(
        "faces: subset whose elementType is blocked",
        all_of(subset([*range(30)]), on_subset(lambda it: it.GetElementTypeAttr().Block())),
    ),
    Good(
        "faces: subset of another family",
        all_of(subset([*range(30)]), on_subset(lambda it: it.CreateFamilyNameAttr("x"))),
    ),
    Good(
        "faces: subset in samples that agree",
        all_of(
            subset([*range(30)]),
            on_subset(lambda it: [it.GetIndicesAttr().Set([*range(30)], frame) for frame in FRAMES]),
        ),
    ),
    Good(
        "faces: subset behind a blocked primvar",
        all_of(subset([*range(30)]), put(FACES, Types.BoolArray, "uniform", [True] * 36), blocked(f"primvars:{FACES}")),
    ),
    Good(
        "faces: a primvar wins over the subset",
        all_of(subset([99]), put(FACES, Types.BoolArray, "uniform", [True] * 36)),
    ),
    Good(
        "faces: by vertex, beside one without points",
        all_of(topology(counts=lambda counts: [0, *counts]), painted(FACES, "vertex", floats(49))),
    ),
    Good("faces: holes of the patch", faces=stages.annulus),
    Good("faces: several pieces", faces=stages.two_pieces),
    Good("names: with namespaces", lambda scene: stages.add_patch(scene.mesh, np.arange(12), "left:arm:elbow")),
    Good("names: not of ASCII", lambda scene: stages.add_patch(scene.mesh, np.arange(12), "élève")),
    Good(
        "names: like those of the mesh's own settings",
        lambda scene: [stages.add_patch(scene.mesh, np.arange(12), name) for name in ("live", "cached", "restPoints")],
    ),
    Good(
        "patches: applied again by the file",
        file=text(body=over("").replace('"skin_GEO"', '"skin_GEO" (append apiSchemas = ["SkinSlideAPI:elbow_L"])')),
    ),
    Good("patches: overlapping", two_overlapping),
    Good("meshes: two", two_meshes),
    Good("meshes: a bad one that is inactive", inactive_neighbour),
    Good("prim: invisible", lambda scene: scene.mesh.MakeInvisible()),
    Good("prim: opinions of a class", class_with_opinions),
    Good("prim: opinions of a variant", variants),
    Good(
        "prim: points of a variant",
        points_of_a_variant,
        warns="points come from the variant high of lod, and what is slid stands whichever is selected; bake into that "
        "variant, or keep it selected",
    ),
    Good("prim: point instancer that is inactive", inactive_instancer),
]


POINTS = [
    Good("points: on sub-frames", half_way),
    Good("points: without samples", still),
    Good(
        "points: one sample",
        lambda scene: (
            [scene.points.ClearAtTime(frame) for frame in FRAMES[1:]]
            and scene.points.Set(stages.vectors(stages.grid().moved(1003)), FRAMES[0])
        ),
    ),
    Good("points: double", all_of(points_as(Types.Point3dArray), sampled("envelope", {1001.3: 0.5, 1002.7: 1.0}))),
    Good("points: half", all_of(points_as(Types.Point3hArray), sampled("envelope", {1001.3: 0.5, 1002.7: 1.0}))),
    Good("points: float3", points_as(Types.Float3Array)),
    Good("points: left-handed", lambda scene: scene.mesh.CreateOrientationAttr("leftHanded")),
    Good(
        "points: left-handed, with normals",
        all_of(lambda scene: scene.mesh.CreateOrientationAttr("leftHanded"), normals("vertex", 49)),
    ),
    Good(
        "points: left-handed by a string, with normals",
        all_of(retyped("orientation", Types.String, "leftHanded"), normals("vertex", 49)),
    ),
    Good("points: skinning was baked", skinned_earlier),
    Good("points: skinning was baked by USD", skinned(skinned_by_usd)),
    Good("points: skinned", skinned(), refuses=SKINNED),
    Good("points: skinned, in samples too", skinned(skinned_in_samples), refuses=SKINNED),
    Good("points: skinned by blend shapes", skinned(blend_shapes_alone), refuses=SKINNED),
    Good("points: skinned by a binding above", skinned(bound_above), refuses=SKINNED),
    Good(
        "points: joints without a SkelRoot",
        skinned(lambda scene: scene.parent.SetTypeName("Xform")),
        warns=f"{NOT_SKINNED}: there is no SkelRoot above it",
        slides=False,
    ),
    *(
        Good(f"points: joints {name}", skinned(edit), warns=f"{NOT_SKINNED}: no Skeleton is bound to it", slides=False)
        for name, edit in {
            "without a binding": lambda scene: scene.prim.RemoveProperty("skel:skeleton"),
            "bound above the SkelRoot": bound_above_the_skel_root,
            "unbound": unbound_below,
            "bound to something else": lambda scene: scene.stage.GetPrimAtPath(rigs.SKELETON).SetTypeName("Xform"),
        }.items()
    ),
    Good(
        "points: joints without weights",
        skinned(lambda scene: scene.prim.RemoveProperty("primvars:skel:jointWeights")),
        warns=f"{NOT_SKINNED}: its joint indices have no weights",
        slides=False,
    ),
    Good("points: joint indices that are not inherited", joints_off_the_mesh),
    Good("points: blend shapes without targets", blend_shapes_without_targets),
    Good(
        "points: by value clips",
        all_of(
            points_are_unsampled,
            clips(clip_of_points, lambda prim: prim.CreateAttribute("points", Types.Point3fArray, False)),
        ),
        rest="rest",
        refuses=f"points come from value clips, {CANNOT_READ}",
    ),
    Good(
        "points: samples that beat value clips",
        clips(clip_of_points, lambda prim: prim.CreateAttribute("points", Types.Point3fArray, False)),
    ),
    Good(
        "topology: samples that agree",
        lambda scene: [
            scene.mesh.GetFaceVertexIndicesAttr().Set(scene.mesh.GetFaceVertexIndicesAttr().Get(), frame)
            for frame in FRAMES
        ],
    ),
    Good("topology: in samples alone", in_samples_alone("faceVertexCounts", "faceVertexIndices", "subdivisionScheme")),
    Good(
        "points: left-handed, in samples alone",
        retyped("orientation", Types.Token, None, dict.fromkeys(FRAMES, "leftHanded")),
    ),
    Good("topology: counts as unsigned", retyped("faceVertexCounts", Types.UIntArray, Vt.UIntArray([4] * 36))),
    Good("topology: counts as int64", retyped("faceVertexCounts", Types.Int64Array, Vt.Int64Array([4] * 36))),
]


def above(change: Callable[[UsdGeom.Xformable], object]) -> Edit:
    """Changes the transforms of the mesh's parent."""

    def edit(scene: Scene) -> None:
        change(UsdGeom.Xformable(scene.prim.GetParent()))

    return edit


def squashed(xform: UsdGeom.Xformable) -> None:
    scale = xform.AddScaleOp()
    for frame, height in zip(FRAMES, (1, 2, 0.25), strict=True):
        scale.Set((1, height, 1), frame)


def leaning(xform: UsdGeom.Xformable) -> None:
    """A scale along a slanted axis, below what turns and grows over time, with samples of their own each."""
    turn, grow = xform.AddRotateXYZOp(), xform.AddScaleOp(UsdGeom.XformOp.PrecisionFloat, "grow")
    for frame in (1001, 1002.5, 1003):
        turn.Set((10 * (frame - 1001), 5, -20 * (frame - 1001)), frame)
    for frame in (1001, 1003):
        grow.Set((frame - 1000,) * 3, frame)
    xform.AddRotateZOp(UsdGeom.XformOp.PrecisionFloat, "lean").Set(30)
    xform.AddScaleOp(UsdGeom.XformOp.PrecisionFloat, "along").Set((2, 1, 1))
    xform.AddRotateZOp(UsdGeom.XformOp.PrecisionFloat, "lean", True)


def in_world(scene: Scene) -> None:
    retyped("skinSlide:worldSpace", Types.Bool, True)(scene)


def even_rule(scene: Scene) -> None:
    setting("forceDensityRule", "even")(scene)


def free_borders(scene: Scene) -> None:
    setting("forceDensityRule", "even")(scene)
    setting("holes", "freeAll")(scene)


def unwelded(scene: Scene) -> None:
    retyped("skinSlide:weld", Types.Bool, False)(scene)


def beside(parent: str = "/World/char/geo", *more: Edit) -> Edit:
    """A mesh that goes on from the last column of points; what else is done is done to both."""

    def edit(scene: Scene) -> None:
        mesh = stages.add_mesh(scene.stage, stages.grid(centre=(1, 0, 0)), f"{parent}/head_GEO")
        for time in (Usd.TimeCode.Default(), *FRAMES):
            points = np.array(mesh.GetPointsAttr().Get(time))
            points[::7] = np.array(scene.points.Get(time))[6::7]
            mesh.GetPointsAttr().Set(stages.vectors(points), time)
        for each in more:
            each(scene)
            each(Scene(scene.folder, scene.stage, mesh))

    return edit


def moves(scene: Scene) -> None:
    """Every kind of transform on the mesh and above it, of every precision, and the inverse of one."""
    parent = UsdGeom.Xformable(scene.prim.GetParent())
    if not parent.GetOrderedXformOps():
        parent.AddTranslateOp().Set((1, 2, 3))
        parent.AddRotateXOp(UsdGeom.XformOp.PrecisionFloat).Set(20.0)
        parent.AddScaleOp(UsdGeom.XformOp.PrecisionHalf).Set(Gf.Vec3h(2))
    mesh = UsdGeom.Xformable(scene.prim)
    mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionFloat, "pivot").Set(Gf.Vec3f(0, 1, 0))
    mesh.AddRotateZYXOp(UsdGeom.XformOp.PrecisionDouble).Set((10, 20, 30))
    mesh.AddOrientOp(UsdGeom.XformOp.PrecisionHalf).Set(Gf.Quath(0.5, 0.5, 0.5, 0.5))
    mesh.AddTransformOp().Set(Gf.Matrix4d(2))
    mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionFloat, "pivot", True)


REST = [
    *(Good(f"rest: primvars:{name}", rest=name) for name in ("rest", "pref", "Pref", "__Pref")),
    Good("rest: skinSlide:restPoints", rest_points, rest=""),
    Good("rest: double", rest_as(Types.Double3Array), rest=""),
    Good("rest: half", rest_as(Types.Half3Array), rest=""),
    Good("rest: varying", rest_as(Types.Point3fArray, interpolation="varying"), rest=""),
    Good("rest: indexed, in a sample", rest_by_indices, rest=""),
    Good("rest: samples that agree", in_samples_alone("primvars:Pref"), rest="Pref"),
    Good(
        "rest: one that does not count may change",
        all_of(*(put("pref", Types.Point3fArray, "vertex", [(frame, 0, 0)] * 49, frame) for frame in FRAMES)),
        rest="rest",
    ),
    Good(
        "rest: blocked, so the next counts",
        all_of(rest_as(Types.Point3fArray), blocked("primvars:rest"), rest_as(Types.Point3fArray, "pref")),
        rest="",
    ),
    Good(
        "rest: in metres, of a cache in centimetres",
        rest_changed(lambda rest: rest / 100),
        rest="rest",
        warns="rest is 0.01 times the size of the cache: lengths are taken at that scale",
    ),
    Good(
        "rest: in metres, and taken as it is",
        all_of(rest_changed(lambda rest: rest / 100), retyped("skinSlide:compareRest", Types.Bool, False)),
        rest="rest",
    ),
    Good(
        "rest: of a pose that is far from the first",
        rest_changed(lambda rest: rest * [2.3, 1, 1]),
        rest="rest",
        warns="rest resembles the cache poorly at first: lengths of edges differ by a factor of ",
    ),
    Good(
        "rest: in another order, and taken as it is",
        all_of(rest_changed(shuffled), retyped("skinSlide:compareRest", Types.Bool, False)),
        rest="rest",
    ),
    Good("rest: on an ancestor, which does not count", inherited("rest", [(0, 0, 0)], type_name=Types.Point3fArray)),
]


FAULTS = [
    Good(
        f"points: {fault} off the patch at a frame",
        all_of(point(0, fault, FRAMES[1]), point(99, fault, FRAMES[2]), *more),
        shape=lambda: stages.grid(9, 9),
        faces=lambda: stages.block(9, range(3, 6), range(3, 6)),
        warns="1 point that no patch uses is not finite, and stays as it is: vertex 0 at (",
    )
    for fault, more in ((NAN, [normals("vertex", 100)]), (INFINITY, [subdivided]))
] + [
    Good(
        "rest: not finite at points of no face",
        all_of(point(49, NAN), point(50, INFINITY)),
        shape=with_loose_points,
        warns="rest points: points (default)[49] is (0, nan, 0), which counts for nothing, since no face has it, "
        "and 1 more like it",
    ),
]


TIMES = [
    Good(
        "times: an offset and a scale of the sublayer",
        vectors("velocities", 49, FRAMES),
        file=text("@./cache.usda@ (offset = -1000.1; scale = 2)"),
    ),
    Good(
        "times: a scale of a third",
        sampled("envelope", {1001: 0.0, 1002: 0.5, 1003: 1.0}),
        file=text("@./cache.usda@ (offset = 0.1; scale = 0.333333)"),
    ),
    Good(
        "times: a payload's offset",
        file=f'#usda 1.0\n({HEAD}; {CLOCK})\ndef "World" (payload = @./cache.usda@ (offset = 7.5)) {{}}\n',
    ),
    Good("times: a sublayer of a sublayer is moved", moved_below, file=text("@./between.usda@")),
    Good(
        "times: another rate than the cache",
        vectors("velocities", 49, FRAMES),
        file=text(head=f"{UNTIMED}; timeCodesPerSecond = 48"),
    ),
    Good(
        "times: only frames per second",
        vectors("velocities", 49, FRAMES),
        file=text(head=f"{UNTIMED}; framesPerSecond = 48"),
    ),
    Good(
        "times: controls next to points but for noise",
        sampled("envelope", {1001 + 1e-9: 0.0, 1002 - 1e-9: 0.5, 1003: 1.0}),
    ),
    Good("times: the rate of the cache", vectors("velocities", 49, FRAMES), file=text(head=UNTIMED)),
    Good(
        "times: controls of the file over those of the cache",
        setting("envelope", 0.0),
        file=text(body=over(f"float {PLACE}:envelope.timeSamples = {{ 1001: 0, 1002.5: 1 }}")),
    ),
    Good("times: samples far apart", far_apart),
    Good(
        "times: samples far apart, with rates, normals and controls",
        all_of(
            far_apart,
            vectors("velocities", 49, SPARSE),
            vectors("accelerations", 49, SPARSE),
            normals("vertex", 49, SPARSE),
            sampled("envelope", {1001: 0.25, 1002.5: 0.5, 1010.5: 1.0}),
        ),
    ),
    Good("times: controls far apart over still points", all_of(still, sampled("envelope", {1001: 0.0, 1004: 1.0}))),
    Good("weld: a point for each corner", shape=split_grid),
    Good(
        "weld: a point for each corner, by value clips",
        all_of(
            points_are_unsampled,
            clips(clip_of_split_points, lambda prim: prim.CreateAttribute("points", Types.Point3fArray, False)),
        ),
        shape=split_grid,
        rest="rest",
        refuses=f"points come from value clips, {CANNOT_READ}",
    ),
    Good("weld: off", retyped("skinSlide:weld", Types.Bool, False), shape=split_grid, slides=False),
    Good("weld: a tolerance", all_of(apart, retyped("skinSlide:weldTolerance", Types.Float, 1e-4)), shape=split_grid),
    Good("weld: points that part", parting, shape=split_grid),
    Good("weld: a point for each corner, subdivided", subdivided, shape=split_grid),
    Good(
        "space: an uneven scale",
        above(lambda xform: xform.AddScaleOp().Set((3, 1, 1))),
        warns="the transforms above scale it 3 times as much one way as another: lengths are taken in its own space",
    ),
    Good(
        "space: a scale that becomes uneven",
        above(squashed),
        warns="the transforms above scale it 4 times as much one way as another, most at frame 1003: lengths",
    ),
    Good(
        "space: lengths in the world",
        all_of(even_rule, in_world, above(lambda xform: xform.AddScaleOp().Set((3, 1, 1)))),
    ),
    Good("space: lengths in the world, subdivided", all_of(subdivided, in_world, above(leaning))),
    Good("space: lengths in the world, where they are the same", all_of(in_world, even_rule)),
    Good("borders: with another mesh", all_of(free_borders, beside())),
    Good("borders: with another mesh, not welded", all_of(free_borders, beside(), unwelded)),
    Good("borders: with another mesh, by the same transforms", all_of(free_borders, beside("/World/char/head", moves))),
    Good("borders: with another mesh, elsewhere", all_of(free_borders, beside("/World/char/head"), moves)),
]
