"""Harmonic images of scaled normals, with their derivatives.

With b = albedo n, the harmonic image of degree l is `albedo A_l Y_k(n) = A_l |b|^(1-l) P_k(b)`,
where the solid harmonic P_k is a homogeneous polynomial of degree l that equals Y_k on the
sphere. Written so, structure has three unknowns a pixel, free of any constraint.
"""

from functools import cache

import numpy as np
from jaxtyping import Float

from harmface.conventions import degrees
from harmface.reflectance import lambert_coefficients
from harmface.sphere import fibonacci_directions, real_harmonics


def directions_of(b: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Return the unit vectors along scaled normals; zero along zero."""
    length = np.linalg.norm(b, axis=-1, keepdims=True)
    return np.asarray(b / np.maximum(length, np.finfo(np.float64).tiny))


def scaled_normal_images(b: Float[np.ndarray, "p 3"], degree: int) -> Float[np.ndarray, "K p"]:
    """Return `S_k = |b| A_l Y_k(b / |b|)`.

    Parameters
    ----------
    b
        Scaled normals, albedo times unit normal.
    degree
        Highest degree.
    """
    return _with_jacobian(b, degree, jacobian=False)[0]


def scaled_normal_images_with_jacobian(
    b: Float[np.ndarray, "p 3"], degree: int
) -> tuple[Float[np.ndarray, "K p"], Float[np.ndarray, "K p 3"]]:
    """Return the images `S_k` and `dS_k / db`.

    `dS_k/db = A_l |b|^(1-l) (grad P_k + (1 - l) P_k b / |b|^2)`.
    """
    return _with_jacobian(b, degree, jacobian=True)


def _with_jacobian(
    b: Float[np.ndarray, "p 3"], degree: int, *, jacobian: bool
) -> tuple[Float[np.ndarray, "K p"], Float[np.ndarray, "_ p 3"]]:
    length = np.maximum(np.linalg.norm(b, axis=1), np.finfo(np.float64).tiny)
    n = b / length[:, None]
    # Powers 0 to degree of each component: every monomial is a product of three of them.
    powers = np.ones((degree + 1, 3, len(b)))
    for exponent in range(1, degree + 1):
        powers[exponent] = powers[exponent - 1] * n.T
    images, gradients = [], []
    for l, coefficients in enumerate(_solid_harmonics(degree)):  # noqa: E741
        exponents = _exponents(l)
        x, y, z = (powers[exponents[:, i], i] for i in range(3))
        images.append(coefficients @ (x * y * z))
        if jacobian:
            slopes = [
                np.maximum(exponents[:, i, None], 0) * powers[np.maximum(exponents[:, i] - 1, 0), i]
                for i in range(3)
            ]
            monomials = np.stack([slopes[0] * y * z, x * slopes[1] * z, x * y * slopes[2]], axis=-1)
            gradient = np.tensordot(coefficients, monomials, axes=1)
            gradients.append(gradient + (1 - l) * images[-1][..., None] * n)
    return (
        np.concatenate(images) * length,
        np.concatenate(gradients) if jacobian else np.empty((0, len(b), 3)),
    )


def _exponents(degree: int) -> np.ndarray:
    """Return the exponents of x, y, z in the monomials of a degree, one a row."""
    return np.array(
        [(i, j, degree - i - j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    )


@cache
def _solid_harmonics(max_degree: int) -> tuple[np.ndarray, ...]:
    """Return, for each degree, the coefficients of `A_l P_k` in its monomials.

    A solid harmonic is what interpolates its harmonic on more directions than there are
    monomials, so the convention of `real_harmonics` is kept whatever it is.
    """
    directions = fibonacci_directions(8 * (max_degree + 1) ** 2)
    harmonics = real_harmonics(directions, max_degree)
    each, transfer = degrees(max_degree), lambert_coefficients(max_degree)
    found = []
    for l in range(max_degree + 1):  # noqa: E741
        monomials = np.prod(directions[:, None] ** _exponents(l), axis=-1)
        solution, *_ = np.linalg.lstsq(monomials, harmonics[each == l].T, rcond=None)
        found.append(transfer[l] * solution.T)
    return tuple(found)
