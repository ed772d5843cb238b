"""Lobes of a cosine's power: Phong's about the mirrored direction, Blinn's about the halfway one.

References
----------
.. [LW94] Lafortune and Willems, Using the Modified Phong Reflectance Model for Physically Based
   Rendering, 1994.
.. [RH01b] Ramamoorthi and Hanrahan, A Signal-Processing Framework for Inverse Rendering,
   SIGGRAPH 2001.
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance.material import Material, above, halfway, share

MOST_EXPONENT = 1e6
"""Beyond it a lobe is narrower than a tenth of a degree, and its powers are lost in float64."""


def check_exponent(exponent: float) -> float:
    """Return an exponent if a lobe can have it."""
    if not 0 <= exponent <= MOST_EXPONENT:
        raise ArgumentError(
            f"exponent must lie in [0, {MOST_EXPONENT:g}], got {exponent}; sharper is a mirror"
        )
    return float(exponent)


@dataclass(frozen=True)
class Phong(Material):
    """Phong's lobe about the mirrored direction, normalised to reflect at most its share.

    The reflectance is `share (e + 2) / (2 pi) max(r . w, 0)^e`, [LW94]_.

    Parameters
    ----------
    exponent
        Sharpness `e`, in [0, 1e6].
    share
        Fraction of the light from the normal's direction that is reflected, in [0, 1].

    Raises
    ------
    ArgumentError
        If one is out of range.
    """

    exponent: float
    share: float = 1.0

    def __post_init__(self) -> None:
        check_exponent(self.exponent)
        share("share", self.share)

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
        along = incoming[..., 2] * outgoing[..., 2]
        tangential = (incoming[..., :2] * outgoing[..., :2]).sum(axis=-1)
        lobe = np.maximum(along - tangential, 0) ** self.exponent
        return self.share * (self.exponent + 2) / (2 * math.pi) * lobe * above(incoming, outgoing)

    def radial(self, max_degree: int) -> Float[np.ndarray, "L"]:
        """Return the factors of the lobe `(e + 1) / (2 pi) max(r . w, 0)^e`, exactly.

        As in [RH01b]_ section 5.2 the cosine of incidence is no part of the lobe, so that it is
        the same from every side: `r_0 = 1`, `r_1 = (e + 1) / (e + 2)` and
        `r_{l+2} = r_l (e - l) / (e + l + 3)`, times the share. Exponent 1 is Lambert's law.

        Parameters
        ----------
        max_degree
            Greatest degree, at least 0.

        Returns
        -------
        numpy.ndarray
            Factors, shape `(max_degree + 1,)`.

        Raises
        ------
        ArgumentError
            If the degree is negative or not whole.

        Examples
        --------
        >>> Phong(20).radial(3).round(6)
        array([1.      , 0.954545, 0.869565, 0.755682])
        """
        e = self.exponent
        factors = np.zeros(checks.degree("max_degree", max_degree) + 1)
        factors[:2] = [1, (e + 1) / (e + 2)][: len(factors)]
        for degree in range(2, len(factors)):
            factors[degree] = factors[degree - 2] * (e - degree + 2) / (e + degree + 1)
        return self.share * factors


@dataclass(frozen=True)
class Blinn(Material):
    """Blinn's lobe about the halfway direction, normalised along the normal.

    The reflectance is `share (e + 2)(e + 4) / (8 pi (2^(-e/2) + e)) max(h . n, 0)^e`: light from
    the normal's direction is reflected to its share exactly.

    Parameters
    ----------
    exponent
        Sharpness `e`, in [0, 1e6].
    share
        Fraction of the light from the normal's direction that is reflected, in [0, 1].

    Raises
    ------
    ArgumentError
        If one is out of range.
    """

    exponent: float
    share: float = 1.0

    def __post_init__(self) -> None:
        check_exponent(self.exponent)
        share("share", self.share)

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
        e = self.exponent
        scale = (e + 2) * (e + 4) / (8 * math.pi * (2 ** (-e / 2) + e))
        lobe = np.maximum(halfway(incoming, outgoing)[..., 2], 0) ** e
        return self.share * scale * lobe * above(incoming, outgoing)
