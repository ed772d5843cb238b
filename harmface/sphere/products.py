"""Products of functions on the sphere, by their coefficients.

The coefficients of a product are quadratic in those of the factors, with the Gaunt tensor
`G_ijk`, the integral of `Y_i Y_j Y_k`, between them. Light times visibility times reflectance is
a triple product.

References
----------
.. [NRH04] Ng, Ramamoorthi and Hanrahan, Triple Product Wavelet Integrals for All-Frequency
   Relighting, SIGGRAPH 2004, section 4.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
"""

import functools

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.sphere.harmonics import real_harmonics
from harmface.sphere.quadrature import gauss_legendre
from harmface.sphere.transforms import degree_of_coefficients

ROUNDING = 1e-12
"""Entries below it are zero: those that are not are above 1e-3 up to degree 8."""


def gaunt_tensor(first: int, second: int, third: int) -> Float[np.ndarray, "I J K"]:
    """Return the integrals `G_ijk` of three real harmonics, [NRH04]_ eq. 9.

    A quadrature that is exact at the sum of the degrees gives them, and hence in this package's
    own signs, whatever other tables of real Gaunt coefficients say. Most of them are zero.

    Parameters
    ----------
    first, second, third
        Greatest degree of each of the three factors, at least 0.

    Returns
    -------
    ndarray
        Shape `((first + 1)**2, (second + 1)**2, (third + 1)**2)`, float64, read-only.

    Raises
    ------
    ArgumentError
        If a degree is negative.

    Examples
    --------
    >>> tensor = gaunt_tensor(2, 2, 2)
    >>> int(np.count_nonzero(tensor)), tensor[1, 1, 6].round(6)
    (83, np.float64(-0.126157))
    """
    for name, degree in (("first", first), ("second", second), ("third", third)):
        checks.degree(name, degree)
    return _gaunt_tensor(first, second, third)


@functools.lru_cache(maxsize=16)
def _gaunt_tensor(first: int, second: int, third: int) -> Float[np.ndarray, "I J K"]:
    rule = gauss_legendre(first + second + third)
    basis = real_harmonics(rule.directions, max(first, second, third))
    one, two, three = (basis[: harmonic_count(degree)] for degree in (first, second, third))
    pairs = one[:, None] * (two * rule.weights)
    tensor = pairs @ three.T
    tensor[np.abs(tensor) < ROUNDING] = 0
    tensor.flags.writeable = False
    return tensor


def multiplication_matrix(
    coefficients: Float[np.ndarray, "*functions J"], max_degree: int, product_degree: int
) -> Float[np.ndarray, "*functions I K"]:
    """Return the matrices that multiply other functions by given ones.

    If `f` has the coefficients and `g` others up to `max_degree`, those of `f g` up to
    `product_degree` are `g @ matrix`: light that changes takes a visibility that is known, or a
    visibility that changes takes a reflectance.

    Parameters
    ----------
    coefficients
        Coefficients of `f`.
    max_degree
        Greatest degree of the other factor.
    product_degree
        Degree to which the product is wanted. It has more: the sum of both.

    Returns
    -------
    numpy.ndarray
        Shape `(*functions, I, K)`: rows for the other factor, columns for the product.

    Raises
    ------
    ArgumentError
        If `J` is not a square, a coefficient is not finite, or a degree is negative.

    Examples
    --------
    By the constant function 1 nothing is changed:

    >>> multiplication_matrix(np.array([np.sqrt(4 * np.pi)]), 1, 1).round(12)
    array([[1., 0., 0., 0.],
           [0., 1., 0., 0.],
           [0., 0., 1., 0.],
           [0., 0., 0., 1.]])
    """
    coefficients = checks.finite("coefficients", coefficients)
    tensor = gaunt_tensor(degree_of_coefficients(coefficients), max_degree, product_degree)
    flat = tensor.astype(coefficients.dtype).reshape(len(tensor), -1)
    return (coefficients @ flat).reshape(*coefficients.shape[:-1], *tensor.shape[1:])


def product(
    first: Float[np.ndarray, "*functions I"],
    second: Float[np.ndarray, "*functions J"],
    max_degree: int | None = None,
) -> Float[np.ndarray, "*functions K"]:
    """Return the coefficients of the product of functions.

    Parameters
    ----------
    first, second
        Coefficients of the factors; their leading axes broadcast.
    max_degree
        Degree to which the product is returned; by default the sum of both degrees, all of it.

    Returns
    -------
    numpy.ndarray
        Shape `(*functions, K)`, K = (degree + 1)**2.

    Raises
    ------
    ArgumentError
        If a last axis is not a square, a coefficient is not finite, or the degree is negative.

    Examples
    --------
    The square of `Y_10` is `(2 Y_20 / sqrt(5) + Y_00) / sqrt(4 pi)`:

    >>> product(np.eye(4)[2], np.eye(4)[2]).round(6)[[0, 6]]
    array([0.282095, 0.252313])
    """
    first = checks.finite("first", first)
    second = checks.finite("second", second)
    one, two = degree_of_coefficients(first), degree_of_coefficients(second)
    matrix = multiplication_matrix(second, one, one + two if max_degree is None else max_degree)
    return np.einsum("...i,...ik->...k", first, matrix)


def triple_product(
    first: Float[np.ndarray, "*functions I"],
    second: Float[np.ndarray, "*functions J"],
    third: Float[np.ndarray, "*functions K"],
) -> Float[np.ndarray, "*functions"]:
    """Return the integrals of light x visibility x reflectance, [NRH04]_ eq. 5.

    Parameters
    ----------
    first, second, third
        Coefficients of the three; their leading axes broadcast.

    Returns
    -------
    numpy.ndarray
        Integrals over the sphere, shape `(*functions)`.

    Raises
    ------
    ArgumentError
        If a last axis is not a square, or a coefficient is not finite.

    Examples
    --------
    >>> one = np.array([np.sqrt(4 * np.pi)])
    >>> triple_product(one, one, one).round(6)
    np.float64(12.566371)
    """
    third = checks.finite("third", third)
    both = product(first, second, degree_of_coefficients(third))
    return np.asarray(np.einsum("...k,...k->...", both, third))
