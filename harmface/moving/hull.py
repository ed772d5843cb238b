"""The visual hull: all points that no silhouette leaves out.

References
----------
.. [L94] Laurentini, The Visual Hull Concept for Silhouette-Based Image Understanding, PAMI 1994.
"""

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import distance_transform_edt
from skimage.measure import marching_cubes

from harmface.errors import ArgumentError
from harmface.geometry import Mesh, vertex_normals
from harmface.moving.views import Views

COARSE = 40
"""Cells along each side of the box in which the object is looked for."""

ROW = 2**10
"""Length of the rows in which points are looked up: OpenCV takes no picture wider than 2^15."""

PIECE = 2**17
"""Points looked at a time: 25 MB for 100 frames."""


def looked_up(
    pictures: Float[np.ndarray, "F H W"], pixels: Float[np.ndarray, "F n 2"]
) -> Float[np.ndarray, "F n"]:
    """Return values of pictures between pixel centres, bilinear; beyond an edge, the edge's.

    Parameters
    ----------
    pictures
        One a frame, float32.
    pixels
        Columns and rows, centres at half-integers.

    Returns
    -------
    numpy.ndarray
        Values, float32.
    """
    count = pixels.shape[1]
    padded = -(-count // ROW) * ROW
    places = np.zeros((len(pictures), padded, 2), np.float32)
    places[:, :count] = pixels - 0.5
    places = places.reshape(len(pictures), -1, ROW, 2)
    found = np.empty((len(pictures), padded), np.float32)
    for picture, place, values in zip(pictures, places, found, strict=True):
        values[:] = cv2.remap(
            picture, place, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        ).ravel()
    return found[:, :count]


class VisualHull:
    """The visual hull as a field on a grid of voxels.

    Parameters
    ----------
    masks
        Silhouettes.
    views
        Of as many frames.
    cells
        Voxels along the longest side.

    Raises
    ------
    ArgumentError
        If the silhouettes have no point in common.
    """

    def __init__(self, masks: Bool[np.ndarray, "F H W"], views: Views, cells: int) -> None:
        self.views = views
        self._inside = np.stack([_signed_distance(mask) for mask in masks])
        center, radius = _place(masks, views)
        box = np.stack([center - radius, center + radius])
        field, self._low, self._step = self._field(box, COARSE)
        # A voxel beside the surface is in it by less than its own size.
        near = np.argwhere(field > -self.pixels_across(center) * self._step)
        if len(near) == 0:
            raise ArgumentError(
                "masks have no point in common under these poses or cameras; check that they "
                "belong to the frames, and how the cameras count rows and columns"
            )
        box = self._low + self._step * np.stack([near.min(axis=0) - 1, near.max(axis=0) + 1])
        self.field, self._low, self._step = self._field(box, cells)
        if not (self.field > 0).any():
            raise ArgumentError("masks have no volume in common; check the poses or cameras")

    def pixels_across(self, point: Float[np.ndarray, "3"]) -> float:
        """Return how many pixels a unit of length has at a point, at most, over all frames."""
        steps = np.concatenate([point[None], point + 1e-3 * self.views.rotations[:, 0]])
        seen = self.views.pixels(steps)
        return float(np.linalg.norm(seen[:, 1:] - seen[:, :1], axis=-1).max() / 1e-3)

    def distances(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        """Return how deep points lie inside all silhouettes, in pixels; negative outside.

        Parameters
        ----------
        points
            In the object's coordinates.

        Returns
        -------
        numpy.ndarray
            Pixels.
        """
        found = np.empty(len(points))
        for first in range(0, len(points), PIECE):
            some = slice(first, first + PIECE)
            found[some] = looked_up(self._inside, self.views.pixels(points[some])).min(axis=0)
        return found

    def mesh(self) -> Mesh:
        """Return its surface.

        Returns
        -------
        Mesh
            White.
        """
        return self.surface(self.field)

    @property
    def points(self) -> Float[np.ndarray, "n 3"]:
        """The centres of all voxels, in the order of the field."""
        indices = np.indices(self.field.shape).reshape(3, -1).T
        return self._low + self._step * indices

    @property
    def step(self) -> float:
        """Side of a voxel."""
        return float(self._step)

    def surface(self, field: Float[np.ndarray, "x y z"]) -> Mesh:
        """Return where a field on this grid, positive inside, is zero.

        Parameters
        ----------
        field
            Of the grid's shape.

        Returns
        -------
        Mesh
            White.
        """
        closed = np.pad(field, 1, constant_values=min(float(field.min()), -1e-6))
        vertices, faces, _, _ = marching_cubes(closed, 0.0, gradient_direction="ascent")
        vertices = self._low + self._step * (vertices.astype(np.float64) - 1)
        faces = faces.astype(np.int64)
        return Mesh(vertices, faces, vertex_normals(vertices, faces), np.ones_like(vertices))

    def _field(
        self, box: Float[np.ndarray, "2 3"], cells: int
    ) -> tuple[Float[np.ndarray, "x y z"], Float[np.ndarray, "3"], float]:
        step = float((box[1] - box[0]).max() / cells)
        shape = np.ceil((box[1] - box[0]) / step).astype(int) + 1
        points = box[0] + step * np.indices(shape).reshape(3, -1).T
        return self.distances(points).reshape(shape), box[0], step


def _signed_distance(mask: Bool[np.ndarray, "H W"]) -> Float[np.ndarray, "H W"]:
    """Return the distance to the silhouette's edge in pixels, positive inside."""
    return (distance_transform_edt(mask) - distance_transform_edt(~mask)).astype(np.float32)


def _place(masks: Bool[np.ndarray, "F H W"], views: Views) -> tuple[Float[np.ndarray, "3"], float]:
    """Return the point nearest to the rays through the silhouettes' middles, and a safe radius."""
    normal, right, widest = np.zeros((3, 3)), np.zeros(3), 0.0
    for frame, mask in enumerate(masks):
        rows, columns = np.nonzero(mask)
        middle = np.array([columns.mean() + 0.5, rows.mean() + 0.5])
        origin, direction = (each[0] for each in views.rays(frame, middle[None]))
        across = np.eye(3) - np.outer(direction, direction)
        normal += across
        right += across @ origin
        widest = max(widest, float(np.hypot(np.ptp(rows), np.ptp(columns))) + 1)
    # Without motion depth is free: the point nearest to the origin.
    center = np.linalg.lstsq(normal, right, rcond=1e-6)[0]
    seen = views.pixels(np.concatenate([center[None], center + 1e-3 * views.rotations[:, 0]]))
    each = np.arange(len(views))
    across = np.linalg.norm(seen[each, 1 + each] - seen[each, 0], axis=1) / 1e-3
    return center, float(widest / across.min())
