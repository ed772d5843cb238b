"""A lamp without a size, seen from near by."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.near_light import NearLight, about_axis, checked_place


@dataclass(frozen=True, eq=False)
class PointLight(NearLight):
    """A lamp without a size.

    Parameters
    ----------
    position
        Where it stands.
    radiance
        Its intensity: irradiance on a surface that faces it at distance 1; one number or one a
        channel.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """

    position: Float[np.ndarray, "3"]
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", checked_place("position", self.position))
        object.__setattr__(self, "radiance", checks.non_negative("intensity", self.radiance))

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        offsets = self.position - points
        distances = np.linalg.norm(offsets, axis=-1)
        if not distances.all():
            raise ArgumentError("points must not lie where the point light is")
        zonal = np.sqrt((2 * np.arange(max_degree + 1) + 1) / (4 * np.pi))
        return about_axis(
            offsets,
            distances,
            zonal / distances[:, None] ** 2,
            -2 * zonal / distances[:, None] ** 3,
        )

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return nothing: no ray meets it.

        Returns
        -------
        tuple of numpy.ndarray
            No vertices, (0, 3), and no triangles, (0, 3).
        """
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)
