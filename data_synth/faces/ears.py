"""The ears: a small loft of rings, from the skin round the ear over the rim into the concha."""

import numpy as np

from .fields import ramp
from .splines import cardinal_weights

CENTRE = (-17.0, -20.0)  # canonical y and z of the middle of the ear
_SIDE = 70.0  # canonical x of the skin there
_FOOT = (32.0, 17.0)  # half height and half length of the patch of skin that becomes the ear

# Rings from the root to the concha, at eight directions in the plane of the ear: backward, then
# up and back, up, up and forward, forward, down and forward, down, down and back.
_RINGS = np.array([0.0, 0.14, 0.26, 0.36, 0.46, 0.57, 0.70, 0.82, 0.92])
_OUT = np.array([  # distance from the middle as a fraction of the outline's
    # back  ub    up    uf    fwd   df    down  db
    (0.00, 0.00, 0.00, 0.00, 0.00, 0.00, 0.00, 0.00),
    (0.24, 0.24, 0.22, 0.24, 0.30, 0.22, 0.16, 0.22),
    (0.44, 0.46, 0.44, 0.45, 0.56, 0.42, 0.32, 0.44),
    (0.58, 0.60, 0.62, 0.62, 0.72, 0.64, 0.48, 0.58),
    (0.76, 0.76, 0.78, 0.76, 0.86, 0.80, 0.68, 0.76),
    (0.93, 0.93, 0.92, 0.90, 0.94, 0.90, 0.90, 0.92),
    (1.00, 1.00, 1.00, 1.00, 1.00, 0.96, 1.00, 1.00),
    (0.90, 0.92, 0.95, 1.00, 1.04, 0.99, 0.93, 0.92),
    (0.30, 0.60, 0.80, 1.02, 1.10, 1.02, 0.72, 0.50),
])  # fmt: skip
_HIGH = np.array([  # height over the plane of the ear, mm
    (-9.0, -9.0, -9.0, -9.0, -9.0, -9.0, -9.0, -9.0),
    (-7.0, -5.0, -6.0, -7.0, -5.0, -7.0, -5.0, -7.0),
    (0.0,  1.0, -1.0, -4.0,  3.5, -2.0,  2.0,  1.5),
    (2.5,  2.5,  1.5, -2.5,  4.0,  0.0,  1.0,  2.5),
    (-1.0, -1.0, -1.5, -1.0, 1.0,  0.0,  0.5, -0.5),
    (1.5,  2.0,  2.0,  1.5,  1.5,  0.5,  0.8,  1.0),
    (0.0,  0.0,  0.0,  1.0,  1.8,  0.5, -0.5,  0.0),
    (-3.0, -3.0, -2.0,  0.8,  1.6,  0.5, -1.5, -3.0),
    (-6.0, -6.0, -4.0,  0.0,  1.0,  0.0, -3.0, -6.0),
])  # fmt: skip


def add_ears(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Lift the skin at canonical points `c` (right half) into the ear."""
    reach, angle = around_ear(c)
    rows = np.flatnonzero((reach < 1) & (c[:, 0] > 40))
    reach, angle = reach[rows], angle[rows]

    round_ = _periodic_weights(angle, _OUT.shape[1])
    along = cardinal_weights(_RINGS, reach, even=True)
    fraction = np.einsum("nr,ra,na->n", along, _OUT, round_)
    high = np.einsum("nr,ra,na->n", along, _HIGH, round_)
    wide = p["ear_breadth"] * (0.485 + 0.075 * np.sin(angle))
    tall = p["ear_height"] / 2 - p["lobe_size"] * np.minimum(np.sin(angle), 0) * 0.5
    back, up = fraction * wide * np.cos(angle), fraction * tall * np.sin(angle)

    flare, lean = np.radians(p["ear_flare"]), np.radians(12.0)
    hinge = 15.0
    lateral = (back + hinge) * np.sin(flare) + high * np.cos(flare)
    rear = back * np.cos(flare) - high * np.sin(flare)
    rear, up = rear * np.cos(lean) + up * np.sin(lean), up * np.cos(lean) - rear * np.sin(lean)
    skin = c[rows] + out[rows]
    target = np.stack(
        [_SIDE + lateral, CENTRE[0] + p["ear_level"] + up, CENTRE[1] + 2 - rear], axis=1
    )
    blend = ramp((1.0 - reach) / 0.13)[:, None]
    out[rows] += blend * (target - skin)


def around_ear(c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the middle of the ear, 1 at the edge of its patch of skin, and direction."""
    s, t = (CENTRE[1] - c[:, 2]) / _FOOT[1], (c[:, 1] - CENTRE[0]) / _FOOT[0]
    return np.hypot(s, t), np.arctan2(t, s)


def _periodic_weights(angle: np.ndarray, count: int) -> np.ndarray:
    """Cardinal trigonometric weights `(N, count)` of a closed curve through `count` values."""
    gap = angle[:, None] - 2 * np.pi * np.arange(count) / count
    terms = sum(np.cos(k * gap) for k in range(1, count // 2))
    return (1 + 2 * terms + np.cos(count // 2 * gap)) / count
