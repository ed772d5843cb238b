"""Interiors: a room with windows, a studio with soft boxes, a nave with coloured windows."""

import numpy as np

from data_synth.environments.box import Wall, box
from data_synth.environments.environment import Environment
from data_synth.environments.layers import Glow, Lancet, Panes


def room() -> Environment:
    """Build a living room by day: two windows to the left, one behind, a lamp on the ceiling."""
    day = _stack([0.9, 1.1, 0.6], [4.0, 4.4, 4.6], [6.0, 7.0, 8.5])
    planks = np.random.default_rng(7).uniform(0.8, 1.2, (1, 12, 1)) * [0.20, 0.12, 0.07]
    return box(
        "room",
        (-2.2, -1.5, -2.6),
        (2.6, 1.2, 3.0),
        {
            "-x": Wall(
                (0.34, 0.33, 0.31),
                (
                    _rectangle(-1.45, 0.05, -0.65, 0.95, (0.75, 0.75, 0.72)),
                    Panes((-1.37, 0.69), (-0.57, 0.49), (0.65, 0.45), np.tile(day, (1, 2, 1))),
                    _rectangle(0.65, 2.15, -0.65, 0.95, (0.75, 0.75, 0.72)),
                    Panes((0.73, 0.69), (-0.57, 0.49), (0.65, 0.45), np.tile(day, (1, 2, 1))),
                ),
            ),
            "+x": Wall(
                (0.52, 0.49, 0.44),
                (
                    Glow((0.6, -0.2), (0.9, 0.7), (0.25, 0.24, 0.22)),
                    _rectangle(-0.6, 0.6, -0.25, 0.6, (0.10, 0.06, 0.03)),
                    _rectangle(-0.53, 0.53, -0.18, 0.53, (0.35, 0.28, 0.16)),
                    _rectangle(-0.4, 0.1, 0.0, 0.4, (0.12, 0.22, 0.34)),
                ),
            ),
            "-y": Wall(
                (0.10, 0.07, 0.05),
                (
                    Panes((-2.2, 0.4), (-2.6, 5.6), (0.4, 5.6), planks, edge=0.012),
                    _rectangle(-1.2, 1.4, -1.1, 1.3, (0.22, 0.05, 0.045)),
                    _rectangle(-1.05, 1.25, -0.95, 1.15, (0.28, 0.10, 0.07)),
                    Glow((-1.4, 0.4), (0.6, 1.2), (0.35, 0.32, 0.28)),
                ),
            ),
            "+y": Wall(
                (0.46, 0.45, 0.43),
                (
                    Glow((-1.5, 0.3), (0.8, 1.6), (0.20, 0.20, 0.20)),
                    _rectangle(0.1, 0.7, -0.1, 0.5, (3.0, 2.5, 1.7), edge=0.06),
                ),
            ),
            "-z": Wall(
                (0.40, 0.38, 0.34),
                (
                    _rectangle(-1.75, -0.15, -0.75, 0.85, (0.70, 0.70, 0.67)),
                    Panes((-1.67, 0.74), (-0.67, 0.49), (0.7, 0.45), np.tile(day, (1, 2, 1))),
                    _rectangle(0.75, 2.15, -1.5, 0.6, (0.09, 0.05, 0.03)),
                    Panes((0.82, 0.64), (-1.42, 0.5), (0.6, 0.46), _books(4, 2)),
                ),
            ),
            "+z": Wall(
                (0.36, 0.35, 0.33),
                (
                    Glow((-1.2, 0.0), (0.9, 0.8), (0.15, 0.15, 0.15)),
                    _rectangle(0.9, 1.85, -1.5, 0.55, (0.16, 0.10, 0.06)),
                    _rectangle(0.98, 1.77, -1.42, 0.47, (0.24, 0.15, 0.09)),
                ),
            ),
        },
        nodes=3,
    )


# The lamps' radiance averages 0.6 over all directions; walls of albedo rho in a closed room
# add about rho / (1 - rho) of that (Sumpner's principle), here with rho = 0.26.
_STUDIO_WALL = (0.21, 0.21, 0.21)


def studio() -> Environment:
    """Build a portrait studio: a large key light, a fill, a rim light, a top light, a backdrop.

    Its walls are light grey, and send back about a quarter of what the lamps give them.
    """
    return box(
        "studio",
        (-3.0, -1.5, -2.5),
        (3.0, 1.8, 3.0),
        {
            "-x": Wall(
                _STUDIO_WALL,
                (_rectangle(-2.2, -1.5, -0.9, 1.3, (5.0, 5.2, 5.6), edge=0.06),),
            ),
            "+x": Wall(
                _STUDIO_WALL,
                (_rectangle(0.9, 2.5, -0.8, 1.0, (1.6, 1.5, 1.4), edge=0.10),),
            ),
            "-y": Wall((0.10, 0.10, 0.10), (Glow((0.0, -1.2), (1.2, 0.9), (0.15, 0.15, 0.15)),)),
            "+y": Wall(
                _STUDIO_WALL,
                (_rectangle(-0.9, 0.9, -0.3, 0.9, (6.0, 6.0, 6.0), edge=0.08),),
            ),
            "-z": Wall((0.10, 0.11, 0.12), (Glow((0.0, 0.2), (1.1, 0.9), (0.9, 0.95, 1.0)),)),
            "+z": Wall(
                _STUDIO_WALL,
                (_rectangle(-2.6, -1.0, -0.2, 1.5, (14.0, 13.4, 12.6), edge=0.10),),
            ),
        },
        nodes=4,
    )


def nave() -> Environment:
    """Build the nave of a church: tall pointed windows of coloured glass along both sides."""
    glass = np.array(
        [
            [[0.2, 0.5, 5.0], [5.0, 0.3, 0.4]],
            [[5.0, 3.0, 0.3], [0.3, 3.0, 1.0]],
            [[4.5, 0.4, 0.3], [0.4, 1.0, 5.0]],
            [[0.3, 2.5, 3.5], [5.0, 2.2, 0.4]],
        ]
    )
    stone = (0.055, 0.050, 0.045)

    def windows(sun: float, shift: int) -> tuple[Lancet, ...]:
        places = (-20.0, -14.0, -8.0, -2.0, 4.0, 10.0)
        return tuple(
            Lancet(z, 2.0, 8.0, 1.5, sun * glass[(i + shift) % 4], edge=0.05)
            for i, z in enumerate(places)
        )

    piers = Panes(
        (-23.6, 6.0), (-1.6, 16.6), (1.2, 16.6), np.tile([0.085, 0.075, 0.065], (1, 7, 1)), edge=0.2
    )
    candles = tuple(Glow((x, -0.2), (0.10, 0.14), (5.0, 3.2, 1.2)) for x in (-1.5, 0.0, 1.5))
    return box(
        "nave",
        (-6.0, -1.6, -26.0),
        (6.0, 15.0, 14.0),
        {
            "-x": Wall(stone, (piers, *windows(1.0, 0)), dusk=0.6, reach=2.0),
            "+x": Wall(stone, (piers, *windows(0.35, 2)), dusk=0.6, reach=2.0),
            "-y": Wall(
                (0.05, 0.045, 0.04),
                (
                    Glow((2.5, -8.0), (1.2, 2.0), (0.20, 0.04, 0.05)),
                    Glow((2.0, -2.0), (1.2, 2.0), (0.05, 0.06, 0.22)),
                    Glow((2.5, 4.0), (1.2, 2.0), (0.20, 0.13, 0.03)),
                    Panes((-1.0, 2.0), (-26.0, 40.0), (2.0, 40.0), _flat(0.10, 0.015, 0.015)),
                ),
                dusk=0.5,
                reach=2.0,
            ),
            "+y": Wall((0.025, 0.022, 0.02), dusk=0.6, reach=3.0),
            "-z": Wall(
                stone,
                (Lancet(0.0, 3.0, 8.0, 2.5, 1.4 * glass[0], tones=5.0, edge=0.05), *candles),
                dusk=0.6,
                reach=2.0,
            ),
            "+z": Wall(stone, (_rectangle(-1.2, 1.2, -1.6, 1.6, (0.02, 0.012, 0.008)),), dusk=0.6),
        },
        nodes=4,
    )


def _flat(*colour: float) -> np.ndarray:
    return np.array(colour).reshape(1, 1, 3)


def _stack(*colours: list[float]) -> np.ndarray:
    """Colours of one column of panes, from the lowest up."""
    return np.array(colours)[:, None, :]


def _books(rows: int, columns: int) -> np.ndarray:
    rng = np.random.default_rng(3)
    return rng.uniform(0.03, 0.22, (rows, columns, 3)) * [1.2, 0.9, 0.8]


def _rectangle(
    s0: float,
    s1: float,
    t0: float,
    t1: float,
    colour: tuple[float, float, float],
    edge: float = 0.03,
) -> Panes:
    """One pane between two corners."""
    size = (s1 - s0, t1 - t0)
    return Panes((s0, size[0]), (t0, size[1]), size, _flat(*colour), edge)
