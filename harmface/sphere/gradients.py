"""Derivatives of harmonics by direction, from the products with x, y and z.

Of the solid harmonic `r^l Y_lm` a derivative by x, y or z is a solid harmonic of degree `l - 1`.
Multiplying it by `x` splits into degrees `l + 1` and `l - 1`,

    x (r^l Y) = (x (r^l Y) - r^2 d/dx (r^l Y) / (2l + 1)) + r^2 d/dx (r^l Y) / (2l + 1),

where both terms on the right are harmonic polynomials, but for the factor r^2: so the derivative
is `2l + 1` times the part of degree `l - 1` of `x Y`, which the Gaunt tensor tells.
"""

import functools

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees
from harmface.sphere.closed_forms import Y1
from harmface.sphere.harmonics import real_harmonics
from harmface.sphere.products import gaunt_tensor

_X_Y_Z = (3, 1, 2)
"""Flat indices of the harmonics that are Y1 times x, y and z."""


def derivative_matrices(max_degree: int) -> Float[np.ndarray, "3 K K"]:
    """Return `D` with which the gradient of `r^l Y_k` on the unit sphere is `D[:, k] @ Y`.

    Parameters
    ----------
    max_degree
        Greatest degree, at least 0.

    Returns
    -------
    ndarray
        Derivatives by x, y and z; row `k` of degree `l` has entries at degree `l - 1` only.
        Shape `(3, K, K)`, float64, read-only.

    Raises
    ------
    ArgumentError
        If the degree is negative.

    Examples
    --------
    The derivative of `Y_10 = 0.488603 z` by z is `0.488603 = sqrt(3) Y_00`:

    >>> derivative_matrices(1)[2, 2].round(6)
    array([1.732051, 0.      , 0.      , 0.      ])
    """
    return _derivative_matrices(checks.degree("max_degree", max_degree))


@functools.lru_cache(maxsize=16)
def _derivative_matrices(max_degree: int) -> Float[np.ndarray, "3 K K"]:
    degree = degrees(max_degree)
    times = gaunt_tensor(1, max_degree, max_degree)[_X_Y_Z, :, :] / Y1
    below = degree[None, :] == degree[:, None] - 1
    matrices = np.where(below, (2 * degree[:, None] + 1) * times, 0.0)
    matrices.flags.writeable = False
    return matrices


def harmonic_gradients(
    directions: Float[np.ndarray, "*pixels 3"], max_degree: int
) -> Float[np.ndarray, "K *pixels 3"]:
    """Return the gradients of harmonics on the sphere, tangent to it.

    The gradient of `Y_lm(x / |x|)` in space at a unit vector `w`, which is that of the solid
    harmonic less its radial part `l Y_lm w`.

    Parameters
    ----------
    directions
        Unit vectors.
    max_degree
        Greatest degree, at least 0.

    Returns
    -------
    ndarray
        Per radian, in the precision of `directions`.

    Raises
    ------
    ArgumentError
        If a direction is not of unit length, or the degree is out of range.

    Examples
    --------
    >>> harmonic_gradients(np.array([1.0, 0.0, 0.0]), 1)[2].round(6)
    array([0.      , 0.      , 0.488603])
    """
    harmonics = real_harmonics(directions, max_degree)
    matrices = derivative_matrices(max_degree).astype(harmonics.dtype)
    gradients = np.moveaxis(np.tensordot(matrices, harmonics, axes=(2, 0)), 0, -1)
    radial = degrees(max_degree).reshape(-1, *[1] * (harmonics.ndim - 1)) * harmonics
    return gradients - radial[..., None] * np.asarray(directions, harmonics.dtype)
