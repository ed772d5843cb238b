"""The nose: ridge, tip, wings, nostrils and the fold behind the wings."""

import numpy as np

from .fields import bump, inside
from .parameters import MEAN
from .splines import cardinal_weights

# Along the mid-line from above the root to the lip: canonical height, then how far the skin is
# pushed down and forward, and the half width of the ridge there. Millimetres.
_TOP = 14.0
_PROFILE = np.array([
    # y0   down  out  half width
    (14.0, 0.0, 0.0, 15.0),
    (6.0, 0.0, 1.5, 13.5),
    (0.0, 0.0, 4.5, 12.5),
    (-7.0, 0.0, 9.3, 13.0),
    (-15.0, 0.5, 14.3, 14.5),
    (-22.0, 1.1, 18.4, 15.0),
    (-28.0, 1.9, 21.4, 15.0),
    (-33.0, 3.4, 22.8, 15.0),
    (-36.5, 4.6, 21.6, 15.0),
    (-40.0, 4.4, 18.4, 14.5),
    (-43.0, 2.8, 11.8, 13.5),
    (-46.0, 0.8, 4.0, 12.5),
    (-50.0, -0.3, 0.8, 12.0),
    (-55.0, 0.0, 0.0, 12.0),
])  # fmt: skip


def add_nose(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Add the nose's displacement at canonical points `c` (right half) to `out`."""
    rows = inside(c, (-1, -55, 30), (34, _TOP, 200))
    x, y = c[rows, 0], c[rows, 1]
    weights = cardinal_weights(_TOP - _PROFILE[:, 0], _TOP - y, even=False)
    down, forward, half = (weights @ _PROFILE[:, 1:]).T
    tip = bump((y + 33.0) / 17.0)
    forward += (p["nose_protrusion"] - MEAN["nose_protrusion"]) * bump((y + 30.0) / 34.0)
    forward += (p["bridge_height"] - MEAN["bridge_height"]) * bump(y / 24.0)
    forward += p["nasal_hump"] * bump((y + 13.0) / 14.0)
    half += (p["bridge_breadth"] - MEAN["bridge_breadth"]) * bump((y + 8.0) / 22.0) + (
        p["tip_breadth"] - MEAN["tip_breadth"]
    ) * tip
    q = np.minimum(x / half, 1.0)
    ridge = 0.72 * (1 - q**2.3) ** 2 + 0.28 * bump(x / (half + 12.0))
    lift = forward * ridge
    drop = -(down + p["tip_drop"] * tip) * ridge

    # The tip is a ball; the wings stand out sideways and end in a fold towards the cheek.
    lift += 2.6 * bump(x / (p["tip_breadth"] + 5.0), (y + 33.5) / 11.0)
    wing = bump((x - 12.0) / 8.0, (y + 37.5) / np.where(y > -37.5, 14.0, 8.5))
    side = (4.2 + (p["nose_breadth"] - MEAN["nose_breadth"]) / 2) * wing
    lift += (p["wing_size"] - 0.6) * wing
    drop -= 4.6 * bump((x - 10.5) / 8.5, (y + 41.0) / 8.0)
    lift -= 1.2 * bump((x - 20.0) / 5.0, (y + 38.0) / 11.0)
    hole = nostril(x, y)
    drop += 8.0 * hole
    lift -= 3.5 * hole
    out[rows] += np.stack([side, drop, lift], axis=1)


def nostril(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Depth of the nostrils, 0 to 1, at canonical `x` and `y`."""
    return bump((np.abs(x) - 6.6 - 0.5 * (y + 42.6)) / 4.6, (y + 42.6) / 2.8)
