"""Six faces in one image: strips and crosses.

A strip holds the faces of `harmface.light.layouts.cube` in their order, from the top or from the
left. The crosses are the cube unfolded, seen from inside, with -z in the middle, where our camera
looks::

    horizontal cross      vertical cross

          +y                   +y
       -x -z +x +z          -x -z +x
          -y                   -y
                               +z (upside down)
"""

import numpy as np
from jaxtyping import Shaped

from harmface.errors import ArgumentError

# For each face in the order +x -x +y -y +z -z, the row and the column of its cell.
_CELLS = {
    "vertical-strip": ((0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (5, 0)),
    "horizontal-strip": ((0, 0), (0, 1), (0, 2), (0, 3), (0, 4), (0, 5)),
    "horizontal-cross": ((1, 2), (1, 0), (0, 1), (2, 1), (1, 3), (1, 1)),
    "vertical-cross": ((1, 2), (1, 0), (0, 1), (2, 1), (3, 1), (1, 1)),
}
_UPSIDE_DOWN = {"vertical-cross": 4}

ARRANGEMENTS = tuple(_CELLS)
"""The names of the arrangements; no two have the same ratio of sides."""


def arrangement_of(shape: tuple[int, ...]) -> str:
    """Return the name of the arrangement that an image of this height and width has.

    Raises
    ------
    ArgumentError
        If six square faces of one size do not fit.
    """
    for name in ARRANGEMENTS:
        rows, columns = _grid(name)
        if shape[0] > 0 and shape[0] % rows == 0 and shape[0] // rows * columns == shape[1]:
            return name
    raise ArgumentError(
        f"an image of {shape[1]} x {shape[0]} pixels is neither a cross (4:3 or 3:4) nor a strip "
        "(1:6 or 6:1) of six square faces of one size; name its layout or crop it"
    )


def faces_from_image(image: Shaped[np.ndarray, "..."]) -> Shaped[np.ndarray, "..."]:
    """Cut a cross or strip `(H, W)` or `(H, W, C)` into faces `(6, N, N)` or `(6, N, N, C)`.

    The arrangement follows from the ratio of the sides; the empty cells of a cross are not read.

    Parameters
    ----------
    image
        Shape (H, W) or (H, W, C), any dtype.

    Returns
    -------
    numpy.ndarray
        Faces +x -x +y -y +z -z, seen from inside.
    """
    name = arrangement_of(image.shape)
    side = image.shape[0] // _grid(name)[0]
    faces = np.stack([image[_cell(cell, side)] for cell in _CELLS[name]])
    if name in _UPSIDE_DOWN:
        turned = _UPSIDE_DOWN[name]
        faces[turned] = faces[turned, ::-1, ::-1].copy()
    return faces


def image_from_faces(
    faces: Shaped[np.ndarray, "6 N N *channels"], arrangement: str = "vertical-strip"
) -> Shaped[np.ndarray, "..."]:
    """Lay faces out in one image, the inverse of `faces_from_image`; empty cells are 0.

    Parameters
    ----------
    faces
        Faces +x -x +y -y +z -z, shape (6, N, N) or (6, N, N, C).
    arrangement
        One of `ARRANGEMENTS`.

    Returns
    -------
    numpy.ndarray
        Shape (H, W) or (H, W, C), in the dtype of `faces`.

    Raises
    ------
    ArgumentError
        If there is no such arrangement.
    """
    if arrangement not in _CELLS:
        raise ArgumentError(
            f"arrangement must be one of {', '.join(ARRANGEMENTS)}, got {arrangement!r}"
        )
    side = faces.shape[1]
    rows, columns = _grid(arrangement)
    image = np.zeros((rows * side, columns * side, *faces.shape[3:]), faces.dtype)
    for number, (face, cell) in enumerate(zip(faces, _CELLS[arrangement], strict=True)):
        upside_down = _UPSIDE_DOWN.get(arrangement) == number
        image[_cell(cell, side)] = face[::-1, ::-1] if upside_down else face
    return image


def faces_from_opengl(
    faces: Shaped[np.ndarray, "6 N N *channels"],
) -> Shaped[np.ndarray, "6 N N *channels"]:
    """Turn faces as OpenGL samples them, rows from the top, into ours; it is its own inverse.

    OpenGL's faces have +y up as ours do, but -z -> right on +x, +z on -x, +x on +z, -x on -z,
    and -z up on +y, +z on -y (OpenGL 4.6 core, table 8.19): the mirror images of ours, left for
    right on the four sides and top for bottom on +y and -y.

    Parameters
    ----------
    faces
        Faces in OpenGL's order, shape (6, N, N) or (6, N, N, C).

    Returns
    -------
    numpy.ndarray
        In the same shape and dtype.
    """
    ours = faces[:, :, ::-1].copy()
    ours[2:4] = faces[2:4, ::-1]
    return ours


def opengl_order_of_cross(
    faces: Shaped[np.ndarray, "6 N N *channels"],
) -> Shaped[np.ndarray, "6 N N *channels"]:
    """Reorder faces cut from a cross as OpenGL names them: its +z is the middle, ours -z."""
    return faces[[0, 1, 2, 3, 5, 4]]


def _grid(arrangement: str) -> tuple[int, int]:
    """Return how many rows and columns of cells there are."""
    rows, columns = zip(*_CELLS[arrangement], strict=True)
    return max(rows) + 1, max(columns) + 1


def _cell(cell: tuple[int, int], side: int) -> tuple[slice, slice]:
    row, column = cell
    return slice(row * side, (row + 1) * side), slice(column * side, (column + 1) * side)
