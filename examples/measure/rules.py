"""Prints how well each rule does on the examples: one line for each example and rule that can slide it.

usage: rules.py STAGE...        (needs libigl)
`gone` is the share of the cache's stretch that is removed at the frame where it has most. `share min` and `median` are,
over the frames, the share of the removable stretch that is removed, as share.py finds it, where a patch is small enough
to search. `whole` and `quarter` are the ratios of smoothness.py at whole frames and at quarter frames; `worst` is the
largest second difference at quarter frames, as a share of the mean edge at rest. `folds` is the most faces turned over
at a frame; `ms` is the median time of a frame in the core, on one thread; `x unit` is that over the time of unit. The
rules are measured by themselves, on the first patch: with linear interpolation, without slide weights and largest
distances.
"""

import sys
from pathlib import Path

import numpy as np
from pxr import Usd

sys.path.insert(0, str(Path(__file__).resolve().parent))
import share
from cells import lines
from sliders import sliders_of
from smoothness import RULES, Rough, mean_edge, motions

from skinslide.arrays.slider import Frame
from skinslide.stage.mesh import PatchedMesh
from skinslide.stage.reading import read_meshes

HEADINGS = (
    "example",
    "rule",
    "vertices",
    "gone",
    "share min",
    "median",
    "whole",
    "quarter",
    "worst",
    "folds",
    "ms",
    "x unit",
)
MOST_SEARCHED = 5000  # vertices
SECONDS = ("density_seconds", "embed_seconds", "relax_seconds", "locate_seconds", "interpolate_seconds")


def milliseconds(frame: Frame) -> float:
    return 1e3 * sum(getattr(patch, name) for patch in frame.patches for name in SECONDS)


def shares(frames: list[share.Found], rule: str) -> tuple[str, str]:
    """The least and the median, over the frames in which any stretch can be removed."""
    found = [each.share(rule) for each in frames if np.isfinite(each.share(rule))]
    return (f"{min(found):.2f}", f"{np.median(found):.2f}") if found else ("-", "-")


def roughness(mesh: PatchedMesh) -> dict[str, list[str]]:
    """By rule: the ratios at whole frames and at quarter frames, and the worst."""
    _, times, moves = motions(mesh)
    edge, found = mean_edge(mesh, mesh.patches[0].faces), {}
    whole, quarter = ({name: Rough.of(move, times[::step]).most for name, move in moves.items()} for step in (4, 1))
    for rule in moves:
        ratios = [f"{most[rule] / most['cache']:.2f}" for most in (whole, quarter)]
        found[rule] = [*ratios, f"{100 * quarter[rule] / edge:.2f} %"]
    return found


def rows(path: Path) -> list[list[str]]:
    """The cells of one example, a row a rule."""
    mesh = read_meshes(Usd.Stage.Open(str(path)))[0][0]
    sliders, rough = sliders_of(mesh, RULES), roughness(mesh)
    count = sum(patch.vertex_count for patch in sliders["even"].patches)
    frames = list(share.frames(mesh, sliders, search=count <= MOST_SEARCHED))
    worst = max(frames, key=lambda found: found.cache)
    cost = {rule: float(np.median([milliseconds(found.frames[rule]) for found in frames])) for rule in sliders}
    cells = []
    for rule in sliders:
        gone = f"{100 * (1 - worst.stretch[rule] / worst.cache):.0f} %"
        folds = max(patch.folded_faces for found in frames for patch in found.frames[rule].patches)
        times = [f"{cost[rule]:.2f}", f"{cost[rule] / cost['unit']:.1f}" if "unit" in cost else "-"]
        cells.append(
            [path.parent.name, rule, str(count), gone, *shares(frames, rule), *rough[rule], str(folds), *times]
        )
    return cells


def main() -> None:
    print(lines(HEADINGS, (row for path in sys.argv[1:] for row in rows(Path(path)))), end="")


if __name__ == "__main__":
    with np.errstate(divide="ignore"):  # an edge of no length has endless stretch, and is never taken
        main()
