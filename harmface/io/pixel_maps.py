"""Arrays that hold something of every pixel of a photograph: its normal, its albedo."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.files import PARSE_ERRORS, excerpt, read_bytes
from harmface.io.images import read_image
from harmface.io.pictures import MAX_PIXELS, read_picture
from harmface.io.tables import npy_array

CODE = 0.01
"""Departure from unit length of normals in 8 bits, whose three codes are half a step off each."""


def read_normal_map(path: Path | str) -> Float[np.ndarray, "H W 3"]:
    """Read normals: `.npy`, rows x columns x 3, or a picture whose codes are `(n + 1) / 2`.

    Zero vectors, or pixels of a picture that are black or transparent, are background.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    numpy.ndarray
        Unit normals, shape (H, W, 3), zero vectors in the background.

    Raises
    ------
    FileError
        If it is no such file, or a normal is not of unit length.
    """
    if Path(path).suffix.lower() == ".npy":
        normals = read_pixel_array(path)
    else:
        picture = read_picture(path)
        # Components are no light: what the file says of its encoding is about the screen.
        normals = picture.values(False)
        if normals.ndim == 3:
            background = ~normals.any(axis=-1)
            if picture.opacity is not None:
                background |= picture.opacity == 0
            normals = 2 * normals - 1
            normals[background] = 0
    if normals.ndim != 3 or normals.shape[-1] != 3:
        raise FileError(
            f"{path}: must hold three components for every pixel, (rows, columns, 3), "
            f"got shape {normals.shape}"
        )
    # What is longer than 2 is wrong, and its square may be more than a float holds.
    length = np.linalg.norm(np.clip(normals, -2, 2), axis=-1)
    seen = length > 0
    wrong = seen & (np.abs(length - 1) > 2 * CODE)
    if not seen.any() or wrong.any():
        told = "none is there" if not seen.any() else f"{wrong.sum()} of {seen.sum()} are not"
        raise FileError(
            f"{path}: normals must be of unit length, {told}; divide each by its length, and leave "
            "zeros in the background"
        )
    return np.divide(normals, length[..., None], out=np.zeros_like(normals), where=seen[..., None])


def read_albedo_map(path: Path | str) -> Float[np.ndarray, "H W *channels"]:
    """Read albedo: `.npy`, rows x columns, or with three channels last; or a linear picture.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    numpy.ndarray
        Shape (H, W) or (H, W, 3), linear, at least 0.

    Raises
    ------
    FileError
        If it is no such file, or a value is negative.
    """
    if Path(path).suffix.lower() != ".npy":
        return read_image(path)
    albedo = read_pixel_array(path)
    try:
        return checks.non_negative("albedo", checks.picture("albedo", albedo))
    except ArgumentError as error:
        raise FileError(f"{path}: {error}") from None


def read_pixel_array(path: Path | str) -> Float[np.ndarray, "..."]:
    """Read a `.npy` file of finite real numbers, in double precision.

    Raises
    ------
    FileError
        If it is no such file, larger than a picture may be, or holds NaN or infinity.
    """
    try:
        found = npy_array(read_bytes(path, 8 * 3 * MAX_PIXELS + 2**16)).astype(np.float64)
        return checks.finite("values", found)
    except FileError:
        raise
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: holds no array of real numbers ({excerpt(error)})") from None
