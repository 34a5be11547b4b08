"""Textures, every way they can be found and sampled."""

import numpy as np
from pxr import Gf

from edits import (
    DENSITY,
    PLACE,
    WEIGHT,
    Scene,
    Types,
    all_of,
    blocked,
    blocked_at,
    image,
    indexed,
    inherited,
    mapped,
    noise,
    over,
    painted,
    put,
    ramp,
    setting,
    st,
    text,
)
from layers import CLOCK, HEAD
from rows import Good
from stages import FRAMES


def udim(scene: Scene) -> None:
    """The sheet covers 2 x 2 tiles."""
    st(2)(scene)
    for tile in (1001, 1002, 1011, 1012):
        image(f"tex/q.{tile}.exr", noise(tile, 0.2, 5))(scene)
    mapped("forceDensity", "./tex/q.<UDIM>.exr")(scene)


def map_by_corner(scene: Scene) -> None:
    """Indexed, by another name, with a seam down the middle."""
    column = np.repeat(np.arange(36) % 6, 4)
    put("uv2", Types.Float2Array, "faceVarying", [Gf.Vec2f(0.1, 0.9), Gf.Vec2f(0.9, 0.2)])(scene)
    indexed("uv2", (column >= 3).astype(int).tolist())(scene)
    setting("mapSt", "uv2")(scene)
    image("w.exr", noise(1, 0, 1), "mask")(scene)
    mapped("weight", "./w.exr")(scene)
    setting("weightMapChannel", "mask")(scene)


def maps_over_time(scene: Scene) -> None:
    st()(scene)
    for frame in FRAMES:
        image(f"w.{frame:.0f}.exr", noise(int(frame), 0, 1))(scene)
        mapped("weight", f"./w.{frame:.0f}.exr", frame)(scene)
    painted(WEIGHT, "vertex", ramp(49, 0.2, 1))(scene)


def density_map_times_paint(scene: Scene) -> None:
    st()(scene)
    image("q.exr", noise(7, 0.2, 5), "Z")(scene)
    mapped("forceDensity", "./q.exr")(scene)
    setting("forceDensityMapChannel", "Z")(scene)
    inherited(DENSITY, 3.0)(scene)


TEXTURES = [
    Good("texture: of densities", density_map_times_paint),
    Good("texture: of weights, by corner and indexed", map_by_corner),
    Good("texture: of weights, over time and times paint", maps_over_time),
    Good("texture: UDIM", udim),
    Good("texture: an empty path is none", mapped("weight", "")),
    Good("texture: blocked", all_of(st(), mapped("weight", "./gone.exr"), blocked(f"{PLACE}:weightMap"))),
    Good(
        "texture: texture coordinates over time",
        all_of(
            st(),
            image("w.exr", noise(3, 0, 1)),
            mapped("weight", "./w.exr"),
            *(
                put("st", Types.TexCoord2fArray, "vertex", [Gf.Vec2f(k / 49, frame - 1001) for k in range(49)], frame)
                for frame in (1001.0, 1002.5)
            ),
        ),
    ),
    Good(
        "texture: none at a sample",
        all_of(
            st(),
            image("w.exr", noise(3, 0, 1)),
            *(mapped("weight", "./w.exr", frame) for frame in (1001, 1003)),
            blocked_at(f"{PLACE}:weightMap", 1002),
        ),
    ),
    Good(
        "texture: none at first",
        all_of(
            st(),
            image("w.exr", noise(3, 0, 1)),
            mapped("weight", "./w.exr", 1002),
            blocked_at(f"{PLACE}:weightMap", 1001),
        ),
    ),
    Good(
        "texture: one over time beside one that is not",
        all_of(
            st(),
            image("q.exr", noise(7, 0.2, 5)),
            mapped("forceDensity", "./q.exr"),
            *(image(f"w.{frame:.0f}.exr", noise(int(frame), 0, 1)) for frame in FRAMES),
            *(mapped("weight", f"./w.{frame:.0f}.exr", frame) for frame in FRAMES),
        ),
    ),
    Good(
        "texture: double coordinates",
        all_of(
            put("st", Types.TexCoord2dArray, "vertex", [Gf.Vec2d(k / 49, 0.3) for k in range(49)]),
            image("w.exr", noise(3, 0, 1)),
            mapped("weight", "./w.exr"),
        ),
    ),
    Good(
        "texture: by an expression",
        all_of(st(), image("w.exr", noise(5, 0, 1)), mapped("weight", '`"./${MAP}.exr"`')),
        file=text(head=f'{HEAD}; {CLOCK}; expressionVariables = {{ string MAP = "w" }}'),
    ),
    Good(
        "texture: named by the file itself",
        all_of(st(), image("tex/w.exr", noise(4, 0, 1))),
        file=text(body=over(f"asset {PLACE}:weightMap = @./tex/w.exr@")),
    ),
]
