"""Rough mirrors: Fresnel's reflection by facets whose slopes have a distribution.

The reflectance is `D(h) G(i, o) F(i . h) / (4 cos_i cos_o)`, h being the halfway direction.

References
----------
.. [TS67] Torrance and Sparrow, Theory for Off-Specular Reflection from Roughened Surfaces, JOSA
   57(9), 1967.
.. [CT82] Cook and Torrance, A Reflectance Model for Computer Graphics, ACM TOG 1(1), 1982.
.. [WMLT07] Walter, Marschner, Li and Torrance, Microfacet Models for Refraction through Rough
   Surfaces, EGSR 2007.
.. [H14] Heitz, Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs, JCGT 3(2),
   2014.
.. [S94] Schlick, An Inexpensive BRDF Model for Physically-based Rendering, 1994.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.reflectance.material import Material, above, halfway, share

LEAST_ROUGHNESS = 1e-3
"""Below it a lobe is narrower than a tenth of a degree: that is a mirror."""


def fresnel(cosine: Float[np.ndarray, "*n"], at_normal: float) -> Float[np.ndarray, "*n"]:
    """Return the reflected share at an angle to a facet, `F0 + (1 - F0)(1 - c)^5` ([S94]_)."""
    return at_normal + (1 - at_normal) * (1 - np.clip(cosine, 0, 1)) ** 5


@dataclass(frozen=True)
class Microfacet(Material):
    """What all rough mirrors have in common.

    Parameters
    ----------
    roughness
        Root mean square slope times the root of 2, in [0.001, 1].
    reflectance
        Fresnel's share at normal incidence, in [0, 1].

    Raises
    ------
    ArgumentError
        If one is out of range.
    """

    roughness: float
    reflectance: float = 1.0

    def __post_init__(self) -> None:
        if not LEAST_ROUGHNESS <= self.roughness <= 1:
            raise ArgumentError(
                f"roughness must lie in [{LEAST_ROUGHNESS}, 1], got {self.roughness}; "
                "smoother is a mirror"
            )
        share("reflectance", self.reflectance)

    @abstractmethod
    def distribution(self, cosine: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
        """Return `D`, whose integral times the cosine over the hemisphere is 1.

        Parameters
        ----------
        cosine
            Of the angle between facet and surface.

        Returns
        -------
        numpy.ndarray
            Density per steradian, of the shape of `cosine`.
        """

    @abstractmethod
    def masking(
        self, incoming: np.ndarray, outgoing: np.ndarray, half: np.ndarray
    ) -> Float[np.ndarray, "*n"]:
        """Return `G`, the share of facets that both directions see.

        Parameters
        ----------
        incoming, outgoing, half
            Unit directions to the light, to the viewer, and halfway between.

        Returns
        -------
        numpy.ndarray
            Shares in [0, 1], shape `(*pairs,)`.
        """

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
        half = halfway(incoming, outgoing)
        lit = above(incoming, outgoing)
        facing = (outgoing * half).sum(axis=-1)
        cosines = np.where(lit > 0, 4 * incoming[..., 2] * outgoing[..., 2], 1)
        spread = self.distribution(half[..., 2]) * self.masking(incoming, outgoing, half)
        return spread * fresnel(facing, self.reflectance) / cosines * lit


def _tangent(direction: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
    """Return the tangent of the polar angle, above the surface."""
    sine = np.hypot(direction[..., 0], direction[..., 1])
    return np.asarray(sine / np.maximum(direction[..., 2], 1e-12))


@dataclass(frozen=True)
class GGX(Microfacet):
    """The distribution with long tails, and Smith's masking of both directions together.

    [WMLT07]_ eq. 33, [H14]_ eq. 72 and 99.

    Parameters
    ----------
    roughness, reflectance
        See `Microfacet`.
    """

    def distribution(self, cosine: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
        """Return `a^2 / (pi (1 + (a^2 - 1) c^2)^2)`, see `Microfacet`.

        Parameters
        ----------
        cosine
            Of the angle between facet and surface.

        Returns
        -------
        numpy.ndarray
            Density per steradian, of the shape of `cosine`.
        """
        square = self.roughness**2
        return square / (math.pi * (1 + (square - 1) * cosine**2) ** 2)

    def masking(
        self, incoming: np.ndarray, outgoing: np.ndarray, half: np.ndarray
    ) -> Float[np.ndarray, "*n"]:
        """Return `1 / (1 + L(i) + L(o))`, see `Microfacet`.

        Parameters
        ----------
        incoming, outgoing, half
            Unit directions to the light, to the viewer, and halfway between.

        Returns
        -------
        numpy.ndarray
            Shares in [0, 1], shape `(*pairs,)`.
        """
        hidden = [
            np.sqrt(1 + (self.roughness * _tangent(each)) ** 2) for each in (incoming, outgoing)
        ]
        return 2 / (hidden[0] + hidden[1])


@dataclass(frozen=True)
class Beckmann(Microfacet):
    """Normally distributed slopes with Smith's masking, [WMLT07]_ eq. 25, [H14]_ eq. 99.

    Parameters
    ----------
    roughness, reflectance
        See `Microfacet`.
    """

    def distribution(self, cosine: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
        """Return `exp(-tan^2 / a^2) / (pi a^2 c^4)`, [CT82]_ eq. 5, see `Microfacet`.

        Parameters
        ----------
        cosine
            Of the angle between facet and surface.

        Returns
        -------
        numpy.ndarray
            Density per steradian, of the shape of `cosine`.
        """
        square = np.maximum(cosine, 1e-6) ** 2
        slopes = np.exp((1 - 1 / square) / self.roughness**2)
        return slopes / (math.pi * self.roughness**2 * square**2)

    def masking(
        self, incoming: np.ndarray, outgoing: np.ndarray, half: np.ndarray
    ) -> Float[np.ndarray, "*n"]:
        """Return Smith's masking of both directions together, see `Microfacet`.

        Parameters
        ----------
        incoming, outgoing, half
            Unit directions to the light, to the viewer, and halfway between.

        Returns
        -------
        numpy.ndarray
            Shares in [0, 1], shape `(*pairs,)`.
        """
        from scipy.special import erf

        total = np.ones(np.broadcast_shapes(incoming.shape, outgoing.shape)[:-1])
        for each in (incoming, outgoing):
            steep = 1 / np.maximum(self.roughness * _tangent(each), 1e-9)
            gauss = np.exp(-(steep**2)) / (steep * math.sqrt(math.pi))
            total = total + (erf(steep) - 1 + gauss) / 2
        return 1 / total


@dataclass(frozen=True)
class TorranceSparrow(Beckmann):
    """Beckmann's distribution of facets, masked in symmetric grooves, [TS67]_, [CT82]_ eq. 2-4.

    Parameters
    ----------
    roughness, reflectance
        See `Microfacet`.
    """

    def masking(
        self, incoming: np.ndarray, outgoing: np.ndarray, half: np.ndarray
    ) -> Float[np.ndarray, "*n"]:
        """Return `min(1, 2 n.h n.i / o.h, 2 n.h n.o / o.h)`, see `Microfacet`.

        Parameters
        ----------
        incoming, outgoing, half
            Unit directions to the light, to the viewer, and halfway between.

        Returns
        -------
        numpy.ndarray
            Shares in [0, 1], shape `(*pairs,)`.
        """
        facing = np.maximum((outgoing * half).sum(axis=-1), 1e-12)
        lower = np.minimum(incoming[..., 2], outgoing[..., 2])
        return np.clip(2 * half[..., 2] * lower / facing, 0, 1)
