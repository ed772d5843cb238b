"""Light as the solution of weighted least squares in which shadows and highlights have no vote.

References
----------
.. [HR09] Huber and Ronchetti, Robust Statistics, 2nd edition, 2009, chapter 7.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

TUKEY = 4.685
"""Residual in standard deviations from which a pixel has no vote: Tukey's biweight then needs 5 %
more pixels than plain least squares where all noise is Gaussian ([HR09]_)."""

HUBER = 1.345
"""Residual from which votes shrink while the biweight's start is looked for: again 5 %."""

GAUSSIAN = 1.4826
"""Standard deviation of a normal distribution over the median of its absolute deviations."""

SAMPLE = 2**15
"""Pixels on which robust weights are iterated; all of them take the last step."""

ROUNDS = 40
"""Most steps of each of the two iterations; some ten are taken."""

CHUNK = 2**15
"""Pixels treated at a time: blocks of some MB, which a cache holds."""


@dataclass(frozen=True, eq=False)
class Information:
    """What the pixels of one channel say of the light: `gram @ light = right`.

    Both are divided by the variance of the noise, so that the inverse of `gram` is the covariance
    of the solution.

    Parameters
    ----------
    gram
        Sum over the pixels of the outer products of their basis.
    right
        Right-hand side.
    noise
        Standard deviation of a pixel of weight 1.
    start
        Light from which the robust weights are taken; zeros without them.
    """

    gram: Float[np.ndarray, "K K"]
    right: Float[np.ndarray, "K"]
    noise: float
    start: Float[np.ndarray, "K"]


def gather(
    basis: Float[np.ndarray, "K p"],
    values: Float[np.ndarray, "p"],
    noise: float | None,
    robust: bool,
) -> Information:
    """Return what pixels say of the light.

    With `robust`, light and noise are first found on a sample: Huber's function, which has one
    minimum, then Tukey's biweight, which gives no vote to what is far off. One step of Newton's
    method on all pixels ends it, so that the result has their precision.

    Parameters
    ----------
    basis
        Harmonic images, each pixel divided by the standard deviation of its noise.
    values
        The photograph, divided alike.
    noise
        Least standard deviation of these values, 1 if that of the pixels was right; None if it is
        only known to be the same everywhere.
    robust
        Whether shadows and highlights are looked for.
    """
    count = len(basis)
    if not robust:
        gram, right, squares = _sums(basis, values)
        light = _solved(gram, right)
        left = max(squares - light @ right, 0.0) / max(values.size - count, 1)
        noise = max(noise or 0.0, float(np.sqrt(left)), _rounding(values))
        return Information(gram / noise**2, right / noise**2, noise, np.zeros(count))
    light, scale = _robust_start(basis, values, noise)
    # The biweight's equations `sum psi(r) s = 0`, linear about the start ([HR09]_ 7.8).
    hessian, gradient = np.zeros((count, count)), np.zeros(count)
    squared, slopes = 0.0, 0.0
    for first in range(0, values.size, CHUNK):
        block = basis[:, first : first + CHUNK]
        residual = (values[first : first + CHUNK] - light @ block) / scale
        inside = np.maximum(1 - (residual / TUKEY) ** 2, 0)
        influence = residual * inside**2
        slope = inside * (1 - 5 * (residual / TUKEY) ** 2)
        hessian += (block * slope) @ block.T
        gradient += block @ influence
        squared += float(influence @ influence)
        slopes += float(slope.sum())
    # Far from Gaussian residuals may leave no minimum about the start: then its votes do.
    values_of = np.linalg.eigvalsh(hessian)
    if values_of[0] < -1e-9 * values_of[-1]:
        weights = _biweight((values - light @ basis) / scale)
        hessian, _, _ = _sums(basis * np.sqrt(weights), values)
    if squared == 0:
        ratio = 1.0
    else:
        ratio = slopes / squared * (values.size - count) / values.size
    precision = ratio / scale**2
    right = hessian @ light + scale * gradient
    return Information(hessian * precision, right * precision, scale, light)


def weights_of(
    residuals: Float[np.ndarray, "*pixels"], noise: float
) -> Float[np.ndarray, "*pixels"]:
    """Return the vote of every pixel under the robust fit, from 0 to 1."""
    return _biweight(residuals / noise)


def _robust_start(
    basis: Float[np.ndarray, "K p"], values: Float[np.ndarray, "p"], noise: float | None
) -> tuple[Float[np.ndarray, "K"], float]:
    """Return light and noise by iterated weights, on a sample of the pixels."""
    if values.size > SAMPLE:
        some = np.random.default_rng(0).choice(values.size, SAMPLE, replace=False)
        basis, values = basis[:, np.sort(some)], values[np.sort(some)]
    light = _solved(*_sums(basis, values)[:2])
    least = max(noise or 0.0, _rounding(values))
    for weigh in (_huber, _biweight):
        for _ in range(ROUNDS):
            residuals = values - light @ basis
            scale = max(GAUSSIAN * float(np.median(np.abs(residuals))), least)
            weights = weigh(residuals / scale)
            weighted = basis * weights
            before, light = light, _solved(weighted @ basis.T, weighted @ values)
            moved = (light - before) @ basis
            if np.abs(moved).max() <= 1e-3 * scale:
                break
    residuals = values - light @ basis
    return light, max(GAUSSIAN * float(np.median(np.abs(residuals))), least)


def _sums(
    basis: Float[np.ndarray, "K p"], values: Float[np.ndarray, "p"]
) -> tuple[Float[np.ndarray, "K K"], Float[np.ndarray, "K"], float]:
    return basis @ basis.T, basis @ values, float(values @ values)


def _solved(gram: Float[np.ndarray, "K K"], right: Float[np.ndarray, "K"]) -> np.ndarray:
    """Return the least solution of normal equations that need not determine it."""
    values, vectors = np.linalg.eigh(gram)
    kept = values > 1e-12 * max(values[-1], np.finfo(np.float64).tiny)
    inverse = np.divide(1, values, out=np.zeros_like(values), where=kept)
    return vectors @ (inverse * (vectors.T @ right))


def _rounding(values: Float[np.ndarray, "p"]) -> float:
    """Return the noise that rounding alone makes, so that exact values have some too."""
    return float(np.finfo(np.float64).eps * max(np.abs(values).max(initial=0), 1e-300))


def _huber(deviations: Float[np.ndarray, "p"]) -> Float[np.ndarray, "p"]:
    return 1 / np.maximum(np.abs(deviations) / HUBER, 1)


def _biweight(deviations: Float[np.ndarray, "*pixels"]) -> Float[np.ndarray, "*pixels"]:
    return np.maximum(1 - (deviations / TUKEY) ** 2, 0) ** 2
