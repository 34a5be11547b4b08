"""The settings of a patch, in words, for people who look at its pictures."""

from __future__ import annotations

from skinslide.arrays.setups import Controls, PatchSetup
from skinslide.problems import counted
from skinslide.stage.mesh import PatchedMesh


def settings_of(mesh: PatchedMesh, setup: int) -> dict[str, str]:
    """What the patch at `setup` of `patches` is slid with, at the first time."""
    patch, animation = mesh.patches[setup], mesh.animation[setup]
    chosen = {"rule": patch.rule, "interpolation": _interpolation(mesh, patch), "holes": patch.holes}
    chosen["boundary"] = patch.boundary if patch.corners is None else f"{patch.boundary}, with corners"
    painted = _painted(patch.controls)
    maps = {read.name.rpartition(":")[2]: read.file for read in animation.textures}
    animated = {"animated": "yes"} if animation.varies else {}
    return {**chosen, **painted, **maps, **animated, "rest": mesh.rest_source}


def _interpolation(mesh: PatchedMesh, patch: PatchSetup) -> str:
    found = mesh.interpolation_of(patch)
    return f"auto: {found}" if patch.interpolation == "auto" else found


def _painted(controls: Controls) -> dict[str, str]:
    edges = 0 if controls.edges is None else len(controls.edges)
    density = [
        *(["by point"] if controls.vertex_density is not None else []),
        *(["by face"] if controls.face_density is not None else []),
        *([f"on {counted(edges, 'edge')}"] if edges else []),
    ]
    return {
        "force density": ", ".join(density) or "not painted",
        "weight": "1" if controls.weight is None else "painted",
        "envelope": f"{controls.envelope:g}",
        "largest distance": "no limit" if controls.max_distance is None else "painted",
    }
