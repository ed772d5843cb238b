"""Light and albedo together: shading is smooth, and albedo mostly the same or changes at edges.

In logarithms a photograph is `log b = log albedo + log E(L)`. Irradiance `E` has low frequencies
only; what changes fast is texture ([R05]_). So differences between neighbours are those of `log E`,
but for the edges of the albedo, and the albedo itself lies about one value, but for lips, brows and
hair. Both are said with a function that lets go of what is far off ([LM71]_ with robust weights).

References
----------
.. [LM71] Land and McCann, Lightness and Retinex Theory, JOSA 1971.
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, section
   0.4.3.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.inverse.conditioning import told_directions
from harmface.inverse.estimate import estimate_light
from harmface.inverse.least_squares import GAUSSIAN
from harmface.inverse.prior import LightPrior
from harmface.inverse.result import LightEstimate
from harmface.rendering import harmonic_images

ACROSS = 64
"""Pairs of neighbours across the object: finer ones would tell the camera's noise."""

CAUCHY = 2.385
"""Deviation at which Cauchy's weight is a half: it needs 5 % more pixels in Gaussian noise."""

DARK = 0.02
"""Irradiance, as a share of its mean, below which a logarithm tells more of the model's error."""

ROUNDS = 30
"""Most steps; some ten are taken."""

FIXED = 1e-3
"""Relative deviation that stands for a scale that is fixed."""

BLOCKS = 8
"""Blocks along each side over which residuals count as one: albedo is alike in neighbours."""


def estimate_light_and_albedo(
    image: Float[np.ndarray, "..."],
    normals: Float[np.ndarray, "H W 3"],
    *,
    degree: int = 2,
    mask: Bool[np.ndarray, "H W"] | None = None,
    believed: Bool[np.ndarray, "..."] | None = None,
    visibility: Float[np.ndarray, "K H W"] | None = None,
    prior: LightPrior | None = None,
    non_negative: bool = False,
) -> tuple[LightEstimate, Float[np.ndarray, "H W *channels"]]:
    """Return light and albedo of a photograph of known shape.

    A factor, in each channel, goes from one to the other without a trace: the median albedo is
    made 1 in each channel. The covariance counts the residuals of a block of the picture as one,
    since albedo is alike in neighbours.

    Parameters
    ----------
    image, normals, degree, mask, believed, visibility, prior, non_negative
        As for `estimate_light`; the photograph must be a picture, of rows and columns.

    Returns
    -------
    tuple
        The light, and the albedo with the photograph's shape; 0 where it is not known.

    Raises
    ------
    ArgumentError
        As for `estimate_light`.
    """
    options: dict[str, Any] = {"mask": mask, "believed": believed}
    start = estimate_light(
        image,
        normals,
        degree=degree,
        visibility=visibility,
        prior=prior,
        non_negative=non_negative,
        **options,
    )
    # Albedo throws degree 2 far off, from where no small step leads back; degree 1 it does not.
    low = min(degree, 1)
    first = None if visibility is None else visibility[: harmonic_count(low)]
    near = estimate_light(image, normals, degree=low, visibility=first, **options).least_norm
    grey = image.ndim == 2
    values = np.atleast_3d(np.asarray(image, np.float64)).transpose(2, 0, 1)
    inside = (normals != 0).any(axis=-1) if mask is None else mask
    basis = (
        harmonic_images(normals.astype(np.float64), inside.astype(np.float64), degree)
        if visibility is None
        else visibility
    )
    lights = np.zeros_like(np.atleast_2d(start.least_norm))
    lights[:, : near.shape[-1]] = near
    precision = np.empty((*lights.shape, lights.shape[-1]))
    albedo = np.zeros(values.shape)
    for channel, seen in enumerate(values):
        votes = inside & (seen > 0)
        if believed is not None:
            votes &= believed if believed.ndim == 2 else believed[..., channel]
        lights[channel], precision[channel] = _fitted(
            np.log(np.where(votes, seen, 1.0)), votes, basis, lights[channel], prior, degree
        )
        received = np.maximum(np.tensordot(lights[channel], basis, axes=1), 0)
        lit = votes & (received > DARK * received[inside].mean())
        albedo[channel][lit] = seen[lit] / received[lit]
        middle = float(np.median(albedo[channel][lit]))
        albedo[channel] /= middle
        lights[channel] *= middle
        precision[channel] /= middle**2
    found = replace(
        start,
        least_norm=lights[0] if grey else lights,
        precision=precision[0] if grey else precision,
        pixels=replace(start.pixels, albedo=albedo.reshape(len(albedo), -1)),
    )
    return found, albedo[0] if grey else np.moveaxis(albedo, 0, -1)


def _fitted(
    logarithms: Float[np.ndarray, "H W"],
    votes: Bool[np.ndarray, "H W"],
    basis: Float[np.ndarray, "K H W"],
    light: Float[np.ndarray, "K"],
    prior: LightPrior | None,
    degree: int,
) -> tuple[Float[np.ndarray, "K"], Float[np.ndarray, "K K"]]:
    """Return the light of one channel and its covariance, by Gauss and Newton."""
    flat, own = basis[:, votes], logarithms[votes]
    first, second = _pairs(votes)
    if not first.size:
        raise ArgumentError("image must show neighbours on the surface, got single pixels")
    which = _blocks(votes)
    floor = DARK * float((light @ flat).mean())
    if floor <= 0:
        raise ArgumentError("image must be brighter than black on the surface")
    precision, pull = np.zeros((len(light), len(light))), np.zeros(len(light))
    for _ in range(ROUNDS):
        received = light @ flat
        lit = received > floor
        slope = np.where(lit, flat / np.maximum(received, floor), 0)
        left = own - np.log(np.maximum(received, floor))
        level = np.median(left[lit])
        pixels = np.where(lit, left - level, 0)
        edges = np.where(lit[first] & lit[second], left[second] - left[first], 0)
        rows = slope[:, second] - slope[:, first]
        wide, narrow = _spread(pixels), _spread(edges)
        weights = _cauchy(pixels / wide) / wide**2
        edge_weights = _cauchy(edges / narrow) / narrow**2
        # The level is free: what a change of it explains is taken out of the slopes.
        centred = slope - (slope @ weights / weights.sum())[:, None]
        hessian = (centred * weights) @ centred.T + (rows * edge_weights) @ rows.T
        # Of slopes that are the same everywhere only rounding is left.
        sizes = np.sqrt((slope**2) @ weights)
        rounding = own.size * np.finfo(np.float64).eps * np.outer(sizes, sizes)
        hessian = np.where(np.abs(hessian) > rounding, hessian, 0)
        scores = centred * (weights * pixels)
        edge_scores = rows * (edge_weights * edges)
        gradient = scores.sum(axis=1) + edge_scores.sum(axis=1)
        if prior is not None:
            precision, pull = prior.precision(float(abs(light[0])), degree)
        kept, _ = told_directions(hessian + precision)
        inverse = kept @ np.linalg.inv(kept.T @ (hessian + precision) @ kept) @ kept.T
        step = inverse @ (gradient + pull - precision @ light)
        light = light + step
        if np.abs(step @ flat).max() < 1e-4 * np.abs(light @ flat).max():
            break
    sums = np.zeros((which.max() + 1, len(light)))
    np.add.at(sums, which, scores.T)
    np.add.at(sums, which[first], edge_scores.T)
    # Scores of a block add up; what is left open stays so.
    covariance = kept.T @ inverse @ (sums.T @ sums + precision) @ inverse @ kept
    # Their scale is no unknown: it is fixed by what the median albedo counts as.
    mean = flat.mean(axis=1)
    fixed = np.outer(mean, mean) / (FIXED * float(light @ mean)) ** 2
    return light, kept @ np.linalg.inv(covariance) @ kept.T + fixed


def _pairs(
    votes: Bool[np.ndarray, "H W"],
) -> tuple[Integer[np.ndarray, "e"], Integer[np.ndarray, "e"]]:
    """Return neighbours to the right and below, as numbers of voting pixels."""
    step = max(1, round(np.sqrt(votes.sum()) / ACROSS))
    number = np.cumsum(votes).reshape(votes.shape) - 1
    firsts, seconds = [], []
    for axis in (0, 1):
        one = np.moveaxis(votes, axis, 0)
        index = np.moveaxis(number, axis, 0)
        both = one[:-step] & one[step:]
        firsts.append(index[:-step][both])
        seconds.append(index[step:][both])
    return np.concatenate(firsts), np.concatenate(seconds)


def _blocks(votes: Bool[np.ndarray, "H W"]) -> Integer[np.ndarray, "p"]:
    """Return the number of the block of the object's box that each voting pixel lies in."""
    rows, columns = np.nonzero(votes)
    place = [
        BLOCKS * (along - along.min()) // (along.max() - along.min() + 1)
        for along in (rows, columns)
    ]
    return place[0] * BLOCKS + place[1]


def _spread(deviations: Float[np.ndarray, "p"]) -> float:
    median = float(np.median(np.abs(deviations)))
    return max(GAUSSIAN * median, 1e-9)


def _cauchy(deviations: Float[np.ndarray, "p"]) -> Float[np.ndarray, "p"]:
    return 1 / (1 + (deviations / CAUCHY) ** 2)
