"""Values and facts as a scene holds them, to be handed to the core: no USD here, and no meaning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np


class Asset(str):
    """The path of a file, as it was authored."""


class Other:
    """A value of a kind that nothing takes."""


NOTHING = Other()  # of a property that was not authored


class Value(NamedTuple):
    """A property at one time, as it was authored."""

    name: str
    # (n,) or (n, width) numpy of an array; a numpy scalar, str, Asset or Other; None: there is none at this time.
    value: Any
    type_name: str
    interpolation: str | None = None
    indices: Value | None = None


class Subset(NamedTuple):
    """A child prim of a patch's name, as in `skinslide_stage_subset`."""

    path: str
    type_name: str
    is_subset: bool


class File(NamedTuple):
    """A file that was asked for, as in `skinslide_stage_file`."""

    path: str | None
    content: bytes | None = None
    size: int = 0
    reason: str | None = None
    descriptor: int | None = None  # of an open file that has the content


@dataclass(frozen=True)
class PrimFacts:
    """Facts of a prim, as in `skinslide_stage_prim`."""

    type_name: str = ""
    is_mesh: bool = False
    is_defined: bool = True
    instance: str | None = None
    instancer: str | None = None
    slid_by: str | None = None
    baked_by: str | None = None
    point_samples: int = 0
    has_joint_indices: bool = False
    blend_shape_count: int = 0
    schemas: Sequence[str] = ()
    properties: Sequence[str] = ()
    uncomposed: str | None = None
    variant_set: str | None = None
    variant: str | None = None
    skel_root: str | None = None
    skeleton: str | None = None
    has_joint_weights: bool = False
    reads_skinning: bool = False


class Pose(NamedTuple):
    """Points of one time, before and after sliding, and turns of the skin where wanted: float32 (V, 3) each."""

    time: float
    cached: np.ndarray
    slid: np.ndarray
    turns: np.ndarray | None


class Poses(tuple[Pose, ...]):
    """Poses that are handed over as an array."""
