"""Real spherical harmonics of any number of directions at once.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.sphere.closed_forms import fill_closed_forms
from harmface.sphere.recurrence import GREATEST_DEGREE, Scratch, fill_recurrence, steps_to

BLOCK = 16384
"""Directions handled together: few enough for the cache, enough to outweigh numpy's calls."""


def real_harmonics(
    directions: Float[np.ndarray, "*pixels 3"], max_degree: int
) -> Float[np.ndarray, "K *pixels"]:
    """Return the real orthonormal harmonics of directions, with the signs of [RH01]_ eq. 3.

    The closed polynomials of that equation serve up to degree 2, a stable recurrence above.

    Parameters
    ----------
    directions
        Unit vectors, shape `(*pixels, 3)`.
    max_degree
        Greatest degree `l`, at least 0, at most 150 in float32 and 1000 in float64.

    Returns
    -------
    ndarray
        Harmonic `k = l (l + 1) + m` in row `k`, shape `((max_degree + 1)**2, *pixels)`, in the
        precision of `directions`.

    Raises
    ------
    ArgumentError
        If a direction is not of unit length, or the degree is out of range.

    Examples
    --------
    >>> real_harmonics(np.array([0.0, 0.0, 1.0]), 1).round(6)
    array([0.282095, 0.      , 0.488603, 0.      ])
    """
    directions = checks.vectors("directions", directions)
    count = harmonic_count(max_degree)
    greatest = GREATEST_DEGREE[directions.dtype]
    if max_degree > greatest:
        raise ArgumentError(
            f"max_degree must be at most {greatest} in {directions.dtype}, got {max_degree}"
        )
    points = directions.reshape(-1, 3)
    out = np.empty((count, len(points)), directions.dtype)
    wrong = 0
    size = min(BLOCK, len(points))
    steps = steps_to(max_degree, directions.dtype)
    xyz, squares = np.empty((2, 3, size), directions.dtype)
    scratch = Scratch.of(max_degree, size, directions.dtype) if steps else None
    for start in range(0, len(points), BLOCK):
        block = points[start : start + BLOCK]
        used = slice(len(block))
        rows = out[:, start : start + BLOCK]
        np.copyto(xyz[:, used], block.T)
        squared = fill_closed_forms(xyz[:, used], rows, squares[:, used])
        wrong += count_not_unit(squared)
        if scratch:
            fill_recurrence(xyz[:, used], rows, steps, scratch.first(len(block)))
    if wrong:
        raise checks.not_unit("directions", wrong, len(points))
    return out.reshape(count, *directions.shape[:-1])


def count_not_unit(squared_lengths: Float[np.ndarray, "N"]) -> int:
    """Return how many squared lengths are not 1, quickly when none is."""
    low, high = 1 - checks.UNIT_TOLERANCE, 1 + checks.UNIT_TOLERANCE
    # Least and greatest pass NaN on, and every comparison with NaN fails.
    if squared_lengths.min() >= low and squared_lengths.max() <= high:
        return 0
    return int(np.count_nonzero(~((squared_lengths >= low) & (squared_lengths <= high))))
