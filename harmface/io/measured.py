"""Tables of what was measured at a few pixels or of a few lamps, for stereo under unknown light."""

from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from harmface.errors import FileError
from harmface.io.tables import read_table


def read_measured_normals(path: Path | str, shape: tuple[int, int]) -> Float[np.ndarray, "H W 3"]:
    """Read normals that were measured at a few pixels.

    Parameters
    ----------
    path
        Table with a line a pixel: its column and row, both from 0 at the top left, and x, y, z of
        its normal, of any length: x right, y up, z towards the camera.
    shape
        Rows and columns of the photographs.

    Returns
    -------
    array
        Unit normals, zero where none was measured.

    Raises
    ------
    FileError
        If the file holds anything else, or pixels outside the photographs.
    """
    numbers = read_table(path).numbers
    place, vectors = _parted(path, numbers, 2, "column row x y z of a pixel's normal")
    columns, rows = place.T
    if not ((columns < shape[1]) & (rows < shape[0])).all():
        raise FileError(f"{path}: has pixels outside photographs of {shape[1]} x {shape[0]}")
    normals = np.zeros((*shape, 3))
    normals[rows, columns] = vectors
    return normals


def read_measured_directions(path: Path | str, images: int) -> Float[np.ndarray, "F 3"]:
    """Read directions to a few of the lamps.

    Parameters
    ----------
    path
        Table with a line a lamp: the number of its photograph, from 1 in the order in which they
        are read, and x, y, z towards the lamp, of any length.
    images
        How many photographs there are.

    Returns
    -------
    array
        Unit directions, zero where none was measured.

    Raises
    ------
    FileError
        If the file holds anything else, or numbers of photographs that there are not.
    """
    numbers = read_table(path).numbers
    place, vectors = _parted(path, numbers, 1, "number x y z of a photograph's lamp")
    index = place[:, 0] - 1
    if not ((index >= 0) & (index < images)).all():
        raise FileError(f"{path}: must number photographs from 1 to {images}")
    directions = np.zeros((images, 3))
    directions[index] = vectors
    return directions


def _parted(
    path: Path | str, numbers: Float[np.ndarray, "n m"], count: int, line: str
) -> tuple[Int[np.ndarray, "n c"], Float[np.ndarray, "n 3"]]:
    """Return the whole numbers that each line begins with, and its vector made a unit one."""
    place, vectors = numbers[:, :count], numbers[:, count:]
    # Their squares may be beyond what floats hold.
    size = np.abs(vectors).max(axis=1, initial=0, keepdims=True)
    whole = (place >= 0).all() and (place < 2**31).all() and (place % 1 == 0).all()
    if vectors.shape[1] != 3 or not whole or not size.all():
        raise FileError(f"{path}: must hold lines of {line}, a vector that is not zero")
    if len(np.unique(place, axis=0)) < len(place):
        raise FileError(f"{path}: measures the same twice; leave one line of each")
    vectors = vectors / size
    return place.astype(int), vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
