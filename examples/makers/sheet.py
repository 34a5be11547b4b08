"""A chequered square in the XZ plane, and a bump that travels under it. Centimetres."""

import numpy as np

from makers import stage

SIDE = 100.0
HEIGHT, WIDTH = 22.0, 11.0  # of the bump: its top, and its radius at 61 % of that
LIGHT, DARK = (0.85, 0.83, 0.78), (0.16, 0.20, 0.28)


def flat(count: int) -> tuple[np.ndarray, np.ndarray]:
    """The sheet at rest, `count` faces along a side: points (V, 3), row by row, and faces (F, 4), facing up."""
    steps = np.linspace(-SIDE / 2, SIDE / 2, count + 1)
    z, x = np.meshgrid(-steps, steps, indexing="ij")
    first = np.arange(count * (count + 1)).reshape(count, count + 1)[:, :-1].ravel()
    points = np.stack([x, np.zeros_like(x), z], axis=2).reshape(-1, 3)
    return points, np.stack([first, first + 1, first + count + 2, first + count + 1], axis=1).astype(np.int32)


def corners(count: int) -> tuple[int, ...]:
    """The sheet's corners, anticlockwise seen from above."""
    return (0, count, (count + 1) ** 2 - 1, count * (count + 1))


def bumped(rest: np.ndarray, share: float) -> np.ndarray:
    """The sheet (V, 3) over the bump after `share`, 0..1, of its way from one side to the other."""
    reach = SIDE / 2 - 2 * WIDTH
    centre = np.array([reach * (2 * share - 1), 0.4 * reach * np.sin(2 * np.pi * share)])
    distance = np.linalg.norm(rest[:, [0, 2]] - centre, axis=1)
    rise = np.sin(np.pi * share) * HEIGHT * np.exp(-0.5 * (distance / WIDTH) ** 2)
    return rest + rise[:, None] * np.array([0.0, 1.0, 0.0])


def cache(count: int, chequer: int, subdivision: str) -> stage.Cache:
    """The bump's way under the sheet; a chequer is `chequer` faces wide."""
    rest, faces = flat(count)
    st = rest[:, [0, 2]] * [1, -1] / SIDE + 0.5
    row, column = np.divmod(np.arange(len(faces)), count)
    colours = np.where(((row // chequer + column // chequer) % 2 == 0)[:, None], LIGHT, DARK)
    frames = (bumped(rest, share) for share in np.linspace(0, 1, stage.FRAME_COUNT))
    return stage.Cache(rest, frames, faces, st, faces, subdivision=subdivision, colours=colours)
