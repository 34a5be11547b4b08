"""The left arm: its joints, its hinge and the points that its patches are around. Centimetres, radians."""

from dataclasses import dataclass

import numpy as np

from makers import skinning


@dataclass(frozen=True)
class Arm:
    """Joints (3,) of the rest pose, and the axis (3,) about which a positive angle flexes the elbow."""

    shoulder: np.ndarray
    elbow: np.ndarray
    wrist: np.ndarray

    @property
    def hinge(self) -> np.ndarray:
        """The axis (3,) of the elbow. The arm is a little bent at rest, and bends further in the same plane."""
        return unit(np.cross(self.elbow - self.shoulder, self.wrist - self.elbow))

    @property
    def outward(self) -> np.ndarray:
        """The direction (3,) in which the elbow points: away from both shoulder and wrist."""
        return unit(unit(self.elbow - self.shoulder) + unit(self.elbow - self.wrist))

    @property
    def along(self) -> np.ndarray:
        """The direction (3,) from shoulder to wrist, past the bend."""
        return unit(self.wrist - self.shoulder)

    def flexed(self, angle: float) -> dict[str, np.ndarray]:
        """The bone turns that flex the elbow by `angle` from the rest pose."""
        return {"lowerarm01.L": skinning.turn(self.elbow, self.hinge, angle)}


def left_arm(points: np.ndarray) -> Arm:
    """The arm of a human given by its base mesh points, targets applied."""
    return Arm(*(skinning.joint(points, f"l-{name}") for name in ("shoulder", "elbow", "hand")))


def unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


def farthest(body: np.ndarray, centre: np.ndarray, direction: np.ndarray, within: float) -> int:
    """Of the points of `body` (V, 3) within a distance of `centre`, the one that lies farthest in `direction`."""
    reach = (body - centre) @ direction
    reach[np.linalg.norm(body - centre, axis=1) > within] = -np.inf
    return int(reach.argmax())


def nearest(body: np.ndarray, place: np.ndarray) -> int:
    """The point of `body` (V, 3) nearest to `place` (3,)."""
    return int(np.linalg.norm(body - place, axis=1).argmin())
