"""Cameras that look along -z, and framing.

A head that is turned is a rotated mesh (`Mesh.rotated`), so cameras carry no rotation and
normals stay in the frame of the harmonics.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.mesh import Mesh

FRAME_MARGIN = 1.05
"""How much larger than the mesh a framing helper makes the picture: 2.5 % clear on each side."""


@dataclass(frozen=True)
class OrthographicCamera:
    """Parallel rays along -z.

    Parameters
    ----------
    center
        The point seen in the middle of the image, and the plane z from which rays start:
        it must lie in front of the mesh.
    height
        Height of the picture in the mesh's unit of length.
    shape
        Rows and columns of pixels; pixels are square.
    """

    center: tuple[float, float, float]
    height: float
    shape: tuple[int, int]

    def __post_init__(self) -> None:
        _check_shape(self.shape)
        if not (np.isfinite(self.height) and self.height > 0):
            raise ArgumentError(f"height must be positive, got {self.height}")

    def rays(
        self, supersampling: int = 1
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
        """Return origins and unit directions, ordered as in `pixel_grid`.

        Parameters
        ----------
        supersampling
            Samples along each side of a pixel.

        Returns
        -------
        tuple of numpy.ndarray
            Origins, in the mesh's unit of length, and unit directions; each of shape (n, 3),
            float64.
        """
        x, y = pixel_grid(self.shape, supersampling)
        scale = self.height / self.shape[0]
        origins = np.empty((x.size, 3))
        origins[:, 0] = self.center[0] + scale * x
        origins[:, 1] = self.center[1] + scale * y
        origins[:, 2] = self.center[2]
        return origins, np.broadcast_to(np.array([0.0, 0.0, -1.0]), origins.shape)

    def towards(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Return the unit directions from points to the camera.

        Parameters
        ----------
        points
            Positions in the mesh's unit of length, shape (n, 3).

        Returns
        -------
        numpy.ndarray
            Unit vectors, shape (n, 3).
        """
        return np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)

    def pixel_sizes(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        """Return the side of a pixel at points, in the mesh's unit of length.

        Parameters
        ----------
        points
            Positions in the mesh's unit of length, shape (n, 3).

        Returns
        -------
        numpy.ndarray
            Lengths, shape (n,).
        """
        return np.full(len(points), self.height / self.shape[0])


@dataclass(frozen=True)
class PerspectiveCamera:
    """Rays from one point, looking along -z.

    Parameters
    ----------
    position
        Centre of projection.
    vertical_field_of_view
        Angle between the top and the bottom edge of the picture, degrees in (0, 180).
    shape
        Rows and columns of pixels; pixels are square.
    """

    position: tuple[float, float, float]
    vertical_field_of_view: float
    shape: tuple[int, int]

    def __post_init__(self) -> None:
        _check_shape(self.shape)
        if not 0 < self.vertical_field_of_view < 180:
            raise ArgumentError(
                "vertical_field_of_view must lie between 0 and 180 degrees, "
                f"got {self.vertical_field_of_view}"
            )

    @property
    def center(self) -> tuple[float, float, float]:
        """Where rays start, and from where depth is measured along -z."""
        return self.position

    def rays(
        self, supersampling: int = 1
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
        """Return origins and unit directions, ordered as in `pixel_grid`.

        Parameters
        ----------
        supersampling
            Samples along each side of a pixel.

        Returns
        -------
        tuple of numpy.ndarray
            Origins, in the mesh's unit of length, and unit directions; each of shape (n, 3),
            float64.
        """
        x, y = pixel_grid(self.shape, supersampling)
        scale = 2 * np.tan(np.radians(self.vertical_field_of_view) / 2) / self.shape[0]
        directions = np.stack([scale * x, scale * y, np.full_like(x, -1.0)], axis=-1)
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        return np.broadcast_to(np.asarray(self.position, float), directions.shape), directions

    def towards(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Return the unit directions from points to the camera.

        Parameters
        ----------
        points
            Positions in the mesh's unit of length, shape (n, 3).

        Returns
        -------
        numpy.ndarray
            Unit vectors, shape (n, 3).
        """
        offset = np.asarray(self.position) - points
        return offset / np.linalg.norm(offset, axis=-1, keepdims=True)

    def pixel_sizes(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        """Return the side of a pixel at points, in the mesh's unit of length.

        Parameters
        ----------
        points
            Positions in the mesh's unit of length, shape (n, 3).

        Returns
        -------
        numpy.ndarray
            Lengths, shape (n,).
        """
        scale = 2 * np.tan(np.radians(self.vertical_field_of_view) / 2) / self.shape[0]
        return scale * (self.position[2] - points[:, 2])


Camera = OrthographicCamera | PerspectiveCamera


def pixel_grid(
    shape: tuple[int, int], supersampling: int
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Return x (right) and y (up) of every sample, in pixels from the centre of the image.

    Pixels are ordered row by row, and the n x n samples of a pixel, at the centres of its
    sub-pixels, follow one another.
    """
    rows, columns = shape
    within = (np.arange(supersampling) + 0.5) / supersampling
    x = (np.arange(columns)[:, None] + within - columns / 2)[None, :, None, :]
    y = (rows / 2 - np.arange(rows)[:, None] - within)[:, None, :, None]
    return tuple(axis.ravel() for axis in np.broadcast_arrays(x, y))  # type: ignore[return-value]


def frame_orthographic(mesh: Mesh, shape: int | tuple[int, int]) -> OrthographicCamera:
    """Return the frontal orthographic camera that shows the whole mesh, centred.

    This is the frame of enrolment and recognition: the centre of the mesh's bounding box is the
    centre of the picture, and the larger of its height and width (each against the picture's
    own) fills 1 / 1.05 of the picture; for a head that is its height.

    Parameters
    ----------
    mesh
        What to show.
    shape
        Rows and columns of the picture, or one number for a square.

    Returns
    -------
    OrthographicCamera
        Its picture's height is 1.05 times what the mesh needs.
    """
    rows, columns = shape if isinstance(shape, tuple) else (shape, shape)
    return frame_box(mesh.bounds, (rows, columns))


def frame_box(bounds: Float[np.ndarray, "2 3"], shape: tuple[int, int]) -> OrthographicCamera:
    """Return the camera of `frame_orthographic` for least and greatest coordinates."""
    rows, columns = shape
    _check_shape(shape)
    low, high = bounds
    middle = (low + high) / 2
    width, height, thickness = high - low
    span = FRAME_MARGIN * max(height, width * rows / columns)
    if span == 0:
        raise ArgumentError("mesh must have an extent across the view, got none")
    front = high[2] + max(thickness, span)
    return OrthographicCamera(
        (float(middle[0]), float(middle[1]), float(front)), float(span), (rows, columns)
    )


def frame_perspective(
    mesh: Mesh, shape: int | tuple[int, int], vertical_field_of_view: float = 30.0
) -> PerspectiveCamera:
    """Return the frontal perspective camera that shows the whole mesh, centred.

    The bounding box's front face fills the picture as in `frame_orthographic`, so nothing behind
    it can leave the picture.

    Parameters
    ----------
    mesh
        What to show.
    shape
        Rows and columns of the picture, or one number for a square.
    vertical_field_of_view
        Degrees.

    Returns
    -------
    PerspectiveCamera
        Looking along -z.
    """
    flat = frame_orthographic(mesh, shape)
    distance = flat.height / 2 / np.tan(np.radians(vertical_field_of_view) / 2)
    x, y, _ = flat.center
    return PerspectiveCamera(
        (x, y, float(mesh.bounds[1, 2] + distance)), vertical_field_of_view, flat.shape
    )


def _check_shape(shape: tuple[int, int]) -> None:
    for name, value in zip(("rows", "columns"), shape, strict=True):
        checks.positive_integer(f"{name} of shape", value)
