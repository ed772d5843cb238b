"""Lambert's law as a filter: the spectrum of the clamped cosine.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
"""

import math

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees


def lambert_coefficients(max_degree: int) -> Float[np.ndarray, "L"]:
    """Return A_l, by which irradiance scales the radiance of degree `l`, [RH01]_ eq. 8-9.

    With a circumflex in [RH01]_: `E_lm = A_l L_lm`. It is pi at degree 0, 2 pi / 3 at degree 1,
    zero at all other odd degrees, and decays as the power -5/2 of the degree.

    Parameters
    ----------
    max_degree
        Greatest degree, at least 0.

    Returns
    -------
    ndarray
        Coefficients, shape `(max_degree + 1,)`, float64, within 2 eps at any degree.

    Raises
    ------
    ArgumentError
        If the degree is negative.

    Examples
    --------
    >>> lambert_coefficients(4).round(6)
    array([ 3.141593,  2.094395,  0.785398,  0.      , -0.1309  ])
    """
    coefficients = np.zeros(checks.degree("max_degree", max_degree) + 1)
    coefficients[1:2] = 2 * math.pi / 3
    for degree in range(0, max_degree + 1, 2):
        sign = (-1) ** (degree // 2 + 1)
        spread = (degree + 2) * (degree - 1)
        coefficients[degree] = 2 * math.pi * sign / spread * central_binomial(degree)
    return coefficients


def central_binomial(degree: int) -> float:
    """Return the bracket of [RH01]_ eq. 8, `l! / (2^l (l/2)!^2)`, at an even degree.

    Python divides whole numbers of any size with a single rounding, so that nothing overflows.

    Examples
    --------
    >>> central_binomial(4), round(central_binomial(10000), 9)
    (0.375, 0.007978646)
    """
    return math.comb(degree, degree // 2) / (1 << degree)


def lambda_normalization(max_degree: int) -> Float[np.ndarray, "L"]:
    """Return Lambda_l = sqrt(4 pi / (2l + 1)), [R05]_ eq. 24, shape `(max_degree + 1,)`.

    Parameters
    ----------
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Shape (max_degree + 1,), float64.

    Raises
    ------
    ArgumentError
        If `max_degree` is negative or not whole.

    Examples
    --------
    >>> lambda_normalization(1).round(6)
    array([3.544908, 2.046653])
    """
    degree = np.arange(checks.degree("max_degree", max_degree) + 1)
    return np.sqrt(4 * math.pi / (2 * degree + 1))


def clamped_cosine_coefficients(max_degree: int) -> Float[np.ndarray, "L"]:
    """Return the coefficients of max(cos, 0) itself, [R05]_ eq. 21 and 28.

    They are A_l / Lambda_l, those of the harmonics of order 0, shape `(max_degree + 1,)`.

    Parameters
    ----------
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Shape (max_degree + 1,), float64.

    Examples
    --------
    >>> clamped_cosine_coefficients(2).round(6)
    array([0.886227, 1.023327, 0.495416])
    """
    return lambert_coefficients(max_degree) / lambda_normalization(max_degree)


def lambert_per_coefficient(max_degree: int) -> Float[np.ndarray, "K"]:
    """Return A_l for every flat index, so that irradiance is this times the radiance.

    Parameters
    ----------
    max_degree
        Greatest degree, at least 0.

    Returns
    -------
    ndarray
        `A_l` repeated `2l + 1` times, shape `((max_degree + 1)**2,)`, float64.

    Examples
    --------
    >>> lambert_per_coefficient(1).round(6)
    array([3.141593, 2.094395, 2.094395, 2.094395])
    """
    return lambert_coefficients(max_degree)[degrees(max_degree)]
