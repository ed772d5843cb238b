"""What light is like before a photograph is seen: a Gaussian over lighting coefficients.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, section
   0.4.3.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees, harmonic_count, luminance, max_degree_of
from harmface.errors import ArgumentError
from harmface.light import EnvironmentMap, project

FEWEST = 2
"""Maps from which a covariance can be learned."""

SHRINKAGE = 2
"""Maps that the isotropic covariance counts for when no rotations are included: of few maps the
sample covariance has no rank to speak of."""


@dataclass(frozen=True, eq=False)
class LightPrior:
    """Mean and covariance of lighting coefficients, each light divided by its own `L_00`.

    With `rotations` all directions are alike: the mean is `L_00` alone, the covariance one number
    a degree, and an estimate with it is the regularised deconvolution by degree, Wiener's.

    Parameters
    ----------
    mean
        Mean coefficients; the first is 1.
    covariance
        Symmetric, positive semidefinite.
    """

    mean: Float[np.ndarray, "K"]
    covariance: Float[np.ndarray, "K K"]

    def __post_init__(self) -> None:
        mean = checks.finite("mean", self.mean)
        covariance = checks.finite("covariance", self.covariance)
        max_degree_of(mean.size)
        if covariance.shape != (mean.size, mean.size):
            raise ArgumentError(
                f"covariance must have shape {(mean.size, mean.size)}, got {covariance.shape}"
            )
        if mean[0] <= 0:
            raise ArgumentError(f"mean of L_00 must be positive, got {mean[0]:.4g}")

    @classmethod
    def learn(
        cls, maps: Iterable[EnvironmentMap], degree: int = 4, *, rotations: bool = False
    ) -> "LightPrior":
        """Learn from environment maps.

        Parameters
        ----------
        maps
            At least two, in grey or colour; colours count as luminance.
        degree
            Highest degree.
        rotations
            Whether every map may be turned any way round, so that up, down and sides are alike.
            Otherwise the covariance is the maps' own, shrunk towards that one.

        Raises
        ------
        ArgumentError
            If there are fewer than two maps, or one is dark.
        """
        lights = []
        for number, each in enumerate(maps):
            light = project(each, degree)
            if light.ndim == 2:
                light = luminance(np.moveaxis(light, 0, -1)) if len(light) == 3 else light[0]
            if light[0] <= 0:
                raise ArgumentError(f"map {number} must not be dark")
            lights.append(np.asarray(light / light[0], np.float64))
        if len(lights) < FEWEST:
            raise ArgumentError(f"maps must number at least {FEWEST}, got {len(lights)}")
        sample = np.stack(lights)
        power = np.bincount(degrees(degree), (sample**2).mean(axis=0)) / np.bincount(
            degrees(degree)
        )
        isotropic = np.diag(power[degrees(degree)])
        isotropic[0, 0] = 0
        if rotations:
            return cls(np.eye(1, harmonic_count(degree))[0], isotropic)
        mean = sample.mean(axis=0)
        own = (sample - mean).T @ (sample - mean)
        count = len(sample)
        return cls(mean, (own + SHRINKAGE * isotropic) / (count - 1 + SHRINKAGE))

    def precision(
        self, scale: float, degree: int
    ) -> tuple[Float[np.ndarray, "K K"], Float[np.ndarray, "K"]]:
        """Return the inverse of the covariance of light of a known `L_00`, and it times the mean.

        Parameters
        ----------
        scale
            `L_00` of the light, positive.
        degree
            At most that of the prior.

        Returns
        -------
        tuple of numpy.ndarray
            Shapes (K, K) and (K,), K = (degree + 1)**2.

        Raises
        ------
        ArgumentError
            If the prior has fewer degrees.
        """
        count = harmonic_count(degree)
        if count > self.mean.size:
            raise ArgumentError(
                f"prior must reach degree {degree}, got one of degree "
                f"{max_degree_of(self.mean.size)}; learn it with that degree"
            )
        covariance = scale**2 * self.covariance[:count, :count]
        # The scale itself is left to the photograph: nothing is known of exposures.
        covariance = covariance + np.outer(self.mean[:count], self.mean[:count]) * (10 * scale) ** 2
        covariance += np.eye(count) * (1e-3 * scale) ** 2
        inverse = np.linalg.inv(covariance)
        return inverse, inverse @ (scale * self.mean[:count])
