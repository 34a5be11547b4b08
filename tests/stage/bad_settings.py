"""Controls and settings of a patch that cannot be used."""

from pxr import Gf

from edits import (
    DENSITY,
    FARTHEST,
    INFINITY,
    NAN,
    PLACE,
    WEIGHT,
    Edit,
    Types,
    all_of,
    blocked_at,
    floats,
    indexed,
    inherited,
    painted,
    put,
    retyped,
    sampled,
    setting,
)
from rows import Bad


def painted_at_one_frame(name: str, value: float) -> Edit:
    return all_of(
        *(painted(name, "vertex", floats(49), frame) for frame in (1001, 1003)),
        painted(name, "vertex", floats(49, 12, value), 1002),
    )


def edges(pairs: list[int], factors: list[float]) -> Edit:
    return all_of(setting("edges", pairs), setting("edgeForceDensities", factors))


def scheme(name: str, *edits: Edit) -> Edit:
    return all_of(retyped("subdivisionScheme", Types.Token, name), *edits)


CONTROLS = [
    Bad(
        "density: zero",
        painted(DENSITY, "vertex", floats(49, 12, 0)),
        f"primvars:{DENSITY}[12] is 0; it must be finite and above 0",
    ),
    Bad(
        "density: negative",
        painted(DENSITY, "uniform", floats(36, 12, -1)),
        f"primvars:{DENSITY}[12] is -1; it must be finite and above 0",
    ),
    Bad(
        "density: nan",
        painted(DENSITY, "vertex", floats(49, 12, NAN)),
        f"primvars:{DENSITY}[12] is nan; it must be finite and above 0",
    ),
    Bad(
        "density: infinite",
        painted(DENSITY, "vertex", floats(49, 12, INFINITY)),
        f"primvars:{DENSITY}[12] is inf; it must be finite and above 0",
    ),
    Bad(
        "density: constant zero",
        painted(DENSITY, "constant", [0]),
        f"primvars:{DENSITY}[0] is 0; it must be finite and above 0",
    ),
    Bad(
        "density: inherited, negative",
        inherited(DENSITY, -1.0),
        f"primvars:{DENSITY}[0] is -1; it must be finite and above 0",
    ),
    Bad(
        "density: length",
        painted(DENSITY, "vertex", floats(48)),
        f"primvars:{DENSITY} has 48 values, but the mesh has 49 points",
    ),
    Bad(
        "density: length by face",
        painted(DENSITY, "uniform", floats(49)),
        f"primvars:{DENSITY} has 49 values, but the mesh has 36 faces",
    ),
    Bad(
        "density: interpolation",
        painted(DENSITY, "faceVarying", floats(49)),
        f"primvars:{DENSITY} has 49 values, but the mesh has 144 face corners",
    ),
    Bad(
        "density: type",
        put(DENSITY, Types.IntArray, "vertex", [1] * 49),
        f"primvars:{DENSITY} is int[]; it must be float[]",
    ),
    Bad(
        "density: zero at a frame",
        painted_at_one_frame(DENSITY, 0.0),
        f"primvars:{DENSITY}[12] is 0; it must be finite and above 0",
        frame="1002",
    ),
    Bad(
        "max distance: nan",
        painted(FARTHEST, "vertex", floats(49, 12, NAN)),
        f"primvars:{FARTHEST}[12] is nan; it must be 0 or more",
    ),
    Bad(
        "max distance: below 0",
        painted(FARTHEST, "vertex", floats(49, 12, -1.0)),
        f"primvars:{FARTHEST}[12] is -1; it must be 0 or more",
    ),
    Bad(
        "max distance: inherited, below 0",
        inherited(FARTHEST, -1.0),
        f"primvars:{FARTHEST}[0] is -1; it must be 0 or more",
    ),
    Bad(
        "weight: nan",
        painted(WEIGHT, "vertex", floats(49, 12, NAN)),
        f"primvars:{WEIGHT}[12] is nan; it must be a number",
    ),
    Bad(
        "weight: infinite",
        painted(WEIGHT, "vertex", [INFINITY] * 49),
        f"primvars:{WEIGHT}[0] is inf; it must be a number",
    ),
    Bad("weight: inherited, nan", inherited(WEIGHT, NAN), f"primvars:{WEIGHT}[0] is nan; it must be a number"),
    Bad(
        "weight: length",
        painted(WEIGHT, "vertex", floats(50)),
        f"primvars:{WEIGHT} has 50 values, but the mesh has 49 points",
    ),
    Bad(
        "weight: length of one",
        painted(WEIGHT, "vertex", [0.5]),
        f"primvars:{WEIGHT} has 1 values, but the mesh has 49 points",
    ),
    Bad("weight: empty", painted(WEIGHT, "vertex", []), f"primvars:{WEIGHT} has 0 values, but the mesh has 49 points"),
    Bad(
        "weight: two constants",
        painted(WEIGHT, "constant", [0.5, 0.5]),
        f"primvars:{WEIGHT} has interpolation constant but 2 values; is vertex missing?",
    ),
    Bad(
        "weight: no constant",
        painted(WEIGHT, "constant", []),
        f"primvars:{WEIGHT} has interpolation constant but 0 values; is vertex missing?",
    ),
    Bad(
        "weight: interpolation",
        painted(WEIGHT, "uniform", floats(36)),
        f"primvars:{WEIGHT} has interpolation uniform; it must be vertex, faceVarying or constant",
    ),
    Bad(
        "weight: corners",
        painted(WEIGHT, "faceVarying", floats(49)),
        f"primvars:{WEIGHT} has 49 values, but the mesh has 144 face corners",
    ),
    Bad(
        "weight: underscores",
        painted(WEIGHT.replace(":", "_"), "vertex", floats(48)),
        f"primvars:{WEIGHT.replace(':', '_')} has 48 values, but the mesh has 49 points",
    ),
    Bad(
        "paint: a channel that is none",
        retyped(f"{PLACE}:paintChannel", Types.Token, "red"),
        f"{PLACE}:paintChannel is 'red'; it must be one of none, r, g, b, a",
    ),
    Bad(
        "paint: a channel that colours have not",
        all_of(put(WEIGHT, Types.Color3fArray, "vertex", [Gf.Vec3f(1)] * 49), setting("paintChannel", "a")),
        f"primvars:{WEIGHT} is color3f[], which has no channel a; {PLACE}:paintChannel names it",
    ),
    Bad(
        "paint: folding that is neither",
        retyped("skinSlide:foldCase", Types.Token, "yes"),
        "skinSlide:foldCase is 'yes'; it must be a bool",
        None,
    ),
    Bad(
        "weight: indexed badly",
        all_of(painted(WEIGHT, "vertex", [0.5]), indexed(WEIGHT, [0] * 48 + [1])),
        f"primvars:{WEIGHT}:indices[48] is 1, but primvars:{WEIGHT} has 1 values",
    ),
    Bad(
        "weight: nan at a frame",
        painted_at_one_frame(WEIGHT, NAN),
        f"primvars:{WEIGHT}[12] is nan; it must be a number",
        frame="1002",
    ),
    Bad(
        "weight: blocked at a frame",
        all_of(
            painted(WEIGHT, "vertex", floats(49), 1001),
            painted(WEIGHT, "vertex", floats(49), 1003),
            blocked_at(f"primvars:{WEIGHT}", 1002),
        ),
        f"primvars:{WEIGHT} has no value",
        frame="1002",
    ),
    Bad("envelope: nan", setting("envelope", NAN), f"{PLACE}:envelope is nan"),
    Bad(
        "envelope: nan at a frame",
        sampled("envelope", {1001: 1.0, 1002: NAN, 1003: 1.0}),
        f"{PLACE}:envelope is nan",
        frame="1002",
    ),
    Bad("edges: odd", edges([0, 1, 2], [1.0]), f"{PLACE}:edges has 3 values; it must hold pairs of point indices"),
    Bad(
        "edges: lengths",
        edges([0, 1, 1, 2], [1.0]),
        f"{PLACE}:edgeForceDensities has 1 values, but {PLACE}:edges has 2 pairs",
    ),
    Bad(
        "edges: no factors",
        setting("edges", [0, 1]),
        f"{PLACE}:edgeForceDensities has 0 values, but {PLACE}:edges has 1 pairs",
    ),
    Bad(
        "edges: factors alone",
        setting("edgeForceDensities", [1.0]),
        f"{PLACE}:edgeForceDensities has 1 values, but {PLACE}:edges has 0 pairs",
    ),
    Bad(
        "edges: factor",
        edges([0, 1, 1, 2], [1.0, 0.0]),
        f"{PLACE}:edgeForceDensities[1], for edge 1-2, is 0; it must be finite and above 0",
    ),
    Bad(
        "edges: factor at a frame",
        all_of(setting("edges", [0, 1]), sampled("edgeForceDensities", {1001: [1.0], 1002: [-1.0], 1003: [1.0]})),
        f"{PLACE}:edgeForceDensities[0], for edge 0-1, is -1; it must be finite and above 0",
        frame="1002",
    ),
    Bad("edges: of no face", edges([0, 8], [2.0]), "0-8 is not an edge of the patch"),
    Bad("edges: no such point", edges([0, 99], [2.0]), "0-99 is not an edge of the patch"),
    Bad(
        "edges: change",
        all_of(sampled("edges", {1001: [0, 1], 1002: [1, 2]}), setting("edgeForceDensities", [2.0])),
        f"{PLACE}:edges changes at frame 1002; it must stay the same over time",
    ),
    Bad(
        "weight: indexed badly at a frame",
        all_of(
            painted(WEIGHT, "vertex", [0.5]),
            *(indexed(WEIGHT, [0] * 48 + [last], frame) for frame, last in ((1001, 0), (1002, 9), (1003, 0))),
        ),
        f"primvars:{WEIGHT}:indices[48] is 9, but primvars:{WEIGHT} has 1 values",
        frame="1002",
    ),
]


SETTINGS = [
    Bad("corners: two", setting("corners", [1, 2]), f"{PLACE}:corners has 2 values; it must have 4"),
    Bad("corners: three", setting("corners", [0, 6, 48]), f"{PLACE}:corners has 3 values; it must have 4"),
    Bad("corners: repeated", setting("corners", [0, 6, 48, 6]), f"{PLACE}:corners has point 6 more than once"),
    Bad("corners: inside", setting("corners", [0, 6, 48, 24]), "corner 24 is not on its outer boundary"),
    Bad(
        "corners: no such point",
        setting("corners", [0, 6, 48, 49]),
        f"{PLACE}:corners[3] is 49, but the mesh has 49 points",
    ),
    Bad(
        "corners: negative",
        setting("corners", [-1, 6, 48, 42]),
        f"{PLACE}:corners[0] is -1, but the mesh has 49 points",
    ),
    Bad(
        "corners: change",
        sampled("corners", {1001: [0, 6, 48, 42], 1002: [0, 6, 48, 41]}),
        f"{PLACE}:corners changes at frame 1002; it must stay the same over time",
    ),
    Bad(
        "token: boundary",
        setting("boundary", "oval"),
        f"{PLACE}:boundary is 'oval'; it must be one of auto, square, circle",
    ),
    Bad(
        "token: of another case",
        setting("boundary", "Square"),
        f"{PLACE}:boundary is 'Square'; it must be one of auto, square, circle",
    ),
    Bad("token: empty", setting("boundary", ""), f"{PLACE}:boundary is ''; it must be one of auto, square, circle"),
    Bad("token: holes", setting("holes", "open"), f"{PLACE}:holes is 'open'; it must be one of pinned, free, freeAll"),
    Bad(
        "token: rule",
        setting("forceDensityRule", "slow"),
        f"{PLACE}:forceDensityRule is 'slow'; it must be one of unit, fast, relaxed, even",
    ),
    Bad(
        "token: interpolation",
        setting("interpolation", "cubic"),
        f"{PLACE}:interpolation is 'cubic'; it must be one of auto, linear, meanValue, limit",
    ),
    Bad(
        "interpolation: limit of no subdivision",
        setting("interpolation", "limit"),
        "interpolation limit needs a mesh that is subdivided",
    ),
    Bad(
        "subdivision: scheme",
        scheme("butterfly"),
        "subdivisionScheme is 'butterfly'; it must be one of none, catmullClark, loop, bilinear",
        None,
    ),
    Bad(
        "subdivision: scheme changes",
        lambda scene: [
            scene.mesh.GetSubdivisionSchemeAttr().Set(token, frame) for token, frame in (("none", 1001), ("loop", 1002))
        ],
        "subdivisionScheme changes at frame 1002; it must stay the same over time",
        None,
    ),
    Bad("subdivision: loop of quads", scheme("loop"), "face 0 has 4 vertices; the loop scheme needs triangles", None),
    Bad(
        "subdivision: boundary rule",
        scheme("catmullClark", retyped("interpolateBoundary", Types.Token, "x")),
        "interpolateBoundary is 'x'; it must be one of edgeAndCorner, edgeOnly, none",
        None,
    ),
    Bad(
        "subdivision: triangle rule",
        scheme("catmullClark", retyped("triangleSubdivisionRule", Types.Token, "x")),
        "triangleSubdivisionRule is 'x'; it must be one of catmullClark, smooth",
        None,
    ),
    Bad(
        "subdivision: crease lengths",
        scheme("catmullClark", lambda scene: scene.mesh.CreateCreaseLengthsAttr([3])),
        "crease lengths add up to 3, but there are 0 crease indices",
        None,
    ),
    Bad(
        "subdivision: crease of no edge",
        scheme(
            "catmullClark",
            lambda scene: [
                scene.mesh.CreateCreaseLengthsAttr([2]),
                scene.mesh.CreateCreaseIndicesAttr([0, 8]),
                scene.mesh.CreateCreaseSharpnessesAttr([1.0]),
            ],
        ),
        "crease 0: 0-8 is not an edge of the mesh",
        None,
    ),
    Bad(
        "subdivision: crease type",
        scheme("catmullClark", retyped("creaseIndices", Types.FloatArray, [1.0])),
        "creaseIndices is not an array of int",
        None,
    ),
    Bad(
        "subdivision: corner sharpnesses",
        scheme("catmullClark", lambda scene: scene.mesh.CreateCornerIndicesAttr([24])),
        "corner sharpnesses: 0 values for 1 corners",
        None,
    ),
    Bad(
        "subdivision: holes of the patch",
        scheme("catmullClark", lambda scene: scene.mesh.CreateHoleIndicesAttr([0])),
        "face 0 has no limit surface: it is one of holeIndices",
    ),
]
