"""What the tables of stages do to a plain one: an edit is a function of the scene, most are made by those here."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

import stages
from layers import CLOCK, HEAD
from skinslide.arrays.images import encode_exr
from stages import FRAMES, MESH, PATCH

Types = Sdf.ValueTypeNames
NAN, INFINITY = float("nan"), float("inf")
PLACE = f"skinSlide:{PATCH}"  # before the name of a setting
FACES, DENSITY, WEIGHT, FARTHEST, HOLD = (
    f"{PLACE}:{name}" for name in ("patch", "forceDensity", "weight", "maxDistance", "hold")
)


@dataclass(frozen=True)
class Scene:
    """A stage with one mesh that is not saved yet, and the folder that it will be saved into."""

    folder: Path
    stage: Usd.Stage
    mesh: UsdGeom.Mesh

    @property
    def prim(self) -> Usd.Prim:
        return self.mesh.GetPrim()

    @property
    def parent(self) -> Usd.Prim:
        return self.stage.GetPrimAtPath("/World/char")

    @property
    def points(self) -> Usd.Attribute:
        return self.mesh.GetPointsAttr()


Edit = Callable[[Scene], None]


def nothing(_scene: Scene) -> None:
    """The stage is as it comes."""


def all_of(*edits: Edit) -> Edit:
    def edit(scene: Scene) -> None:
        for each in edits:
            each(scene)

    return edit


# ---- Text of the .skinslide file ----


def text(sublayer: str = "@./cache.usda@", *, head: str = f"{HEAD}; {CLOCK}", body: str = "") -> str:
    return f"#usda 1.0\n({head}; subLayers = [{sublayer}])\n{body}\n"


def over(properties: str) -> str:
    """Opinions on the mesh."""
    prims = Sdf.Path(MESH).pathString.strip("/").split("/")
    return "".join(f'over "{name}" {{\n' for name in prims) + properties + "\n}" * len(prims)


# ---- Attributes ----


def setting(name: str, value, time: float | None = None, patch: str = PATCH) -> Edit:
    """A property that the schema declares."""
    return lambda scene: stages.set_property(scene.mesh, name, value, time, patch)


def even(scene: Scene) -> None:
    """The rule even."""
    setting("forceDensityRule", "even")(scene)


def sampled(name: str, values: dict[float, object]) -> Edit:
    """Samples of a property that the schema declares."""
    return all_of(*(setting(name, value, time) for time, value in values.items()))


def retyped(
    name: str, type_name: Sdf.ValueTypeName, value, samples: dict[float, object] | None = None, *, at: str = MESH
) -> Edit:
    """Scene description may hold what the schema does not declare, if written as text or through Sdf."""

    def edit(scene: Scene) -> None:
        layer = scene.stage.GetRootLayer()
        spec = layer.GetPrimAtPath(at)
        if name in spec.properties:
            spec.RemoveProperty(spec.properties[name])
        attribute = Sdf.AttributeSpec(spec, name, type_name)
        if value is not None:
            attribute.default = value
        for time, sample in (samples or {}).items():
            layer.SetTimeSample(attribute.path, time, sample)

    return edit


def related(name: str, target: str = "/World") -> Edit:
    """A relationship in the place of an attribute."""

    def edit(scene: Scene) -> None:
        scene.prim.RemoveProperty(name)
        scene.prim.CreateRelationship(name).AddTarget(target)

    return edit


def removed(name: str) -> Edit:
    return lambda scene: scene.prim.RemoveProperty(name)


def blocked(name: str) -> Edit:
    return lambda scene: scene.prim.GetAttribute(name).Block()


def blocked_at(name: str, time: float) -> Edit:
    return lambda scene: scene.stage.GetRootLayer().SetTimeSample(f"{MESH}.{name}", time, Sdf.ValueBlock())


# ---- Primvars ----


def put(name: str, type_name: Sdf.ValueTypeName, interpolation: str, value, time: float | None = None) -> Edit:
    return lambda scene: stages.set_primvar(scene.mesh, name, type_name, interpolation, value, time)


def painted(name: str, interpolation: str, values: Iterable[float], time: float | None = None) -> Edit:
    return put(name, Types.FloatArray, interpolation, Vt.FloatArray(list(values)), time)


def indexed(name: str, indices: list[int], time: float | None = None) -> Edit:
    def edit(scene: Scene) -> None:
        primvar = UsdGeom.PrimvarsAPI(scene.prim).GetPrimvar(name)
        primvar.SetIndices(Vt.IntArray(indices), Usd.TimeCode.Default() if time is None else time)

    return edit


def inherited(name: str, value, interpolation: str = "constant", type_name: Sdf.ValueTypeName = Types.Float) -> Edit:
    """A primvar on an ancestor."""
    return lambda scene: UsdGeom.PrimvarsAPI(scene.parent).CreatePrimvar(name, type_name, interpolation).Set(value)


def inherited_samples(name: str, values: dict[float, float]) -> Edit:
    """A constant on an ancestor, over time."""

    def edit(scene: Scene) -> None:
        primvar = UsdGeom.PrimvarsAPI(scene.parent).CreatePrimvar(name, Types.Float, "constant")
        for time, value in values.items():
            primvar.Set(value, time)

    return edit


def floats(count: int, index: int = 0, value: float = 1.0) -> list[float]:
    """Ones, except for one of them."""
    values = [1.0] * count
    values[index] = value
    return values


def ramp(count: int, low: float, high: float) -> list[float]:
    return np.linspace(low, high, count).tolist()


# ---- Faces ----


def subset(indices: list[int], element: str | None = "face", name: str = PATCH) -> Edit:
    """A GeomSubset in place of the primvar."""

    def edit(scene: Scene) -> None:
        scene.prim.RemoveProperty(f"primvars:{FACES}")
        child = UsdGeom.Subset.Define(scene.stage, f"{MESH}/{name}")
        if element:
            child.CreateElementTypeAttr(element)
        child.CreateIndicesAttr(indices)

    return edit


def on_subset(change: Callable[[UsdGeom.Subset], object]) -> Edit:
    return lambda scene: change(UsdGeom.Subset(scene.stage.GetPrimAtPath(f"{MESH}/{PATCH}")))


# ---- The mesh ----


def point(index: int, value: float, time: float | None = None) -> Edit:
    """The y of one point."""

    def edit(scene: Scene) -> None:
        time_code = Usd.TimeCode.Default() if time is None else Usd.TimeCode(time)
        points = np.array(scene.points.Get(time_code))
        points[index, 1] = value
        scene.points.Set(stages.vectors(points), time_code)

    return edit


def points_as(type_name: Sdf.ValueTypeName) -> Edit:
    """The same points, of another type."""

    def edit(scene: Scene) -> None:
        default, samples = scene.points.Get(), {frame: scene.points.Get(frame) for frame in FRAMES}
        array = type_name.type.pythonClass
        converted = {frame: array(list(map(_vector(type_name), value))) for frame, value in samples.items()}
        retyped("points", type_name, array(list(map(_vector(type_name), default))), converted)(scene)

    return edit


def _vector(type_name: Sdf.ValueTypeName):
    return type_name.scalarType.type.pythonClass


def rest_changed(change: Callable[[np.ndarray], np.ndarray]) -> Edit:
    """primvars:rest, made of what it is (V, 3)."""

    def edit(scene: Scene) -> None:
        rest = scene.prim.GetAttribute("primvars:rest")
        rest.Set(stages.vectors(change(np.array(rest.Get()))))

    return edit


def shuffled(points: np.ndarray) -> np.ndarray:
    """The points in another order."""
    return points[np.random.default_rng(3).permutation(len(points))]


def still(scene: Scene) -> None:
    """Removes the samples of points: they are those of the last frame, over a rest of their own."""
    last = scene.points.Get(FRAMES[-1])
    rest = scene.points.Get()
    scene.points.Clear()
    scene.points.Set(last)
    stages.set_primvar(scene.mesh, "rest", Types.Point3fArray, "vertex", rest)


def topology(**arrays: Callable[[list[int]], list[int]]) -> Edit:
    """Changes counts and indices."""

    def edit(scene: Scene) -> None:
        attributes = {"counts": scene.mesh.GetFaceVertexCountsAttr(), "indices": scene.mesh.GetFaceVertexIndicesAttr()}
        for name, change in arrays.items():
            attributes[name].Set(change(list(attributes[name].Get())))

    return edit


def half_way(scene: Scene) -> None:
    """Puts samples between frames."""
    for frame in (1001.25, 1001.5, 1002.75):
        scene.points.Set(stages.vectors(stages.grid().moved(frame)), frame)


def clips(edit: Callable[[Usd.Prim], None], declare: Callable[[Usd.Prim], None]) -> Edit:
    """Value clips below /World/char: one file, of a mesh that is filled by edit."""

    def author(scene: Scene) -> None:
        for name, fill in (("clip.usda", edit), ("manifest.usda", declare)):
            clip = Usd.Stage.CreateNew(str(scene.folder / name))
            fill(clip.OverridePrim(MESH.replace("/World/char", "/clip")))
            clip.Save()
        api = Usd.ClipsAPI(scene.parent)
        api.SetClipPrimPath("/clip")
        api.SetClipAssetPaths([Sdf.AssetPath("./clip.usda")])
        api.SetClipManifestAssetPath(Sdf.AssetPath("./manifest.usda"))
        api.SetClipActive([(FRAMES[0], 0)])
        api.SetClipTimes([(frame, frame) for frame in FRAMES])

    return author


# ---- Normals, vectors and rates ----

# Names of primvars: vectors that the skin carries, by role the last; rates of points; and what is left as it is.
CARRIED = (
    "normals",
    "normal",
    "N",
    "tangents",
    "bitangents",
    "tangentU",
    "tangentv",
    "binormals",
    "rig:tangent",
    "flow",
)
RATES = ("velocities", "v", "accelerations")
LEFT = ("Nref", "__Nref", "restNormals", "bentNormals", "width")


def directions(
    name: str,
    type_name: Sdf.ValueTypeName = Types.Vector3fArray,
    interpolation: str = "vertex",
    count: int = 49,
    times: Iterable[float | None] = FRAMES,
) -> Edit:
    """A primvar of vectors of any length, others at each time."""
    element, size = _vector(type_name), type_name.scalarType.type.pythonClass.dimension

    def values(time: float | None) -> list:
        numbers = np.random.default_rng(int(time or 0)).normal(size=(count, size))
        return [element(*map(float, each)) for each in numbers]

    return all_of(*(put(name, type_name, interpolation, values(time), time) for time in times))


def of_size(name: str, size: int) -> Edit:
    return lambda scene: UsdGeom.PrimvarsAPI(scene.prim).GetPrimvar(name).SetElementSize(size)


def vectors(attribute: str, count: int, times: Iterable[float | None], value: tuple = (0, 0, 1)) -> Edit:
    """The same vector `count` times, as the normals, velocities or accelerations of a mesh."""

    def edit(scene: Scene) -> None:
        create = {
            "normals": scene.mesh.CreateNormalsAttr,
            "velocities": scene.mesh.CreateVelocitiesAttr,
            "accelerations": scene.mesh.CreateAccelerationsAttr,
        }[attribute]()
        for time in times:
            value_at = stages.vectors(np.tile(value, (count, 1)))
            create.Set(value_at, Usd.TimeCode.Default() if time is None else time)

    return edit


def normals(interpolation: str | None, count: int, times: Iterable[float | None] = FRAMES) -> Edit:
    def edit(scene: Scene) -> None:
        vectors("normals", count, times)(scene)
        if interpolation:
            scene.mesh.SetNormalsInterpolation(interpolation)

    return edit


def one_of(attribute: str, index: int, value: tuple, time: float) -> Edit:
    """Changes one of its vectors at a time."""

    def edit(scene: Scene) -> None:
        found = np.array(scene.prim.GetAttribute(attribute).Get(time))
        found[index] = value
        scene.prim.GetAttribute(attribute).Set(stages.vectors(found), time)

    return edit


# ---- Maps ----


def st(scale: float = 1.0) -> Edit:
    """Texture coordinates by vertex, 0 to `scale` over the sheet."""
    pairs = scale * (stages.grid().points[:, :2] + 0.5)
    return put("st", Types.TexCoord2fArray, "vertex", [Gf.Vec2f(*pair) for pair in pairs.tolist()])


def image(name: str, pixels: np.ndarray | float, channel: str = "R") -> Edit:
    """An OpenEXR file in the folder."""

    def edit(scene: Scene) -> None:
        path = scene.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(encode_exr({channel: np.broadcast_to(np.asarray(pixels, np.float32), (16, 16)).copy()}))

    return edit


def noise(seed: int, low: float, high: float) -> np.ndarray:
    return np.random.default_rng(seed).uniform(low, high, (16, 16))


def mapped(control: str, path: str, time: float | None = None) -> Edit:
    return setting(f"{control}Map", Sdf.AssetPath(path), time)
