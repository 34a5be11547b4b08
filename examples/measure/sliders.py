"""What the measures of rules share: each rule by itself on an example, whatever else is set up there."""

import contextlib
from collections.abc import Sequence
from dataclasses import replace

from skinslide.arrays.slider import Slider, SliderError
from skinslide.stage.mesh import PatchedMesh


def sliders_of(mesh: PatchedMesh, rules: Sequence[str]) -> dict[str, Slider]:
    """By rule, a slider of the first patch; none for a rule that cannot slide it, as the paper's a closed one."""
    patch = mesh.patches[0]
    plain = replace(patch, interpolation="linear", controls=replace(patch.controls, weight=None, max_distance=None))
    found = {}
    for rule in rules:
        with contextlib.suppress(SliderError):
            found[rule] = mesh.build([replace(plain, rule=rule)])
    return found
