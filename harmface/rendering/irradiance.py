"""Irradiance from lighting coefficients: three forms of one quadratic polynomial, and maps of it.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import math
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import max_degree_of
from harmface.errors import ArgumentError
from harmface.light.distant_light import DistantLight
from harmface.light.layouts import Layout, layout_named
from harmface.reflectance import lambert_per_coefficient
from harmface.rendering.reference import irradiance
from harmface.sphere import real_harmonics

C1 = math.sqrt(15 * math.pi) / 16
C2 = math.sqrt(math.pi / 12)
C3 = 3 * math.sqrt(5 * math.pi) / 16
C4 = math.sqrt(math.pi) / 2
C5 = math.sqrt(5 * math.pi) / 16
"""The constants of RH01 eq. 12, to all digits."""


def harmonic_irradiance(
    coefficients: Float[np.ndarray, "*channels K"], normals: Float[np.ndarray, "*pixels 3"]
) -> Float[np.ndarray, "..."]:
    """Return `E(n) = sum A_l L_lm Y_lm(n)`, [RH01]_ eq. 7, to any degree.

    Parameters
    ----------
    coefficients
        Lighting coefficients.
    normals
        Unit normals.

    Returns
    -------
    numpy.ndarray
        Irradiance, `(*channels, *pixels)`. It may fall below zero where the light has sharp
        features, see `light.non_negative_window`.

    Raises
    ------
    ArgumentError
        If `K` is not a square, a coefficient is not finite or a normal not of unit length.

    Examples
    --------
    Under radiance 1 from everywhere, every normal receives pi:

    >>> harmonic_irradiance(np.array([np.sqrt(4 * np.pi)]), np.array([0.0, 0.6, 0.8])).round(6)
    np.float64(3.141593)
    """
    coefficients = checks.finite("coefficients", coefficients)
    max_degree = max_degree_of(coefficients.shape[-1])
    received = coefficients * lambert_per_coefficient(max_degree).astype(coefficients.dtype)
    normals = checks.unit_vectors("normals", normals)
    return np.tensordot(received, real_harmonics(normals, max_degree), axes=1)


def irradiance_matrix(
    coefficients: Float[np.ndarray, "*channels 9"],
) -> Float[np.ndarray, "*channels 4 4"]:
    """Return the symmetric matrix `M` of [RH01]_ eq. 12, with which `E(n) = (n, 1)^T M (n, 1)`.

    Parameters
    ----------
    coefficients
        Lighting coefficients of degree 2.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, 4, 4)`, in the precision of `coefficients`.

    Raises
    ------
    ArgumentError
        If there are not nine, or one is not finite.

    Examples
    --------
    >>> irradiance_matrix(np.eye(9)[0])[3].round(6)
    array([0.      , 0.      , 0.      , 0.886227])
    """
    l00, l1m1, l10, l11, l2m2, l2m1, l20, l21, l22 = _nine(coefficients)
    matrix = np.array(
        [
            [C1 * l22, C1 * l2m2, C1 * l21, C2 * l11],
            [C1 * l2m2, -C1 * l22, C1 * l2m1, C2 * l1m1],
            [C1 * l21, C1 * l2m1, C3 * l20, C2 * l10],
            [C2 * l11, C2 * l1m1, C2 * l10, C4 * l00 - C5 * l20],
        ]
    )
    return np.moveaxis(matrix, (0, 1), (-2, -1))


def matrix_irradiance(
    matrix: Float[np.ndarray, "*channels 4 4"], normals: Float[np.ndarray, "*pixels 3"]
) -> Float[np.ndarray, "..."]:
    """Return `E(n) = (n, 1)^T M (n, 1)`, [RH01]_ eq. 11.

    Parameters
    ----------
    matrix
        From `irradiance_matrix`.
    normals
        Unit normals.

    Returns
    -------
    numpy.ndarray
        Irradiance, `(*channels, *pixels)`.

    Raises
    ------
    ArgumentError
        If the matrix is not 4 x 4 and finite, or a normal not of unit length.
    """
    matrix = checks.finite("matrix", matrix)
    if matrix.shape[-2:] != (4, 4):
        raise ArgumentError(f"matrix must have shape (..., 4, 4), got {matrix.shape}")
    normals = checks.unit_vectors("normals", normals)
    ones = np.ones((*normals.shape[:-1], 1), normals.dtype)
    points = np.concatenate([normals, ones], axis=-1).reshape(-1, 4)
    values = np.einsum("...pi,pi->...p", points @ matrix, points)
    return values.reshape(*matrix.shape[:-2], *normals.shape[:-1])


def polynomial_irradiance(
    coefficients: Float[np.ndarray, "*channels 9"], normals: Float[np.ndarray, "*pixels 3"]
) -> Float[np.ndarray, "..."]:
    """Return `E(n)` as the quadratic polynomial of [RH01]_ eq. 13, written out.

    Parameters and result are those of `harmonic_irradiance`, at degree 2.

    Parameters
    ----------
    coefficients
        Radiance coefficients, shape `(*channels, 9)`.
    normals
        Unit normals, shape `(*pixels, 3)`.

    Returns
    -------
    numpy.ndarray
        Irradiance, shape `(*channels, *pixels)`.

    Raises
    ------
    ArgumentError
        If there are not nine coefficients, one is not finite, or a normal not of unit length.
    """
    normals = checks.unit_vectors("normals", normals)
    x, y, z = np.moveaxis(normals, -1, 0)
    spread = (1,) * x.ndim
    l00, l1m1, l10, l11, l2m2, l2m1, l20, l21, l22 = (
        each.reshape(*each.shape, *spread) for each in _nine(coefficients)
    )
    return (
        C1 * l22 * (x**2 - y**2)
        + C3 * l20 * z**2
        + (C4 * l00 - C5 * l20)
        + 2 * C1 * (l2m2 * x * y + l21 * x * z + l2m1 * y * z)
        + 2 * C2 * (l11 * x + l1m1 * y + l10 * z)
    )


def irradiance_map(
    coefficients: Float[np.ndarray, "*channels K"], layout: str | Layout, height: int
) -> Float[np.ndarray, "*channels_pixels"]:
    """Return the irradiance environment map: `E` of the normal that each pixel stands for.

    Parameters
    ----------
    coefficients
        Lighting coefficients.
    layout
        A layout or its name; around a disc the map is 0.
    height
        Height of the map, of a face for a cube.

    Returns
    -------
    numpy.ndarray
        Irradiance, `(*channels, *pixels)`.

    Raises
    ------
    ArgumentError
        If `K` is not a square, a coefficient is not finite, or there is no such layout.
    """
    coefficients = checks.finite("coefficients", coefficients)
    per_coefficient = lambert_per_coefficient(max_degree_of(coefficients.shape[-1]))
    return harmonic_map(
        coefficients * per_coefficient.astype(coefficients.dtype), layout_named(layout), height
    )


def harmonic_map(
    coefficients: Float[np.ndarray, "*channels K"], layout: Layout, height: int
) -> Float[np.ndarray, "*channels_pixels"]:
    """Return the function of some coefficients as a map, 0 around a disc."""
    height = checks.positive_integer("height", height)
    basis = _map_basis(layout, height, max_degree_of(coefficients.shape[-1]))
    values = coefficients @ basis.astype(coefficients.dtype, copy=False)
    return values.reshape(*coefficients.shape[:-1], *layout.shape(height))


def irradiance_error(
    coefficients: Float[np.ndarray, "*channels K"],
    light: DistantLight,
    normals: Float[np.ndarray, "*pixels 3"],
) -> Float[np.ndarray, "..."]:
    """Return by how much the coefficients' irradiance exceeds the light's own, summed directly.

    Parameters
    ----------
    coefficients
        Lighting coefficients of the light.
    light
        The light, such as `EnvironmentMap.as_distant_light()`, with the same channels.
    normals
        Unit normals; those of a map weight all alike if its solid angles are their weights.

    Returns
    -------
    numpy.ndarray
        Error, `(*channels, *pixels)`, as a fraction of the light's total intensity, the integral
        of radiance, as in [RH01]_ 3.1.

    Raises
    ------
    ArgumentError
        If the light is dark in a channel, or as for `harmonic_irradiance`.
    """
    total = light.total()
    if not (total > 0).all():
        raise ArgumentError("light must not be dark in any channel: no error is relative to none")
    error = harmonic_irradiance(coefficients, normals) - irradiance(normals, light)
    return error / total.reshape(*total.shape, *[1] * (normals.ndim - 1))


@lru_cache(maxsize=4)
def _map_basis(layout: Layout, height: int, max_degree: int) -> Float[np.ndarray, "K pixels"]:
    """Return `Y_lm` at every pixel of a map, kept for the next map of its size."""
    directions = layout.directions(height).reshape(-1, 3)
    basis = real_harmonics(directions, max_degree)
    basis *= layout.solid_angles(height).ravel() > 0
    return basis


def _nine(coefficients: Float[np.ndarray, "*channels K"]) -> Float[np.ndarray, "9 *channels"]:
    coefficients = checks.finite("coefficients", coefficients)
    if coefficients.shape[-1:] != (9,):
        raise ArgumentError(
            f"coefficients must be the nine of degree 2, shape (..., 9), got {coefficients.shape}"
        )
    return np.moveaxis(coefficients, -1, 0)
