"""How far the normals may be wrong, pixel by pixel.

Two things make a normal wrong. Noise, and light that the model does not know, move each pixel by
itself: the residuals of the pixel and the curvature of its own fit tell how far to expect, and
its neighbours how far it was. And the linear map that the cues chose is sure in some directions
and vague in others; an error in it moves all normals together, those across it most. At their
optimum the cues of different regions of the picture pull in different directions, and how far that
may move the map tells how vague it is; its covariance is carried to each normal.

References
----------
.. [H67] Huber, The Behavior of Maximum Likelihood Estimates under Nonstandard Conditions, Fifth
   Berkeley Symposium on Mathematical Statistics and Probability, 1967.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter

from harmface.stereo.cues import ALONE, Cues
from harmface.stereo.factorization import chunks
from harmface.stereo.gauge import Rows, linearized, shifted
from harmface.stereo.light_models import LightModel
from harmface.stereo.stack import picture

HALF_SURE = 5.0
"""Expected error, degrees, at which confidence is a half."""

UNTOLD = 4.0
"""Times by which the map errs more than the residuals of the cues tell, as light that the model
misses bends what they judge: 1 to 3 under single sources, 2 to 8 under several."""

POOLED = 2
"""Observations that the noise of all pixels counts for in that of each."""

VICINITY = 4.0
"""Pixels within which the roughness of a surface is alike: standard deviation of the window."""

BESIDE = (4 / 6, -1 / 6)
"""Weights of both neighbours one and two pixels off on a line, that foretell cubics."""


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


def beside_neighbours(
    n: Float[np.ndarray, "p 3"], mask: Bool[np.ndarray, "H W"], noise: Float[np.ndarray, "p"]
) -> Float[np.ndarray, "p"]:
    """Return the error of each normal that noise has made, degrees, judged by those around.

    `d = e + s` is how far a normal is from what those on lines through it foretell, exactly if they
    follow a cubic: e its own error, of variance o, s what the surface and the neighbours' own
    errors leave, of variance t. If both are normally distributed,

        E(e^2 | d) = (g d)^2 + (1 - g) o,   g = o / (o + t).

    With D the mean of d^2 in the vicinity and N that of the variances which noise gives d, t is
    what D exceeds N by, and the neighbours' share; where D is less than N, as highlights bend
    neighbours alike, only D / N of the variance sigma^2 is a normal's own, and the rest is added.

    Parameters
    ----------
    n
        Unit normals.
    mask
        Their pixels.
    noise
        sigma, of `noise_error`.
    """
    reach = len(BESIDE)
    shape = tuple(side + 2 * reach for side in mask.shape)
    inside, normals, variance = np.zeros(shape, bool), np.zeros((*shape, 3)), np.zeros(shape)
    here = (slice(reach, -reach), slice(reach, -reach))
    inside[here], normals[here][mask], variance[here][mask] = mask, n, noise**2
    rows, columns = np.nonzero(inside)
    foretold, by_neighbours, lines = np.zeros((len(n), 3)), np.zeros(len(n)), np.zeros(len(n))
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        places = [
            ((rows + step * down, columns + step * right), weight)
            for distance, weight in enumerate(BESIDE, 1)
            for step, weight in ((distance, weight), (-distance, weight))
        ]
        whole = np.all([inside[place] for place, _ in places], axis=0)
        lines += whole
        foretold += whole[:, None] * sum(weight * normals[place] for place, weight in places)
        by_neighbours += whole * sum(weight**2 * variance[place] for place, weight in places)
    alone = lines == 0
    lines = np.maximum(lines, 1)
    squared = np.degrees(np.linalg.norm(n - foretold / lines[:, None], axis=1)) ** 2
    by_neighbours /= lines**2
    squared = np.where(alone, noise**2, squared)
    floor = np.finfo(np.float64).eps * max(float(squared.max()), np.finfo(np.float64).tiny)
    seen = _vicinity(squared, mask)
    by_noise = _vicinity(noise**2 + by_neighbours, mask)
    share = np.minimum(seen / np.maximum(by_noise, floor), 1.0)
    own = share * noise**2
    left = np.maximum(seen - by_noise, 0.0) + share * by_neighbours
    gain = own / np.maximum(own + left, floor)
    return np.sqrt(gain**2 * squared + (1 - gain) * own + (1 - share) * noise**2)


def _vicinity(
    values: Float[np.ndarray, "p"], mask: Bool[np.ndarray, "H W"]
) -> Float[np.ndarray, "p"]:
    """Return the mean about each pixel."""
    count = gaussian_filter(mask.astype(np.float64), VICINITY, mode="constant")
    return gaussian_filter(picture(values, mask), VICINITY, mode="constant")[mask] / count[mask]


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
