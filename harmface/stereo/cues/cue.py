"""What every cue has: residuals, a learned scale, and a test of whether it holds.

A cue says of a candidate map T, by which scaled normals are `b = T v` of the structure v, how far
it is from what is expected of surfaces, lamps or albedo. Its residuals are taken to be drawn from
Cauchy's distribution, whose heavy tails let edges and wrong pixels count for little, with a scale
that is learned: a cue that no candidate can meet well says little. With s the likeliest scale,

    cost = votes min_s (log s + mean log(1 + (r / s)^2)),

and s solves `mean 1 / (1 + (r / s)^2) = 1 / 2`. Residuals of neighbouring pixels err together, so
a cue counts as a number of independent observations, its votes, and not as its residuals.

References
----------
.. [HW77] Holland and Welsch, Robust Regression Using Iteratively Reweighted Least-Squares,
   Communications in Statistics 1977.
"""

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

Rows = Float[np.ndarray, "3 d"]

VOTES = 10.0
"""Independent observations that a cue over a whole picture counts as: a surface has some ten parts
that do not err together, as they differ in what they show, in texture and in light."""

EM_STEPS = 5
"""Steps from the median in which the scale settles to a few percent."""


@runtime_checkable
class Cue(Protocol):
    """What is known of a surface or its light beside the images."""

    @property
    def name(self) -> str:
        """As reports have it."""

    @property
    def floor(self) -> float:
        """Least scale, in the unit of the residuals."""

    @property
    def believable(self) -> float:
        """Scale from which the cue does not hold."""

    @property
    def votes(self) -> float:
        """Independent observations that it counts as."""

    def residuals(self, rows: Rows) -> Float[np.ndarray, "n"]:
        """Return the residuals of a candidate."""


def scale_of(residuals: Float[np.ndarray, "n"], floor: float) -> float:
    """Return the likeliest scale of Cauchy's distribution, at least the floor.

    Expectation-maximisation of Student's distribution with one degree of freedom ([HW77]_ for the
    loss): `s^2 = mean 2 r^2 / (1 + r^2 / s^2)`, from the median.

    Examples
    --------
    >>> residuals = np.tan(np.pi * (np.linspace(0.001, 0.999, 999) - 0.5))
    >>> round(scale_of(3 * residuals, 0.0), 2)
    3.0
    """
    squared = residuals**2
    least = max(floor**2, np.finfo(np.float64).tiny)
    scale = max(float(np.median(squared)), least)
    for _ in range(EM_STEPS):
        scale = max(2 * float((squared / (1 + squared / scale)).sum()) / squared.size, least)
    return float(np.sqrt(scale))


def cost_of(cue: Cue, rows: Rows) -> float:
    """Return the cost of a candidate by one cue."""
    residuals = cue.residuals(rows)
    scale = scale_of(residuals, cue.floor)
    return float(cue.votes * (np.log(scale) + np.log1p((residuals / scale) ** 2).mean()))
