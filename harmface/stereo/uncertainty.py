"""How far the normals may be wrong, pixel by pixel, and the surface as a whole.

Two things make a normal wrong. Noise, and light that the model does not know, move each pixel by
itself: the residuals of the pixel and the curvature of its own fit tell how far to expect, and
its neighbours how far it was. And the linear map that the cues chose is sure in some directions
and vague in others; an error in it moves all normals together. How vague it is, is told by other
maps, weighted, see `gauge`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import gaussian_filter

from harmface.stereo.cues import Rows
from harmface.stereo.factorization import chunks
from harmface.stereo.homogeneous import directions_of
from harmface.stereo.light_models import LightModel
from harmface.stereo.stack import picture

HALF_SURE = 5.0
"""Expected error, degrees, at which confidence is a half."""

SAMPLE = 2000
"""Pixels that tell how the whole surface moves."""

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
        slope = model.by_normal(light, b[some])
        residual = values[:, some] - model.predict(light, b[some])
        found[some] = error_of_fit(slope, residual, b[some], weights[:, some])
    return found


def error_of_fit(
    slope: Float[np.ndarray, "F p 3"],
    residual: Float[np.ndarray, "F p"],
    b: Float[np.ndarray, "p 3"],
    weights: Float[np.ndarray, "F p"],
) -> Float[np.ndarray, "p"]:
    """Return what `noise_error` does, of the derivatives J by b and the residuals.

    Parameters
    ----------
    slope
        J of each observation.
    residual
        What the fit left of it.
    b
        Scaled normals.
    weights
        Of the observations.
    """
    slope = slope.swapaxes(0, 1)
    normal = (weights.T[..., None] * slope).swapaxes(1, 2) @ slope
    freedom = np.maximum(weights.sum(axis=0) - 3, 0)
    remaining = (weights * residual**2).sum(axis=0)
    pooled = remaining.sum() / max(freedom.sum(), 1.0)
    variance = (remaining + POOLED * pooled) / (freedom + POOLED)
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
    remaining = np.maximum(seen - by_noise, 0.0) + share * by_neighbours
    gain = own / np.maximum(own + remaining, floor)
    return np.sqrt(gain**2 * squared + (1 - gain) * own + (1 - share) * noise**2)


def _vicinity(
    values: Float[np.ndarray, "p"], mask: Bool[np.ndarray, "H W"]
) -> Float[np.ndarray, "p"]:
    """Return the mean about each pixel."""
    count = gaussian_filter(mask.astype(np.float64), VICINITY, mode="constant")
    return gaussian_filter(picture(values, mask), VICINITY, mode="constant")[mask] / count[mask]


@dataclass(frozen=True, eq=False)
class MapError:
    """How far the map may turn and stretch the whole surface.

    Parameters
    ----------
    angle
        Expected error of each normal by it, degrees.
    tilt
        Of the whole surface about the x and the y axis, degrees.
    stretch
        Of its depth, relative.
    """

    angle: Float[np.ndarray, "p"]
    tilt: tuple[float, float]
    stretch: float


def map_error(
    maps: Sequence[tuple[float, Rows]], rows: Rows, structure: Float[np.ndarray, "p d"]
) -> MapError:
    """Return how far normals may be off by the map.

    A map that gives the convex-concave counterpart is compared with it: which of the two it is, is
    another question.

    Parameters
    ----------
    maps
        Weights and maps whose weighted squares of distances add up to a variance, of
        `spread_of_maps`.
    rows
        The chosen map.
    structure
        v.
    """
    found = directions_of(structure @ rows.T)
    some = slice(None, None, max(1, len(found) // SAMPLE))
    here = _lean_and_depth(found[some])
    squares, moved = np.zeros(len(found)), np.zeros(3)
    for weight, other in maps:
        other = other * np.sign((structure[some] @ other[2]).sum() * found[some, 2].sum())
        n = directions_of(structure @ other.T)
        flipped = n * (-1, -1, 1)
        if (found * flipped)[some].sum() > (found * n)[some].sum():
            n = flipped
        chord = np.linalg.norm(n - found, axis=1)
        squares += weight * np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1))) ** 2
        moved += weight * (_lean_and_depth(n[some]) - here) ** 2
    tilt_x, tilt_y, stretch = np.sqrt(moved)
    return MapError(
        np.minimum(np.sqrt(squares), 90.0), (float(tilt_x), float(tilt_y)), float(stretch)
    )


def _lean_and_depth(n: Float[np.ndarray, "p 3"]) -> Float[np.ndarray, "3"]:
    """Return the mean lean about x and y, degrees, and the logarithm of the slopes' spread."""
    towards = np.maximum(n[:, 2], 0.05)
    slopes = n[:, :2] / towards[:, None]
    middle = np.median(slopes, axis=0)
    size = np.median(np.linalg.norm(slopes - middle, axis=1))
    lean = np.degrees(np.arctan(middle))
    return np.array([lean[1], lean[0], np.log(max(size, 1e-6))])


def smoothed_noise(
    noise: Float[np.ndarray, "p"],
    before: Float[np.ndarray, "p 3"],
    after: Float[np.ndarray, "p 3"],
    mask: Bool[np.ndarray, "H W"],
) -> Float[np.ndarray, "p"]:
    """Return the noise of normals that a smooth surface was fitted to, degrees.

    What the fit has taken out of the normals about a pixel, it has taken out of their noise; a
    quarter of the variance is left at least, as neighbours share what is left.

    Parameters
    ----------
    noise
        Of the normals before the fit, degrees.
    before, after
        Scaled normals.
    mask
        Their pixels.
    """
    chord = np.linalg.norm(directions_of(before) - directions_of(after), axis=1)
    removed = _vicinity(np.degrees(chord) ** 2, mask)
    return np.sqrt(np.maximum(noise**2 - removed, noise**2 / 4))


def confidence_of(expected: Float[np.ndarray, "*pixels"]) -> Float[np.ndarray, "*pixels"]:
    """Return confidence in (0, 1], `1 / (1 + e / 5)` of an expected error of e degrees."""
    return 1 / (1 + expected / HALF_SURE)
