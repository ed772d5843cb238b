"""Harmonics above degree 2, as products of a polynomial in z and one in x and y.

    Y_lm = Q_lm(z) Re (x + iy)^m,    Y_l,-m = Q_lm(z) Im (x + iy)^m,    m >= 0.

There is no angle, no square root and no division by the distance from the axis, so that the
poles are points like any other. Q obeys the normalised Legendre recurrence

    Q_lm = a_lm z Q_l-1,m - b_lm Q_l-2,m,

which is stable upwards in the degree and runs over all orders of a degree at once.
"""

import functools
import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from harmface.sphere.closed_forms import Y1, Y2, Y22

GREATEST_DEGREE = {np.dtype(np.float32): 150, np.dtype(np.float64): 1000}
"""Where Q, which grows at the poles as (x + iy)^m vanishes there, is still far from overflow."""


class Step(NamedTuple):
    """Constants of one degree of the recurrence."""

    degree: int
    a: Float[np.ndarray, "orders 1"]
    """a_lm at orders 0 to l - 1."""
    b: Float[np.ndarray, "orders-1 1"]
    """b_lm at orders 0 to l - 2; b vanishes at order l - 1."""
    sectoral: float
    """Q_ll, a constant."""


@functools.lru_cache(maxsize=32)
def steps_to(max_degree: int, dtype: np.dtype) -> tuple[Step, ...]:
    """Return the constants of degrees 3 to `max_degree`."""
    steps = []
    sectoral = Y22
    for degree in range(3, max_degree + 1):
        m2 = np.square(np.arange(degree, dtype=np.float64))[:, np.newaxis]
        gap = degree**2 - m2
        a = np.sqrt((4 * degree**2 - 1) / gap)
        b = np.sqrt((2 * degree + 1) / (2 * degree - 3) * ((degree - 1) ** 2 - m2) / gap)
        sectoral *= math.sqrt((2 * degree + 1) / (2 * degree))
        steps.append(Step(degree, a.astype(dtype), b[:-1].astype(dtype), sectoral))
    return tuple(steps)


class Scratch(NamedTuple):
    """Room for the intermediate rows of a block of N directions."""

    circle: Float[np.ndarray, "2 orders N"]
    """Re (x + iy)^m and Im (x + iy)^m."""
    degrees: Float[np.ndarray, "3 orders N"]
    """Q of three successive degrees."""
    products: Float[np.ndarray, "orders N"]

    @classmethod
    def of(cls, max_degree: int, size: int, dtype: np.dtype) -> "Scratch":
        """Make room for `size` directions."""
        orders = max_degree + 1
        return cls(
            np.empty((2, orders, size), dtype),
            np.empty((3, orders, size), dtype),
            np.empty((orders, size), dtype),
        )

    def first(self, size: int) -> "Scratch":
        """Return the room for the first `size` directions."""
        return type(self)(*(rows[..., :size] for rows in self))


def fill_recurrence(
    xyz: Float[np.ndarray, "3 N"],
    out: Float[np.ndarray, "K N"],
    steps: tuple[Step, ...],
    scratch: Scratch,
) -> None:
    """Write the degrees of `steps`, from 3 upwards, after the nine rows below them."""
    z = xyz[2]
    cosines, sines = fill_circle(xyz, scratch.circle, scratch.products)
    before, last, q = scratch.degrees
    before[0], before[1] = out[2], Y1
    last[0], last[2] = out[6], Y22
    np.multiply(z, Y2, out=last[1])
    for degree, a, b, sectoral in steps:
        np.multiply(last[:degree], z, out=q[:degree])
        q[:degree] *= a
        np.multiply(before[: degree - 1], b, out=scratch.products[: degree - 1])
        q[: degree - 1] -= scratch.products[: degree - 1]
        q[degree] = sectoral
        first, middle, end = degree**2, degree * (degree + 1), (degree + 1) ** 2
        np.multiply(q[: degree + 1], cosines[: degree + 1], out=out[middle:end])
        np.multiply(q[degree:0:-1], sines[degree:0:-1], out=out[first:middle])
        before, last, q = last, q, before


def fill_circle(
    xyz: Float[np.ndarray, "3 N"],
    circle: Float[np.ndarray, "2 orders N"],
    scratch: Float[np.ndarray, "orders N"],
) -> Float[np.ndarray, "2 orders N"]:
    """Write the real and the imaginary parts of (x + iy)^m for m = 0, 1, 2, ..."""
    x, y, _ = xyz
    circle[0, 0], circle[1, 0] = 1, 0
    circle[:, 1] = xyz[:2]
    products, turn = scratch[:2], scratch[2:4]
    np.negative(y, out=turn[0])
    turn[1] = y
    for order in range(2, circle.shape[1]):
        np.multiply(circle[:, order - 1], x, out=circle[:, order])
        np.multiply(circle[::-1, order - 1], turn, out=products)
        circle[:, order] += products
    return circle
