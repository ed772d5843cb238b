"""Tables of how an object stands in each frame of a film."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from harmface.errors import FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import PARSE_ERRORS, excerpt, read_bytes
from harmface.io.tables import npy_array, read_table
from harmface.moving import Views, views_from_cameras, views_from_poses

COLUMNS = ("turn_x", "turn_y", "turn_z", "column", "row", "scale")
"""Rotation vector in degrees, pixel where the object's origin is seen, pixels to a unit."""


def write_poses(path: Path | str, views: Views, names: list[str]) -> None:
    """Write the poses of an object that is seen by parallel rays, a line a frame.

    Parameters
    ----------
    path
        The CSV file to make or replace.
    views
        Of parallel rays.
    names
        Of the frames.
    """
    turns = Rotation.from_matrix(views.rotations).as_rotvec(degrees=True)
    places = views.matrices[:, :2, 3]
    scales = np.linalg.norm(views.matrices[:, 0, :3], axis=1)
    lines = [",".join(["frame", *COLUMNS])]
    for name, *numbers in zip(names, *turns.T, *places.T, scales, strict=True):
        lines.append(",".join([name, *(f"{number:.9g}" for number in numbers)]))
    with atomic_write(path) as file:
        file.write("\n".join(lines).encode() + b"\n")


def read_poses(path: Path | str, frames: int) -> Views:
    """Read a table that `write_poses` wrote, or another with the same columns.

    Parameters
    ----------
    path
        CSV file: turn_x, turn_y, turn_z (rotation vector in degrees; x right, y up, z towards the
        camera), column, row (where the object's origin is seen), scale (pixels to a unit).
    frames
        How many there must be.

    Returns
    -------
    Views
        Of parallel rays.

    Raises
    ------
    FileError
        If the file is missing, has other columns or another number of lines.
    """
    numbers = read_table(path).numbers
    if numbers.shape[1] != len(COLUMNS):
        raise FileError(
            f"{path}: must have the columns {', '.join(COLUMNS)}, got {numbers.shape[1]} columns"
        )
    _check_count(path, len(numbers), frames)
    turns = Rotation.from_rotvec(numbers[:, :3], degrees=True).as_matrix()
    try:
        return views_from_poses(turns, numbers[:, 3:5], numbers[:, 5])
    except ValueError as error:
        raise FileError(f"{path}: {error}") from None


def read_cameras(path: Path | str, frames: int) -> tuple[Views, bool]:
    """Read camera matrices, see `views_from_cameras`.

    Parameters
    ----------
    path
        An `.npy` file of shape (frames, 3, 4).
    frames
        How many there must be.

    Returns
    -------
    tuple of Views and bool
        And whether the object's z axis was turned over.

    Raises
    ------
    FileError
        If the file is missing, damaged, of another shape or another number of cameras.
    """
    try:
        matrices = npy_array(read_bytes(path))
        views = views_from_cameras(matrices)
    except FileError:
        raise
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: holds no cameras ({excerpt(error)})") from None
    _check_count(path, len(matrices), frames)
    return views


def _check_count(path: Path | str, count: int, frames: int) -> None:
    if count != frames:
        raise FileError(f"{path}: tells of {count} frames, the film has {frames}; give one a frame")
