"""Latitude and longitude: rows are latitudes from +y down, columns are longitudes.

The centre column looks to +z, the left quarter to +x, the top row to +y, and the left and right
edges meet at -z, as the OpenEXR library defines it. (OpenEXR counts from pixel to pixel, so that
its first row is the pole itself; here, as for photographs, a pixel is an area with a centre.)
"""

import math

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.light.layouts.layout import ALL, Layout


class LatLong(Layout):
    """The map of latitudes and longitudes, twice as wide as high."""

    name = "latlong"

    def shape(self, height: int) -> tuple[int, ...]:
        """Return the shape of the pixel axes, see `Layout`."""
        return height, 2 * height

    def height_of(self, shape: tuple[int, ...]) -> int:
        """Return the height of a map of this shape, or refuse it, see `Layout`."""
        if len(shape) != 2 or shape[1] != 2 * shape[0] or shape[0] == 0:
            raise ArgumentError(
                f"a lat-long map is twice as wide as it is high, got {_size(shape)}; "
                "name its layout (angular, mirror-ball, cube) or crop it"
            )
        return shape[0]

    def directions_at(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> Float[np.ndarray, "... 3"]:
        """Return the direction that each position looks at, see `Layout`."""
        rows, columns = position
        latitude = np.pi * (0.5 - rows / height)
        longitude = np.pi * (1 - columns / height)
        x = np.cos(latitude) * np.sin(longitude)
        z = np.cos(latitude) * np.cos(longitude)
        return np.stack([x, np.broadcast_to(np.sin(latitude), x.shape), z], axis=-1)

    def positions_of(
        self, directions: Float[np.ndarray, "... 3"], height: int
    ) -> tuple[Float[np.ndarray, "..."], ...]:
        """Return the position of each direction, see `Layout`."""
        x, y, z = np.moveaxis(directions, -1, 0)
        latitude = np.arctan2(y, np.hypot(x, z))
        longitude = np.arctan2(x, z)
        return height * (0.5 - latitude / np.pi), height * (1 - longitude / np.pi)

    def solid_angles(self, height: int, rows: slice = ALL) -> Float[np.ndarray, "*pixels"]:
        """Return exact solid angles, see `Layout`."""
        # The difference of the cosines at a row's edges, by the product formula: no cancellation.
        centres = np.pi * (np.arange(height)[rows] + 0.5) / height
        row = 2 * math.sin(np.pi / (2 * height)) * np.sin(centres)
        return np.repeat(row[:, None] * (np.pi / height), 2 * height, axis=1)


def _size(shape: tuple[int, ...]) -> str:
    """Say a map's size, as width by height where it has just these."""
    return f"{shape[1]} x {shape[0]} pixels" if len(shape) == 2 else f"the shape {shape}"
