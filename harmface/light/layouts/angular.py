"""The angular map or light probe of RH01 figure 3: a disc, its radius the angle from +z.

The centre looks to +z and the whole rim to -z; the image's polar angle is the azimuth, from +x at
the right towards +y at the top. Pixels outside the disc show nothing.
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


class Angular(Layout):
    """The angular map: radius = polar angle / pi."""

    name = "angular"
    offset = 0.0
    """How far, in pixels, from its centre to the upper left a pixel's direction is taken."""

    def shape(self, height: int) -> tuple[int, ...]:
        """Return the shape of the pixel axes, see `Layout`."""
        return height, height

    def height_of(self, shape: tuple[int, ...]) -> int:
        """Return the height of a map of this shape, or refuse it, see `Layout`."""
        return square_height("an angular map", shape)

    def directions_at(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> Float[np.ndarray, "... 3"]:
        """Return the direction that each position looks at, see `Layout`."""
        u, v = plane_position(position, height, self.offset)
        radius = np.hypot(u, v)
        # sin(pi r) / r, which is pi at the centre. Beyond the rim the angle grows past pi, and the
        # direction comes back on the other side of -z, as it should.
        slope = np.pi * np.sinc(radius)
        return np.stack([slope * u, slope * v, np.cos(np.pi * radius)], axis=-1)

    def positions_of(
        self, directions: Float[np.ndarray, "... 3"], height: int
    ) -> tuple[Float[np.ndarray, "..."], ...]:
        """Return the position of each direction, see `Layout`."""
        x, y, z = np.moveaxis(directions, -1, 0)
        return disc_position(x, y, np.arctan2(np.hypot(x, y), z) / np.pi, height, self.offset)

    def pixels_near(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> tuple[Int[np.ndarray, "..."], ...]:
        """Return the pixels at positions, or the nearest inside the disc, see `Layout`."""
        return pixels_inside(position, height, self.offset)

    def solid_angles(self, height: int, rows: slice = ALL) -> Float[np.ndarray, "*pixels"]:
        """Return exact solid angles, see `Layout`."""
        lines = 2 * (np.arange(height + 1) - self.offset) / height - 1
        lines[0], lines[-1] = -1, 1
        # (1 - cos(pi r)) / r**2 = pi**2 / 2 * (sin(pi r / 2) / (pi r / 2))**2
        return disc_solid_angles(
            lines, lambda squared: np.pi**2 / 2 * np.sinc(np.sqrt(squared) / 2) ** 2, rows
        )


class RH01Probe(Angular):
    """The angular map as RH01's own program reads it, each pixel at its upper left corner.

    That program, prefilter.c, takes pixel (i, j) of a probe w pixels wide to look at
    `u = (j - w / 2) / (w / 2)` and `v = (w / 2 - i) / (w / 2)`. The published tables were computed
    so; on a probe of 1000 pixels this half pixel is some 0.2 to 0.4 % of the coefficients. The
    last row and column take in the rim that is left.
    """

    name = "rh01-probe"
    offset = 0.5
