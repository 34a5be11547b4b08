"""Poses the human: joint positions, bone transforms, linear blend skinning. Centimetres, radians."""

from collections.abc import Mapping

import numpy as np

from makers import makehuman


def joint(points: np.ndarray, name: str) -> np.ndarray:
    """Where joint NAME lies, (3,): the middle of its cube in `points`, the base mesh with its targets applied."""
    return points[makehuman.read_mesh().cubes[f"joint-{name}"]].mean(axis=0)


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """The right-handed rotation (3, 3) by `angle` about `axis`, for column vectors (Rodrigues' formula)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def turn(pivot: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """The rigid motion (3, 4) that rotates by `angle` about the line through `pivot` along `axis`."""
    linear = rotation(axis, angle)
    return np.column_stack([linear, pivot - linear @ pivot])


def bone_motions(turns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Each bone's motion (3, 4) from the rest pose; `turns` are without the parents', in the space of the rest pose."""
    rig, motions = makehuman.read_rig(), {}

    def motion(bone: str) -> np.ndarray:
        if bone not in motions:
            parent = rig[bone]["parent"]
            above = motion(parent) if parent else np.eye(3, 4)
            own = turns.get(bone, np.eye(3, 4))
            motions[bone] = above @ np.vstack([own, [0, 0, 0, 1]])
        return motions[bone]

    return {bone: motion(bone) for bone in rig}


def skin(
    body: np.ndarray, turns: Mapping[str, np.ndarray], weights: Mapping[str, np.ndarray] | None = None
) -> np.ndarray:
    """Linear blend skinning of points (V, 3): p' = Σ_b w_b (M_b p), (V, 3); by default the body's, with its weights."""
    weights, motions = weights or makehuman.read_weights(), bone_motions(turns)
    moved = body.copy()
    for bone, motion in motions.items():
        if not np.array_equal(motion, np.eye(3, 4)):
            moved += weights[bone][:, None] * (body @ motion[:, :3].T + motion[:, 3] - body)
    return moved
