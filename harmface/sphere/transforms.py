"""Between functions on the sphere and their coefficients.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.sphere.harmonics import real_harmonics
from harmface.sphere.quadrature import Quadrature


def project(
    values: Float[np.ndarray, "... J"], quadrature: Quadrature, max_degree: int
) -> Float[np.ndarray, "... K"]:
    """Return the coefficients of functions sampled at the directions of a quadrature.

    Each coefficient is the integral of function times harmonic, [RH01]_ eq. 10. It is exact for
    functions of degree at most `quadrature.degree - max_degree`.

    Parameters
    ----------
    values
        Finite values at `quadrature.directions`, shape `(..., J)`.
    quadrature
        A rule of degree at least `2 max_degree`, so that the harmonics stay orthonormal on it.
    max_degree
        Greatest degree of the coefficients, at least 0.

    Returns
    -------
    ndarray
        Coefficients, shape `(..., K)`, in the precision of `values`; summed in float64.

    Raises
    ------
    ArgumentError
        If the shapes disagree, a value is not finite, or the rule is of too low a degree.
    """
    max_degree = checks.degree("max_degree", max_degree)
    values = checks.finite("values", values)
    count = quadrature.weights.size
    if values.ndim == 0 or values.shape[-1] != count:
        raise ArgumentError(
            f"values must have shape (..., {count}), one for each direction of the quadrature, "
            f"got {values.shape}"
        )
    if quadrature.degree < 2 * max_degree:
        raise ArgumentError(
            f"quadrature must be of degree {2 * max_degree} or more to tell harmonics up to "
            f"degree {max_degree} apart, got degree {quadrature.degree}"
        )
    weighted = quadrature.weights * real_harmonics(quadrature.directions, max_degree)
    return (values @ weighted.T).astype(values.dtype)


def project_function(
    function: Callable[[Float[np.ndarray, "J 3"]], Float[np.ndarray, "... J"]],
    quadrature: Quadrature,
    max_degree: int,
) -> Float[np.ndarray, "... K"]:
    """Return the coefficients of a function of directions, [RH01]_ eq. 10; see `project`.

    Parameters
    ----------
    function
        Takes directions, (J, 3), and returns values, (..., J).
    quadrature
        Where to sample the function.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Shape (..., K).

    Examples
    --------
    >>> from harmface.sphere import gauss_legendre
    >>> project_function(lambda w: w[:, 2], gauss_legendre(2), 1).round(6) + 0.0
    array([0.      , 0.      , 2.046653, 0.      ])
    """
    return project(function(quadrature.directions), quadrature, max_degree)


def synthesize(
    coefficients: Float[np.ndarray, "... K"], directions: Float[np.ndarray, "*pixels 3"]
) -> Float[np.ndarray, "..."]:
    """Return the functions of some coefficients at directions, [RH01]_ eq. 4.

    Parameters
    ----------
    coefficients
        Finite coefficients, shape `(..., K)`.
    directions
        Unit vectors, shape `(*pixels, 3)`.

    Returns
    -------
    ndarray
        Values, shape `(..., *pixels)`.

    Raises
    ------
    ArgumentError
        If `K` is not a square, a coefficient is not finite, or a direction not of unit length.
    """
    coefficients = checks.finite("coefficients", coefficients)
    harmonics = real_harmonics(directions, degree_of_coefficients(coefficients))
    return np.tensordot(coefficients, harmonics, axes=1)


def energy_per_degree(coefficients: Float[np.ndarray, "... K"]) -> Float[np.ndarray, "... L"]:
    """Return the energy of a function in each degree, which no rotation changes.

    The sum over the degrees is the integral of the squared function (Parseval).

    Parameters
    ----------
    coefficients
        Finite coefficients, shape `(..., K)`.

    Returns
    -------
    ndarray
        Sums of squared coefficients, shape `(..., max_degree + 1)`.

    Raises
    ------
    ArgumentError
        If a coefficient is not finite, or K is not a square.

    Examples
    --------
    >>> energy_per_degree(np.array([2.0, 1.0, 2.0, 3.0]))
    array([ 4., 14.])
    """
    coefficients = checks.finite("coefficients", coefficients)
    starts = np.square(np.arange(degree_of_coefficients(coefficients) + 1))
    energy = np.add.reduceat(np.square(coefficients, dtype=np.float64), starts, axis=-1)
    return energy.astype(coefficients.dtype)


def degree_of_coefficients(coefficients: Float[np.ndarray, "... K"]) -> int:
    """Return the degree up to which the last axis of `coefficients` reaches.

    Raises
    ------
    ArgumentError
        If its length is not a square.
    """
    if coefficients.ndim == 0:
        raise ArgumentError("coefficients must have shape (..., K), got a single number")
    return max_degree_of(coefficients.shape[-1])
