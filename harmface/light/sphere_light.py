"""A ball that shines, seen from near by."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer
from numpy.polynomial.legendre import legvander

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.analytic import zonal_cap
from harmface.light.near_light import NearLight, about_axis, check_radius, checked_place


@dataclass(frozen=True, eq=False)
class SphereLight(NearLight):
    """A ball that shines: seen from anywhere it is a cone of constant radiance.

    Parameters
    ----------
    center
        Middle of the ball.
    radius
        Above 0.
    radiance
        The same everywhere and in all directions: one number or one a channel.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """

    center: Float[np.ndarray, "3"]
    radius: float
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", checked_place("center", self.center))
        check_radius(self.radius)
        object.__setattr__(self, "radiance", checks.non_negative("radiance", self.radiance))

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        # With `sin(angle) = radius / distance` only the edge of the cone changes with distance.
        offsets = self.center - points
        distances = np.linalg.norm(offsets, axis=-1)
        inside = np.count_nonzero(distances <= self.radius)
        if inside:
            raise ArgumentError(f"points must lie outside the sphere light, got {inside} inside")
        angles = np.arcsin(self.radius / distances)
        degree = np.arange(max_degree + 1)
        scale = 2 * np.pi * np.sqrt((2 * degree + 1) / (4 * np.pi))
        edge = legvander(np.cos(angles), max_degree) * scale
        slopes = -edge * (self.radius**2 / (distances**3 * np.cos(angles)))[:, None]
        return about_axis(offsets, distances, zonal_cap(angles, max_degree), slopes)

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return its surface for ray casting, of the same area.

        Returns
        -------
        tuple of numpy.ndarray
            Vertices, (V, 3), and the corners of each triangle, (F, 3), counter-clockwise from where
            it shines.
        """
        from trimesh.creation import icosphere

        ball = icosphere(subdivisions=3)
        grown = self.radius * np.sqrt(4 * np.pi / ball.area)
        return self.center + grown * np.asarray(ball.vertices), np.asarray(ball.faces, np.int64)
