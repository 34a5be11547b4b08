"""Sliders that measure a rule by itself, whatever else is set up on an example."""

import contextlib
from collections.abc import Sequence
from dataclasses import replace

from skinslide.arrays.slider import Slider, SliderError
from skinslide.stage.mesh import PatchedMesh


def sliders_of(mesh: PatchedMesh, rules: Sequence[str]) -> dict[str, Slider]:
    """By rule, a slider of the first patch; none for a rule that cannot slide it, as `unit` cannot a closed one."""
    patch = mesh.patches[0]
    plain = replace(patch, interpolation="linear", controls=replace(patch.controls, weight=None, max_distance=None))
    found = {}
    for rule in rules:
        with contextlib.suppress(SliderError):
            found[rule] = mesh.build([replace(plain, rule=rule)])
    return found
