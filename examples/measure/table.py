"""Prints what the baked examples show: one line a patch, from the reports in OUTDIR/*/bake.json.

usage: table.py OUTDIR
Stretch is the RMS over the patch's edges of log(length / rest length), in the cache and slid, at the frame where the
cache has most of it. Times are means over the frames, on one thread, in the core. folded and clamped are the most of
any frame.
"""

import json
import sys
from pathlib import Path

ORDER = ("elbow", "fine_elbow", "bicep", "face", "finger", "sleeve", "chequer", "bump")
STAGES = ("density", "embed", "relax", "locate", "interpolate")
HEADINGS = ("example", "vertices", "edges", *(f"{stage} ms" for stage in STAGES), "frame ms")
RESULTS = ("cache", "slid", "change", "at frame", "folded", "clamped")


def row(example: str, patch: dict) -> list[str]:
    """The cells of one patch."""
    milliseconds = [1e3 * patch["mean"][f"{stage}_seconds"] for stage in STAGES]
    before, after = patch["worst_frame_stretch_before"], patch["worst_frame_stretch_after"]
    return [
        example,
        str(patch["vertex_count"]),
        str(patch["edge_count"]),
        *(f"{value:.3f}" for value in [*milliseconds, sum(milliseconds)]),
        f"{before:.3f}",
        f"{after:.3f}",
        f"{100 * (after / before - 1):+.0f} %",
        f"{patch['worst_frame']:g}",
        str(patch["max"]["folded_faces"]),
        str(patch["max"]["clamped_vertices"]),
    ]


def main() -> None:
    """Prints the table, then where the layers are."""
    folder = Path(sys.argv[1])
    rows = [[*HEADINGS, *RESULTS]]
    for example in ORDER:
        report = json.loads((folder / example / "bake.json").read_text())
        rows += [row(example, patch) for mesh in report["meshes"] for patch in mesh["patches"]]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for cells in rows:
        print("  ".join(cell.rjust(width) for cell, width in zip(cells, widths, strict=True)))
    print(f"\nEach {folder}/EXAMPLE holds")
    print("  cache.usdc  the cached character           check.txt  what skinslide found on the stage")
    print("  stage.usda  the cache and its patch        bake.json  what happened at each frame")
    print("  slid.usdc   the corrected points, as overs to be sublayered above stage.usda")


if __name__ == "__main__":
    main()
