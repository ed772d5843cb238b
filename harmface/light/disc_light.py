"""A round flat lamp, seen from near by; `near_light` has the mathematics."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.near_light import (
    NearLight,
    check_radius,
    checked_place,
    in_front,
    outline_integrals,
    spread,
)

RIM_NODES = 128
"""Nodes round a disc: to rounding farther than 0.3 radii from the rim, 1e-6 at a tenth."""


@dataclass(frozen=True, eq=False)
class DiscLight(NearLight):
    """A flat round lamp that shines from one side.

    Parameters
    ----------
    center
        Middle of the disc.
    normal
        Unit vector to where it shines.
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
    normal: Float[np.ndarray, "3"]
    radius: float
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", checked_place("center", self.center))
        normal = checks.unit_vectors("normal", self.normal)
        if normal.shape != (3,):
            raise ArgumentError(f"normal must have shape (3,), got {normal.shape}")
        object.__setattr__(self, "normal", normal.astype(np.float64))
        check_radius(self.radius)
        object.__setattr__(self, "radiance", checks.non_negative("radiance", self.radiance))

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        front = in_front(points, self.center, self.normal, 2 * self.radius, "disc")
        rim, tangents = self._rim(RIM_NODES)
        seen = rim - points[front, None]
        distances = np.linalg.norm(seen, axis=-1, keepdims=True)
        seen /= distances
        steps = np.cross(seen, tangents / distances) * (2 * np.pi / RIM_NODES)
        return spread(
            front, *outline_integrals(seen, steps, 1 / distances[..., 0], -self.normal, max_degree)
        )

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return its surface for ray casting.

        Returns
        -------
        tuple of numpy.ndarray
            Vertices, (V, 3), and the corners of each triangle, (F, 3), counter-clockwise from where
            it shines.
        """
        rim, _ = self._rim(RIM_NODES)
        around = np.arange(RIM_NODES)
        faces = np.stack([np.full(RIM_NODES, RIM_NODES), around, np.roll(around, -1)], axis=1)
        return np.concatenate([rim, self.center[None]]), faces

    def _rim(self, count: int) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
        """Return points round the rim, and the derivatives by the angle."""
        along = np.cross(self.normal, np.eye(3)[np.abs(self.normal).argmin()])
        along /= np.linalg.norm(along)
        across = np.cross(self.normal, along)
        angle = 2 * np.pi * np.arange(count)[:, None] / count
        cosine, sine = self.radius * np.cos(angle), self.radius * np.sin(angle)
        return self.center + cosine * along + sine * across, cosine * across - sine * along
