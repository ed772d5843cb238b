"""Loss that grows slowly, so that a few wrong observations do not decide.

References
----------
.. [HW77] Holland and Welsch, Robust Regression Using Iteratively Reweighted Least-Squares,
   Communications in Statistics 1977.
"""

import numpy as np
from jaxtyping import Float

CAUCHY = 2.385
"""Scales at which Cauchy's weight is a half: 95 % efficient on normal residuals ([HW77]_)."""

NORMAL_MAD = 1.4826
"""Standard deviation over median absolute value of a normal distribution."""


def robust_scale(residual: Float[np.ndarray, "*n"]) -> float:
    """Return a standard deviation that outliers do not inflate, from the median absolute value."""
    return NORMAL_MAD * float(np.median(np.abs(residual))) if residual.size else 0.0


def cauchy_weights(
    residual: Float[np.ndarray, "*n"], scale: float | Float[np.ndarray, "..."]
) -> Float[np.ndarray, "*n"]:
    """Return `1 / (1 + (r / c s)^2)`, the weights of Cauchy's loss; 1 where the scale is 0."""
    reach = CAUCHY * np.asarray(scale)
    ratio = np.divide(residual, reach, out=np.zeros_like(residual), where=reach > 0)
    return 1 / (1 + ratio**2)
