"""Real spherical harmonics of any number of directions at once.

References
----------
.. [RH01] Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment
   Maps, SIGGRAPH 2001.
"""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import harmonic_count, max_degree_of
from harmface.errors import ArgumentError
from harmface.sphere.closed_forms import fill_closed_forms
from harmface.sphere.recurrence import GREATEST_DEGREE, Recurrence

THREADS = min(os.cpu_count() or 1, 4)
"""Most threads at work; they share Python's lock between numpy's calls, and hence do not scale."""


ROUNDINGS = 16
"""Units in the last place by which the squared length of a direction just divided by its length
may miss 1: three squares, two sums, a root and three quotients, each half a unit on both sides."""


def block_size(max_degree: int) -> int:
    """Return how many directions to handle together.

    Few enough for the rows at work, whose number grows with the degree, to stay in the cache;
    enough to outweigh the cost of calling numpy. Measured best at degrees 2 and 10.
    """
    return 2**18 // max(max_degree, 2)


def real_harmonics(
    directions: Float[np.ndarray, "*pixels 3"], max_degree: int
) -> Float[np.ndarray, "K *pixels"]:
    """Return the real orthonormal harmonics of directions, with the signs of [RH01]_ eq. 3.

    The closed polynomials of that equation serve up to degree 2, a stable recurrence above.

    Parameters
    ----------
    directions
        Unit vectors, shape `(*pixels, 3)`; lengths within 5e-5 of 1 are brought to 1.
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
    threads = THREADS if len(points) >= THREADS * block_size(max_degree) else 1
    parts = np.array_split(points, threads), np.array_split(out, threads, axis=1)
    if threads == 1:
        wrong = sum(map(fill_part, *parts))
    else:
        with ThreadPoolExecutor(threads) as executor:
            wrong = sum(executor.map(fill_part, *parts))
    if wrong:
        raise checks.not_unit("directions", wrong, len(points))
    return out.reshape(count, *directions.shape[:-1])


def fill_part(points: Float[np.ndarray, "N 3"], out: Float[np.ndarray, "K N"]) -> int:
    """Write the harmonics of some points and return how many of these are not unit vectors."""
    size = block_size(max_degree_of(len(out)))
    block = None
    wrong = 0
    for start in range(0, len(points), size):
        some = points[start : start + size]
        if block is None or block.size != len(some):
            block = Block(len(some), max_degree_of(len(out)), points.dtype)
        wrong += block.fill(some, out[:, start : start + size])
    return wrong


class Block:
    """Room to work on a number of directions at once."""

    def __init__(self, size: int, max_degree: int, dtype: np.dtype) -> None:
        self.size = size
        self.xyz, self.squares = np.empty((2, 3, size), dtype)
        self.recurrence = Recurrence(self.xyz, max_degree) if max_degree > 2 else None

    def fill(self, points: Float[np.ndarray, "N 3"], out: Float[np.ndarray, "K N"]) -> int:
        """Write the harmonics of some points and return how many are not unit vectors."""
        # One component at a time is faster than all transposed at once.
        for row, component in zip(self.xyz, points.T, strict=True):
            row[:] = component
        squared_lengths = fill_closed_forms(self.xyz, out, self.squares)
        wrong = count_not_unit(squared_lengths)
        if wrong:
            return wrong
        if beyond_rounding(squared_lengths):
            # A harmonic of degree l is off by l times as much as its direction's length is.
            self.xyz /= np.sqrt(squared_lengths)
            fill_closed_forms(self.xyz, out, self.squares)
        if self.recurrence:
            self.recurrence.fill(out)
        return 0


def beyond_rounding(squared_lengths: Float[np.ndarray, "N"]) -> bool:
    """Return whether a squared length is farther from 1 than a few roundings take it."""
    most = ROUNDINGS * np.finfo(squared_lengths.dtype).eps
    return bool(squared_lengths.min() < 1 - most or squared_lengths.max() > 1 + most)


def count_not_unit(squared_lengths: Float[np.ndarray, "N"]) -> int:
    """Return how many squared lengths are not 1, quickly when none is."""
    low, high = 1 - checks.UNIT_TOLERANCE, 1 + checks.UNIT_TOLERANCE
    # Least and greatest pass NaN on, and every comparison with NaN fails.
    if squared_lengths.min() >= low and squared_lengths.max() <= high:
        return 0
    return int(np.count_nonzero(~((squared_lengths >= low) & (squared_lengths <= high))))
