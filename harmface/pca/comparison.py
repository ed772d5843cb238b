"""What theory and images agree on: fractions, spans and modes side by side."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.linalg import subspace_angles

from harmface import checks
from harmface.errors import ArgumentError
from harmface.pca.analytic import AnalyticPCA
from harmface.pca.empirical import EmpiricalPCA

RESAMPLES = 1000
"""Bootstrap samples: enough for the ends of a 95 % interval to be known to a tenth of its width."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """The first modes by theory and from images.

    Parameters
    ----------
    analytic, empirical
        Share of each mode in the variance.
    interval
        Ends of the 95 % bootstrap interval of each empirical share.
    principal_angles
        Angles between the spans of the modes, degrees, falling.
    correlations
        Inner product of each pair of modes under the weights, in [-1, 1]. The sign of a mode is
        arbitrary; among modes of like share, so is its direction.
    """

    analytic: Float[np.ndarray, "count"]
    empirical: Float[np.ndarray, "count"]
    interval: Float[np.ndarray, "2 count"]
    principal_angles: Float[np.ndarray, "count"]
    correlations: Float[np.ndarray, "count"]


def compare(
    analytic: AnalyticPCA,
    empirical: EmpiricalPCA,
    count: int = 5,
    rng: np.random.Generator | int = 0,
) -> Comparison:
    """Set the first components by theory beside those of images of the same pixels.

    Parameters
    ----------
    analytic
        Components by theory; their weights are used.
    empirical
        Components of images, at least `count`.
    count
        How many components.
    rng
        Draws the bootstrap samples.

    Returns
    -------
    Comparison
        Shares side by side, principal angles in degrees, and correlations of the modes.

    Raises
    ------
    ArgumentError
        If the pixels differ, or either has fewer components.
    """
    count = checks.positive_integer("count", count)
    if empirical.weights.shape != analytic.weights.shape:
        raise ArgumentError(
            f"empirical must have the analytic pixels {analytic.weights.shape}, got "
            f"{empirical.weights.shape}; take both from one view"
        )
    if len(empirical.modes) < count:
        raise ArgumentError(
            f"empirical must have {count} modes, got {len(empirical.modes)}; compute as many"
        )
    roots = np.sqrt(analytic.weights)
    by_theory, by_images = (
        (modes * roots).reshape(count, -1).astype(np.float64)
        for modes in (analytic.modes(count), empirical.modes[:count])
    )
    lengths = np.linalg.norm(by_theory, axis=1) * np.linalg.norm(by_images, axis=1)
    return Comparison(
        analytic.fractions[:count],
        empirical.fractions[:count],
        bootstrap_interval(empirical, rng)[:, :count],
        np.degrees(subspace_angles(by_theory.T, by_images.T)),
        np.einsum("jp,jp->j", by_theory, by_images) / lengths,
    )


def bootstrap_interval(
    pca: EmpiricalPCA, rng: np.random.Generator | int = 0, level: float = 0.95
) -> Float[np.ndarray, "2 count"]:
    """Return the bootstrap percentile interval of each share, images drawn with replacement.

    Each sample is decomposed within the span of the computed modes: what lies beyond is counted
    in the total variance.

    Parameters
    ----------
    pca
        Components of images drawn independently.
    rng
        Draws the samples.
    level
        Probability that the interval is meant to cover, in (0, 1).

    Returns
    -------
    numpy.ndarray
        Lower and upper bound of each share, shape (2, count), in [0, 1].

    Raises
    ------
    ArgumentError
        If `level` does not lie between 0 and 1.
    """
    if not 0 < level < 1:
        raise ArgumentError(f"level must lie between 0 and 1, got {level}")
    images, count = pca.scores.shape
    draws = checks.generator(rng).multinomial(images, np.full(images, 1 / images), RESAMPLES)
    shares = draws / images
    products = np.einsum("fi,fj->fij", pca.scores, pca.scores).reshape(images, -1)
    moments = (shares @ products).reshape(-1, count, count)
    totals = shares @ pca.energies
    if pca.subtract_mean:
        means = shares @ pca.scores
        moments -= np.einsum("bi,bj->bij", means, means)
        totals -= np.einsum("bi,bi->b", means, means)
    fractions = np.linalg.eigvalsh(moments)[:, ::-1] / totals[:, None]
    return np.quantile(fractions, [(1 - level) / 2, (1 + level) / 2], axis=0)
