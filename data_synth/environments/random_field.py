"""A random smooth environment whose log radiance has an angular power spectrum of 1 / l^2.

References
----------
.. [DWA04] R. Dror, A. Willsky, E. Adelson, "Statistical characterization of real-world
   illumination", Journal of Vision 4(9), 2004: the power of natural environments falls with
   the degree l about as l^-2 or a little faster.
"""

from functools import partial

import numpy as np

from data_synth.environments.environment import Environment
from data_synth.environments.rules import sphere_rule

# Axes of the ridge functions. A Gaussian field has 2 l + 1 free coefficients at degree l.
_AXES = 64


def random_field(
    rng: np.random.Generator | int = 0,
    *,
    max_degree: int = 16,
    contrast: float = 0.8,
    tint: float = 0.15,
) -> Environment:
    """Build an environment of random clouds of light.

    The log of the radiance is a sum of ridges `w P_l(d . u)` over random axes u with normal
    weights w. As the mean of `P_l(d . u) P_l(d' . u)` over u is `P_l(d . d') / (2 l + 1)`, each
    Legendre polynomial feeds its own degree alone, isotropically; the deviation of its weights
    is set so that the mean square of a coefficient of degree l is proportional to `1 / l^2`
    [DWA04]_, from 1 up to `max_degree`. The exponential makes it non-negative.

    Parameters
    ----------
    rng : numpy Generator or seed
    max_degree : int
        At least 1.
    contrast : float
        Standard deviation of the log radiance, all channels in common, in (0, 2].
    tint : float
        Standard deviation of each channel's own part, over that of the common one, in [0, 1].
    """
    if max_degree < 1:
        raise ValueError(f"max_degree must be at least 1, got {max_degree}: 16 is smooth")
    if not 0 < contrast <= 2:
        raise ValueError(f"contrast must be in (0, 2], got {contrast}: 0.8 is a cloudy day")
    if not 0 <= tint <= 1:
        raise ValueError(f"tint must be in [0, 1], got {tint}: 0 is grey")
    rng = np.random.default_rng(rng)
    axes = rng.standard_normal((_AXES, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    degree = np.arange(1, max_degree + 1)
    # A ridge w P_l has the power w^2 4 pi / (2 l + 1), spread over 2 l + 1 coefficients; the
    # variance of the field is the sum of (2 l + 1) / (4 pi) times the power of a coefficient.
    power = 1.0 / degree**2
    power *= contrast**2 / ((2 * degree + 1) * power).sum() * 4.0 * np.pi
    deviation = (2 * degree + 1) * np.sqrt(power / (4.0 * np.pi * _AXES))
    common = rng.standard_normal((max_degree, _AXES, 1))
    own = rng.standard_normal((max_degree, _AXES, 3))
    weights = deviation[:, None, None] * (common + tint * own)
    return Environment(
        "random_field", partial(_radiance, axes, weights), sphere_rule, nodes=2 * max_degree
    )


# Directions evaluated at once: the work arrays then stay in the processor's cache.
_BLOCK = 2048


def _radiance(axes: np.ndarray, weights: np.ndarray, directions: np.ndarray) -> np.ndarray:
    flat = directions.reshape(-1, 3)
    log = np.empty_like(flat)
    for start in range(0, len(flat), _BLOCK):
        block = slice(start, start + _BLOCK)
        log[block] = _ridges(axes, weights, flat[block])
    return np.exp(log).reshape(directions.shape)


def _ridges(axes: np.ndarray, weights: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Sum over axes and degrees of weight times Legendre polynomial, (N, 3)."""
    cosine = directions @ axes.T
    before, legendre = np.ones_like(cosine), cosine
    total: np.ndarray = legendre @ weights[0]
    for degree in range(2, len(weights) + 1):
        # Bonnet: l P_l = (2 l - 1) x P_{l-1} - (l - 1) P_{l-2}.
        step = (2.0 - 1.0 / degree) * cosine * legendre - (1.0 - 1.0 / degree) * before
        before, legendre = legendre, step
        total += legendre @ weights[degree - 1]
    return total
