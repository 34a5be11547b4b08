"""Chooses faces by the joints of a rig: those whose weights mix a joint with its parent or children, near it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Usd

from skinslide.arrays.topology import Topology
from skinslide.problems import Fault
from skinslide.stage.finding import is_skinned
from skinslide.stage.rig import LEAST_WEIGHT, Rig
from skinslide.stage.skinning import Skinning


def read_rig(prim: Usd.Prim) -> Rig:
    """The rig of a mesh. Raises Fault."""
    if not is_skinned(prim):
        raise Fault("UsdSkel does not skin it, so it has no joints")
    return Skinning(prim).rig()


def faces_at(rig: Rig, topology: Topology, joints: Sequence[int], reach: float) -> np.ndarray:
    """The faces around some joints, int32, ascending. Raises Fault.

    Args:
        rig: Of the mesh.
        topology: Its faces.
        joints: Of the rig.
        reach: How far from a joint, in its length: the distance to its children, or of one without to its parent.
    """
    chosen = np.zeros(topology.face_count, bool)
    for joint in joints:
        found = _around(rig, topology, joint, reach)
        if not found.any():
            mixed = f"mixes {rig.joints[joint]} with its parent or children"
            raise Fault(f"no face whose points are within {reach:g} lengths of the joint {mixed}")
        chosen |= found
    return np.flatnonzero(chosen).astype(np.int32)


def _around(rig: Rig, topology: Topology, joint: int, reach: float) -> np.ndarray:
    """Bool (F,): faces of which a point mixes the joint with those beside it, and all points are near it."""
    parent, children = rig.parents[joint], np.flatnonzero(rig.parents == joint)
    beside = np.array([*children, *([parent] if parent >= 0 else [])], np.int32)
    if not beside.size:
        raise Fault(f"the joint {rig.joints[joint]} has neither a parent nor children")
    ends = rig.places[children if children.size else beside]
    length = np.linalg.norm(ends - rig.places[joint], axis=1).mean()
    own, others = _weight_of(rig, np.array([joint])), _weight_of(rig, beside)
    mixed = (own > LEAST_WEIGHT) & (others > LEAST_WEIGHT)
    near = np.linalg.norm(rig.points - rig.places[joint], axis=1) <= reach * length
    return topology.faces_of_any(mixed) & topology.faces_of_all(near)


def _weight_of(rig: Rig, joints: np.ndarray) -> np.ndarray:
    """The weight (V,) that joints have together on each point."""
    return np.where(np.isin(rig.influences, joints), rig.weights, 0).sum(axis=1)
