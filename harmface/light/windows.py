"""Windows against ringing: weights per degree that fade the higher ones out.

Cutting a harmonic series short makes a small bright light ring, and irradiance may fall below
zero on the far side. Nothing in this package applies a window unless asked to. Those of Hann and
Lanczos, as in [S08]_, only soften the ringing; `non_negative_window` ends what falls below zero.

References
----------
.. [LH74] Lawson and Hanson, Solving Least Squares Problems, 1974.
.. [S08] Sloan, Stupid Spherical Harmonics (SH) Tricks, GDC 2008.
"""

import numpy as np
from jaxtyping import Bool, Float
from numpy.polynomial.legendre import legder, legroots, legval, legvander

from harmface import checks
from harmface.conventions import degrees, max_degree_of
from harmface.errors import ArgumentError

ROUNDS = 8
"""How often the points where a kernel dips are added to those where it is held above zero."""

LEVEL = 1e-6
"""Imaginary part below which a root of the slope counts as real: a double root splits by about
the root of eps, and a point too many does no harm."""


def hann_window(max_degree: int, width: float | None = None) -> Float[np.ndarray, "L"]:
    """Return `(1 + cos(pi l / width)) / 2` for every degree `l`, and 0 beyond the width.

    Parameters
    ----------
    max_degree
        Highest degree.
    width
        Where the window reaches zero, above 0; by default at the first degree left out.

    Returns
    -------
    numpy.ndarray
        Shape (max_degree + 1,), float64.

    Examples
    --------
    >>> hann_window(2).round(6)
    array([1.  , 0.75, 0.25])
    """
    degree, width = _ramp(max_degree, width)
    return np.where(degree < width, (1 + np.cos(np.pi * degree / width)) / 2, 0)


def lanczos_window(max_degree: int, width: float | None = None) -> Float[np.ndarray, "L"]:
    """Return `sin(pi l / width) / (pi l / width)` for every degree `l`, and 0 beyond the width.

    The arguments are those of `hann_window`.

    Parameters
    ----------
    max_degree
        Highest degree.
    width
        Degree from which on weights are 0; `max_degree + 1` if not given.

    Returns
    -------
    numpy.ndarray
        Shape (max_degree + 1,), float64.
    """
    degree, width = _ramp(max_degree, width)
    return np.where(degree < width, np.sinc(degree / width), 0)


def non_negative_window(transfer: Float[np.ndarray, "L"]) -> Float[np.ndarray, "L"]:
    """Return the mildest window under which no light, itself non-negative, has a negative result.

    The cut series of a light is the light convolved with a kernel, a Legendre series. Where the
    kernel is nowhere negative, neither is the result, whatever the light. Of all such kernels of
    the same mean this window makes the one nearest in the mean square. It is found by holding the
    kernel above zero at ever more of the points where it would dip; the little that is left is
    raised by fading all degrees above 0 a trifle more.

    Parameters
    ----------
    transfer
        By what each degree of radiance is multiplied: `reflectance.lambert_coefficients(n)` for
        irradiance, ones for radiance itself; the first must be positive.

    Returns
    -------
    numpy.ndarray
        One weight a degree, 1 at degree 0; degrees that are not transferred keep weight 1.

    Raises
    ------
    ArgumentError
        If the first is not positive, or one is NaN or infinite.

    Examples
    --------
    Irradiance of degree 2, whose kernel would dip to -4 % of a light's irradiance:

    >>> non_negative_window(np.pi * np.array([1, 2 / 3, 1 / 4])).round(3)
    array([1.   , 0.858, 0.909])
    """
    transfer = checks.finite("transfer", transfer).astype(np.float64)
    if transfer.ndim != 1 or not transfer.size or transfer[0] <= 0:
        raise ArgumentError("transfer must be a list of numbers, the first positive")
    degree = np.arange(len(transfer))
    kernel = (2 * degree + 1) / (4 * np.pi) * transfer
    free = (degree > 0) & (transfer != 0)
    window = np.ones(len(transfer))
    cosines = _level_points(kernel)
    for _ in range(ROUNDS):
        window[free] = 1 + _least_change(kernel, free, cosines) / kernel[free]
        cosines = np.append(cosines, _level_points(kernel * window))
    below = max(0.0, -legval(_level_points(kernel * window), kernel * window).min())
    window[free] *= kernel[0] / (kernel[0] + below)
    return window


def _least_change(
    kernel: Float[np.ndarray, "L"],
    free: Bool[np.ndarray, "L"],
    cosines: Float[np.ndarray, "points"],
) -> Float[np.ndarray, "free"]:
    """Return the least change of a Legendre series that lifts it to zero at some points.

    Least in the mean square over the sphere: with coefficients `z` of orthonormal functions, the
    least `z` with `G z >= h` is a problem of non-negative least squares, [LH74]_ chapter 23.
    """
    from scipy.optimize import nnls  # takes a quarter of a second to load

    degree = np.arange(len(kernel))
    norms = np.sqrt((2 * degree[free] + 1) / (4 * np.pi))
    values = legvander(cosines, len(kernel) - 1)
    dual = np.vstack([(values[:, free] * norms).T, -values @ kernel])
    target = np.append(np.zeros(len(norms)), 1.0)
    residual = dual @ nnls(dual, target)[0] - target
    return -residual[:-1] / residual[-1] * norms


def windowed(
    coefficients: Float[np.ndarray, "*channels K"], window: Float[np.ndarray, "L"]
) -> Float[np.ndarray, "*channels K"]:
    """Return coefficients with each degree multiplied by its weight.

    Parameters
    ----------
    coefficients
        Lighting coefficients, shape `(*channels, K)`.
    window
        A weight for each degree.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, K)`.

    Raises
    ------
    ArgumentError
        If the window has not one weight for every degree.
    """
    coefficients = checks.finite("coefficients", coefficients)
    window = checks.finite("window", window)
    max_degree = max_degree_of(coefficients.shape[-1])
    if window.shape != (max_degree + 1,):
        raise ArgumentError(
            f"window must have {max_degree + 1} weights, one a degree, got shape {window.shape}"
        )
    return coefficients * window[degrees(max_degree)].astype(coefficients.dtype)


def _ramp(max_degree: int, width: float | None) -> tuple[Float[np.ndarray, "L"], float]:
    degree = np.arange(checks.degree("max_degree", max_degree) + 1.0)
    width = max_degree + 1.0 if width is None else width
    if not width > 0:
        raise ArgumentError(f"width must be positive, got {width}")
    return degree, width


def _level_points(series: Float[np.ndarray, "L"]) -> Float[np.ndarray, "points"]:
    """Return where a Legendre series on [-1, 1] may be least: at the ends or where it is level."""
    roots = legroots(legder(series))
    level = roots.real[(np.abs(roots.imag) < LEVEL) & (np.abs(roots.real) < 1)]
    return np.append(level, [-1.0, 1.0])
