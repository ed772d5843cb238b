"""Cubic splines as matrices: a curve through given values is a weighted sum of fixed profiles."""

import numpy as np


def cardinal_weights(knots: np.ndarray, at: np.ndarray, *, even: bool) -> np.ndarray:
    """Weights `W` with `W @ values` the C2 cubic spline through `values` at `knots`.

    Parameters
    ----------
    knots
        `(K,)` increasing abscissae; the first is 0.
    at
        `(N,)` abscissae to evaluate at. Beyond the last knot the end cubic goes on.
    even
        Whether the curve arrives at 0 with zero slope (it is the right half of an even
        function) or with zero curvature (of an odd one). The other end has zero curvature.

    Returns
    -------
    `(N, K)` float64.
    """
    count = len(knots)
    gap = np.diff(knots)
    system = np.zeros((count, count))
    load = np.zeros((count, count))
    inner = np.arange(1, count - 1)
    system[inner, inner - 1] = gap[:-1] / 6
    system[inner, inner] = (gap[:-1] + gap[1:]) / 3
    system[inner, inner + 1] = gap[1:] / 6
    load[inner, inner - 1] = 1 / gap[:-1]
    load[inner, inner] = -1 / gap[:-1] - 1 / gap[1:]
    load[inner, inner + 1] = 1 / gap[1:]
    system[-1, -1] = 1
    if even:
        system[0, :2] = gap[0] / 3, gap[0] / 6
        load[0, :2] = -1 / gap[0], 1 / gap[0]
    else:
        system[0, 0] = 1
    curvature = np.linalg.solve(system, load)

    left = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, count - 2)
    width = gap[left]
    upper = (at - knots[left]) / width
    lower = 1 - upper
    weights = (lower**3 - lower)[:, None] * curvature[left]
    weights += (upper**3 - upper)[:, None] * curvature[left + 1]
    weights *= (width**2 / 6)[:, None]
    rows = np.arange(len(at))
    weights[rows, left] += lower
    weights[rows, left + 1] += upper
    return weights
