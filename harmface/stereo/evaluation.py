"""How wrong normals are: angles to the truth, as they are and after an ambiguity is undone.

References
----------
.. [BKY99] Belhumeur, Kriegman and Yuille, The Bas-Relief Ambiguity, IJCV 1999.
.. [K76] Kabsch, A Solution for the Best Rotation to Relate Two Sets of Vectors, Acta
   Crystallographica 1976.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from harmface import checks
from harmface.errors import ArgumentError
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.linear_map import nearest_linear_map
from harmface.stereo.lorentz import nearest_lorentz


@dataclass(frozen=True)
class AngularError:
    """Angles between estimated and true normals, degrees.

    Parameters
    ----------
    mean, median, p90, p99
        Over the pixels; p90 and p99 are percentiles.
    """

    mean: float
    median: float
    p90: float
    p99: float


def angular_errors(
    normals: Float[np.ndarray, "*pixels 3"], truth: Float[np.ndarray, "*pixels 3"]
) -> Float[np.ndarray, "*pixels"]:
    """Return the angle between unit normals in degrees.

    The chord, rather than the dot product, keeps small angles exact.

    Parameters
    ----------
    normals
        Unit normals.
    truth
        True unit normals of the same shape.

    Returns
    -------
    numpy.ndarray
        Angles in degrees, shape `(*pixels)`.

    Raises
    ------
    ArgumentError
        If a vector is not of unit length, or the shapes differ.

    Examples
    --------
    >>> angular_errors(np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 1.0, 0.0]])).round(6)
    array([90.])
    """
    normals, truth = _checked(normals, truth)
    chord = np.linalg.norm(normals - truth, axis=-1)
    return np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1)))


def summary(errors: Float[np.ndarray, "n"]) -> AngularError:
    """Return mean, median and percentiles of angles.

    Parameters
    ----------
    errors
        Angles in degrees.

    Returns
    -------
    AngularError
        In degrees.

    Raises
    ------
    ArgumentError
        If there is no angle.
    """
    if errors.size == 0:
        raise ArgumentError("errors must hold at least one angle, got none")
    median, p90, p99 = np.percentile(errors, [50, 90, 99])
    return AngularError(float(errors.mean()), float(median), float(p90), float(p99))


def without_convexity(
    normals: Float[np.ndarray, "p 3"], truth: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "p 3"]:
    """Return the normals, or their convex-concave counterpart (-x, -y, z) if that is nearer.

    Parameters
    ----------
    normals
        Unit normals.
    truth
        True unit normals of the same shape.

    Returns
    -------
    numpy.ndarray
        Unit normals, shape (p, 3).

    Raises
    ------
    ArgumentError
        If a vector is not of unit length, or the shapes differ.
    """
    normals, truth = _checked(normals, truth)
    flipped = normals * np.array([-1, -1, 1], normals.dtype)
    return min(normals, flipped, key=lambda each: float(angular_errors(each, truth).mean()))


def without_rotation(
    normals: Float[np.ndarray, "p 3"], truth: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "p 3"]:
    """Return the normals after the best rotation or reflection to the truth ([K76]_).

    Parameters
    ----------
    normals
        Unit normals.
    truth
        True unit normals of the same shape.

    Returns
    -------
    numpy.ndarray
        Unit normals, shape (p, 3).

    Raises
    ------
    ArgumentError
        If a vector is not of unit length, or the shapes differ.
    """
    normals, truth = _checked(normals, truth)
    left, _, right = np.linalg.svd(truth.T @ normals)
    return normals @ (left @ right).T


def without_lorentz(
    normals: Float[np.ndarray, "p 3"], truth: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "p 3"]:
    """Return the normals after the Lorentz transformation of (1, n) nearest to the truth.

    It moves normals as a conformal map of the sphere; this is what images of exactly degree 1 or
    2 leave open, see `second_order`.

    Parameters
    ----------
    normals
        Unit normals.
    truth
        True unit normals of the same shape.

    Returns
    -------
    numpy.ndarray
        Unit normals, shape (p, 3).

    Raises
    ------
    ArgumentError
        If a vector is not of unit length, or the shapes differ.
    """
    normals, truth = _checked(normals, truth)
    null = np.concatenate([np.ones((1, len(normals))), normals.T])
    image = nearest_lorentz(normals, truth) @ null
    return np.asarray((image[1:] / image[0]).T)


def without_linear_map(
    b: Float[np.ndarray, "p d"], truth: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "p 3"]:
    """Return unit normals after the best linear map of d numbers a pixel to the truth.

    With d = 3 this undoes a bas-relief or any other linear ambiguity; with the structure of a
    factorisation, d = 4 or 9, it is the *oracle*: no method that is linear in that space does
    better. See `nearest_linear_map`.

    Parameters
    ----------
    b
        Numbers d of each pixel, such as albedo times normal.
    truth
        True unit normals.

    Returns
    -------
    numpy.ndarray
        Unit normals, shape (p, 3).
    """
    return directions_of(b @ nearest_linear_map(b, truth).T)


def without_bas_relief(
    normals: Float[np.ndarray, "p 3"], truth: Float[np.ndarray, "p 3"]
) -> Float[np.ndarray, "p 3"]:
    """Return the normals after the bas-relief transformation nearest to the truth ([BKY99]_).

    `n ~ (s n_x + mu n_z, s n_y + nu n_z, lambda n_z)`, s = 1 or -1: what images of a surface under
    distant lamps leave open.

    Parameters
    ----------
    normals
        Unit normals.
    truth
        True unit normals of the same shape.

    Returns
    -------
    numpy.ndarray
        Unit normals, shape (p, 3).

    Raises
    ------
    ArgumentError
        If a vector is not of unit length, or the shapes differ.
    """
    normals, truth = _checked(normals, truth)

    def turned(numbers: Float[np.ndarray, "3"], sign: float) -> Float[np.ndarray, "p 3"]:
        mu, nu, stretch = numbers
        z = normals[:, 2]
        found = [sign * normals[:, 0] + mu * z, sign * normals[:, 1] + nu * z, np.exp(stretch) * z]
        return directions_of(np.stack(found, axis=1))

    fits = [
        (least_squares(lambda each, s=sign: (turned(each, s) - truth).ravel(), start), sign)
        for sign in (1.0, -1.0)
        for start in ((0, 0, -0.7), (0, 0, 0.0), (0, 0, 0.7))
    ]
    best, sign = min(fits, key=lambda each: float(each[0].cost))
    return turned(best.x, sign)


def _checked(
    normals: Float[np.ndarray, "*pixels 3"], truth: Float[np.ndarray, "*pixels 3"]
) -> tuple[Float[np.ndarray, "*pixels 3"], Float[np.ndarray, "*pixels 3"]]:
    """Return unit normals of one shape."""
    normals = checks.unit_vectors("normals", normals)
    truth = checks.unit_vectors("truth", truth)
    if normals.shape != truth.shape:
        raise ArgumentError(f"truth must match normals {normals.shape}, got {truth.shape}")
    return normals, truth
