"""A street at night: lit windows and shops on both sides, street lamps, a wet road."""

import numpy as np

from data_synth.environments.box import Wall, box
from data_synth.environments.environment import Environment
from data_synth.environments.layers import Glow, Layer, Panes


def street() -> Environment:
    """Build a street at night, running along z; the subject stands nearer its left side."""
    return box(
        "street",
        (-3.5, -1.6, -48.0),
        (8.5, 13.0, 48.0),
        {
            "-x": Wall((0.012, 0.010, 0.010), _facade(1, 1.0), dusk=0.5, reach=1.5),
            "+x": Wall((0.010, 0.009, 0.011), _facade(2, 0.7), dusk=0.5, reach=1.5),
            "-y": Wall((0.008, 0.008, 0.010), _road(), dusk=0.3, reach=1.0),
            "+y": Wall((0.004, 0.005, 0.010), dusk=0.0),
            "-z": Wall(
                (0.010, 0.010, 0.016),
                (Glow((2.5, -1.0), (4.0, 2.0), (0.25, 0.14, 0.06)),),
                dusk=0.0,
            ),
            "+z": Wall(
                (0.010, 0.010, 0.016),
                (Glow((2.5, -1.0), (4.0, 2.0), (0.12, 0.08, 0.05)),),
                dusk=0.0,
            ),
        },
        nodes=4,
    )


_LAMPS = (-33.0, -15.0, 3.0, 21.0, 39.0)
_SODIUM = np.array([1.0, 0.55, 0.16])


def _facade(seed: int, brightness: float) -> tuple[Layer, ...]:
    """Three storeys of windows, a third of them lit, over a row of shops, and the lamps."""
    rng = np.random.default_rng(seed)
    lit = rng.random((3, 32, 1)) < 0.35
    warmth = rng.uniform(0.3, 1.0, (3, 32, 1)) * [1.0, 0.72, 0.38]
    windows = np.where(lit, 1.2 * brightness * warmth, [0.012, 0.014, 0.020])
    shops = rng.dirichlet([4.0, 3.0, 2.0], (1, 12)) * rng.uniform(0.2, 2.5, (1, 12, 1))
    pools = [Glow((z, 1.5), (2.2, 1.8), tuple(0.10 * brightness * _SODIUM)) for z in _LAMPS]
    heads = [Glow((z, 3.2), (0.30, 0.20), tuple(30.0 * brightness * _SODIUM)) for z in _LAMPS]
    return (
        *pools,
        Panes((-47.3, 3.0), (3.9, 3.0), (1.4, 1.8), windows, edge=0.10),
        Panes((-47.0, 8.0), (-1.1, 3.0), (6.5, 2.6), brightness * shops, edge=0.12),
        *heads,
    )


def _road() -> tuple[Layer, ...]:
    """Two pavements, and the lamps' light on the wet asphalt between them."""
    pools = [Glow((x, z), (1.5, 3.0), tuple(0.10 * _SODIUM)) for z in _LAMPS for x in (-2.5, 7.5)]
    streaks = [Glow((1.5, z), (0.5, 4.0), (0.06, 0.05, 0.05)) for z in (-24.0, -6.0, 12.0)]
    pavement = np.full((1, 2, 3), 0.022)
    return (
        Panes((-3.5, 10.0), (-48.0, 96.0), (2.0, 96.0), pavement, edge=0.10),
        *pools,
        *streaks,
    )
