"""Which light a set of normals can tell.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, section
   0.4.3.
"""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics

NULL = 1e-6
"""Singular value, as a share of the largest, from which a combination of coefficients counts as
untold: that of degree 2 on a frontal hemisphere is 0.026 of it, rounding some 1e-8."""


def singular_values(
    normals: Float[np.ndarray, "*pixels 3"],
    degree: int = 2,
    weights: Float[np.ndarray, "*pixels"] | None = None,
) -> Float[np.ndarray, "n"]:
    """Return the singular values of irradiance as a function of light, as root mean squares.

    They are those of the matrix `A_l Y_lm(n_p) sqrt(w_p / sum w)`, a row a pixel: by how much a
    change of the coefficients by 1, in each principal direction, changes the irradiance of the
    pixels on average. Degrees whose `A_l` is zero, the odd ones above 1, are left out: no convex
    matte object tells anything of them ([R05]_).

    Parameters
    ----------
    normals
        Unit normals.
    degree
        Highest degree.
    weights
        Of each normal, such as its solid angle; all alike if not given.

    Returns
    -------
    numpy.ndarray
        From the largest to the smallest, one for each coefficient of the degrees that are not
        left out.

    Raises
    ------
    ArgumentError
        If a normal is not of unit length, or a weight negative.

    Examples
    --------
    All normals of a sphere tell the ninth combination a quarter as well as the first:

    >>> from harmface.sphere import gauss_legendre
    >>> rule = gauss_legendre(8)
    >>> singular_values(rule.directions, 2, rule.weights)[[0, 1, 8]].round(4)
    array([0.8862, 0.5908, 0.2216])
    """
    factors = lambert_per_coefficient(degree)
    basis = real_harmonics(checks.unit_vectors("normals", normals), degree)
    told = (basis * factors.reshape(-1, *[1] * (normals.ndim - 1)))[factors != 0]
    told = told.reshape(len(told), -1)
    flat = np.ones(told.shape[1]) if weights is None else checks.non_negative("weights", weights)
    flat = flat.reshape(-1)
    if flat.size != told.shape[1] or not flat.any():
        raise ArgumentError(
            f"weights must be one for each of {told.shape[1]} normals, not all 0, got {flat.size}"
        )
    return np.linalg.svd(told * np.sqrt(flat / flat.sum()), compute_uv=False)


def told_directions(
    gram: Float[np.ndarray, "K K"],
) -> tuple[Float[np.ndarray, "K r"], Bool[np.ndarray, "K"]]:
    """Return the combinations of coefficients that data tell, and which coefficients they fix.

    Parameters
    ----------
    gram
        Matrix of the normal equations.

    Returns
    -------
    tuple
        Orthonormal combinations as columns, and for each coefficient whether it is a sum of them.
    """
    # Coefficients are measured by what is known of each, so that a weak prior stands beside much.
    sizes = np.sqrt(np.diagonal(gram))
    sizes = np.where(sizes > 0, sizes, 1)
    values, vectors = np.linalg.eigh(gram / (sizes[:, None] * sizes))
    kept = vectors[:, values > NULL**2]
    if kept.shape[1] == len(gram):
        return np.eye(len(gram)), np.ones(len(gram), bool)
    return np.linalg.qr(kept * sizes[:, None])[0], (kept**2).sum(axis=1) > 1 - NULL
