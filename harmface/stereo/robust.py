"""Loss that grows slowly, so that a few wrong observations do not decide.

References
----------
.. [HW77] Holland and Welsch, Robust Regression Using Iteratively Reweighted Least-Squares,
   Communications in Statistics 1977.
"""

import numpy as np
from jaxtyping import Bool, Float

CAUCHY = 2.385
"""Scales at which Cauchy's weight is a half: 95 % efficient on normal residuals ([HW77]_)."""

BRIGHTER = 3.0
"""How many times worse a value above the prediction is than one as far below."""

ROUNDING = 1e-6
"""Noise, relative to the mean observation, that counts as none."""

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


def seen_weights(
    residual: Float[np.ndarray, "F p"], seen: Bool[np.ndarray, "F p"], *, least: float = 0.0
) -> Float[np.ndarray, "F p"]:
    """Return Cauchy's weights of observations about their own robust scale; 0 where none is seen.

    Parameters
    ----------
    residual
        What a fit left of the images.
    seen
        Observations that are not saturated.
    least
        Scale to use if the residuals' is smaller.
    """
    return seen * cauchy_weights(residual, max(robust_scale(residual[seen]), least))


def point_source_weights(
    values: Float[np.ndarray, "F p"],
    predicted: Float[np.ndarray, "F p"],
    lit: Bool[np.ndarray, "F p"],
    *,
    least: float = 0.0,
) -> Float[np.ndarray, "F p"]:
    """Return weights of observations under one point source each; 0 where none is lit.

    They are Cauchy's, about the robust scale of all that is lit, but trust brightness above the
    prediction less than below: a matt surface shows `b . l`, and highlights and light from other
    parts of the object only add to it, while shadows, being dark, are out already.

    Parameters
    ----------
    values, predicted
        Images as rows of pixels, and what was expected of them.
    lit
        Observations in no shadow, and usable.
    least
        Scale to use if the residuals' is smaller, as long as the prediction is far from settled.
    """
    residual = values - predicted
    # Rounding is no noise: a scale that shrank to it would leave pixels without any weight.
    scale = max(robust_scale(residual[lit]), ROUNDING * float(np.abs(values).mean()), least)
    return lit * cauchy_weights(np.where(residual > 0, BRIGHTER, 1) * residual, scale)
