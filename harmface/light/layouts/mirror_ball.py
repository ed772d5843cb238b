"""The mirror ball: a reflecting sphere photographed from afar along -z.

A ball's point with normal n reflects the view to 2 n_z n - z: the centre looks back at the camera,
to +z, and the rim past the ball, to -z. The radius is sin(theta / 2), so that equal areas of the
image are equal solid angles.
"""

import numpy as np
from jaxtyping import Float, Int

from harmface.light.layouts.disc import disc_solid_angles
from harmface.light.layouts.layout import ALL, Layout
from harmface.light.layouts.square import (
    disc_position,
    pixels_inside,
    plane_position,
    square_height,
)


class MirrorBall(Layout):
    """The mirror ball: radius = sin(polar angle / 2)."""

    name = "mirror-ball"

    def shape(self, height: int) -> tuple[int, ...]:
        """Return the shape of the pixel axes, see `Layout`."""
        return height, height

    def height_of(self, shape: tuple[int, ...]) -> int:
        """Return the height of a map of this shape, or refuse it, see `Layout`."""
        return square_height("a mirror-ball map", shape)

    def directions_at(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> Float[np.ndarray, "... 3"]:
        """Return the direction that each position looks at, see `Layout`."""
        u, v = plane_position(position, height)
        squared = np.minimum(u**2 + v**2, 1)  # Beyond the rim there is no ball: -z.
        slope = 2 * np.sqrt(1 - squared)
        return np.stack([slope * u, slope * v, 1 - 2 * squared], axis=-1)

    def positions_of(
        self, directions: Float[np.ndarray, "... 3"], height: int
    ) -> tuple[Float[np.ndarray, "..."], ...]:
        """Return the position of each direction, see `Layout`."""
        x, y, z = np.moveaxis(directions, -1, 0)
        return disc_position(x, y, np.sin(np.arctan2(np.hypot(x, y), z) / 2), height)

    def pixels_near(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> tuple[Int[np.ndarray, "..."], ...]:
        """Return the pixels at positions, or the nearest inside the disc, see `Layout`."""
        return pixels_inside(position, height)

    def solid_angles(self, height: int, rows: slice = ALL) -> Float[np.ndarray, "*pixels"]:
        """Return exact solid angles, see `Layout`."""
        # 1 - cos(theta) = 2 sin(theta / 2)**2 = 2 r**2
        lines = np.linspace(-1, 1, height + 1)
        return disc_solid_angles(lines, lambda squared: np.full_like(squared, 2.0), rows)
