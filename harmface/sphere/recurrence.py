"""Harmonics above degree 2, as products of a polynomial in z and one in x and y.

    Y_lm = Q_lm(z) Re (x + iy)^m,    Y_l,-m = Q_lm(z) Im (x + iy)^m,    m >= 0.

There is no angle, no square root and no division by the distance from the axis, so that the
poles are points like any other. Q obeys the normalised Legendre recurrence

    Q_lm = a_lm z Q_l-1,m - b_lm Q_l-2,m,

which is stable upwards in the degree and runs over all orders of a degree at once.
"""

import functools
import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from harmface.sphere.closed_forms import Y0, Y1

GREATEST_DEGREE = {np.dtype(np.float32): 150, np.dtype(np.float64): 1000}
"""Where Q, which grows at the poles as (x + iy)^m vanishes there, is still far from overflow."""

Operation = Callable[[], object]
"""One array operation on rows that are given."""


class Constants(NamedTuple):
    """Constants of one degree of the recurrence."""

    degree: int
    a: Float[np.ndarray, "orders 1"]
    """a_lm at orders 0 to l - 1."""
    b: Float[np.ndarray, "orders-1 1"]
    """b_lm at orders 0 to l - 2; b vanishes at order l - 1."""
    sectoral: float
    """Q_ll."""


@functools.lru_cache(maxsize=32)
def constants_to(max_degree: int, dtype: np.dtype) -> tuple[Constants, ...]:
    """Return the constants of degrees 2 to `max_degree`."""
    constants = []
    sectoral = Y1
    for degree in range(2, max_degree + 1):
        m2 = np.square(np.arange(degree, dtype=np.float64))[:, np.newaxis]
        gap = degree**2 - m2
        a = np.sqrt((4 * degree**2 - 1) / gap)
        b = np.sqrt((2 * degree + 1) / (2 * degree - 3) * ((degree - 1) ** 2 - m2) / gap)
        sectoral *= math.sqrt((2 * degree + 1) / (2 * degree))
        constants.append(Constants(degree, a.astype(dtype), b[:-1].astype(dtype), sectoral))
    return tuple(constants)


class Step(NamedTuple):
    """What to do at one degree."""

    operations: list[Operation]
    """Make Q."""
    products: list[tuple[slice, Float[np.ndarray, "orders N"], Float[np.ndarray, "orders N"]]]
    """Rows of the result, and the rows of Q and of the powers of x + iy that make them."""


class Recurrence:
    """Fills in the degrees from 3 upwards for one block of N directions after another.

    The operations are laid out once, on rows that stay where they are, and replayed for every
    block: to slice the rows anew would take a good part of the time, and Python's lock.

    Parameters
    ----------
    xyz
        The directions of the block, shape `(3, N)`, rewritten by the caller for every block.
    max_degree
        Greatest degree, at least 2.
    """

    def __init__(self, xyz: Float[np.ndarray, "3 N"], max_degree: int) -> None:
        z = xyz[2]
        powers = np.empty((2, max_degree + 1, xyz.shape[1]), xyz.dtype)
        before, last, q = np.empty((3, max_degree + 1, xyz.shape[1]), xyz.dtype)
        self.preparation: list[Operation] = [
            *powers_of(xyz, powers),
            partial(before[0].fill, Y0),
            partial(np.multiply, z, Y1, last[0]),
            partial(last[1].fill, Y1),
        ]
        self.steps = []
        for degree, a, b, sectoral in constants_to(max_degree, xyz.dtype):
            outer, inner = slice(degree), slice(degree - 1)
            operations: list[Operation] = [
                partial(np.multiply, last[outer], z, q[outer]),
                partial(np.multiply, q[outer], a, q[outer]),
                partial(np.multiply, before[inner], b, before[inner]),
                partial(np.subtract, q[inner], before[inner], q[inner]),
                partial(q[degree].fill, sectoral),
            ]
            middle = degree * (degree + 1)
            up, down = slice(degree + 1), slice(degree, 0, -1)
            products = [
                (slice(middle, middle + degree + 1), q[up], powers[0, up]),
                (slice(middle - degree, middle), q[down], powers[1, down]),
            ]
            # The closed forms have degree 2.
            self.steps.append(Step(operations, products if degree > 2 else []))
            before, last, q = last, q, before

    def fill(self, out: Float[np.ndarray, "K N"]) -> None:
        """Write the rows of `out` from degree 3 upwards."""
        for operation in self.preparation:
            operation()
        for step in self.steps:
            for operation in step.operations:
                operation()
            for rows, q, powers in step.products:
                np.multiply(q, powers, out=out[rows])


def powers_of(
    xyz: Float[np.ndarray, "3 N"], powers: Float[np.ndarray, "2 orders N"]
) -> list[Operation]:
    """Return the operations that write Re (x + iy)^m and Im (x + iy)^m for m = 0, 1, 2, ..."""
    x, y, _ = xyz
    turn, products = np.empty((2, 2, xyz.shape[1]), xyz.dtype)
    powers[0, 0], powers[1, 0] = 1, 0
    operations: list[Operation] = [
        partial(np.copyto, powers[:, 1], xyz[:2]),
        partial(np.negative, y, turn[0]),
        partial(np.copyto, turn[1], y),
    ]
    for order in range(2, powers.shape[1]):
        last, power = powers[:, order - 1], powers[:, order]
        operations += [
            partial(np.multiply, last, x, power),
            partial(np.multiply, last[::-1], turn, products),
            partial(np.add, power, products, power),
        ]
    return operations
