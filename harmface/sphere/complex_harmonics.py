"""Complex harmonics, and the conversion to and from the real ones.

With the Condon-Shortley phase, for m > 0 and real harmonics R,

    Y_lm   = (-1)^m (R_lm + i R_l,-m) / sqrt 2,
    Y_l,-m =        (R_lm - i R_l,-m) / sqrt 2,        Y_l0 = R_l0:

a unitary matrix in each pair of orders. Coefficients transform by its conjugate, so that sums
of coefficient times harmonic agree; those of a real function have c_l,-m = (-1)^m conj c_lm.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Complex, Float, Int

from harmface import checks
from harmface.conventions import max_degree_of, orders
from harmface.errors import ArgumentError
from harmface.sphere.harmonics import real_harmonics


class Pairs(NamedTuple):
    """Flat indices of the harmonics of order m > 0, of their partners, and the phases."""

    positive: Int[np.ndarray, "P"]
    negative: Int[np.ndarray, "P"]
    phase: Float[np.ndarray, "P"]
    """(-1)^m."""


def pairs(max_degree: int) -> Pairs:
    """Return the pairs of orders m and -m up to a degree."""
    order = orders(max_degree)
    positive = np.flatnonzero(order > 0)
    order = order[positive]
    return Pairs(positive, positive - 2 * order, 1.0 - 2.0 * (order % 2))


def complex_harmonics(
    directions: Float[np.ndarray, "*pixels 3"], max_degree: int
) -> Complex[np.ndarray, "K *pixels"]:
    """Return the complex orthonormal harmonics with Condon-Shortley phase, [R05]_ eq. 11-12.

    They are those of `scipy.special.sph_harm_y`.

    Parameters
    ----------
    directions
        Unit vectors, shape `(*pixels, 3)`.
    max_degree
        Greatest degree, at least 0.

    Returns
    -------
    ndarray
        Harmonic `k = l (l + 1) + m` in row `k`, shape `(K, *pixels)`, complex64 for float32
        directions and complex128 for float64.

    Raises
    ------
    ArgumentError
        If a direction is not of unit length, or the degree is negative.

    Examples
    --------
    >>> complex_harmonics(np.array([0.0, 1.0, 0.0]), 1).round(6) + 0.0
    array([0.282095+0.j , 0. -0.345494j, 0. +0.j , 0. -0.345494j])
    """
    real = real_harmonics(directions, max_degree)
    # As coefficients do, up to the conjugate.
    return np.moveaxis(_pair_up(np.moveaxis(real, 0, -1)).conj(), -1, 0)


def real_to_complex(coefficients: Float[np.ndarray, "... K"]) -> Complex[np.ndarray, "... K"]:
    """Return coefficients of the complex harmonics from those of the real harmonics.

    Parameters
    ----------
    coefficients
        Finite coefficients of real functions, shape `(..., K)`.

    Returns
    -------
    numpy.ndarray
        Shape (..., K), complex.

    Raises
    ------
    ArgumentError
        If `K` is not a square or a coefficient is not finite.
    """
    return _pair_up(checks.finite("coefficients", coefficients))


def _pair_up(real: Float[np.ndarray, "... K"]) -> Complex[np.ndarray, "... K"]:
    positive, negative, phase = pairs(max_degree_of(real.shape[-1]))
    result = real.astype(np.result_type(real, np.complex64))
    half = np.sqrt(0.5).astype(real.dtype)
    even, odd = half * real[..., positive], half * real[..., negative]
    result[..., negative] = even + 1j * odd
    result[..., positive] = phase.astype(real.dtype) * (even - 1j * odd)
    return result


def complex_to_real(coefficients: Complex[np.ndarray, "... K"]) -> Float[np.ndarray, "... K"]:
    """Return coefficients of the real harmonics from those of the complex harmonics.

    Parameters
    ----------
    coefficients
        Finite coefficients of real functions, shape `(..., K)`.

    Returns
    -------
    numpy.ndarray
        Shape (..., K), float.

    Raises
    ------
    ArgumentError
        If `K` is not a square, a coefficient is not finite, or the function is not real.
    """
    coefficients = checks.array_of("coefficients", coefficients)
    if coefficients.dtype not in (np.complex64, np.complex128):
        raise ArgumentError(f"coefficients must be complex, got dtype {coefficients.dtype}")
    real, imaginary = checks.finite(
        "coefficients", np.stack([coefficients.real, coefficients.imag])
    )
    max_degree = max_degree_of(coefficients.shape[-1])
    positive, negative, phase = pairs(max_degree)
    zonal = np.flatnonzero(orders(max_degree) == 0)
    phase = phase.astype(real.dtype)
    half = np.sqrt(0.5).astype(real.dtype)
    result = np.empty_like(real)
    result[..., zonal] = real[..., zonal]
    result[..., positive] = half * (phase * real[..., positive] + real[..., negative])
    result[..., negative] = half * (imaginary[..., negative] - phase * imaginary[..., positive])
    departure = np.abs(_pair_up(result) - coefficients).max(initial=0)
    size = np.abs(coefficients).max(initial=0)
    if departure > np.sqrt(np.finfo(real.dtype).eps) * size:
        raise ArgumentError(
            "coefficients must belong to a real function, c(l, -m) = (-1)^m conj c(l, m), "
            f"got a departure of {departure:.3g} with a greatest size of {size:.3g}"
        )
    return result
