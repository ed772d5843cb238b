"""The mouth: two lips, the crease between them, philtrum and corners."""

import numpy as np

from .fields import bump, inside, ramp

_LEVEL = -66.0  # canonical height of the crease in the middle


def lip_curves(x: np.ndarray, p: dict[str, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Heights (canonical y) of the upper lip's edge, the crease and the lower lip's edge."""
    u = np.minimum(np.abs(x) / (p["mouth_width"] / 2), 1.0)
    crease = _LEVEL - 0.8 * bump(x / 10.0) + (p["mouth_curve"] - 0.2) * u**3
    taper = 1 - u * u
    upper = crease + p["upper_vermilion"] * taper**0.8 - p["cupids_bow"] * bump(x / 6.5) * taper
    lower = crease - p["lower_vermilion"] * taper**0.65
    return upper, crease, lower


def add_mouth(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Add the lips' displacement at canonical points `c` (right half) to `out`."""
    rows = inside(c, (-1, -100, 30), (45, -42, 200))
    x, y = c[rows, 0], c[rows, 1]
    half = p["mouth_width"] / 2
    upper, crease, lower = lip_curves(x, p)
    taper = np.maximum(1 - (x / (half + 5)) ** 2, 0.0) ** 1.5

    # Across each lip, from the crease (0) to the edge of the red (1) and a little beyond. The
    # lower lip's factor makes the two meet at the crease.
    above = y > crease
    thick = np.where(above, upper - crease, crease - lower) + 2.2
    across = np.abs(y - crease) / thick
    swell = np.where(above, _swell(across, 0.45, 1.2), 0.808 * _swell(across, 0.35, 1.26))
    lift = p["lip_fullness"] * taper * swell
    lift -= 2.2 * np.exp(-(((y - crease) / 0.8) ** 2)) * ramp((half + 3 - x) / 10)

    lift -= p["philtrum_depth"] * bump(x / 5.5, (y + 53.0) / 9.0)
    lift += 0.5 * p["philtrum_depth"] * bump((x - 6.0) / 4.0, (y + 54.0) / 9.0)
    lift -= 1.6 * bump((x - half - 2.0) / 9.0, (y + 67.0) / 9.0)
    fold = x - 22.0 + 0.42 * (y + 40.0)
    along = bump((y + 55.0) / 22.0)
    lift += p["nasolabial_depth"] * along * (0.9 * bump((fold - 7.0) / 11.0) - bump(fold / 6.0))
    out[rows, 2] += lift


def _swell(across: np.ndarray, peak: float, width: float) -> np.ndarray:
    return np.maximum(1 - ((across - peak) / width) ** 2, 0.0) ** 3
