"""What a camera's noise says: the likelihood of every subject, and whether any fits at all.

The variance of a pixel of mean intensity `I` is `gain I + read^2 + step^2 / 12`: photons counted,
the amplifier, and rounding to codes ([J07]_). Weights are its inverse at the reconstruction, not at
the pixel itself, whose noise would weigh in; saturated pixels say nothing and are left out.

This is the camera's part alone: light that the subspace does not hold (cast shadows, highlights)
counts as evidence against everybody, and `chi_square` tells how much there is of it.

References
----------
.. [J07] Janesick, Photon Transfer, SPIE 2007.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.errors import ArgumentError
from harmface.recognition.distance import Model
from harmface.recognition.probes import checked_probes
from harmface.recognition.spanned import SubspaceDistance

STEPS = 4
"""Fits, the first with equal weights: then weights change by less than a part in a thousand."""

CHUNK = 2**20
"""Pixels of pairs treated at a time: 8 MB an array."""


@dataclass(frozen=True)
class CameraNoise:
    """Noise of a linear photograph, in the photograph's unit.

    Parameters
    ----------
    gain
        Unit per electron: variance per intensity of the photons' noise.
    read
        Standard deviation of the noise in the dark.
    step
        Difference between neighbouring codes, such as 1 / 255.
    saturation
        Intensity from which a pixel is saturated.

    Examples
    --------
    A well of 20,000 electrons, 5 of read noise, 8 bits:

    >>> noise = CameraNoise(gain=1 / 20_000, read=5 / 20_000, step=1 / 255)
    >>> noise.variance(np.array([0.5])).round(8)
    array([2.634e-05])
    """

    gain: float
    read: float
    step: float
    saturation: float = 1.0

    def __post_init__(self) -> None:
        for name in ("gain", "read", "step"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                raise ArgumentError(f"{name} must be 0 or more, got {value}")
        if not self.saturation > 0:
            raise ArgumentError(f"saturation must be above 0, got {self.saturation}")
        if self.read == 0 and self.step == 0:
            raise ArgumentError("read or step must be above 0: no camera is free of noise")

    def variance(self, intensity: Float[np.ndarray, "*any"]) -> Float[np.ndarray, "*any"]:
        """Return the variance of pixels whose mean is `intensity`; below 0 counts as 0.

        Parameters
        ----------
        intensity
            Mean of each pixel, in the photograph's unit, of any shape.

        Returns
        -------
        numpy.ndarray
            Shape of the intensity, in the photograph's unit squared.
        """
        return self.gain * np.maximum(intensity, 0) + (self.read**2 + self.step**2 / 12)


@dataclass(frozen=True, eq=False)
class Likelihoods:
    """How probable each probe is as a photograph of each subject.

    Parameters
    ----------
    log
        Logarithm of the likelihood, light being unknown, up to a constant of the probe.
    chi_square
        Sum of squared residuals over their variances: of the right subject it follows the
        chi-square distribution.
    freedom
        Its degrees of freedom for each probe: pixels that are not saturated less dimensions.
    """

    log: Float[np.ndarray, "n N"]
    chi_square: Float[np.ndarray, "n N"]
    freedom: Integer[np.ndarray, "n"]


def likelihoods(
    probes: Float[np.ndarray, "n p"], bases: Float[np.ndarray, "N d p"], noise: CameraNoise
) -> Likelihoods:
    """Return the likelihood of every subject for every probe.

    It is the mean over all light, every one as probable beforehand: with the residual `r` of the
    best fit, the variances `v` and the basis `Q`,

        `log p = -(sum r^2 / v + sum log v + log det(Q diag(1 / v) Q^T)) / 2`

    Parameters
    ----------
    probes
        Linear photographs as rows of pixels, in the unit of the noise; none may be all black.
    bases
        Orthonormal rows of each subject, none of them zero, see `orthonormal_basis`.
    noise
        Of the camera.

    Returns
    -------
    Likelihoods
        Logarithms, chi-square and degrees of freedom, in float64.

    Raises
    ------
    ArgumentError
        On NaN, an all-black probe, probes of another size than the bases, or one that has no
        more pixels below saturation than the subspace has dimensions.
    """
    subjects, dimension, pixels = bases.shape
    probes = checked_probes(probes, pixels).astype(np.float64)
    lit = probes < noise.saturation
    freedom = lit.sum(axis=1) - dimension
    if (freedom < 1).any():
        raise ArgumentError(
            f"probes must have more than {dimension} pixels below saturation "
            f"({noise.saturation}), but number {int(freedom.argmin())} has "
            f"{int(freedom.min()) + dimension}; expose less"
        )
    bases = bases.astype(np.float64)
    log, chi_square = np.empty((2, len(probes), subjects))
    step = max(1, CHUNK // pixels)
    for subject, basis in enumerate(bases):
        products = (basis[:, None] * basis).reshape(-1, pixels).T
        for first in range(0, len(probes), step):
            some = slice(first, first + step)
            log[some, subject], chi_square[some, subject] = _of_subject(
                probes[some], lit[some], basis, products, noise
            )
    return Likelihoods(log, chi_square, freedom)


def _of_subject(
    probes: Float[np.ndarray, "n p"],
    lit: np.ndarray,
    basis: Float[np.ndarray, "d p"],
    products: Float[np.ndarray, "p u"],
    noise: CameraNoise,
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Return the logarithm of the likelihood of one subject, and chi-square."""
    variances = np.ones_like(probes)
    for _ in range(STEPS):
        weights = lit / variances
        systems = (weights @ products).reshape(-1, len(basis), len(basis))
        right = (weights * probes) @ basis.T
        reconstruction = np.linalg.solve(systems, right[..., None])[..., 0] @ basis
        variances = noise.variance(reconstruction)
    weights = lit / variances
    chi_square = np.einsum("np,np->n", weights, (probes - reconstruction) ** 2)
    systems = (weights @ products).reshape(systems.shape)
    spread = np.log(variances).sum(axis=1, where=lit) + np.linalg.slogdet(systems)[1]
    return -(chi_square + spread) / 2, chi_square


TYPICAL = CameraNoise(gain=1 / 20_000, read=5 / 20_000, step=1 / 255)
"""A well of 20,000 electrons, 5 of read noise, 8 bits: a small camera of the usual kind."""


@dataclass(frozen=True)
class LikelihoodDistance(SubspaceDistance):
    """The misfit in units of the camera's noise: `sqrt(chi_square / freedom)` of `likelihoods`.

    It is 1 of a probe that a subspace explains up to noise.

    Parameters
    ----------
    noise
        Of the camera.
    """

    noise: CameraNoise = TYPICAL

    def distances(
        self, model: Model, probes: Float[np.ndarray, "n H W"], mask: Bool[np.ndarray, "H W"]
    ) -> Float[np.ndarray, "n N"]:
        """Return the misfit of every probe to every subject."""
        found = likelihoods(probes[:, mask], model["bases"], self.noise)
        return np.sqrt(found.chi_square / found.freedom[:, None])
