"""The sculptor's tools: soft masks and profiles of compact support."""

import numpy as np


def bump(*offsets: np.ndarray) -> np.ndarray:
    """`(1 - r²)³` inside the unit ball of the given scaled offsets, 0 outside; C2."""
    inside = 1.0 - sum(offset * offset for offset in offsets)
    return np.maximum(inside, 0.0) ** 3


def ramp(x: np.ndarray | float) -> np.ndarray:
    """C2 step from 0 at `x = 0` to 1 at `x = 1`."""
    t = np.clip(x, 0.0, 1.0)
    return t * t * t * (t * (6 * t - 15) + 10)


def soft_max(a: np.ndarray, b: np.ndarray, width: np.ndarray | float) -> np.ndarray:
    """Take the larger of two heights, rounded where they differ by less than about `width`."""
    return 0.5 * (a + b + np.sqrt((a - b) ** 2 + width**2))


def inside(c: np.ndarray, low: tuple[float, ...], high: tuple[float, ...]) -> np.ndarray:
    """Find the rows of `c` within an axis-aligned box."""
    return np.flatnonzero(((c > low) & (c < high)).all(axis=1))
