"""Gram matrices of canonical shapes in closed form, as [R02]_ has them for the half-sphere.

Each is `Q_kk' = integral of Y_k(n) Y_k'(n) dn` over the normals of a shape that faces the viewer
(+z), for one of three measures `dn`:

`"all"`
    every normal of the shape, seen or not, the same weight;
`"normals"`
    the half that is turned to the viewer, every normal the same weight;
`"pixels"`
    the same half as an orthographic camera sees it, every pixel the same weight: foreshortened.

References
----------
.. [R02] Ramamoorthi, Analytic PCA Construction for Theoretical Analysis of Lighting
   Variability in Images of a Lambertian Object, PAMI 2002.
"""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int
from scipy.linalg import toeplitz

from harmface import checks
from harmface.conventions import degrees, harmonic_count, orders
from harmface.errors import ArgumentError
from harmface.sphere import real_harmonics

Measure = Literal["all", "normals", "pixels"]
"""Which normals of a shape count, and how much."""


def sphere_gram(max_degree: int, measure: Measure) -> Float[np.ndarray, "K K"]:
    """Return the Gram matrix of a sphere: over solid angle, for pixels times `n_z`.

    Over all normals it is the identity. Over half of them azimuth still keeps orders apart, and
    products of two Legendre functions of the same order integrate by Legendre's equation to
    their Wronskian at the rim. Foreshortening multiplies by `z`, which leads from a harmonic to
    its two neighbours in degree.

    Parameters
    ----------
    max_degree
        Highest degree of the harmonics.
    measure
        `"all"`, `"normals"` or `"pixels"`, see the module.

    Returns
    -------
    numpy.ndarray
        Symmetric, shape (K, K), float64.

    Examples
    --------
    >>> sphere_gram(1, "normals").round(3)
    array([[0.5  , 0.   , 0.433, 0.   ],
           [0.   , 0.5  , 0.   , 0.   ],
           [0.433, 0.   , 0.5  , 0.   ],
           [0.   , 0.   , 0.   , 0.5  ]])
    """
    _check(measure)
    count = harmonic_count(max_degree)
    if measure == "all":
        return np.eye(count)
    if measure == "normals":
        return _half_sphere(max_degree)
    return (_times_z(max_degree) @ _half_sphere(max_degree + 1))[:, :count]


def cone_gram(max_degree: int, measure: Measure, elevation: float) -> Float[np.ndarray, "K K"]:
    """Return the Gram matrix of an upright cone seen from the side.

    Its normals `(cos e sin a, sin e, cos e cos a)` lie on a circle, on which a harmonic of
    degree `l` is a trigonometric polynomial of degree `l` in `a`; products of those integrate
    in closed form. The measure is `da`, for pixels times `cos a`.

    Parameters
    ----------
    max_degree
        Highest degree of the harmonics.
    measure
        `"all"`, `"normals"` or `"pixels"`, see the module.
    elevation
        Angle `e` of the normals above the horizontal, degrees in (-90, 90); 0 is a cylinder.

    Returns
    -------
    numpy.ndarray
        Symmetric, shape (K, K), float64.

    Raises
    ------
    ArgumentError
        If `max_degree` is negative, or there is no such measure.
    """
    max_degree = checks.degree("max_degree", max_degree)
    _check(measure)
    if not -90 < elevation < 90:
        raise ArgumentError(f"elevation must lie in (-90, 90) degrees, got {elevation}")
    # A trigonometric polynomial is known from as many samples as it has coefficients.
    frequency = np.arange(-max_degree, max_degree + 1)
    angle = 2 * np.pi * np.arange(frequency.size) / frequency.size
    tilt = np.full_like(angle, np.radians(elevation))
    normals = np.stack(
        [np.cos(tilt) * np.sin(angle), np.sin(tilt), np.cos(tilt) * np.cos(angle)], axis=-1
    )
    waves = np.exp(-1j * np.outer(angle, frequency)) / frequency.size
    series = real_harmonics(normals, max_degree) @ waves
    overlap = toeplitz(_arc(np.arange(frequency.size), measure))
    return (series @ overlap @ series.conj().T).real


def cylinder_gram(max_degree: int, measure: Measure) -> Float[np.ndarray, "K K"]:
    """Return the Gram matrix of an upright cylinder, see `cone_gram`.

    Parameters
    ----------
    max_degree
        Highest degree of the harmonics.
    measure
        `"all"`, `"normals"` or `"pixels"`, see the module.

    Returns
    -------
    numpy.ndarray
        Symmetric, shape (K, K), float64.
    """
    return cone_gram(max_degree, measure, 0.0)


def _half_sphere(max_degree: int) -> Float[np.ndarray, "K K"]:
    """Return the overlaps of the harmonics over `z > 0`.

    Let `f` and `g` be what harmonics of one order and degrees `p` and `q` have of `z`, with norm
    1 on [-1, 1]. The difference of their Legendre equations integrates to

        (q (q + 1) - p (p + 1)) int_0^1 f g dz = f(0) g'(0) - g(0) f'(0),

    and a function shares its norm evenly between `z > 0` and `z < 0`.
    """
    degree_of, order = degrees(max_degree), orders(max_degree)
    eigenvalue = degree_of * (degree_of + 1)
    # At azimuth 0 the factor of azimuth is 1 / sqrt(2 pi) at order 0, 1 / sqrt(pi) at others.
    rim = real_harmonics(np.array([1.0, 0.0, 0.0]), max_degree)
    value = rim[eigenvalue + np.abs(order)] * np.sqrt(np.where(order == 0, 2 * np.pi, np.pi))
    # f'(0) = sqrt((2 p + 1) / (2 p - 1) (p^2 - m^2)) times the value at degree p - 1.
    slope = np.zeros_like(value)
    inner, below = _neighbours(max_degree)
    p, m = degree_of[inner], order[inner]
    slope[inner] = np.sqrt((2 * p + 1) / (2 * p - 1) * (p**2 - m**2)) * value[below]
    wronskian = np.outer(value, slope) - np.outer(slope, value)
    gap = eigenvalue - eigenvalue[:, None]
    gram = np.diag(np.full(len(value), 0.5))
    meets = (order == order[:, None]) & (gap != 0)
    return np.divide(wronskian, gap, out=gram, where=meets)


def _times_z(max_degree: int) -> Float[np.ndarray, "K K1"]:
    """Return `a` with `z Y_k = sum_j a_kj Y_j`, which reaches one degree further."""
    inner, below = _neighbours(max_degree + 1)
    p, m = degrees(max_degree + 1)[inner], orders(max_degree + 1)[inner]
    matrix = np.zeros((harmonic_count(max_degree + 1),) * 2)
    matrix[inner, below] = np.sqrt((p**2 - m**2) / (4 * p**2 - 1))
    return (matrix + matrix.T)[: harmonic_count(max_degree)]


def _neighbours(max_degree: int) -> tuple[Int[np.ndarray, "n"], Int[np.ndarray, "n"]]:
    """Return flat indices of the harmonics whose order also exists one degree below, and those."""
    inner = np.flatnonzero(np.abs(orders(max_degree)) < degrees(max_degree))
    return inner, inner - 2 * degrees(max_degree)[inner]


def _arc(frequency: Int[np.ndarray, "n"], measure: Measure) -> Float[np.ndarray, "n"]:
    """Return the integral of `exp(i f a) da` over the circle, or over the half `cos a > 0`."""
    if measure == "all":
        return np.where(frequency == 0, 2 * np.pi, 0.0)
    if measure == "normals":
        return np.pi * np.sinc(frequency / 2)
    return (_arc(frequency + 1, "normals") + _arc(frequency - 1, "normals")) / 2


def _check(measure: str) -> None:
    if measure not in get_args(Measure):
        raise ArgumentError(f"measure must be one of {get_args(Measure)}, got {measure!r}")
