"""Hair: where it grows on scalp, brows and chin, from 0 to 1, and how far it stands out."""

import numpy as np

from .ears import around_ear
from .fields import bump, ramp

_NAPE = -62.0  # canonical height of the lower edge of short hair


def hair_mask(c: np.ndarray, p: dict[str, float], softness: float) -> np.ndarray:
    """Hair on the scalp at canonical points, fading over `softness` mm at its edge."""
    x, y, z = np.abs(c[:, 0]), c[:, 1], c[:, 2]
    brow = p["hairline"] + p["temple_recession"] * bump((x - 40.0) / 26.0) - 3.0 * bump(x / 24.0)
    # From the nape up behind the ear, over it, down to the sideburn's tip, up to the temple and
    # on to the forehead.
    line = _NAPE + (14.0 - _NAPE) * ramp((z + 56.0) / 30.0)
    line += (-14.0 - 14.0) * ramp((z + 6.0) / 8.0) + (30.0 + 14.0) * ramp((z - 4.0) / 18.0)
    line += (brow - 30.0) * ramp((z - 22.0) / 36.0)
    return ramp(0.5 + (y - line) / softness)


def add_hair(c: np.ndarray, out: np.ndarray, p: dict[str, float]) -> None:
    """Add the volume of the hair at canonical points `c` (right half) to `out`."""
    outward = c * [1.0, 0.6, 0.8] + [0, 30, 0]
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    thick = p["hair_volume"] * ramp((c[:, 1] + 20.0) / 70.0) + 0.25 * p["hair_volume"]
    thick *= ramp((around_ear(c)[0] - 0.7) / 0.8)  # tucked behind the ears
    out += outward * (thick * hair_mask(c, p, 26.0) / 1.25)[:, None]
    # Long hair falls straight down where the neck recedes.
    hang = long_hair_mask(c, p)
    back = np.minimum(c[:, 2] + 20.0, -1.0)
    reach = np.hypot(c[:, 0] / 70.0, back / 76.0)
    stretch = hang * np.maximum(1.0 / np.maximum(reach, 0.5) - 1.0, 0.0)
    out[:, 0] += stretch * c[:, 0]
    out[:, 2] += stretch * back


def long_hair_mask(c: np.ndarray, p: dict[str, float]) -> np.ndarray:
    """Hair that hangs from the back and sides of the head past the narrower neck."""
    y, z = c[:, 1], c[:, 2]
    tip = _NAPE - p["hair_length"]
    behind = ramp((-26.0 - z - 0.1 * (y + 60.0)) / 24.0)
    return (
        ramp((p["hair_length"] - 20.0) / 35.0)
        * behind
        * ramp((-12.0 - y) / 46.0)
        * ramp((y - tip) / 40.0)
    )


def brow_mask(x: np.ndarray, y: np.ndarray, p: dict[str, float]) -> np.ndarray:
    """Eyebrows at canonical `x` (either side) and `y`."""
    u = np.clip((np.abs(x) - 33.0) / 20.0, -1.0, 1.0)
    middle = 19.0 + p["brow_height"] + 2.6 * (1 - (u - 0.3) ** 2)
    half = p["brow_thickness"] * (0.85 - 0.45 * u)
    return ramp((1 - np.abs(u)) * 3.5) * ramp(1.5 - np.abs(y - middle) / half)


def beard_mask(c: np.ndarray) -> np.ndarray:
    """Where a beard would grow at canonical points."""
    x, y, z = np.abs(c[:, 0]), c[:, 1], c[:, 2]
    top = -46.0 - 16.0 * bump((x - 34.0) / 22.0) + 30.0 * ramp((34.0 - z) / 26.0)
    bare = bump(x / 12.0, (y + 80.0) / 7.0)
    return (
        ramp((top - y) / 12.0)
        * ramp((y + 132.0) / 24.0)
        * ramp((z + 6.0) / 16.0)
        * (1 - 0.6 * bare)
    )
