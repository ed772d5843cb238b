"""Matte surfaces as materials: Lambert's, and the rough ones of Oren and Nayar.

References
----------
.. [ON94] Oren and Nayar, Generalization of Lambert's Reflectance Model, SIGGRAPH 1994, section 4.4
   (the qualitative model).
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.reflectance.lambert import lambert_coefficients
from harmface.reflectance.material import Material, above, share


@dataclass(frozen=True)
class Lambert(Material):
    """Reflects the same radiance to all sides.

    Parameters
    ----------
    albedo
        Reflected share, in [0, 1].

    Raises
    ------
    ArgumentError
        If the albedo is no share.
    """

    albedo: float = 1.0

    def __post_init__(self) -> None:
        share("albedo", self.albedo)

    def evaluate(
        self, incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
    ) -> Float[np.ndarray, "..."]:
        """Return `albedo / pi`, see `Material`.

        Parameters
        ----------
        incoming, outgoing
            Unit directions to the light and to the viewer, z along the normal.

        Returns
        -------
        numpy.ndarray
            Per steradian, shape `(*channels, *pairs)`.
        """
        return self.albedo / math.pi * above(incoming, outgoing)

    def radial(self, max_degree: int) -> Float[np.ndarray, "L"]:
        """Return `albedo A_l / pi`, see `Material`.

        Parameters
        ----------
        max_degree
            Greatest degree, at least 0.

        Returns
        -------
        numpy.ndarray
            Factors, shape `(*channels, max_degree + 1)`.

        Raises
        ------
        ArgumentError
            If the degree is negative or not whole.
        """
        return self.albedo / math.pi * lambert_coefficients(max_degree)


@dataclass(frozen=True)
class OrenNayar(Material):
    """A rough matte surface of Lambertian facets, [ON94]_.

    Parameters
    ----------
    roughness
        Standard deviation of the facets' slope angle, in radians, at least 0.
    albedo
        Of the facets, in [0, 1].

    Raises
    ------
    ArgumentError
        If the roughness is negative or not finite, or the albedo is no share.
    """

    roughness: float
    albedo: float = 1.0

    def __post_init__(self) -> None:
        if not (np.isfinite(self.roughness) and self.roughness >= 0):
            raise ArgumentError(f"roughness must be 0 or more, got {self.roughness}")
        share("albedo", self.albedo)

    def evaluate(
        self, incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
    ) -> Float[np.ndarray, "..."]:
        """Return the reflectance, see `Material`.

        Parameters
        ----------
        incoming, outgoing
            Unit directions to the light and to the viewer, z along the normal.

        Returns
        -------
        numpy.ndarray
            Per steradian, shape `(*channels, *pairs)`.
        """
        variance = self.roughness**2
        flat = 1 - 0.5 * variance / (variance + 0.33)
        rough = 0.45 * variance / (variance + 0.09)
        # sin sin cos(phi) is the tangents' product; sin(larger) tan(smaller) divides the sines'
        # product by the larger cosine.
        tangential = (incoming[..., :2] * outgoing[..., :2]).sum(axis=-1)
        steeper = np.maximum(np.maximum(incoming[..., 2], outgoing[..., 2]), 1e-12)
        bent = np.maximum(tangential, 0) / steeper
        return self.albedo / math.pi * (flat + rough * bent) * above(incoming, outgoing)
