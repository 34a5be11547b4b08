"""What the rule even cannot slide, and settings of its own that cannot be."""

import numpy as np

import stages
from edits import (
    HOLD,
    NAN,
    PLACE,
    Types,
    all_of,
    even,
    floats,
    image,
    mapped,
    painted,
    retyped,
    sampled,
    setting,
    st,
)
from rows import Bad

HOLD_AT = f"{PLACE}:holdMap: {{folder}}/m.exr"


def wound_apart() -> stages.Shape:
    return stages.from_faces([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (1, 2, 3)])


def middle() -> np.ndarray:
    return stages.block(6, range(2, 4), range(2, 4))


EVEN = [
    Bad("even: three faces at an edge", even, "edge 0-1 has 3 faces", shape=stages.fin),
    Bad(
        "even: faces against each other",
        even,
        "faces 0 and 1 are wound against each other at edge 1-2",
        shape=wound_apart,
    ),
    Bad("even: in one place", even, "all its rest points are in one place", shape=lambda: stages.grid(size=0)),
    Bad(
        "holes: all free, by a rule in the plane",
        setting("holes", "freeAll"),
        "holes freeAll, which frees the outer boundary too, needs rule relaxed or even",
        faces=stages.annulus,
    ),
    Bad(
        "hold: zero",
        all_of(even, painted(HOLD, "vertex", floats(49, 12, 0))),
        f"primvars:{HOLD}[12] is 0; it must be finite and above 0",
    ),
    Bad(
        "hold: nan, whatever the rule",
        painted(HOLD, "constant", [NAN]),
        f"primvars:{HOLD}[0] is nan; it must be finite and above 0",
    ),
    Bad(
        "hold: length",
        painted(HOLD, "vertex", floats(48)),
        f"primvars:{HOLD} has 48 values, but the mesh has 49 points",
    ),
    Bad(
        "hold: interpolation",
        painted(HOLD, "uniform", floats(36)),
        f"primvars:{HOLD} has interpolation uniform; it must be vertex, faceVarying or constant",
    ),
    Bad("hold: a map that is missing", all_of(st(), mapped("hold", "./m.exr")), f"{HOLD_AT}: there is no such file"),
    Bad(
        "hold: a map of zeros",
        all_of(st(), image("m.exr", 0.0), mapped("hold", "./m.exr")),
        f"{HOLD_AT} at point 0 is 0; it must be finite and above 0",
    ),
    Bad(
        "hold: type of the channel",
        all_of(st(), image("m.exr", 1.0), mapped("hold", "./m.exr"), retyped(f"{PLACE}:holdMapChannel", Types.Int, 3)),
        f"{PLACE}:holdMapChannel is 3; it must be a token",
    ),
    Bad("response: above 1", setting("stretchResponse", 1.5), f"{PLACE}:stretchResponse is 1.5; it must be 0 to 1"),
    Bad("response: nan", setting("stretchResponse", NAN), f"{PLACE}:stretchResponse is nan; it must be 0 to 1"),
    Bad(
        "response: below 0 at a frame",
        all_of(even, sampled("compressionResponse", {1001: 1.0, 1002: -1.0, 1003: 1.0})),
        f"{PLACE}:compressionResponse is -1; it must be 0 to 1",
        frame="1002",
    ),
    Bad(
        "response: type",
        retyped(f"{PLACE}:compressionResponse", Types.String, "much"),
        f"{PLACE}:compressionResponse is 'much'; it must be a float",
    ),
    Bad("grow: below 0", setting("grow", -1.0), f"{PLACE}:grow is -1; it must be 0 or more"),
    Bad("grow: nan", setting("grow", NAN), f"{PLACE}:grow is nan; it must be 0 or more"),
    Bad("grow: type", retyped(f"{PLACE}:grow", Types.Token, "far"), f"{PLACE}:grow is 'far'; it must be a float"),
    Bad(
        "grow: changes",
        all_of(even, sampled("grow", {1001: 0.1, 1002: 0.3})),
        f"{PLACE}:grow changes at frame 1002; it must stay the same over time",
        faces=middle,
    ),
    Bad(
        "grow: onto faces that cannot be",
        all_of(even, setting("grow", 3.0)),
        "edge 0-1 has 3 faces",
        shape=stages.fin,
        faces=lambda: np.arange(1),
    ),
]
