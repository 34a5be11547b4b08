"""The joints of a rig by the names that artists call them."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from skinslide.problems import Fault, in_place_of
from skinslide.stage.sides import OTHER_SIDE

# Of a joint's weight: exporters leave less than this where they round.
LEAST_WEIGHT = 0.01
# A letter stands alone, as in arm_L; a word may be part of another, as in LeftForeArm.
_WORDS = "|".join(word for word in OTHER_SIDE if len(word) > 1)
_SIDE = re.compile(rf"{_WORDS}|(?<![A-Za-z0-9])[LRlr](?![A-Za-z0-9])")


@dataclass(frozen=True)
class Rig:
    """The joints that move a mesh, and how much; places and points are in the mesh's space, in the pose of binding."""

    joints: list[str]
    parents: np.ndarray  # (J,) int32, -1 of a root
    places: np.ndarray  # (J, 3)
    points: np.ndarray  # (V, 3)
    influences: np.ndarray  # (V, n) int32, joints
    weights: np.ndarray  # (V, n) float32

    def names(self) -> list[str]:
        """Of the joints that move points, each as much of its path as tells it from the others."""
        return [self._name(joint) for joint in np.unique(self.influences[self.weights > LEAST_WEIGHT])]

    def find(self, name: str) -> int:
        """The joint of a name, which is its path or how that ends. Raises Fault."""
        found = [i for i, joint in enumerate(self.joints) if joint == name] or self._ending(name)
        if len(found) != 1:
            several = f"not one joint, but any of {', '.join(map(self._name, found))}"
            raise Fault(f"{name} is {several if found else f'not a joint; {in_place_of(name, self.names())}'}")
        return found[0]

    def across(self, joint: int) -> int:
        """The same joint of the other side, by its name. Raises Fault."""
        own = self.joints[joint]
        other = _SIDE.sub(lambda side: OTHER_SIDE[side[0]], own)
        if other == own or other not in self.joints:
            raise Fault(f"the joint {self._name(joint)} has no counterpart, which would be {other}")
        return self.joints.index(other)

    def _name(self, joint: int) -> str:
        last = self.joints[joint].rpartition("/")[2]
        return last if len(self._ending(last)) == 1 else self.joints[joint]

    def _ending(self, name: str) -> list[int]:
        return [i for i, joint in enumerate(self.joints) if f"/{joint}".endswith(f"/{name}")]
