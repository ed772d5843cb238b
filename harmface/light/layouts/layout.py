"""What every arrangement of an environment's directions in an image can do."""

from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Float, Int

from harmface import checks

ALL = slice(None)
"""All rows of a map."""


class Layout(ABC):
    """An arrangement of all directions in an image.

    Positions are continuous, in the order of the array's axes (rows, then columns; a cube's face
    comes first), and a pixel's centre lies half a pixel from its edges: the first at 0.5.
    """

    name: str
    """The layout's name on the command line and in `LAYOUTS`."""

    @abstractmethod
    def shape(self, height: int) -> tuple[int, ...]:
        """Return the shape of the pixel axes of a map `height` pixels high.

        Parameters
        ----------
        height
            Rows of the map, or of a cube's face.
        """

    @abstractmethod
    def height_of(self, shape: tuple[int, ...]) -> int:
        """Return the height of a map from the shape of its pixel axes.

        Parameters
        ----------
        shape
            Shape of the pixel axes.

        Raises
        ------
        ArgumentError
            If no map of this layout has such a shape; the message says how that was noticed.
        """

    @abstractmethod
    def directions_at(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> Float[np.ndarray, "... 3"]:
        """Return the unit direction that a position looks at; also just beyond the map's edges.

        Parameters
        ----------
        *position
            Rows, then columns, in pixels; a cube's face first. They broadcast.
        height
            Rows of the map, or of a cube's face.
        """

    @abstractmethod
    def positions_of(
        self, directions: Float[np.ndarray, "... 3"], height: int
    ) -> tuple[Float[np.ndarray, "..."], ...]:
        """Return the position of each direction, the inverse of `directions_at`.

        Parameters
        ----------
        directions
            Unit vectors, shape (..., 3).
        height
            Rows of the map, or of a cube's face.
        """

    @abstractmethod
    def solid_angles(self, height: int, rows: slice = ALL) -> Float[np.ndarray, "*pixels"]:
        """Return the exact solid angle of every pixel in steradians; over the map they sum to 4 pi.

        With `rows` only those of some rows, of each face where there are faces.

        Parameters
        ----------
        height
            Rows of the map, or of a cube's face.
        rows
            Rows to return.
        """

    @property
    def axes(self) -> int:
        """How many axes of an array hold the pixels."""
        return len(self.shape(1))

    def directions(self, height: int, rows: slice = ALL) -> Float[np.ndarray, "*pixels 3"]:
        """Return the unit direction at the centre of every pixel, or of those of some rows.

        Parameters
        ----------
        height
            Rows of the map, or of a cube's face.
        rows
            Rows to return.

        Returns
        -------
        numpy.ndarray
            Unit vectors, shape `(*pixels, 3)`, float64.

        Raises
        ------
        ArgumentError
            If `height` is below 1.
        """
        *first, _, width = self.shape(checks.positive_integer("height", height))
        faces = [np.arange(count, dtype=float).reshape(-1, 1, 1) for count in first]
        down = np.array(range(height)[rows])[:, None] + 0.5
        across = np.arange(width) + 0.5
        return self.directions_at(*faces, down, across, height=height)

    def pixels_near(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> tuple[Int[np.ndarray, "..."], ...]:
        """Return the indices of pixels that show about where positions at or beyond an edge look.

        Inside the map that is the pixel at the position.

        Parameters
        ----------
        *position
            Rows, then columns, in pixels; a cube's face first. They broadcast.
        height
            Rows of the map, or of a cube's face.

        Returns
        -------
        tuple of numpy.ndarray
            Indices, one array for each pixel axis.
        """
        there = self.positions_of(self.directions_at(*position, height=height), height)
        return tuple(
            np.clip(axis.astype(np.intp), 0, limit - 1)
            for axis, limit in zip(there, self.shape(height), strict=True)
        )
