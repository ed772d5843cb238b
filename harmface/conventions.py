"""Axes, indices, angles and colour: the one place where a convention is fixed.

Frame: right-handed, x to the right, y up, z towards the viewer; the camera looks along -z.
Directions are unit vectors from the surface to the light, shape `(..., 3)`.
Harmonics: real, orthonormal, no Condon-Shortley phase, signs as [RH01]_ eq. 3; degree `l`,
order `m`, flat index `k = l (l + 1) + m`.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import math

import numpy as np
from jaxtyping import Float, Int

from harmface import checks
from harmface.errors import ArgumentError

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Weights of linear Rec. 709 / sRGB primaries in luminance (IEC 61966-2-1)."""


def flat_index(degree: int, order: int) -> int:
    """Return the flat index `k = l (l + 1) + m` of a harmonic.

    Parameters
    ----------
    degree
        Degree `l`, at least 0.
    order
        Order `m`, with `|m| <= l`.

    Returns
    -------
    int
        `k`, from 0.

    Raises
    ------
    ArgumentError
        If there is no such harmonic.

    Examples
    --------
    >>> [flat_index(1, m) for m in (-1, 0, 1)]
    [1, 2, 3]
    """
    degree = checks.degree("degree", degree)
    if abs(order) > degree:
        raise ArgumentError(
            f"order must lie in [-{degree}, {degree}] at degree {degree}, got {order}"
        )
    return degree * (degree + 1) + order


def degree_order(index: int) -> tuple[int, int]:
    """Return degree and order `(l, m)` of flat index `k`, the inverse of `flat_index`.

    Parameters
    ----------
    index
        Flat index `k`, at least 0.

    Returns
    -------
    tuple of int
        Degree `l` and order `m`.

    Raises
    ------
    ArgumentError
        If `index` is negative or not whole.

    Examples
    --------
    >>> degree_order(8)
    (2, 2)
    """
    index = checks.degree("index", index)
    degree = math.isqrt(index)
    return degree, index - degree * (degree + 1)


def harmonic_count(max_degree: int) -> int:
    """Return `K = (max_degree + 1)**2`, the number of harmonics up to a degree.

    Parameters
    ----------
    max_degree
        Highest degree, at least 0.

    Returns
    -------
    int
        `K`.

    Raises
    ------
    ArgumentError
        If `max_degree` is negative or not whole.

    Examples
    --------
    >>> [harmonic_count(degree) for degree in range(4)]
    [1, 4, 9, 16]
    """
    return (checks.degree("max_degree", max_degree) + 1) ** 2


def max_degree_of(count: int) -> int:
    """Return the degree up to which `count` harmonics reach.

    Parameters
    ----------
    count
        Number of harmonics `K`, a square.

    Returns
    -------
    int
        The highest degree.

    Raises
    ------
    ArgumentError
        If `count` is not a square.

    Examples
    --------
    >>> max_degree_of(9)
    2
    """
    root = math.isqrt(max(count, 0))
    if count < 1 or root * root != count:
        raise ArgumentError(
            f"the number of harmonics must be a square (1, 4, 9, 16, ...), got {count}"
        )
    return root - 1


def degrees(max_degree: int) -> Int[np.ndarray, "K"]:
    """Return the degree `l` of every flat index up to `max_degree`.

    Parameters
    ----------
    max_degree
        Highest degree, at least 0.

    Returns
    -------
    numpy.ndarray
        Shape (K,), integers.

    Raises
    ------
    ArgumentError
        If `max_degree` is negative or not whole.

    Examples
    --------
    >>> degrees(2)
    array([0, 1, 1, 1, 2, 2, 2, 2, 2])
    """
    each = np.arange(checks.degree("max_degree", max_degree) + 1)
    return np.repeat(each, 2 * each + 1)


def orders(max_degree: int) -> Int[np.ndarray, "K"]:
    """Return the order `m` of every flat index up to `max_degree`.

    Parameters
    ----------
    max_degree
        Highest degree, at least 0.

    Returns
    -------
    numpy.ndarray
        Shape (K,), integers.

    Examples
    --------
    >>> orders(1)
    array([ 0, -1,  0,  1])
    """
    each = degrees(max_degree)
    return np.arange(each.size) - each * (each + 1)


def directions_from_angles(
    polar: Float[np.ndarray, "..."] | float, azimuth: Float[np.ndarray, "..."] | float
) -> Float[np.ndarray, "... 3"]:
    """Return `(sin t cos p, sin t sin p, cos t)`, [RH01]_ eq. 3.

    Parameters
    ----------
    polar
        Angle from +z in radians.
    azimuth
        Angle about +z from +x towards +y in radians; broadcasts with `polar`.

    Returns
    -------
    numpy.ndarray
        Unit vectors, shape (..., 3) for angles of shape (...); float64 unless both angles are
        float32.

    Raises
    ------
    ArgumentError
        If an angle is not finite.

    Examples
    --------
    >>> directions_from_angles(np.pi / 2, 0.0).round(12)
    array([1., 0., 0.])
    """
    polar, azimuth = np.broadcast_arrays(
        checks.finite("polar", polar), checks.finite("azimuth", azimuth)
    )
    sine = np.sin(polar)
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.cos(polar)], axis=-1)


def angles_from_directions(
    directions: Float[np.ndarray, "*points 3"],
) -> tuple[Float[np.ndarray, "*points"], Float[np.ndarray, "*points"]]:
    """Return polar angle in [0, pi] and azimuth in (-pi, pi] of directions, in radians.

    The arc tangent of both components keeps full precision near the poles.

    Parameters
    ----------
    directions
        Vectors of any length but zero, shape (..., 3).

    Returns
    -------
    tuple of numpy.ndarray
        Polar angle and azimuth in radians, each of shape (...), in the precision of `directions`.

    Raises
    ------
    ArgumentError
        If a value is not finite or the last axis is not of three.

    Examples
    --------
    >>> polar, azimuth = angles_from_directions(np.array([0.0, 1.0, 0.0]))
    >>> np.degrees([polar, azimuth]).round(9)
    array([90., 90.])
    """
    directions = checks.finite("directions", checks.vectors("directions", directions))
    x, y, z = np.moveaxis(directions, -1, 0)
    return np.asarray(np.arctan2(np.hypot(x, y), z)), np.asarray(np.arctan2(y, x))


def light_direction(azimuth: float, elevation: float) -> Float[np.ndarray, "3"]:
    """Return the direction to a light placed as seen from the camera.

    Parameters
    ----------
    azimuth
        Degrees from the viewing axis +z towards +x: positive is to the right in the image.
    elevation
        Degrees from the horizontal plane towards +y.

    Returns
    -------
    numpy.ndarray
        Unit vector from the surface to the light, shape (3,), float64.

    Raises
    ------
    ArgumentError
        If an angle is not finite.

    Examples
    --------
    >>> light_direction(90.0, 0.0).round(12)
    array([1., 0., 0.])
    """
    a = np.radians(checks.finite("azimuth", azimuth))
    e = np.radians(checks.finite("elevation", elevation))
    return np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])


def luminance(rgb: Float[np.ndarray, "*pixels 3"]) -> Float[np.ndarray, "*pixels"]:
    """Return the luminance of linear RGB values (Rec. 709 primaries).

    Parameters
    ----------
    rgb
        Linear values of any scale, shape (..., 3).

    Returns
    -------
    numpy.ndarray
        Shape (...), in the unit and precision of `rgb`.

    Raises
    ------
    ArgumentError
        If the values are integers, not finite, or not three in the last axis.

    Examples
    --------
    >>> luminance(np.array([[1.0, 1.0, 1.0]])).round(12)
    array([1.])
    """
    rgb = checks.vectors("rgb", checks.intensities("rgb", rgb))
    return np.asarray(rgb @ np.asarray(LUMINANCE, dtype=rgb.dtype))


def srgb_to_linear(encoded: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """Undo the sRGB transfer curve (IEC 61966-2-1): values in [0, 1] to linear light.

    Parameters
    ----------
    encoded
        Values encoded in sRGB, in [0, 1]; any shape.

    Returns
    -------
    numpy.ndarray
        Linear values, in the shape and precision of `encoded`.

    Raises
    ------
    ArgumentError
        If the values are integers or not finite.

    Examples
    --------
    >>> srgb_to_linear(np.array([0.0, 0.5, 1.0])).round(4)
    array([0.   , 0.214, 1.   ])
    """
    encoded = checks.intensities("encoded", encoded)
    return np.where(
        encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0) + 0.055) / 1.055) ** 2.4
    ).astype(encoded.dtype)


def linear_to_srgb(linear: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """Apply the sRGB transfer curve (IEC 61966-2-1), the inverse of `srgb_to_linear`.

    Parameters
    ----------
    linear
        Linear values, in [0, 1]; any shape. Beyond, the curve is continued.

    Returns
    -------
    numpy.ndarray
        Encoded values, in the shape and precision of `linear`.

    Raises
    ------
    ArgumentError
        If the values are integers or not finite.

    Examples
    --------
    >>> linear_to_srgb(np.array([0.0, 0.214, 1.0])).round(3)
    array([0. , 0.5, 1. ])
    """
    linear = checks.intensities("linear", linear)
    return np.where(
        linear <= 0.0031308,
        linear * 12.92,
        1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055,
    ).astype(linear.dtype)


# Frames of environment maps.
#
# Our layouts follow OpenEXR (lat-long, cube) and [RH01]_ figure 3 (angular map). Software that
# places a map otherwise means another direction by the same pixel. Each function returns the
# orthogonal matrix that carries the direction our layout gives to a pixel into the direction that
# convention means by it, in our axes; `EnvironmentMap` takes it as its `frame`. A matrix of
# determinant -1 mirrors the surroundings.


def openexr_frame() -> Float[np.ndarray, "3 3"]:
    """Return the identity: lat-long centre +z and left quarter +x, cube faces seen from inside.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix, shape (3, 3), float64.
    """
    return np.eye(3)


def rh01_frame() -> Float[np.ndarray, "3 3"]:
    """Return the identity: the angular map of [RH01]_ figure 3, centre +z, +x at the right.

    Looking to +z with +y up, +x is at the left: the published tables belong to mirrored probes.
    They also belong to half a pixel's shift, see `light.layouts.RH01Probe`.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix, shape (3, 3), float64.
    """
    return np.eye(3)


def debevec_frame() -> Float[np.ndarray, "3 3"]:
    """Return the mirror `z -> -z`: Debevec's light probes, which look to -z at the centre.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix of determinant -1, shape (3, 3), float64.
    """
    return np.diag([1.0, 1.0, -1.0])


def y_up_latlong_frame() -> Float[np.ndarray, "3 3"]:
    """Return half a turn about +y: lat-long maps that look to -z, as our camera, at the centre.

    Returns
    -------
    numpy.ndarray
        Rotation matrix, shape (3, 3), float64.
    """
    return np.diag([-1.0, 1.0, -1.0])


def z_up_latlong_frame() -> Float[np.ndarray, "3 3"]:
    """Return the frame of lat-long maps made in a z-up world, with its +x at the centre.

    The z-up world is laid on its back first, see `z_up_to_y_up`: its +z becomes our +y.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix, shape (3, 3), float64.
    """
    # Longitude runs from +z to +x in our layout and from +x to +y there.
    latlong = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    return z_up_to_y_up() @ latlong


def three_js_latlong_frame() -> Float[np.ndarray, "3 3"]:
    """Return a quarter turn about +y: three.js's equirectangular maps look to +x at the centre.

    Returns
    -------
    numpy.ndarray
        Rotation matrix, shape (3, 3), float64.
    """
    return np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


def opengl_cube_frame() -> Float[np.ndarray, "3 3"]:
    """Return the identity, for faces turned by `light.faces_from_opengl`.

    OpenGL samples a cube by left-handed axes: each of its faces is the mirror image of ours.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix, shape (3, 3), float64.
    """
    return np.eye(3)


def three_js_cube_frame() -> Float[np.ndarray, "3 3"]:
    """Return the mirror `x -> -x`, for faces turned by `light.faces_from_opengl`.

    three.js flips x when it samples a cube, which undoes OpenGL's mirroring.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix of determinant -1, shape (3, 3), float64.
    """
    return np.diag([-1.0, 1.0, 1.0])


def z_up_to_y_up() -> Float[np.ndarray, "3 3"]:
    """Return the rotation that carries +z, up in many modelling worlds, to +y, and +y to -z.

    Returns
    -------
    numpy.ndarray
        Rotation matrix, shape (3, 3), float64.

    Examples
    --------
    >>> z_up_to_y_up() @ [0.0, 0.0, 1.0]
    array([0., 1., 0.])
    """
    return np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


MAP_FRAMES = {
    ("latlong", "openexr"): openexr_frame,
    ("latlong", "y-up"): y_up_latlong_frame,
    ("latlong", "z-up"): z_up_latlong_frame,
    ("latlong", "three.js"): three_js_latlong_frame,
    ("angular", "rh01"): rh01_frame,
    ("angular", "figure-3"): rh01_frame,
    ("angular", "debevec"): debevec_frame,
    ("mirror-ball", "figure-3"): rh01_frame,
    ("mirror-ball", "debevec"): debevec_frame,
    ("cube", "openexr"): openexr_frame,
    ("cube", "opengl"): opengl_cube_frame,
    ("cube", "three.js"): three_js_cube_frame,
}
"""Every known pair of a map's layout and frame; each layout's first frame is our own."""


def map_frame(layout: str, frame: str | None = None) -> Float[np.ndarray, "3 3"]:
    """Return the frame of a layout by name, by default our own: the identity.

    Parameters
    ----------
    layout
        "latlong", "angular", "mirror-ball" or "cube".
    frame
        Name of a frame of that layout, see `MAP_FRAMES`; our own if not given.

    Returns
    -------
    numpy.ndarray
        Orthogonal matrix, shape (3, 3), float64.

    Raises
    ------
    ArgumentError
        If that layout has no such frame.

    Examples
    --------
    >>> map_frame("angular", "debevec").diagonal()
    array([ 1.,  1., -1.])
    """
    known = [name for of, name in MAP_FRAMES if of == layout]
    if frame is None:
        frame = known[0]
    if frame not in known:
        raise ArgumentError(
            f"frame of a {layout} map must be one of {', '.join(known)}, got {frame!r}"
        )
    return MAP_FRAMES[layout, frame]()
