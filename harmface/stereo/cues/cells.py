"""Differences of a field over the 2 x 2 cells of a mask."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from harmface.stereo.stack import index_of


@dataclass(frozen=True, eq=False)
class Cells:
    """The 2 x 2 blocks of pixels that lie whole in a mask.

    Parameters
    ----------
    corners
        Index, among the masked pixels, of the corners of each cell: upper left, upper right,
        lower left, lower right.
    """

    corners: Int[np.ndarray, "c 4"]

    def thinned(self, most: int) -> "Cells":
        """Return at most so many cells, evenly spread over all."""
        if len(self.corners) <= most:
            return self
        return Cells(self.corners[np.linspace(0, len(self.corners) - 1, most).astype(int)])

    def middle(self, field: Float[np.ndarray, "p d"]) -> Float[np.ndarray, "c d"]:
        """Return the mean over each cell."""
        return field[self.corners].mean(axis=1)

    def along_x(self, field: Float[np.ndarray, "p d"]) -> Float[np.ndarray, "c d"]:
        """Return the derivative to the right, per pixel, at the middle of each cell."""
        a, b, c, d = np.moveaxis(field[self.corners], 1, 0)
        return (b + d - a - c) / 2

    def along_y(self, field: Float[np.ndarray, "p d"]) -> Float[np.ndarray, "c d"]:
        """Return the derivative upwards, per pixel, at the middle of each cell."""
        a, b, c, d = np.moveaxis(field[self.corners], 1, 0)
        return (a + b - c - d) / 2


def cells_of(mask: Bool[np.ndarray, "H W"]) -> Cells:
    """Return the cells of a mask."""
    index = index_of(mask)
    corners = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]], axis=-1)
    corners = corners.reshape(-1, 4)
    return Cells(corners[(corners >= 0).all(axis=1)])
