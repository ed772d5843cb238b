"""How lighting varies: mean and covariance of its harmonic coefficients."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees, harmonic_count, max_degree_of
from harmface.errors import ArgumentError
from harmface.sphere import real_harmonics
from harmface.summaries import summary

FRONT = np.array([0.0, 0.0, 1.0])
"""The direction from the object to the viewer."""


@dataclass(frozen=True, eq=False)
class LightDistribution:
    """The first two moments of random lighting coefficients, all that PCA asks of the light.

    Parameters
    ----------
    mean
        Coefficients of the mean light.
    covariance
        Covariance of the coefficients about that mean.

    Raises
    ------
    ArgumentError
        If the covariance is not symmetric positive semi-definite, the sizes differ or are not
        those of all harmonics up to a degree, or a value is NaN or infinite.
    """

    mean: Float[np.ndarray, "K"]
    covariance: Float[np.ndarray, "K K"]

    __repr__ = summary

    def __post_init__(self) -> None:
        mean = checks.finite("mean", self.mean)
        covariance = checks.finite("covariance", self.covariance)
        max_degree_of(mean.size)
        if covariance.shape != (mean.size, mean.size):
            raise ArgumentError(
                f"covariance must have shape {(mean.size, mean.size)} as the mean has "
                f"{mean.size} coefficients, got {covariance.shape}"
            )
        # Rounding of a sum over K, in moments about zero, is what the covariance may carry.
        size = np.abs(covariance).max() + np.square(mean).max()
        slack = len(mean) * np.finfo(covariance.dtype).eps * size
        if np.abs(covariance - covariance.T).max() > slack:
            raise ArgumentError(
                "covariance must be symmetric, got entries that differ from their mirror image; "
                "give (C + C.T) / 2 if they should not"
            )
        least = np.linalg.eigvalsh(covariance).min()
        if least < -len(mean) * slack:
            raise ArgumentError(
                f"covariance must be positive semi-definite, got the eigenvalue {least:.4g}; "
                "estimate it from samples of the light, or drop its negative eigenvalues"
            )

    @property
    def max_degree(self) -> int:
        """Highest degree of the coefficients."""
        return max_degree_of(len(self.mean))

    @property
    def second_moment(self) -> Float[np.ndarray, "K K"]:
        """Mean of `L L^T`, the covariance about zero light."""
        return self.covariance + np.outer(self.mean, self.mean)


def uniform_lights(max_degree: int) -> LightDistribution:
    """Return one directional light of irradiance 1, uniform over the sphere.

    Its second moment is the identity over 4 pi; degree 0, which such lights share, is the mean.

    Parameters
    ----------
    max_degree
        Highest degree of the coefficients.

    Returns
    -------
    LightDistribution
        Mean and covariance of radiance coefficients.

    Examples
    --------
    >>> (4 * np.pi * uniform_lights(1).covariance).round(12)
    array([[0., 0., 0., 0.],
           [0., 1., 0., 0.],
           [0., 0., 1., 0.],
           [0., 0., 0., 1.]])
    """
    mean = np.zeros(harmonic_count(max_degree))
    mean[0] = 1 / np.sqrt(4 * np.pi)
    return LightDistribution(mean, np.diag(1 / (4 * np.pi) - np.square(mean)))


def cone_lights(
    max_degree: int, half_angle: float, axis: Float[np.ndarray, "3"] = FRONT
) -> LightDistribution:
    """Return one directional light of irradiance 1, uniform within a cone.

    The moments integrate polynomials, which a product rule of Gauss and of equal steps in
    azimuth does exactly.

    Parameters
    ----------
    max_degree
        Highest degree of the coefficients.
    half_angle
        Angle between the axis and the cone's surface, degrees in (0, 180].
    axis
        Unit vector towards the middle of the lights; by default the viewer.

    Returns
    -------
    LightDistribution
        Mean and covariance of radiance coefficients.

    Raises
    ------
    ArgumentError
        If `max_degree` is negative, the angle outside (0, 180], or the axis no unit vector.
    """
    max_degree = checks.degree("max_degree", max_degree)
    axis = checks.unit_vectors("axis", axis)
    if not 0 < half_angle <= 180:
        raise ArgumentError(f"half_angle must lie in (0, 180] degrees, got {half_angle}")
    nodes, weights = np.polynomial.legendre.leggauss(max_degree + 1)
    # Below the tip of the axis by this much: exact for the narrowest cone.
    drop = (1 - nodes) * np.sin(np.radians(half_angle) / 2) ** 2
    radius = np.sqrt(drop * (2 - drop))
    azimuth = 2 * np.pi * np.arange(2 * max_degree + 1) / (2 * max_degree + 1)
    across = np.linalg.svd(axis[None])[2][1:]
    around = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1) @ across
    directions = radius[:, None, None] * around + (1 - drop)[:, None, None] * axis
    return directional_lights(
        max_degree, directions.reshape(-1, 3), np.repeat(weights, azimuth.size)
    )


def front_lights(max_degree: int) -> LightDistribution:
    """Return one directional light of irradiance 1, uniform over the viewer's half-sphere.

    Parameters
    ----------
    max_degree
        Highest degree of the coefficients.

    Returns
    -------
    LightDistribution
        Mean and covariance of radiance coefficients.
    """
    return cone_lights(max_degree, 90.0)


def directional_lights(
    max_degree: int,
    directions: Float[np.ndarray, "J 3"],
    weights: Float[np.ndarray, "J"] | None = None,
) -> LightDistribution:
    """Return one directional light of irradiance 1, drawn from a set of directions.

    Parameters
    ----------
    max_degree
        Highest degree of the coefficients.
    directions
        Unit directions to the light.
    weights
        How often each is drawn, up to a factor; by default equally.

    Returns
    -------
    LightDistribution
        Mean and covariance of radiance coefficients.

    Raises
    ------
    ArgumentError
        If the weights are negative or all zero, or differ in number from the directions.
    """
    if weights is None:
        weights = np.ones(len(directions))
    weights = checks.non_negative("weights", weights)
    if weights.shape != directions.shape[:-1]:
        raise ArgumentError(
            f"weights must have shape {directions.shape[:-1]} as the directions, "
            f"got {weights.shape}"
        )
    if not weights.any():
        raise ArgumentError("weights must not be all zero; give some direction a positive weight")
    return _moments(real_harmonics(directions, max_degree).T, weights / weights.sum())


def environment_lights(coefficients: Float[np.ndarray, "N K"]) -> LightDistribution:
    """Return the distribution of a set of environments, each as likely as the next.

    Parameters
    ----------
    coefficients
        Harmonic coefficients of the radiance of each environment.

    Returns
    -------
    LightDistribution
        Mean and covariance of the coefficients.

    Raises
    ------
    ArgumentError
        If the coefficients are not finite, or K is not a square.
    """
    coefficients = checks.finite("coefficients", coefficients)
    if len(coefficients) == 0:
        raise ArgumentError("coefficients must hold at least one environment, got none")
    return _moments(coefficients, np.full(len(coefficients), 1 / len(coefficients)))


def isotropic_lights(power: Float[np.ndarray, "degrees"]) -> LightDistribution:
    """Return zero-mean lighting without a preferred direction, by its power spectrum.

    Parameters
    ----------
    power
        Variance `C_l` of each coefficient of degree `l`, not negative.

    Returns
    -------
    LightDistribution
        Zero mean, and a diagonal covariance.

    Raises
    ------
    ArgumentError
        If a power is negative or not finite.
    """
    power = checks.non_negative("power", power)
    if len(power) == 0:
        raise ArgumentError("power must start with degree 0, got no degree")
    variances = power[degrees(len(power) - 1)]
    return LightDistribution(np.zeros_like(variances), np.diag(variances))


def _moments(
    coefficients: Float[np.ndarray, "N K"], probabilities: Float[np.ndarray, "N"]
) -> LightDistribution:
    """Return mean and covariance, centred before squaring so that nothing cancels."""
    mean = probabilities @ coefficients
    deviations = (coefficients - mean) * np.sqrt(probabilities)[:, None]
    return LightDistribution(mean, deviations.T @ deviations)
