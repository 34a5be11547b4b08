"""Prints the results of the baked examples: one line for each patch, from the reports in OUTDIR/*/bake.json.

usage: table.py OUTDIR
Stretch is the RMS of log(length / rest length) over the patch's edges, in the cache and slid, at the frame where the
cache has most of it. folded and clamped are the largest counts at any frame. Times are means over the frames, in the
core, on one thread; writes those of each stage of a slide to OUTDIR/times.txt.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from cells import lines

ORDER = (
    *("elbow", "fine_elbow", "bicep", "face", "finger", "sleeve", "chequer", "bump"),
    *("body", "fingers", "trunk", "torus", "character"),
)
STAGES = ("density", "embed", "relax", "locate", "interpolate")
RESULTS = ("example", "vertices", "cache", "slid", "change", "at frame", "folded", "clamped", "ms a frame")
TIMES = ("example", "vertices", "edges", *(f"{stage} ms" for stage in STAGES), "frame ms")


def milliseconds(patch: dict) -> list[float]:
    """Of each stage, then of all together."""
    times = [1e3 * patch["mean"][f"{stage}_seconds"] for stage in STAGES]
    return [*times, sum(times)]


def results(example: str, patch: dict) -> list[str]:
    """What sliding did to one patch."""
    before, after = patch["worst_frame_stretch_before"], patch["worst_frame_stretch_after"]
    return [
        example,
        str(patch["vertex_count"]),
        f"{before:.3f}",
        f"{after:.3f}",
        f"{100 * (after / before - 1):+.0f} %",
        f"{patch['worst_frame']:g}",
        str(patch["max"]["folded_faces"]),
        str(patch["max"]["clamped_vertices"]),
        f"{milliseconds(patch)[-1]:.2f}",
    ]


def times(example: str, patch: dict) -> list[str]:
    """What sliding one patch took."""
    sizes = [str(patch[f"{kind}_count"]) for kind in ("vertex", "edge")]
    return [example, *sizes, *(f"{value:.3f}" for value in milliseconds(patch))]


def main() -> None:
    """Prints the results and writes the times."""
    folder = Path(sys.argv[1])
    reports = {example: json.loads((folder / example / "bake.json").read_text()) for example in ORDER}
    patches = [
        (name, patch) for name, report in reports.items() for mesh in report["meshes"] for patch in mesh["patches"]
    ]
    print(lines(RESULTS, (results(*patch) for patch in patches)), end="")
    (folder / "times.txt").write_text(lines(TIMES, (times(*patch) for patch in patches)))


if __name__ == "__main__":
    main()
