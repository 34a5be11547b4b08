"""Where the readers are not yet as the tables say: of each row, what is wrong today. A mend deletes its line here."""

# ---- What the tool says otherwise ----

_CHECK_WORDS_IT = "check has its own words for what the core says"

TOOL = {
    "subset: inactive": "an inactive prim counts",
    "points: nan at a frame": _CHECK_WORDS_IT,
    "points: infinite at a frame": _CHECK_WORDS_IT,
}

# ---- What a layer computes or says otherwise ----

_INHERITED = "an inherited constant does not count"
_WRAPS = "a whole number beyond an int wraps around"
_NO_PATCH = "at a frame the patch is not named"
_LEFT = "left as they are, neither blocked nor right"
_UNTOLD = "blocked without a word"
_REST = "the interpolation of a rest primvar is not looked at"
_TYPE = "declared as normal3f[], whatever type the stage has"
_NO_FILE = "the map's file is not named"
_OFFSET = "the offset of a sublayer of the file itself is lost"

LAYER = {
    # other bytes
    "weight: inherited": _INHERITED,
    "weight: inherited, 0": _INHERITED,
    "weight: inherited, an array of one": _INHERITED,
    "weight: inherited over time": _INHERITED,
    "weight: inherited, nan": _INHERITED,
    "weight: blocked on the mesh": _INHERITED,
    "max distance: inherited": _INHERITED,
    "max distance: inherited, 0": _INHERITED,
    "max distance: inherited, below 0": _INHERITED,
    "density: inherited, negative": _INHERITED,
    "times: an offset and a scale of the sublayer": _OFFSET,
    "times: a scale of a third": _OFFSET,
    "texture: texture coordinates over time": "between samples texture coordinates are held, not interpolated",
    "envelope: by value clips": "value clips of what is not points are passed over in silence",
    "points: baked already": "the mark of a bake is not looked at, and points slide twice",
    "points: joint indices that are not inherited": "joint indices of any interpolation are inherited",
    "points: blend shapes without targets": "a relationship without targets counts as skinning",
    "rest: by corner": _REST,
    "rest: by face": _REST,
    "rest: constant": _REST,
    "type: corners beyond int": _WRAPS,
    "type: corners, unsigned beyond int": _WRAPS,
    "type: counts beyond int": _WRAPS,
    "type: indices beyond int": _WRAPS,
    "type: edges beyond int": _WRAPS,
    "type: subset beyond int": _WRAPS,
    "type: creases beyond int": _WRAPS,
    "type: holes beyond int": _WRAPS,
    "type: edge factors, no array": "a number counts as an array of one",
    "points: left-handed by a string, with normals": "a string is no token there, as it is elsewhere",
    "normals: a primvar of doubles": _TYPE,
    "normals: a primvar of another kind": _TYPE,
    "subset: inactive": "an inactive prim counts",
    "normals: of a wrong length": _LEFT,
    "normals: of a wrong length at a frame": _LEFT,
    "normals: a primvar of a wrong length": _LEFT,
    "normals: of no interpolation": _LEFT,
    "normals: indexed badly": _LEFT,
    "normals: blocked at a frame": _LEFT,
    "velocities: blocked at a frame": _LEFT,
    "velocities: of a wrong length": _LEFT,
    "velocities: no time codes per second": _LEFT,
    # the same bytes, but not a word
    "velocities: at other times": _UNTOLD,
    "velocities: without samples": _UNTOLD,
    "velocities: of a still cache": _UNTOLD,
    "accelerations: of two samples": _UNTOLD,
    "prim: no patch name": "passed over in silence",
    # other words
    "prim: empty patch name": "read as a patch called nothing",
    "prim: point instancer": "not what to do about it",
    "payload: missing": "neither the prim nor that it is composition that failed",
    "type: envelope": "the value without quotes",
    "texture: type": "the value without quotes",
    "corners: no such point": "not which of the corners",
    "corners: negative": "not which of the corners",
    "density: zero at a frame": _NO_PATCH,
    "weight: nan at a frame": _NO_PATCH,
    "weight: blocked at a frame": _NO_PATCH,
    "weight: indexed badly at a frame": _NO_PATCH,
    "envelope: nan at a frame": _NO_PATCH,
    "edges: factor at a frame": _NO_PATCH,
    "texture: missing at a frame": _NO_PATCH,
    "texture: density, zero": _NO_FILE,
    "texture: density, negative": _NO_FILE,
    "texture: density, too large with paint": _NO_FILE,
    "texture: no tiles": "a tile where no tile is there",
    "texture: a tile is missing": "not that the patch needs it",
}
