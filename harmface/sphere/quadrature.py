"""Rules that integrate every harmonic up to a stated degree exactly.

References
----------
.. [LL99] Lebedev and Laikov, A quadrature formula for the sphere of the 131st algebraic order of
   accuracy, Doklady Mathematics 59, 1999.
"""

import functools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.summaries import summary

# The orders of [LL99]_, without 13, 25 and 27, some of whose weights are negative.
LEBEDEV_ORDERS = (
    *(3, 5, 7, 9, 11, 15, 17, 19, 21, 23, 29, 31, 35, 41, 47, 53, 59),
    *(65, 71, 77, 83, 89, 95, 101, 107, 113, 119, 125, 131),
)


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Directions and weights: the integral of `f` over the sphere is `f(directions) @ weights`.

    Parameters
    ----------
    directions
        Unit vectors, shape (J, 3).
    weights
        Solid angles in steradians, shape (J,); they sum to 4 pi.
    degree
        Every harmonic up to this degree is integrated exactly.
    """

    directions: Float[np.ndarray, "J 3"]
    weights: Float[np.ndarray, "J"]
    degree: int

    __repr__ = summary

    def __post_init__(self) -> None:
        checks.degree("degree", self.degree)
        checks.unit_vectors("directions", self.directions)
        checks.finite("weights", self.weights)
        if self.directions.ndim != 2 or self.weights.shape != self.directions.shape[:1]:
            raise ArgumentError(
                "a quadrature needs directions of shape (J, 3) and weights of shape (J,), "
                f"got {self.directions.shape} and {self.weights.shape}"
            )


def gauss_legendre(degree: int) -> Quadrature:
    """Return the product of a Gauss-Legendre rule in z and a uniform rule in azimuth.

    It has `(degree // 2 + 1) (degree + 1)` directions, at any degree.

    Parameters
    ----------
    degree
        Degree up to which harmonics are integrated exactly, at least 0.

    Returns
    -------
    Quadrature
        Of `degree // 2 + 1` rows of `degree + 1` directions.

    Raises
    ------
    ArgumentError
        If `degree` is negative or not whole.

    Examples
    --------
    >>> rule = gauss_legendre(4)
    >>> rule.directions.shape, round(float(rule.directions[:, 2] ** 4 @ rule.weights), 12)
    ((15, 3), 2.513274122872)
    """
    return _gauss_legendre(checks.degree("degree", degree))


@functools.lru_cache(maxsize=16)
def _gauss_legendre(degree: int) -> Quadrature:
    # n nodes are exact for polynomials of degree 2n - 1, and n azimuths for orders below n.
    heights, weights = np.polynomial.legendre.leggauss(degree // 2 + 1)
    azimuths = 2 * np.pi / (degree + 1) * np.arange(degree + 1)
    radii = np.sqrt((1 - heights) * (1 + heights))
    directions = np.empty((heights.size, azimuths.size, 3))
    directions[..., 0] = np.outer(radii, np.cos(azimuths))
    directions[..., 1] = np.outer(radii, np.sin(azimuths))
    directions[..., 2] = heights[:, np.newaxis]
    return _frozen(
        directions.reshape(-1, 3),
        np.repeat(weights * (2 * np.pi / azimuths.size), azimuths.size),
        degree,
    )


def lebedev(degree: int) -> Quadrature:
    """Return the smallest Lebedev rule, [LL99]_, that is exact up to a degree.

    It needs about two thirds of the directions of `gauss_legendre`, spread evenly over the
    sphere, has the symmetry of the octahedron, and only positive weights.

    Parameters
    ----------
    degree
        Degree up to which harmonics are integrated exactly, 0 to 131. The rule that is returned
        may reach further: see its `degree`.

    Returns
    -------
    Quadrature
        Exact up to its own degree, which may be higher.

    Raises
    ------
    ArgumentError
        If there is no such rule.

    Examples
    --------
    >>> rule = lebedev(4)
    >>> rule.directions.shape, rule.degree
    ((14, 3), 5)
    """
    degree = checks.degree("degree", degree)
    if degree > LEBEDEV_ORDERS[-1]:
        raise ArgumentError(
            f"degree must be at most {LEBEDEV_ORDERS[-1]} for a Lebedev rule, got {degree}; "
            "gauss_legendre has every degree"
        )
    return _lebedev(next(order for order in LEBEDEV_ORDERS if order >= degree))


@functools.lru_cache(maxsize=16)
def _lebedev(order: int) -> Quadrature:
    from scipy.integrate import lebedev_rule  # takes a quarter of a second to load

    directions, weights = lebedev_rule(order)
    return _frozen(np.ascontiguousarray(directions.T), weights, order)


def _frozen(
    directions: Float[np.ndarray, "J 3"], weights: Float[np.ndarray, "J"], degree: int
) -> Quadrature:
    """Return a rule that callers share and hence cannot write to."""
    directions.flags.writeable = weights.flags.writeable = False
    return Quadrature(directions, weights, degree)
