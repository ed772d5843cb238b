"""How far the normals may be wrong, pixel by pixel.

Two things make a normal wrong. Noise, and light that the model does not know, move each pixel by
itself: the residuals of the pixel and the curvature of its own fit tell how far. And the linear
map that the cues chose is sure in some directions and vague in others; an error in it moves all
normals together, those across it most. At their optimum the cues of different regions of the
picture pull in different directions, and how far that may move the map tells how vague it is;
its covariance is carried to each normal.

References
----------
.. [H67] Huber, The Behavior of Maximum Likelihood Estimates under Nonstandard Conditions, Fifth
   Berkeley Symposium on Mathematical Statistics and Probability, 1967.
"""

import numpy as np
from jaxtyping import Float

from harmface.stereo.cues import ALONE, Cues
from harmface.stereo.factorization import chunks
from harmface.stereo.gauge import Rows, linearized, shifted
from harmface.stereo.light_models import LightModel

HALF_SURE = 5.0
"""Expected error, degrees, at which confidence is a half."""

UNTOLD = 4.0
"""Times by which the map errs more than the residuals of the cues tell, as light that the model
misses bends what they judge: 1 to 3 under single sources, 2 to 8 under several."""

POOLED = 2
"""Observations that the noise of all pixels counts for in that of each."""


def noise_error(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "p"]:
    """Return the standard deviation of each normal by its own residuals, degrees.

    With `C = s^2 (J' W J)^-1` the covariance of b, s^2 the pixel's weighted mean square residual
    averaged with that of all (three observations fit exactly, and would pass for sure), the
    normal's is `P C P / |b|^2`, P the projection across b; its trace is the square of the angle.
    """
    found = np.empty(len(b))
    for some in chunks(len(b), 32 * len(values)):
        found[some] = _noise_error(values[:, some], model, light, b[some], weights[:, some])
    return found


def _noise_error(
    values: Float[np.ndarray, "F p"],
    model: LightModel,
    light: Float[np.ndarray, "F q"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "p"]:
    slope = model.by_normal(light, b).swapaxes(0, 1)
    normal = (weights.T[..., None] * slope).swapaxes(1, 2) @ slope
    residual = values - model.predict(light, b)
    freedom = np.maximum(weights.sum(axis=0) - 3, 0)
    left = (weights * residual**2).sum(axis=0)
    pooled = left.sum() / max(freedom.sum(), 1.0)
    variance = (left + POOLED * pooled) / (freedom + POOLED)
    floor = 1e-9 * np.einsum("pii->", normal) / len(normal) + np.finfo(np.float64).tiny
    covariance = np.linalg.inv(normal + floor * np.eye(3)) * variance[:, None, None]
    squared = (b**2).sum(axis=1)
    # Of a pixel without light nothing is known.
    seen = squared > np.finfo(np.float64).eps * squared.max(initial=0)
    squared = np.where(seen, squared, 1.0)
    along = np.einsum("pi,pij,pj->p", b, covariance, b) / squared
    across = np.einsum("pii->p", covariance) - along
    angle = np.degrees(np.sqrt(np.maximum(across, 0) / squared))
    return np.where(seen, np.minimum(angle, 90.0), 90.0)


def ambiguity_error(
    cues: Cues, rows: Rows, structure: Float[np.ndarray, "d p"]
) -> Float[np.ndarray, "p"]:
    """Return the standard deviation of each normal by the vagueness of the cues, degrees.

    The covariance of T is Huber's ([H67]_), `H^-1 G H^-1`: H the second derivative of the cost,
    G the sum of `g g'` over the regions of the picture, g the slope of the cost of one.

    Parameters
    ----------
    cues
        That chose the rows.
    rows
        T of `b = T v`.
    structure
        v.
    """
    near = linearized(cues, rows, shifted, rows.size)
    pulls = near.slope * near.pull
    together = np.zeros((rows.size, near.region.max(initial=0) + 1))
    placed = near.region != ALONE
    np.add.at(together.T, near.region[placed], pulls[:, placed].T)
    alone = pulls[:, ~placed]
    # The scale of T moves no normal; neither does what the cues cannot see at all beyond reason.
    reason = np.eye(rows.size)
    inverse = np.linalg.inv(near.curvature + reason)
    spread = UNTOLD**2 * (together @ together.T + alone @ alone.T) + reason
    size = np.linalg.norm(rows) / 3
    covariance = (inverse @ spread @ inverse).reshape(*rows.shape, *rows.shape) * size**2
    b = rows @ structure
    length = np.maximum(np.linalg.norm(b, axis=0), np.finfo(np.float64).tiny)
    moved = np.einsum("iajb,ap,bp->pij", covariance, structure, structure, optimize=True)
    n = b / length
    across = np.einsum("pii->p", moved) - np.einsum("ip,pij,jp->p", n, moved, n)
    return np.degrees(np.sqrt(np.maximum(across, 0)) / length)


def confidence_of(expected: Float[np.ndarray, "*pixels"]) -> Float[np.ndarray, "*pixels"]:
    """Return confidence in (0, 1], `1 / (1 + e / 5)` of an expected error of e degrees."""
    return 1 / (1 + expected / HALF_SURE)
