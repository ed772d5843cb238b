"""A mirror, which passes every degree of the light."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance.material import Material, share


@dataclass(frozen=True)
class Mirror(Material):
    """Shows the light in the mirrored direction, times its share.

    Parameters
    ----------
    share
        Reflected share, in [0, 1].

    Raises
    ------
    ArgumentError
        If it is no share.
    """

    share: float = 1.0

    def __post_init__(self) -> None:
        share("share", self.share)

    def evaluate(
        self, incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
    ) -> Float[np.ndarray, "..."]:
        """Refuse: a mirror's reflectance is no function of two directions.

        Parameters
        ----------
        incoming, outgoing
            Directions that are not looked at.

        Raises
        ------
        ArgumentError
            Always.
        """
        raise ArgumentError(
            "a mirror has no reflectance that can be summed over directions; look the light up in "
            "the mirrored direction, or take a sharp lobe such as ggx:0.05"
        )

    def radial(self, max_degree: int) -> Float[np.ndarray, "L"]:
        """Return the share at every degree, see `Material`.

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
        return np.full(checks.degree("max_degree", max_degree) + 1, self.share)
