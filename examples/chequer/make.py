"""Chequer: a bump travels under a chequered square of 64 by 64 faces over 24 frames.

Cached, each point only rises and falls, so the chequers on the bump's flanks are drawn out lengthwise. In the result
the squares all around draw in towards the bump and those on it come back near to square; the bump itself and the edge
of the sheet stay where they were. The patch is the whole sheet, with its four corners; the rest pose is flat.
"""

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from makers import stage
from makers.command import main

COUNT = 64  # faces along a side
SIDE = 100.0  # cm
HEIGHT, WIDTH = 22.0, 11.0  # cm, of the bump: its top, and its radius at 61 % of that
CHEQUER = 4  # faces along a chequer
LIGHT, DARK = (0.85, 0.83, 0.78), (0.16, 0.20, 0.28)


def sheet() -> tuple[np.ndarray, np.ndarray]:
    """The flat sheet in the XZ plane: points (V, 3), row by row, and faces (F, 4), facing up."""
    steps = np.linspace(-SIDE / 2, SIDE / 2, COUNT + 1)
    z, x = np.meshgrid(-steps, steps, indexing="ij")
    first = np.arange(COUNT * (COUNT + 1)).reshape(COUNT, COUNT + 1)[:, :-1].ravel()
    points = np.stack([x, np.zeros_like(x), z], axis=2).reshape(-1, 3)
    return points, np.stack([first, first + 1, first + COUNT + 2, first + COUNT + 1], axis=1).astype(np.int32)


def bumped(rest: np.ndarray, share: float) -> np.ndarray:
    """The sheet (V, 3) over the bump after `share`, 0..1, of its way from one side to the other."""
    reach = SIDE / 2 - 2 * WIDTH
    centre = np.array([reach * (2 * share - 1), 0.4 * reach * np.sin(2 * np.pi * share)])
    distance = np.linalg.norm(rest[:, [0, 2]] - centre, axis=1)
    rise = np.sin(np.pi * share) * HEIGHT * np.exp(-0.5 * (distance / WIDTH) ** 2)
    return rest + rise[:, None] * np.array([0.0, 1.0, 0.0])


def make(folder: Path) -> Path:
    """Writes the example into `folder` and returns the shot's path."""
    rest, faces = sheet()
    st = rest[:, [0, 2]] * [1, -1] / SIDE + 0.5
    row, column = np.divmod(np.arange(len(faces)), COUNT)
    colours = np.where(((row // CHEQUER + column // CHEQUER) % 2 == 0)[:, None], LIGHT, DARK)
    frames = (bumped(rest, share) for share in np.linspace(0, 1, stage.FRAME_COUNT))
    cache = stage.Cache(rest, frames, faces, st, faces, subdivision="none", colours=colours)
    corners = (0, COUNT, len(rest) - 1, len(rest) - 1 - COUNT)
    return stage.write(folder, cache, stage.Patch("sheet", np.ones(len(faces), dtype=bool), corners=corners))


if __name__ == "__main__":
    main(make, __doc__)
