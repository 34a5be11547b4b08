"""The left hand: the joints of its fingers, 1 the thumb to 5, and how they curl. Centimetres, radians."""

from collections.abc import Sequence

import numpy as np

from makers import skinning
from makers.arm import unit


def finger(points: np.ndarray, number: int) -> np.ndarray:
    """Where a finger's joints lie, (4, 3), from the knuckle to the tip, in the base mesh with its targets applied."""
    return np.array([skinning.joint(points, f"l-finger-{number}-{joint}") for joint in range(1, 5)])


def hinge(joints: np.ndarray) -> np.ndarray:
    """The axis (3,) of a finger's joints (4, 3): it is a little curled at rest, and curls further in that plane."""
    return unit(np.cross(joints[1] - joints[0], joints[3] - joints[2]))


def curled(points: np.ndarray, number: int, angles: Sequence[float]) -> dict[str, np.ndarray]:
    """The bone turns that curl a finger by `angles` at its three joints."""
    joints = finger(points, number)
    return {
        f"finger{number}-{joint}.L": skinning.turn(pivot, hinge(joints), angle)
        for joint, (pivot, angle) in enumerate(zip(joints[:3], angles, strict=True), start=1)
    }
