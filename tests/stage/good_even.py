"""The rule even: patches of any faces, what is painted for it, and what grows a patch."""

import numpy as np

import stages
from edits import (
    DENSITY,
    FARTHEST,
    HOLD,
    INFINITY,
    NAN,
    WEIGHT,
    Edit,
    Scene,
    all_of,
    even,
    floats,
    image,
    inherited,
    mapped,
    noise,
    painted,
    ramp,
    sampled,
    setting,
    st,
)
from rows import Good
from stages import FRAMES


def with_points(change, *frames: float | None) -> Edit:
    """Points of frames, or at rest for None, changed."""

    def edit(scene: Scene) -> None:
        for frame in frames:
            points = change(np.array(scene.points.Get() if frame is None else scene.points.Get(frame)))
            scene.points.Set(stages.vectors(points), *([] if frame is None else [frame]))

    return edit


def in_one_place(points: np.ndarray) -> np.ndarray:
    return np.zeros_like(points) + points[0]


def some_in_one_place(points: np.ndarray) -> np.ndarray:
    """A face of no area, one on a line, and a spike."""
    points[[16, 17, 23, 24]] = points[16]
    points[38] = points[37]
    points[10] += (0, 0, 30)
    return points


def noisy(points: np.ndarray) -> np.ndarray:
    return points + np.random.default_rng(1).uniform(-0.1, 0.1, points.shape)


def apart() -> stages.Shape:
    """Triangles that share no point."""
    points = [(3 * k + x, y, 0) for k in range(4) for x, y in ((0, 0), (1, 0), (0, 1))]
    return stages.from_faces(points, [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(4)])


def map_of_hold(scene: Scene) -> None:
    st()(scene)
    image("h.exr", noise(7, 0.5, 4), "Z")(scene)
    mapped("hold", "./h.exr")(scene)
    setting("holdMapChannel", "Z")(scene)
    painted(HOLD, "vertex", ramp(49, 2, 0.5))(scene)


def smooth(scene: Scene) -> None:
    scene.mesh.GetSubdivisionSchemeAttr().Set("catmullClark")


def middle() -> np.ndarray:
    return stages.block(6, range(2, 4), range(2, 4))


EVEN = [
    Good("even", even),
    Good("even: a box", even, shape=stages.box),
    Good("even: a torus", even, shape=stages.torus),
    Good("even: a torus, meanValue", all_of(even, setting("interpolation", "meanValue")), shape=stages.torus),
    Good("even: a torus, limit", all_of(even, smooth), shape=stages.torus),
    Good("even: two pieces", even, faces=stages.two_pieces),
    Good("even: pinched", even, shape=lambda: stages.grid(3, 3), faces=stages.pinched, slides=False),
    Good("even: nothing is free", even, faces=lambda: np.arange(1), slides=False),
    Good("even: triangles apart", even, shape=apart, slides=False),
    Good("even: holes", even, faces=stages.annulus),
    Good("even: holes that are free", all_of(even, setting("holes", "free")), faces=stages.annulus),
    Good("even: all boundaries are free", all_of(even, setting("holes", "freeAll")), faces=stages.annulus),
    Good("even: corners and boundary", all_of(even, setting("boundary", "square"), setting("corners", [0, 6, 48, 42]))),
    Good("even: rest with faces of no area", all_of(even, with_points(some_in_one_place, None))),
    Good(
        "even: a pose in one place",
        all_of(even, with_points(in_one_place, FRAMES[1])),
        warns="84 edges of no length, taken as 1e-6 of the mean rest edge",
    ),
    Good("even: noise", all_of(even, with_points(noisy, FRAMES[1]))),
    Good("even: far away", all_of(even, with_points(lambda points: points + 1e4, None, *FRAMES))),
    Good("even: weight", all_of(even, painted(WEIGHT, "vertex", ramp(49, 0, 1)))),
    Good("even: max distance", all_of(even, painted(FARTHEST, "vertex", ramp(49, 0, 0.05)))),
    Good("even: densities over ten decades", all_of(even, painted(DENSITY, "vertex", np.logspace(-5, 5, 49)))),
    Good(
        "even: densities over time",
        all_of(
            even, painted(DENSITY, "uniform", ramp(36, 1, 5), 1001), painted(DENSITY, "uniform", ramp(36, 5, 1), 1003)
        ),
    ),
    Good("hold: by vertex", all_of(even, painted(HOLD, "vertex", ramp(49, 0.2, 5)))),
    Good("hold: constant", all_of(even, painted(HOLD, "constant", [5.0]))),
    Good("hold: inherited", all_of(even, inherited(HOLD, 5.0))),
    Good(
        "hold: over time",
        all_of(even, painted(HOLD, "vertex", ramp(49, 1, 5), 1001), painted(HOLD, "vertex", ramp(49, 5, 1), 1003)),
    ),
    Good(
        "hold: 0 off the patch", all_of(even, painted(HOLD, "vertex", floats(49, 48, 0.0))), faces=lambda: np.arange(30)
    ),
    Good("hold: a map, times paint", all_of(even, map_of_hold)),
    Good("hold: by another rule it counts for nothing", painted(HOLD, "vertex", ramp(49, 0.2, 5))),
    Good("response: to stretch", all_of(even, setting("stretchResponse", 0.25))),
    Good("response: to compression, over time", all_of(even, sampled("compressionResponse", {1001: 1.0, 1003: 0.0}))),
    Good("grow", all_of(even, setting("grow", 0.3)), faces=middle),
    Good("grow: without end", all_of(even, setting("grow", INFINITY)), faces=middle),
    Good("grow: none", all_of(even, setting("grow", 0.0)), faces=middle),
    Good("grow: relaxed", all_of(setting("forceDensityRule", "relaxed"), setting("grow", 0.3)), faces=middle),
    Good("grow: by a rule in the plane it counts for nothing", setting("grow", 0.3), faces=middle),
    Good(
        "grow: paint off the patch",
        all_of(even, setting("grow", 0.2), painted(WEIGHT, "vertex", floats(49, 0, NAN))),
        faces=middle,
    ),
]
