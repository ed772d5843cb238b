"""The nose: ridge, tip, wings, nostrils and the fold behind the wings."""

import numpy as np

from .fields import bump, inside
from .splines import cardinal_weights

# Along the mid-line from above the root to the lip: canonical height, then how far the skin is
# pushed down and forward, and the half width of the ridge there. Millimetres.
_TOP = 14.0
_PROFILE = np.array([
    # y0   down  out  half width
    (14.0, 0.0,  0.0, 10.0),
    (6.0,  0.0,  1.5, 9.5),
    (0.0,  0.0,  4.5, 9.5),
    (-7.0, 0.0,  9.3, 11.0),
    (-15.0, 0.5, 14.3, 12.5),
    (-22.0, 1.1, 18.4, 13.0),
    (-28.0, 1.9, 21.4, 13.5),
    (-33.0, 3.0, 22.6, 14.0),
    (-36.5, 3.8, 21.4, 14.0),
    (-40.0, 3.4, 18.2, 13.5),
    (-43.0, 2.0, 11.6, 12.5),
    (-46.0, 0.3,  4.0, 12.0),
    (-50.0, -0.3, 0.8, 12.0),
    (-55.0, 0.0,  0.0, 12.0),
])  # fmt: skip


def add_nose(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Add the nose's displacement at canonical points `c` (right half) to `out`."""
    rows = inside(c, (-1, -55, 30), (34, _TOP, 200))
    x, y = c[rows, 0], c[rows, 1]
    weights = cardinal_weights(_TOP - _PROFILE[:, 0], _TOP - y, even=False)
    down, forward, half = (weights @ _PROFILE[:, 1:]).T
    tip = bump((y + 33.0) / 17.0)
    forward += (p["nose_protrusion"] - 19.5) * bump((y + 30.0) / 34.0)
    forward += (p["bridge_height"] - 4.5) * bump(y / 24.0)
    forward += p["nasal_hump"] * bump((y + 13.0) / 14.0)
    half += (p["bridge_breadth"] - 13.0) * bump((y + 8.0) / 22.0) + (p["tip_breadth"] - 9.0) * tip
    ridge = 0.8 * np.maximum(1 - (x / half) ** 2, 0.0) ** 1.6 + 0.2 * bump(x / (half + 12.0))
    lift = forward * ridge
    drop = -(down + p["tip_drop"] * tip) * ridge

    # The tip is a ball; the wings stand out sideways and end in a fold towards the cheek.
    lift += 2.6 * bump(x / (p["tip_breadth"] + 5.0), (y + 33.5) / 11.0)
    wing = bump((x - 11.5) / 8.5, (y + 38.5) / 10.0)
    side = (4.2 + (p["nose_breadth"] - 34.5) / 2) * wing
    lift += (p["wing_size"] + 3.0) * wing
    drop -= 3.2 * wing
    lift -= 1.5 * bump((x - 20.0) / 5.0, (y + 38.0) / 11.0)
    hole = nostril(x, y)
    drop += 7.0 * hole
    lift -= 3.5 * hole
    out[rows] += np.stack([side, drop, lift], axis=1)


def nostril(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Depth of the nostrils, 0 to 1, at canonical `x` and `y`."""
    return bump((np.abs(x) - 6.6 - 0.5 * (y + 42.6)) / 4.6, (y + 42.6) / 2.8)
