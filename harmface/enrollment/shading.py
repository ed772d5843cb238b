"""What photographs under known light say of the slopes of a surface, pixel by pixel.

With the depth `z`, its slopes `p = -dz/dx` and `q = -dz/dy` and the brightness `g = albedo n_z`, a
photograph under light of irradiance 1 from `l` is `I = g max(p l_x + q l_y + l_z, 0)`: linear in
the slopes once `g` is known, which the photographs as they stand tell well.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

DARK = 0.03
"""Intensity, as a fraction of a subject's bright pixels, that counts half: likely in shadow."""

OUTLIER = 0.05
"""Misfit, as a fraction of a pixel's own brightness, that counts half: a shadow or highlight."""

TINY = 1e-6
"""Weight and brightness below which a pixel says nothing."""


@dataclass(frozen=True)
class SlopeEquations:
    """Normal equations of the slopes `(p, q)` of every pixel.

    Parameters
    ----------
    matrix
        Symmetric 2 x 2 matrix of each pixel.
    right
        Right-hand sides.
    """

    matrix: Float[np.ndarray, "2 2 m"]
    right: Float[np.ndarray, "2 m"]

    @classmethod
    def mean(cls, each: list["SlopeEquations"]) -> "SlopeEquations":
        """Return the mean of several subjects' equations."""
        matrices, rights = [own.matrix for own in each], [own.right for own in each]
        return cls(np.mean(matrices, axis=0), np.mean(rights, axis=0))


def slope_equations(
    images: Float[np.ndarray, "F m"],
    lights: Float[np.ndarray, "F 3"],
    slopes: Float[np.ndarray, "2 m"],
    robust: bool,
) -> SlopeEquations:
    """Return the equations of the slopes about present ones, the brightness eliminated.

    With the shading `s_f = p l_x + q l_y + l_z`, the misfits `I_f / g - s_f` are least for fixed
    `g` under the equations of two unknowns; what a change of `g` would explain as well, their part
    along `s_f` itself, is projected out of them.

    Parameters
    ----------
    images
        Photographs as rows of pixels.
    lights
        Direction to the light of each.
    slopes
        Present slopes.
    robust
        Whether to weigh down what present slopes do not explain.
    """
    weights, s = usable(images), shading(lights, slopes)
    if robust:
        weights = without_outliers(images, weights, s)
    target = ratio(images, brightness(images, weights, s)) - lights[:, 2:]
    tilts = lights[:, :2]
    own = (weights * s * s).sum(axis=0) + TINY
    mixed = tilts.T @ (weights * s)
    matrix = np.einsum("fm,fi,fj->ijm", weights, tilts, tilts) - mixed[:, None] * mixed / own
    right = tilts.T @ (weights * target) - mixed * (weights * s * target).sum(axis=0) / own
    return SlopeEquations(matrix, right)


def evenly_exposed(
    images: Float[np.ndarray, "F m"],
    lights: Float[np.ndarray, "F 3"],
    slopes: Float[np.ndarray, "2 m"],
) -> Float[np.ndarray, "F m"]:
    """Return photographs divided by the strength of their light, against the subject's mean.

    A flash a few hundredths stronger would pass for a surface that leans towards it.
    """
    s = shading(lights, slopes)
    weights = usable(images)
    expected = brightness(images, weights, s) * s
    weights = without_outliers(images, weights, s)
    strength = (weights * expected * images).sum(axis=1)
    strength /= (weights * expected**2).sum(axis=1) + TINY
    return images * (strength.mean() / np.maximum(strength, TINY))[:, None]


def usable(images: Float[np.ndarray, "F m"]) -> Float[np.ndarray, "F m"]:
    """Return weights that fall where a photograph is dark, and likely in shadow."""
    squared = (images / max(float(np.percentile(images, 95)), TINY) / DARK) ** 2
    return squared / (1 + squared)


def without_outliers(
    images: Float[np.ndarray, "F m"],
    weights: Float[np.ndarray, "F m"],
    s: Float[np.ndarray, "F m"],
) -> Float[np.ndarray, "F m"]:
    """Return the weights, less by Cauchy's factor where the shading misses the photographs."""
    misfit = ratio(images, brightness(images, weights, s)) - s
    return weights / (1 + (misfit / OUTLIER) ** 2)


def shading(
    lights: Float[np.ndarray, "F 3"], slopes: Float[np.ndarray, "2 m"]
) -> Float[np.ndarray, "F m"]:
    """Return `max(p l_x + q l_y + l_z, 0)`."""
    return np.maximum(lights[:, :2] @ slopes + lights[:, 2:], 0)


def brightness(
    images: Float[np.ndarray, "F m"],
    weights: Float[np.ndarray, "F m"],
    s: Float[np.ndarray, "F m"],
) -> Float[np.ndarray, "m"]:
    """Return the `g` with which `g s` fits the photographs best."""
    return (weights * s * images).sum(axis=0) / ((weights * s * s).sum(axis=0) + TINY)


def ratio(images: Float[np.ndarray, "F m"], g: Float[np.ndarray, "m"]) -> Float[np.ndarray, "F m"]:
    """Return the photographs over the brightness, finite where that vanishes."""
    return images / np.maximum(g, TINY)
