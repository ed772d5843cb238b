"""The cube: six square faces +x -x +y -y +z -z, each seen from inside, as OpenEXR turns them.

=====  =====  =====
face   right  up
=====  =====  =====
+x     +z     +y
-x     -z     +y
+y     +x     +z
-y     +x     -z
+z     -x     +y
-z     +x     +y
=====  =====  =====
"""

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError
from harmface.light.layouts.layout import ALL, Layout

FACES = ("+x", "-x", "+y", "-y", "+z", "-z")
"""The faces in the order of the array's first pixel axis."""

_FORWARD = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
_UP = np.array([[0, 1, 0], [0, 1, 0], [0, 0, 1], [0, 0, -1], [0, 1, 0], [0, 1, 0]], float)
_RIGHT = np.cross(_FORWARD, _UP)

FACE_ROTATIONS: Float[np.ndarray, "6 3 3"] = np.stack([_RIGHT, _UP, -_FORWARD], axis=-1)
"""For each face the rotation that carries the face -z, unturned, onto it."""


class Cube(Layout):
    """The cube map; its height is the side of a face."""

    name = "cube"

    def shape(self, height: int) -> tuple[int, ...]:
        """Return the shape of the pixel axes, see `Layout`."""
        return 6, height, height

    def height_of(self, shape: tuple[int, ...]) -> int:
        """Return the height of a map of this shape, or refuse it, see `Layout`."""
        if len(shape) != 3 or shape[0] != 6 or shape[1] != shape[2] or shape[1] == 0:
            raise ArgumentError(
                f"a cube map has six square faces of one size, got pixel axes of shape {shape}; "
                "cut a cross or strip into its faces first"
            )
        return shape[1]

    def directions_at(
        self, *position: Float[np.ndarray, "..."], height: int
    ) -> Float[np.ndarray, "... 3"]:
        """Return the direction that each position looks at, see `Layout`."""
        faces, rows, columns = position
        faces = np.asarray(faces, dtype=np.intp)
        u = (2 * columns / height - 1)[..., None]
        v = (1 - 2 * rows / height)[..., None]
        towards = _FORWARD[faces] + u * _RIGHT[faces] + v * _UP[faces]
        return towards / np.linalg.norm(towards, axis=-1, keepdims=True)

    def positions_of(
        self, directions: Float[np.ndarray, "... 3"], height: int
    ) -> tuple[Float[np.ndarray, "..."], ...]:
        """Return the position of each direction, see `Layout`."""
        largest = np.abs(directions).argmax(axis=-1)
        along = np.take_along_axis(directions, largest[..., None], axis=-1)[..., 0]
        faces = 2 * largest + (along < 0)
        depth = np.abs(along)
        u = np.einsum("...i,...i->...", directions, _RIGHT[faces]) / depth
        v = np.einsum("...i,...i->...", directions, _UP[faces]) / depth
        return faces.astype(float), height * (1 - v) / 2, height * (1 + u) / 2

    def solid_angles(self, height: int, rows: slice = ALL) -> Float[np.ndarray, "*pixels"]:
        """Return exact solid angles, see `Layout`."""
        # A rectangle from the face's centre to (u, v) subtends atan(u v / sqrt(1 + u^2 + v^2)).
        edges = np.linspace(-1, 1, height + 1)
        some = range(height)[rows]
        u, v = edges, edges[some.start : some.stop + 1, None]
        corner = np.arctan2(u * v, np.sqrt(1 + u**2 + v**2))
        face = np.diff(np.diff(corner, axis=0), axis=1)
        return np.broadcast_to(face, (6, *face.shape))
