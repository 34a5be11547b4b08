"""Textures that cannot be sampled."""

import struct
from collections.abc import Callable

import numpy as np
import OpenEXR
from pxr import Gf, Sdf

from edits import (
    DENSITY,
    INFINITY,
    NAN,
    PLACE,
    Edit,
    Scene,
    Types,
    all_of,
    image,
    indexed,
    mapped,
    nothing,
    painted,
    put,
    removed,
    retyped,
    setting,
    st,
)
from rows import Bad
from skinslide.arrays.images import encode_exr


def with_map(edit: Edit = nothing, control: str = "weight", path: str = "./m.exr") -> Edit:
    return all_of(st(), mapped(control, path), edit)


def with_good_map(edit: Edit) -> Edit:
    return with_map(all_of(image("m.exr", 0.5), edit))


def bytes_of(change: Callable[[bytes], bytes]) -> Edit:
    """A file of 16 x 16 texels, changed."""

    def edit(scene: Scene) -> None:
        (scene.folder / "m.exr").write_bytes(change(encode_exr({"R": np.tile(np.float32([[0.5, 1.0]]), (16, 8))})))

    return with_map(edit)


def with_window(*box: int) -> Edit:
    def change(data: bytes) -> bytes:
        at = data.index(b"dataWindow\0box2i\0") + len(b"dataWindow\0box2i\0") + 4
        return data[:at] + struct.pack("<4i", *box) + data[at + 16 :]

    return bytes_of(change)


def deep(scene: Scene) -> None:
    samples = np.empty((2, 2), dtype=object)
    for place in np.ndindex(2, 2):
        samples[place] = np.ones(1, np.float32)
    header = {"type": OpenEXR.deepscanline, "compression": OpenEXR.ZIPS_COMPRESSION}
    OpenEXR.File(header, {"R": samples}).write(str(scene.folder / "m.exr"))


def whole_numbers(scene: Scene) -> None:
    OpenEXR.File({}, {"R": np.ones((2, 2), np.uint32)}).write(str(scene.folder / "m.exr"))


def coordinates(interpolation: str, value, type_name: Sdf.ValueTypeName = Types.TexCoord2fArray) -> Edit:
    return with_good_map(put("st", type_name, interpolation, value))


AT = f"{PLACE}:weightMap: {{folder}}/m.exr"
IN_TILES = f"{PLACE}:weightMap: {{folder}}/w.<UDIM>.exr"
DENSITY_AT = f"{PLACE}:forceDensityMap: {{folder}}/m.exr"
BROKEN = "not an OpenEXR file, or a truncated or corrupt one"


TEXTURES = [
    Bad("texture: missing", with_map(), f"{AT}: there is no such file"),
    Bad("texture: a folder", with_map(lambda scene: (scene.folder / "m.exr").mkdir()), f"{AT}: cannot be read"),
    Bad("texture: empty", bytes_of(lambda data: b""), f"{AT}: {BROKEN}: the file ends at byte 0"),
    Bad(
        "texture: another format",
        bytes_of(lambda data: b"\x89PNG" + data),
        f"{AT}: {BROKEN}: File is not an OpenEXR file...",
    ),
    Bad("texture: header cut", bytes_of(lambda data: data[:200]), f"{AT}: {BROKEN}: the file ends at byte 200"),
    Bad(
        "texture: texels cut",
        bytes_of(lambda data: data[:-10]),
        f"{AT}: truncated or corrupt: row 0 of 16 cannot be decoded: ...",
    ),
    Bad(
        "texture: corrupt",
        bytes_of(lambda data: data[:-9] + b"\xff" * 9),
        f"{AT}: truncated or corrupt: row 0 of 16 cannot be decoded: ...",
    ),
    Bad("texture: zero-sized", with_window(0, 0, -1, -1), f"{AT}: {BROKEN}: Invalid data window (0, 0 - -1, -1)"),
    Bad(
        "texture: gigantic",
        with_window(0, 0, 99999, 99999),
        f"{AT}: the data window is 100000 x 100000; more texels than 16384 x 16384 are refused",
    ),
    Bad(
        "texture: wrong channel",
        with_good_map(setting("weightMapChannel", "Q")),
        f"{AT}: there is no channel Q; the file has R",
    ),
    Bad("texture: deep", with_map(deep), f"{AT}: the image is deep; flatten it"),
    Bad(
        "texture: whole numbers",
        with_map(whole_numbers),
        f"{AT}: channel R holds whole numbers (uint); it must be half or float",
    ),
    Bad("texture: nan", with_map(image("m.exr", NAN)), f"{AT}: the map is nan at st (0, 0), on face 0"),
    Bad("texture: infinite", with_map(image("m.exr", INFINITY)), f"{AT}: the map is inf at st (0, 0), on face 0"),
    Bad(
        "texture: no st",
        with_good_map(removed("primvars:st")),
        f"has a map, but the mesh has no primvars:st; name one in {PLACE}:mapSt: there are none",
    ),
    Bad(
        "texture: no st of that name",
        with_good_map(setting("mapSt", "uv")),
        f"has a map, but the mesh has no primvars:uv; name one in {PLACE}:mapSt: there are primvars:st",
    ),
    Bad(
        "texture: st length",
        coordinates("vertex", [Gf.Vec2f(0)] * 48),
        "primvars:st has 48 values, but the mesh has 49 points",
    ),
    Bad(
        "texture: st corners",
        coordinates("faceVarying", [Gf.Vec2f(0)] * 49),
        "primvars:st has 49 values, but the mesh has 144 face corners",
    ),
    Bad(
        "texture: st indices",
        with_good_map(
            all_of(
                put("st", Types.TexCoord2fArray, "vertex", [Gf.Vec2f(0), Gf.Vec2f(1)]), indexed("st", [0] * 48 + [2])
            )
        ),
        "primvars:st:indices[48] is 2, but primvars:st has 2 values",
    ),
    Bad(
        "texture: st interpolation",
        coordinates("uniform", [Gf.Vec2f(0)] * 36),
        "primvars:st has interpolation uniform; a map needs faceVarying, vertex or varying",
    ),
    Bad(
        "texture: st type",
        coordinates("vertex", [1.0] * 49, Types.FloatArray),
        "primvars:st is float[]; a map needs pairs of floats",
    ),
    Bad("texture: st nan", coordinates("vertex", [Gf.Vec2f(NAN, 0)] * 49), f"{AT}: face 0 has st (nan, 0)"),
    Bad(
        "texture: type",
        with_good_map(retyped(f"{PLACE}:weightMap", Types.String, "m.exr")),
        f"{PLACE}:weightMap is 'm.exr'; it must be an asset",
    ),
    Bad(
        "texture: type of the channel",
        with_good_map(retyped(f"{PLACE}:weightMapChannel", Types.Int, 3)),
        f"{PLACE}:weightMapChannel is 3; it must be a token",
    ),
    Bad(
        "texture: type of the name of st",
        with_good_map(retyped(f"{PLACE}:mapSt", Types.Int, 3)),
        f"{PLACE}:mapSt is 3; it must be a token",
    ),
    Bad("texture: density, missing", with_map(control="forceDensity"), f"{DENSITY_AT}: there is no such file"),
    Bad(
        "texture: density, wrong channel",
        with_map(all_of(image("m.exr", 1.0), setting("forceDensityMapChannel", "Q")), "forceDensity"),
        f"{DENSITY_AT}: there is no channel Q; the file has R",
    ),
    Bad(
        "texture: type of the density's channel",
        with_map(all_of(image("m.exr", 1.0), retyped(f"{PLACE}:forceDensityMapChannel", Types.Int, 3)), "forceDensity"),
        f"{PLACE}:forceDensityMapChannel is 3; it must be a token",
    ),
    Bad(
        "texture: density, zero",
        with_map(image("m.exr", 0.0), "forceDensity"),
        f"{DENSITY_AT} at point 0 is 0; it must be finite and above 0",
    ),
    Bad(
        "texture: density, negative",
        with_map(image("m.exr", -2.0), "forceDensity"),
        f"{DENSITY_AT} at point 0 is -2; it must be finite and above 0",
    ),
    Bad(
        "texture: density, too large with paint",
        with_map(all_of(image("m.exr", 1e30), painted(DENSITY, "vertex", [1e30] * 49)), "forceDensity"),
        f"primvars:{DENSITY} times {DENSITY_AT} at point 0 is inf; it must be finite and above 0",
    ),
    Bad(
        "texture: missing at a frame",
        all_of(
            st(),
            image("m.exr", 0.5),
            mapped("weight", "./m.exr", 1001),
            mapped("weight", "./gone.exr", 1002),
            mapped("weight", "./m.exr", 1003),
        ),
        f"{PLACE}:weightMap: {{folder}}/gone.exr: there is no such file",
        frame="1002",
    ),
    Bad("texture: no tiles", all_of(st(2), mapped("weight", "./w.<UDIM>.exr")), f"{IN_TILES}: there is no such file"),
    Bad(
        "texture: a tile is missing",
        all_of(st(2), image("w.1001.exr", 0.5), image("w.1002.exr", 0.5), mapped("weight", "./w.<UDIM>.exr")),
        IN_TILES.replace("<UDIM>", "1011") + ": there is no such file, and the patch has texture coordinates in it",
    ),
    Bad(
        "texture: coordinates in no tile",
        all_of(st(-1), image("w.1001.exr", 0.5), mapped("weight", "./w.<UDIM>.exr")),
        f"{IN_TILES}: face 0 has st (-0, -0), which is in no UDIM tile",
    ),
]
