"""Where the object stands before a fixed camera in each frame of a film.

The camera and the lamps stand still; the object turns and moves. A view is known by the matrix that
projects points of the object to pixels, and by the rotation that turns the object's directions into
those of the camera, where the light is fixed.

References
----------
.. [HZ04] Hartley and Zisserman, Multiple View Geometry in Computer Vision, 2nd edition, 2004,
   sections 6.2 and 6.3.
"""

from dataclasses import dataclass
from io import BytesIO

import numpy as np
from jaxtyping import Bool, Float
from scipy.linalg import rq

from harmface import checks
from harmface.errors import ArgumentError
from harmface.summaries import summary

LEAST_MOTION = np.radians(1.0)
"""Rotation about an axis below which shading tells nothing of it."""


@dataclass(frozen=True, eq=False)
class Views:
    """Cameras as the object sees them, one a frame.

    Parameters
    ----------
    matrices
        Each takes `(x, y, z, 1)` of the object to `w (column, row, 1)`, in pixels whose centres are
        at half-integers, with `w` positive before the camera.
    rotations
        Each turns the object's directions into the camera's: x right, y up, z towards the camera.
    """

    matrices: Float[np.ndarray, "F 3 4"]
    rotations: Float[np.ndarray, "F 3 3"]

    __repr__ = summary

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.matrices)

    def __getitem__(self, chosen: Bool[np.ndarray, "F"]) -> "Views":
        """Return some of the frames."""
        return Views(self.matrices[chosen], self.rotations[chosen])

    def pixels(self, points: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "F *n 2"]:
        """Return column and row of points of the object in every frame.

        Parameters
        ----------
        points
            In the object's coordinates.

        Returns
        -------
        numpy.ndarray
            Pixels, centres at half-integers.
        """
        flat = points.reshape(-1, 3)
        seen = np.einsum("fij,nj->fni", self.matrices[:, :, :3], flat)
        seen += self.matrices[:, None, :, 3]
        return (seen[..., :2] / seen[..., 2:]).reshape(len(self), *points.shape[:-1], 2)

    def rays(
        self, frame: int, pixels: Float[np.ndarray, "n 2"]
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
        """Return where the lines of sight of pixels start, and their unit directions.

        Parameters
        ----------
        frame
            Number of the frame.
        pixels
            Columns and rows.

        Returns
        -------
        tuple of numpy.ndarray
            Points and directions in the object's coordinates, away from the camera.
        """
        matrix, offset = self.matrices[frame, :, :3], self.matrices[frame, :, 3]
        towards = -self.rotations[frame, 2]
        if np.linalg.cond(matrix) > 1e9:
            # Parallel rays: the point of each nearest to the origin, moved along the rays.
            origins = np.linalg.lstsq(matrix[:2], (pixels * offset[2] - offset[:2]).T, rcond=None)
            return origins[0].T, np.broadcast_to(towards, (len(pixels), 3))
        inverse = np.linalg.inv(matrix)
        directions = np.concatenate([pixels, np.ones((len(pixels), 1))], axis=1) @ inverse.T
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        return np.broadcast_to(-inverse @ offset, directions.shape), directions

    def towards_camera(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "F n 3"]:
        """Return the unit directions from points to the camera in each frame.

        Parameters
        ----------
        points
            In the object's coordinates.

        Returns
        -------
        numpy.ndarray
            In the object's coordinates.
        """
        found = np.empty((len(self), len(points), 3))
        for frame, (matrix, rotation) in enumerate(zip(self.matrices, self.rotations, strict=True)):
            if np.linalg.cond(matrix[:, :3]) > 1e9:
                found[frame] = rotation[2]
            else:
                found[frame] = -np.linalg.solve(matrix[:, :3], matrix[:, 3]) - points
        return found / np.linalg.norm(found, axis=-1, keepdims=True)

    def as_npy(self) -> bytes:
        """Return the matrices as the content of an NPY file.

        Returns
        -------
        bytes
            What `numpy.save` writes.
        """
        buffer = BytesIO()
        np.save(buffer, self.matrices, allow_pickle=False)
        return buffer.getvalue()

    def spread(self) -> Float[np.ndarray, "3"]:
        """Return how far the object turns about the axes that it turns about most, radians.

        Root mean squares of the rotation vectors from the mean rotation along their principal
        axes, greatest first.

        Returns
        -------
        numpy.ndarray
            Radians.
        """
        from scipy.spatial.transform import Rotation

        left, _, right = np.linalg.svd(self.rotations.sum(axis=0))
        mean = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
        turned = Rotation.from_matrix(self.rotations @ mean.T).as_rotvec()
        return np.linalg.svd(turned - turned.mean(axis=0), compute_uv=False) / np.sqrt(len(turned))

    def axes(self) -> int:
        """Return about how many independent axes the object turns.

        Returns
        -------
        int
            0, 1, 2 or 3.
        """
        return int((self.spread() > LEAST_MOTION).sum())


def views_from_poses(
    rotations: Float[np.ndarray, "F 3 3"],
    places: Float[np.ndarray, "_ 2"],
    scales: Float[np.ndarray, "_"],
) -> Views:
    """Return the views of an object that is seen from far away.

    Parameters
    ----------
    rotations
        Rotation of the object in each frame: x right, y up, z towards the camera.
    places
        Column and row where the object's origin is seen.
    scales
        Pixels to a unit of length of the object.

    Returns
    -------
    Views
        Of parallel rays.

    Raises
    ------
    ArgumentError
        If a rotation is none, a scale is not positive, or the numbers of frames differ.
    """
    rotations = np.stack([checks.rotation("rotations", each) for each in rotations])
    places, scales = checks.finite("places", places), checks.finite("scales", scales)
    if places.shape != (len(rotations), 2) or scales.shape != (len(rotations),):
        raise ArgumentError(
            f"rotations, places and scales must be of as many frames, got {len(rotations)}, "
            f"{len(places)} and {len(scales)}"
        )
    if not (scales > 0).all():
        raise ArgumentError(f"scales must be positive, got {scales.min():.4g}")
    matrices = np.zeros((len(rotations), 3, 4))
    matrices[:, 0, :3] = scales[:, None] * rotations[:, 0]
    matrices[:, 1, :3] = -scales[:, None] * rotations[:, 1]
    matrices[:, :2, 3], matrices[:, 2, 3] = places, 1
    return Views(matrices, rotations)


def views_from_cameras(matrices: Float[np.ndarray, "..."]) -> tuple[Views, bool]:
    """Return the views of camera matrices, each the projection of the object in one frame.

    A matrix is `K [R | t]` up to a factor ([HZ04]_ 6.2.4), or one of parallel rays. The origin of
    the object is taken to lie before the cameras, which fixes the sign. If the object's coordinates
    are left-handed their z axis is turned over.

    Parameters
    ----------
    matrices
        From `(x, y, z, 1)` to `w (column, row, 1)`, rows counted downwards.

    Returns
    -------
    tuple of Views and bool
        And whether the z axis was turned over.

    Raises
    ------
    ArgumentError
        If the shape is another, a value is not finite, or a matrix is no camera.
    """
    matrices = checks.finite("cameras", matrices).astype(np.float64)
    if matrices.ndim != 3 or matrices.shape[1:] != (3, 4):
        raise ArgumentError(f"cameras must have shape (frames, 3, 4), got {matrices.shape}")
    if not matrices[:, 2, 3].all():
        raise ArgumentError("cameras must see the object's origin before them")
    if not matrices[:, 2, :3].any():
        return _affine(matrices / matrices[:, 2:, 3:]), False
    if (np.linalg.matrix_rank(matrices[:, :, :3]) < 3).any():
        raise ArgumentError("cameras must be of rank 3, or have third rows (0, 0, 0, 1)")
    matrices = matrices / np.linalg.norm(matrices[:, 2, :3], axis=1)[:, None, None]
    matrices *= np.sign(matrices[:, 2, 3])[:, None, None]
    mirrored = np.linalg.det(matrices[:, :, :3]) < 0
    if mirrored.any() != mirrored.all():
        raise ArgumentError("cameras must all be of one handedness; some are mirrored")
    if mirrored.all():
        matrices = matrices * np.array([1.0, 1, -1, 1])
    rotations = np.empty((len(matrices), 3, 3))
    for frame, matrix in enumerate(matrices[:, :, :3]):
        scale, rotation = rq(matrix)
        # From x right, y down, z away to x right, y up, z towards the camera.
        rotations[frame] = (np.sign(np.diag(scale))[:, None] * rotation) * [[1], [-1], [-1]]
    return Views(matrices, rotations), bool(mirrored.all())


def _affine(matrices: Float[np.ndarray, "F 3 4"]) -> Views:
    """Return the views of cameras of parallel rays, by the rotations nearest to their rows."""
    across = matrices[:, :2, :3] * [[1], [-1]]
    if (np.linalg.matrix_rank(across) < 2).any():
        raise ArgumentError("cameras of parallel rays must be of rank 2; check their first rows")
    left, _, right = np.linalg.svd(across, full_matrices=False)
    rotations = np.empty((len(matrices), 3, 3))
    rotations[:, :2] = left @ right
    rotations[:, 2] = np.cross(rotations[:, 0], rotations[:, 1])
    return Views(matrices, rotations)
