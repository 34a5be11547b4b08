"""Values of types that nothing is made of."""

from pxr import Gf, Vt

from edits import FARTHEST, PLACE, WEIGHT, Types, all_of, put, retyped, setting, subset
from rows import Bad
from stages import MESH, PATCH

TYPES = [
    Bad(
        "type: envelope",
        retyped(f"{PLACE}:envelope", Types.String, "x"),
        f"{PLACE}:envelope is 'x'; it must be a float",
    ),
    Bad(
        "type: envelope, an array",
        retyped(f"{PLACE}:envelope", Types.FloatArray, [0.5]),
        f"{PLACE}:envelope is [0.5]; it must be a float",
    ),
    Bad("type: corners", retyped(f"{PLACE}:corners", Types.Float, 1.0), f"{PLACE}:corners is not an array of int"),
    Bad(
        "type: corners beyond int",
        retyped(f"{PLACE}:corners", Types.Int64Array, Vt.Int64Array([1 << 32, 6, 48, 42])),
        f"{PLACE}:corners has a value that does not fit an int",
    ),
    Bad(
        "type: corners, unsigned beyond int",
        retyped(f"{PLACE}:corners", Types.UIntArray, Vt.UIntArray([(1 << 32) - 1, 6, 48, 42])),
        f"{PLACE}:corners has a value that does not fit an int",
    ),
    Bad("type: edges", retyped(f"{PLACE}:edges", Types.StringArray, ["x"]), f"{PLACE}:edges is not an array of int"),
    Bad(
        "type: edge factors",
        all_of(setting("edges", [0, 1]), retyped(f"{PLACE}:edgeForceDensities", Types.IntArray, [1])),
        f"{PLACE}:edgeForceDensities is not an array of float",
    ),
    Bad(
        "type: edges beyond int",
        all_of(
            retyped(f"{PLACE}:edges", Types.Int64Array, Vt.Int64Array([16 + (1 << 32), 17])),
            setting("edgeForceDensities", [4.0]),
        ),
        f"{PLACE}:edges has a value that does not fit an int",
    ),
    Bad(
        "type: edge factors, no array",
        all_of(setting("edges", [16, 17]), retyped(f"{PLACE}:edgeForceDensities", Types.Float, 4.0)),
        f"{PLACE}:edgeForceDensities is not an array of float",
    ),
    Bad(
        "type: boundary",
        retyped(f"{PLACE}:boundary", Types.Int, 1),
        f"{PLACE}:boundary is '1'; it must be one of auto, square, circle",
    ),
    Bad("type: points", retyped("points", Types.Int, 1), "points is not an array of points", None),
    Bad(
        "type: points of four",
        retyped("points", Types.Float4Array, [Gf.Vec4f(0)] * 49),
        "points is not an array of points",
        None,
    ),
    Bad("type: counts", retyped("faceVertexCounts", Types.Float, 1.0), "faceVertexCounts is not an array of int", None),
    Bad(
        "type: counts beyond int",
        retyped("faceVertexCounts", Types.Int64Array, Vt.Int64Array([(1 << 32) + 4] + [4] * 35)),
        "faceVertexCounts has a value that does not fit an int",
        None,
    ),
    Bad(
        "type: indices beyond int",
        retyped("faceVertexIndices", Types.Int64Array, Vt.Int64Array([1 << 32] * 144)),
        "faceVertexIndices has a value that does not fit an int",
        None,
    ),
    Bad("type: rest", put("rest", Types.StringArray, "vertex", ["x"]), "primvars:rest is not an array of points", None),
    Bad(
        "type: rest of whole numbers",
        put("rest", Types.Int3Array, "vertex", [Gf.Vec3i(0)] * 49),
        "primvars:rest is not an array of points",
        None,
    ),
    Bad(
        "type: weight, double beyond float",
        put(WEIGHT, Types.DoubleArray, "vertex", Vt.DoubleArray([1.0] * 48 + [1e300])),
        f"primvars:{WEIGHT}[48] is 1e+300; it must be a number",
    ),
    Bad(
        "type: max distance, whole numbers",
        put(FARTHEST, Types.IntArray, "vertex", Vt.IntArray([1] * 49)),
        f"primvars:{FARTHEST} is int[]; it must be float[]",
    ),
    Bad(
        "type: weight, a colour without a channel",
        put(WEIGHT, Types.Color3fArray, "vertex", [Gf.Vec3f(1)] * 49),
        f"primvars:{WEIGHT} is color3f[]; it must be float[], or "
        f"{PLACE}:paintChannel must name the channel that counts",
    ),
    Bad(
        "type: subset beyond int",
        all_of(subset([0]), retyped("indices", Types.Int64Array, Vt.Int64Array([1 << 32]), at=f"{MESH}/{PATCH}")),
        f"{MESH}/{PATCH}.indices has a value that does not fit an int",
    ),
    Bad(
        "type: creases beyond int",
        all_of(
            retyped("subdivisionScheme", Types.Token, "catmullClark"),
            retyped("creaseIndices", Types.Int64Array, Vt.Int64Array([1 << 32, 1])),
            retyped("creaseLengths", Types.IntArray, [2]),
            retyped("creaseSharpnesses", Types.FloatArray, [1.0]),
        ),
        "creaseIndices has a value that does not fit an int",
        None,
    ),
    Bad(
        "type: holes beyond int",
        all_of(
            retyped("subdivisionScheme", Types.Token, "catmullClark"),
            retyped("holeIndices", Types.Int64Array, Vt.Int64Array([1 << 32])),
        ),
        "holeIndices has a value that does not fit an int",
        None,
    ),
    Bad(
        "type: subset",
        all_of(subset([0]), retyped("indices", Types.FloatArray, [1.0], at=f"{MESH}/{PATCH}")),
        f"{MESH}/{PATCH}.indices is not an array of int",
    ),
]
