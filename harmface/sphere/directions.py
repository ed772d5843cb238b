"""Sets of directions: near-uniform, random, and random in parts of the sphere."""

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


def stratified_directions(
    strata: int, rng: np.random.Generator | int
) -> Float[np.ndarray, "S 2 3"]:
    """Return two independent directions in each of as many parts of the sphere of equal area.

    The mean over all of a function is unbiased, and less scattered than over independent
    directions; half the squared difference of the two values in a part estimates the variance
    there without bias. The parts are nearly square cells of bands between circles of latitude.

    Parameters
    ----------
    strata
        Number of parts, at least 1.
    rng
        Random generator or seed.

    Returns
    -------
    numpy.ndarray
        Unit vectors, shape (strata, 2, 3).

    Raises
    ------
    ArgumentError
        If `strata` is below 1, or `rng` is neither generator nor seed.

    Examples
    --------
    >>> stratified_directions(500, 0).shape
    (500, 2, 3)
    """
    strata = checks.positive_integer("strata", strata)
    rng = checks.generator(rng)
    bands = max(1, round(math.sqrt(math.pi * strata) / 2))
    edges = np.cos(np.pi * np.arange(bands + 1) / bands)
    # Whole cells in each band; its bounds then follow from their areas.
    ends = np.rint(strata * (1 - edges) / 2)
    cells = np.diff(ends).astype(int)
    band = np.repeat(np.arange(bands), cells)
    cell = np.arange(strata) - ends[:-1][band]
    down, across = rng.random((2, strata, 2))
    heights = 1 - 2 * (ends[:-1][band] + cells[band] * down.T).T / strata
    azimuth = 2 * math.pi * ((cell + across.T) / cells[band]).T
    return _from_heights(heights, azimuth)


def _from_heights(
    z: Float[np.ndarray, "*J"], azimuth: Float[np.ndarray, "*J"]
) -> Float[np.ndarray, "*J 3"]:
    radius = np.sqrt((1 - z) * (1 + z))
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
