"""Light as the solution of weighted least squares in which shadows and highlights have no vote.

References
----------
.. [HR09] Huber and Ronchetti, Robust Statistics, 2nd edition, 2009, chapter 7.
.. [CM15] Cameron and Miller, A Practitioner's Guide to Cluster-Robust Inference, Journal of Human
   Resources 2015.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.conventions import harmonic_count
from harmface.inverse.conditioning import told_directions
from harmface.reflectance import lambert_per_coefficient
from harmface.sphere import real_harmonics

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

BLOCKS = 16
"""Blocks along each side of the surface whose errors count as independent: what the model misses,
a shadow or a highlight, is about as large."""

TINY = 1e-20
"""Noise, or its share of variance, that stands for none."""


@dataclass(frozen=True, eq=False)
class Pixels:
    """The pixels of a surface, in blocks: irradiance per harmonic, photograph, albedo, noise.

    Parameters
    ----------
    blocks
        Numbers of the pixels in each block; every pixel of the surface is in one.
    normals
        Of every pixel.
    degree
        Highest degree.
    irradiances
        Of every pixel under each harmonic; by `A_l Y_lm(n)` if None.
    values, albedo
        Photograph and albedo, channels first; albedo may have one channel for all.
    votes
        Which values may vote, channels first; None if all may.
    deviations
        Standard deviation of the noise, channels first or one channel for all; None if unknown.
    """

    blocks: list[np.ndarray]
    normals: Float[np.ndarray, "p 3"]
    degree: int
    irradiances: Float[np.ndarray, "K p"] | None
    values: Float[np.ndarray, "channels p"]
    albedo: Float[np.ndarray, "..."]
    votes: Bool[np.ndarray, "channels p"] | None
    deviations: Float[np.ndarray, "..."] | None

    def basis(self, some: Integer[np.ndarray, "n"]) -> Float[np.ndarray, "K n"]:
        """Return the irradiance of some pixels under each harmonic, in double precision."""
        if self.irradiances is not None:
            return self.irradiances[:, some]
        basis = real_harmonics(self.normals[some].astype(np.float64, copy=False), self.degree)
        basis *= lambert_per_coefficient(self.degree)[:, None]
        return basis

    def scaled(
        self, some: Integer[np.ndarray, "n"]
    ) -> tuple[Float[np.ndarray, "channels n"], Float[np.ndarray, "..."]]:
        """Return photograph and albedo of some pixels over their noise, 0 where none may vote."""
        values = self.values[:, some].astype(np.float64, copy=False)
        factor = self.albedo[:, some] if self.albedo.shape[1] > 1 else self.albedo
        if self.deviations is not None:
            over = self.deviations[:, some] if self.deviations.shape[1] > 1 else self.deviations
            values, factor = values / over, factor / over
        if self.votes is not None:
            votes = self.votes[:, some]
            values, factor = values * votes, factor * votes
        return values, factor


@dataclass(frozen=True, eq=False)
class Information:
    """What the pixels of one channel say of the light: `gram @ light = right`.

    The inverse of `gram` is the covariance of the solution.

    Parameters
    ----------
    gram, right
        The two sides.
    noise
        Standard deviation of a voting value over what was said of it.
    residual
        What is left of the voting values, relative to their root mean square.
    """

    gram: Float[np.ndarray, "K K"]
    right: Float[np.ndarray, "K"]
    noise: float
    residual: float


def gather(pixels: Pixels, robust: bool) -> list[Information]:
    """Return what the pixels say of the light, channel by channel.

    With `robust`, light and noise are first found on a sample: Huber's function, which has one
    minimum, then Tukey's biweight, which gives no vote to what is far off. One step of Newton's
    method on all pixels ends it, so that the result has their precision ([HR09]_ 7.8).

    The covariance is that of independent noise where the noise is given. Otherwise it is larger by
    as much as the sums of the influence over blocks vary more than independent noise would have
    them: neighbours have much of what the model misses in common, and their number does not
    average it away (the variance inflation of [CM15]_ section II.A, measured as one number).
    """
    count = harmonic_count(pixels.degree)
    channels = len(pixels.values)
    every = np.concatenate(pixels.blocks)
    some = every
    if every.size > SAMPLE:
        some = np.sort(np.random.default_rng(0).choice(every, SAMPLE, replace=False))
    basis = pixels.basis(some)
    values, factor = pixels.scaled(some)
    factor = np.broadcast_to(factor, values.shape)
    known = pixels.deviations is not None
    light, scale = np.zeros((channels, count)), np.ones(channels)
    hessian = np.empty((channels, count, count))
    for c in range(channels):
        own = factor[c] > 0
        of, seen = basis * factor[c], values[c]
        if not own.all():
            of, seen = of[:, own], seen[own]
        light[c], scale[c] = _start(of, seen, 1.0 if known else 0.0, robust)
        residual = (seen - light[c] @ of) / scale[c]
        slope = _slope(residual) if robust else np.ones(seen.size)
        hessian[c] = (of * slope) @ of.T
        lowest = np.linalg.eigvalsh(hessian[c])
        if lowest[0] < -1e-9 * lowest[-1]:
            # Far from Gaussian residuals may leave no minimum about the start: its votes do.
            hessian[c] = (of * biweight(residual)) @ of.T
    hessian *= every.size / some.size
    scores = np.empty((len(pixels.blocks), channels, count))
    sums = np.zeros((5, channels))
    for number, block in enumerate(pixels.blocks):
        basis = pixels.basis(block)
        values, factor = pixels.scaled(block)
        residual = (values - factor * (light @ basis)) / scale[:, None]
        weights = biweight(residual) if robust else np.ones_like(residual)
        influence = residual * weights
        voters = np.broadcast_to(factor > 0, values.shape)
        sums += [
            voters.sum(axis=1),
            np.einsum("cn,cn->c", influence, influence),
            np.einsum("cn,cn->c", _slope(residual), voters) if robust else voters.sum(axis=1),
            np.einsum("cn,cn->c", influence, residual),
            np.einsum("cn,cn,cn->c", weights, values, values),
        ]
        scores[number] = (influence * factor) @ basis.T
    return [
        _information(light[c], scale[c], hessian[c], scores[:, c], sums[:, c], known)
        for c in range(channels)
    ]


def _information(
    light: Float[np.ndarray, "K"],
    scale: float,
    hessian: Float[np.ndarray, "K K"],
    scores: Float[np.ndarray, "B K"],
    sums: Float[np.ndarray, "5"],
    known: bool,
) -> Information:
    """Return what one channel says, by one step from the start and the residuals there."""
    voters, squared, slopes, left, power = sums
    count = light.size
    kept, _ = told_directions(hessian)
    own = kept.T @ hessian @ kept
    moved = light + scale * kept @ np.linalg.solve(own, kept.T @ scores.sum(axis=0))
    # Independent noise: influence and slope have the same sums whatever the pixel.
    ratio = max(squared / slopes, TINY) if slopes > 0 else 1.0
    covariance = scale**2 * ratio * voters / max(voters - count, 1.0) * np.linalg.inv(own)
    # Of all harmonics the first, which is even, has blocks of the most equal say.
    even = scores[:, 0]
    blocks = int((even != 0).sum())
    if not known and blocks > 2 * count:
        seen = float(even @ even) * blocks / (blocks - count)
        covariance *= max(seen / (hessian[0, 0] * ratio), TINY)
    precision = kept @ np.linalg.inv(covariance) @ kept.T
    residual = scale * float(np.sqrt(left / power)) if power > 0 else float("nan")
    return Information(precision, precision @ moved, scale, residual)


def _start(
    basis: Float[np.ndarray, "K p"], values: Float[np.ndarray, "p"], least: float, robust: bool
) -> tuple[Float[np.ndarray, "K"], float]:
    """Return light and noise by least squares, with iterated weights if they are to be robust."""
    light = _solved(basis @ basis.T, basis @ values)
    # Rounding alone makes some noise, so that exact values have some too.
    least = max(least, float(np.finfo(np.float64).eps * np.abs(values).max(initial=0)), TINY)
    if not robust:
        left = values - light @ basis
        return light, max(float(np.sqrt(left @ left / max(values.size - len(light), 1))), least)
    for weigh in (_huber, biweight):
        for _ in range(ROUNDS):
            residuals = values - light @ basis
            scale = max(GAUSSIAN * float(np.median(np.abs(residuals))), least)
            weighted = basis * weigh(residuals / scale)
            before, light = light, _solved(weighted @ basis.T, weighted @ values)
            if np.abs((light - before) @ basis).max() <= 1e-3 * scale:
                break
    residuals = values - light @ basis
    return light, max(GAUSSIAN * float(np.median(np.abs(residuals))), least)


def _solved(gram: Float[np.ndarray, "K K"], right: Float[np.ndarray, "K"]) -> np.ndarray:
    """Return the least solution of normal equations that need not determine it."""
    kept, _ = told_directions(gram)
    return kept @ np.linalg.solve(kept.T @ gram @ kept, kept.T @ right)


def _huber(deviations: Float[np.ndarray, "p"]) -> Float[np.ndarray, "p"]:
    return 1 / np.maximum(np.abs(deviations) / HUBER, 1)


def biweight(deviations: Float[np.ndarray, "*pixels"]) -> Float[np.ndarray, "*pixels"]:
    """Return Tukey's vote of every pixel, from 0 to 1, by its residual in standard deviations."""
    inside = np.maximum(1 - (deviations / TUKEY) ** 2, 0)
    return inside * inside


def _slope(deviations: Float[np.ndarray, "*pixels"]) -> Float[np.ndarray, "*pixels"]:
    """Return the derivative of a deviation times its biweight."""
    squares = (deviations / TUKEY) ** 2
    return np.maximum(1 - squares, 0) * (1 - 5 * squares)
