"""Lights whose coefficients are known: directional, disc, cone, hemisphere, ambient, and sums.

Light adds up, and so do coefficients: a dynamic light joins a projected environment by
`add_lights(environment_coefficients, directional(...))`, with nothing projected again.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005.
"""

import numpy as np
from jaxtyping import Float
from numpy.polynomial.legendre import legder, legvander

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.light.distant_light import DistantLight
from harmface.sphere import real_harmonics, rotate_zonal


def directional_lights(light: DistantLight, max_degree: int) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients `L_lm = sum_j E_j Y_lm(w_j)` of directional lights.

    Parameters
    ----------
    light
        Directions and the irradiance each gives at normal incidence.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Radiance coefficients, shape `(*channels, K)`.

    Examples
    --------
    >>> overhead = DistantLight(np.array([[0.0, 1.0, 0.0]]), np.array([2.0]))
    >>> directional_lights(overhead, 1).round(6)
    array([0.56419 , 0.977205, 0.      , 0.      ])
    """
    return light.irradiances @ real_harmonics(light.directions, max_degree).T


def disc(
    direction: Float[np.ndarray, "3"],
    angular_radius: float,
    irradiance: Float[np.ndarray, "*channels"] | float,
    max_degree: int,
) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of a disc such as the sun: a cone light of given irradiance.

    Parameters
    ----------
    direction
        Unit vector to the disc's centre.
    angular_radius
        Radians, in (0, pi / 2]; towards 0 it becomes a directional light.
    irradiance
        What a surface that faces the disc receives, not negative: one number or one a channel.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Radiance coefficients, shape `(*channels, K)`.

    Raises
    ------
    ArgumentError
        If an argument is outside its range.
    """
    if not 0 < angular_radius <= np.pi / 2:
        raise ArgumentError(f"angular_radius must lie in (0, pi / 2], got {angular_radius}")
    # The disc's radiance is its irradiance over pi sin(radius)**2.
    irradiance = checks.non_negative("irradiance", irradiance)
    zonal = zonal_cap(angular_radius, max_degree) / (np.pi * np.sin(angular_radius) ** 2)
    return rotate_zonal(irradiance[..., None] * zonal, _axis(direction))


def cone(
    direction: Float[np.ndarray, "3"],
    half_angle: float,
    radiance: Float[np.ndarray, "*channels"] | float,
    max_degree: int,
) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of the same radiance from all directions of a cone.

    Parameters
    ----------
    direction
        Unit vector along the cone's axis.
    half_angle
        Radians from the axis, in (0, pi].
    radiance
        Not negative: one number or one a channel.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Radiance coefficients, shape `(*channels, K)`.

    Raises
    ------
    ArgumentError
        If an argument is outside its range.
    """
    if not 0 < half_angle <= np.pi:
        raise ArgumentError(f"half_angle must lie in (0, pi], got {half_angle}")
    radiance = checks.non_negative("radiance", radiance)
    return rotate_zonal(radiance[..., None] * zonal_cap(half_angle, max_degree), _axis(direction))


def hemisphere(
    direction: Float[np.ndarray, "3"],
    radiance: Float[np.ndarray, "*channels"] | float,
    max_degree: int,
) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of the same radiance from all of a hemisphere, see `cone`.

    Parameters
    ----------
    direction
        Unit vector to the hemisphere's pole.
    radiance
        Not negative: one number or one a channel.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Radiance coefficients, shape `(*channels, K)`.
    """
    return cone(direction, np.pi / 2, radiance, max_degree)


def ambient(
    radiance: Float[np.ndarray, "*channels"] | float, max_degree: int
) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of the same radiance from everywhere: `sqrt(4 pi)` times it, at 0.

    Parameters
    ----------
    radiance
        Not negative: one number or one a channel.
    max_degree
        Highest degree.

    Returns
    -------
    numpy.ndarray
        Shape `(*channels, K)`, in the precision of `radiance`.

    Raises
    ------
    ArgumentError
        If the radiance is negative or not finite.

    Examples
    --------
    >>> ambient(1.0, 1).round(6)
    array([3.544908, 0.      , 0.      , 0.      ])
    """
    radiance = checks.non_negative("radiance", radiance)
    coefficients = np.zeros((*radiance.shape, harmonic_count(max_degree)), radiance.dtype)
    coefficients[..., 0] = np.sqrt(4 * np.pi) * radiance
    return coefficients


def add_lights(*coefficients: Float[np.ndarray, "..."]) -> Float[np.ndarray, "*channels K"]:
    """Return the coefficients of several lights together.

    Parameters
    ----------
    *coefficients
        Coefficients of each; their leading axes broadcast, so that grey joins colour, and a light
        of lower degree counts as zero above it.

    Returns
    -------
    numpy.ndarray
        Shape (..., K) of the highest degree among them.

    Raises
    ------
    ArgumentError
        If there is none.

    Examples
    --------
    >>> add_lights(np.array([1.0]), np.array([0.0, 1.0, 2.0, 3.0]))
    array([1., 1., 2., 3.])
    """
    if not coefficients:
        raise ArgumentError("coefficients of at least one light are needed")
    coefficients = tuple(checks.finite("coefficients", light) for light in coefficients)
    count = max(light.shape[-1] for light in coefficients)
    leading = np.broadcast_shapes(*(light.shape[:-1] for light in coefficients))
    total = np.zeros((*leading, count), np.result_type(*coefficients))
    for light in coefficients:
        total[..., : light.shape[-1]] += light
    return total


def zonal_cap(
    half_angle: Float[np.ndarray, "*points"] | float, max_degree: int
) -> Float[np.ndarray, "*points L"]:
    """Return the zonal coefficients of radiance 1 within an angle from +z.

    The integral of `P_l` from `c = cos(angle)` to 1 is `(1 - c**2) P_l'(c) / (l (l + 1))` by
    Legendre's equation: unlike a difference of polynomials it keeps its digits for small discs.
    """
    half_angle = np.asarray(half_angle, float)
    degree = np.arange(checks.degree("max_degree", max_degree) + 1)
    below = legvander(np.cos(half_angle), max_degree)[..., : max(max_degree, 1)]
    slopes = below.reshape(*half_angle.shape, -1) @ legder(np.eye(max_degree + 1))
    integrals = np.empty((*half_angle.shape, len(degree)))
    integrals[..., 0] = 2 * np.sin(half_angle / 2) ** 2
    sines = np.sin(half_angle)[..., None] ** 2
    integrals[..., 1:] = sines * slopes[..., 1:] / (degree[1:] * (degree[1:] + 1))
    return 2 * np.pi * np.sqrt((2 * degree + 1) / (4 * np.pi)) * integrals


def _axis(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    direction = checks.unit_vectors("direction", direction)
    if direction.shape != (3,):
        raise ArgumentError(f"direction must have shape (3,), got {direction.shape}")
    return direction
