"""The eyes: eyeball, cornea, lids with their margins, and the fold above."""

import numpy as np

from .fields import bump, inside, ramp, soft_max
from .parameters import MEAN

CENTRE = (31.0, 0.0)  # canonical x and y of the pupil
_BALL = 12.0  # radius of the eyeball, mm
_DEPTH = 66.0  # canonical z of its centre
_LID = 1.6  # thickness of a lid
_MARGIN = 1.1  # width over which a lid falls to the eyeball


def fissure(x: np.ndarray, p: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Heights of the upper and lower lid margin at horizontal offset `x` from the pupil."""
    length, high = p["fissure_length"], p["fissure_height"]
    u = np.clip(x / length + 0.5, 0.0, 1.0)
    line = np.tan(np.radians(p["canthal_tilt"])) * length * (u - 0.45)
    arch = np.sqrt(4 * u * (1 - u))
    return line + 0.47 * high * arch * (1.15 - 0.3 * u), line - 0.50 * high * arch * (0.8 + 0.4 * u)


def opening(x: np.ndarray, y: np.ndarray, p: dict[str, float]) -> np.ndarray:
    """How open the eye is, 0 (skin) to 1 (eyeball), at offsets from the pupil."""
    upper, lower = fissure(x, p)
    gap = ramp((upper - y) / _MARGIN + 0.5) * ramp((y - lower) / _MARGIN + 0.5)
    return gap * ramp((upper - lower - 0.3) / 2.5)


def add_eyes(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Bring the skin at canonical points `c` (right half) to lids and eyeball."""
    rows = inside(c, (-2, -25, 20), (64, 25, 200))
    x, y = c[rows, 0] - CENTRE[0], c[rows, 1] - CENTRE[1]
    reach = np.hypot(x, y)

    def dome(radius: float) -> np.ndarray:
        cap = np.sqrt(np.maximum(radius**2 - reach**2, 0.0) + 4.0) - 2.0
        return _DEPTH - p["eye_depth"] + cap - radius / 2 * np.maximum(reach - radius, 0.0)

    skin = c[rows, 2] + out[rows, 2]
    upper, lower = fissure(x, p)
    middle = bump(x / 20.0)
    socket = skin + p["lid_fold"] * middle * bump((y - upper - 7.0) / 4.5)
    socket -= 1.0 * middle * bump((y - upper - 2.8) / 3.2)
    socket += p["eye_bag"] * middle * bump((y - lower + 6.5) / 4.5)
    socket -= 0.8 * p["eye_bag"] * middle * bump((y - lower + 11.0) / 4.5)
    lid = soft_max(socket, dome(_BALL + _LID), np.where(y > 0, 1.6, 3.2))
    ball = dome(_BALL) + 0.9 * bump(reach / 6.8)
    wet = np.minimum(soft_max(ball, lid - 2.4, 0.8), lid - 0.5)
    height = lid + opening(x, y, p) * (wet - lid)
    within = ramp((1 - np.hypot(x / 32.0, y / 24.0)) / 0.42)
    out[rows, 2] += within * (height - skin)
    out[rows, 0] += (p["intercanthal_width"] - MEAN["intercanthal_width"]) / 2 * within
