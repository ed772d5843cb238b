"""Sums and scalings of materials: a coat on a coloured ground."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.reflectance.material import Material


@dataclass(frozen=True, eq=False)
class Mixture(Material):
    """The sum of materials, each scaled.

    Parameters
    ----------
    parts
        Materials, at least one.
    scales
        A factor, or one for each channel, of each material; at least 0.

    Raises
    ------
    ArgumentError
        If there is none, numbers disagree, or a scale is negative.

    Examples
    --------
    >>> from harmface.reflectance import Lambert, Phong
    >>> skin = Mixture((Lambert(), Phong(20)), (np.array([0.6, 0.4, 0.3]), 0.05))
    >>> skin.radial(2).round(3)
    array([[0.65 , 0.448, 0.193],
           [0.45 , 0.314, 0.143],
           [0.35 , 0.248, 0.118]])
    """

    parts: tuple[Material, ...]
    scales: tuple[float | Float[np.ndarray, "channels"], ...]

    def __post_init__(self) -> None:
        if not self.parts or len(self.parts) != len(self.scales):
            raise ArgumentError(
                f"a mixture needs a scale for each material, got {len(self.parts)} materials and "
                f"{len(self.scales)} scales"
            )
        for scale in self.scales:
            checks.non_negative("scales", np.asarray(scale, float))

    def evaluate(
        self, incoming: Float[np.ndarray, "*#pairs 3"], outgoing: Float[np.ndarray, "*#pairs 3"]
    ) -> Float[np.ndarray, "..."]:
        """Return the weighted sum, see `Material`.

        Parameters
        ----------
        incoming, outgoing
            Unit directions to the light and to the viewer, z along the normal.

        Returns
        -------
        numpy.ndarray
            Per steradian, shape `(*channels, *pairs)`.
        """
        axes = len(np.broadcast_shapes(incoming.shape, outgoing.shape)) - 1
        return self._sum([part.evaluate(incoming, outgoing) for part in self.parts], axes)

    def radial(self, max_degree: int) -> Float[np.ndarray, "... L"]:
        """Return the weighted sum of the parts' lobes, see `Material`.

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
        return self._sum([part.radial(max_degree) for part in self.parts], 1)

    def _sum(self, values: list[np.ndarray], axes: int) -> np.ndarray:
        """Return the sum of scaled arrays, whose channels lead `axes` axes."""
        total: np.ndarray | float = 0.0
        for scale, value in zip(self.scales, values, strict=True):
            scale = np.asarray(scale, float)
            total = total + scale.reshape(*scale.shape, *[1] * axes) * value
        return np.asarray(total)
