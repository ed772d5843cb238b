"""Sets of directions: near-uniform and random."""

import math

import numpy as np
from jaxtyping import Float

from harmface import checks


def fibonacci_directions(count: int) -> Float[np.ndarray, "J 3"]:
    """Return near-uniform directions on the Fibonacci spiral, from +z down to -z.

    Each stands for a band of the same area, so that the mean over them approaches the mean over
    the sphere; successive azimuths differ by the golden angle.

    Parameters
    ----------
    count
        Number of directions, at least 1.

    Returns
    -------
    numpy.ndarray
        Unit vectors, shape (count, 3), float64.

    Raises
    ------
    ArgumentError
        If `count` is below 1.

    Examples
    --------
    >>> fibonacci_directions(3)[:, 2]
    array([ 0.66666667,  0. , -0.66666667])
    """
    index = np.arange(checks.positive_integer("count", count))
    golden_angle = math.pi * (3 - math.sqrt(5))
    return _from_heights(1 - (2 * index + 1) / count, golden_angle * index)


def random_directions(count: int, rng: np.random.Generator | int) -> Float[np.ndarray, "J 3"]:
    """Return independent directions, uniform over the sphere.

    Parameters
    ----------
    count
        Number of directions, at least 1.
    rng
        Random generator or seed.

    Returns
    -------
    numpy.ndarray
        Unit vectors, shape (count, 3), float64.

    Raises
    ------
    ArgumentError
        If `count` is below 1.
    """
    count = checks.positive_integer("count", count)
    uniform = checks.generator(rng).random((2, count))
    # By Archimedes the height of a uniform direction is uniform.
    return _from_heights(1 - 2 * uniform[0], 2 * math.pi * uniform[1])


def _from_heights(
    z: Float[np.ndarray, "J"], azimuth: Float[np.ndarray, "J"]
) -> Float[np.ndarray, "J 3"]:
    radius = np.sqrt((1 - z) * (1 + z))
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
