"""Rotation of functions on the sphere.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, in Face
   Processing: Advanced Modeling Methods, 2005.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees
from harmface.errors import ArgumentError
from harmface.sphere.harmonics import real_harmonics
from harmface.sphere.quadrature import gauss_legendre
from harmface.sphere.transforms import degree_of_coefficients


def rotation_matrices(
    rotation: Float[np.ndarray, "3 3"], max_degree: int
) -> list[Float[np.ndarray, "orders orders"]]:
    """Return how the harmonics of each degree mix under a rotation, [R05]_ eq. 16.

    The matrix of degree `l` is defined by `Y_l(R n) = D_l Y_l(n)` for every direction `n`. It is
    computed as the integral of `Y_l(R n) Y_l(n)^T` by a quadrature that is exact for it: there
    are no angles, hence no rotation at which they fail.

    Parameters
    ----------
    rotation
        Proper rotation matrix `R`, shape `(3, 3)`; one in single precision is replaced by the
        rotation nearest to it, so that `D_l` is orthogonal in any case.
    max_degree
        Greatest degree, at least 0.

    Returns
    -------
    list of ndarray
        `D_0, D_1, ...`, orthogonal, shape `(2l + 1, 2l + 1)`, float64, rows and columns in the
        order of `m` from `-l` to `l`.

    Raises
    ------
    ArgumentError
        If `rotation` is not a rotation or the degree is negative.

    Examples
    --------
    >>> quarter_turn_about_z = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    >>> rotation_matrices(quarter_turn_about_z, 1)[1].round(12) + 0.0
    array([[ 0., 0.,  1.],
           [ 0., 1.,  0.],
           [-1., 0.,  0.]])
    """
    left, _, right = np.linalg.svd(checks.rotation("rotation", rotation))
    quadrature = gauss_legendre(2 * checks.degree("max_degree", max_degree))
    turned = real_harmonics(quadrature.directions @ (left @ right).T, max_degree)
    weighted = quadrature.weights * real_harmonics(quadrature.directions, max_degree)
    blocks = [slice(degree**2, (degree + 1) ** 2) for degree in range(max_degree + 1)]
    return [turned[block] @ weighted[block].T for block in blocks]


def rotate(
    coefficients: Float[np.ndarray, "... K"], rotation: Float[np.ndarray, "3 3"]
) -> Float[np.ndarray, "... K"]:
    """Return the coefficients of functions turned by a rotation, `w -> f(R^-1 w)`.

    What was seen in direction `w` is then seen in direction `R w`.

    Parameters
    ----------
    coefficients
        Finite coefficients of `f`, shape `(..., K)`.
    rotation
        Proper rotation matrix `R`, shape `(3, 3)`.

    Returns
    -------
    ndarray
        Coefficients, shape `(..., K)`, in the precision of `coefficients`.

    Raises
    ------
    ArgumentError
        If `K` is not a square, a coefficient is not finite, or `rotation` is not a rotation.
    """
    coefficients = checks.finite("coefficients", coefficients)
    result = np.empty_like(coefficients)
    for degree, matrix in enumerate(
        rotation_matrices(rotation, degree_of_coefficients(coefficients))
    ):
        block = slice(degree**2, (degree + 1) ** 2)
        result[..., block] = coefficients[..., block] @ matrix.T
    return result


def rotate_zonal(
    zonal: Float[np.ndarray, "... L"], axis: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "... K"]:
    """Return the coefficients of functions about +z, turned to be about another axis.

    A function about an axis needs no rotation matrix, [R05]_ eq. 18: coefficient `lm` is
    `sqrt(4 pi / (2l + 1)) z_l Y_lm(axis)`.

    Parameters
    ----------
    zonal
        Finite coefficients `z_l` of the harmonics of order 0, shape `(..., max_degree + 1)`.
    axis
        Unit vector that +z is turned to, shape `(3,)`.

    Returns
    -------
    ndarray
        Coefficients, shape `(..., K)`, in the precision of `zonal`.

    Raises
    ------
    ArgumentError
        If a coefficient is not finite or `axis` is not a unit vector.

    Examples
    --------
    >>> rotate_zonal(np.array([1.0, 1.0]), np.array([1.0, 0.0, 0.0]))
    array([1., 0., 0., 1.])
    """
    zonal = checks.finite("zonal", zonal)
    axis = checks.unit_vectors("axis", axis)
    if zonal.ndim == 0 or zonal.shape[-1] == 0 or axis.shape != (3,):
        raise ArgumentError(
            "zonal must have shape (..., max_degree + 1) and axis shape (3,), "
            f"got {zonal.shape} and {axis.shape}"
        )
    max_degree = zonal.shape[-1] - 1
    degree = degrees(max_degree)
    harmonics = real_harmonics(axis.astype(np.float64), max_degree)
    turned = np.sqrt(4 * np.pi / (2 * degree + 1)) * harmonics
    return (zonal[..., degree] * turned).astype(zonal.dtype)
