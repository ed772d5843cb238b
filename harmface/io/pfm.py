"""Portable float maps (`.pfm`): raw float32, bottom row first."""

import re
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes
from harmface.io.pictures import MAX_PIXELS, check_size

_HEADER = re.compile(rb"(P[fF])\s+(\d{1,9})\s+(\d{1,9})\s+([-+0-9.eE]{1,32})\s")


def read_pfm(
    path: Path | str, *, max_pixels: int = MAX_PIXELS
) -> Float[np.ndarray, "H W *channels"]:
    """Return the values of a float map, float32, top row first: `(H, W)` or `(H, W, 3)`.

    The sign of the scale gives the byte order; its size is a unit, and is left alone.

    Parameters
    ----------
    path
        The file.
    max_pixels
        Largest picture read.

    Raises
    ------
    FileError
        If the file is missing, no float map, larger than `max_pixels`, or not as long as its
        header says.
    """
    data = read_bytes(path)
    header = _HEADER.match(data)
    if not header:
        raise FileError(f"{path}: is not a portable float map (its header is not one)")
    kind, width, height, scale = header[1], int(header[2]), int(header[3]), header[4]
    channels = 3 if kind == b"PF" else 1
    check_size(path, width, height, max_pixels)
    try:
        order = "<f4" if float(scale) < 0 else ">f4"
    except ValueError:
        raise FileError(f"{path}: its scale is not a number") from None
    expected, found = 4 * width * height * channels, len(data) - header.end()
    if expected != found:
        raise FileError(
            f"{path}: its header names {width} x {height} pixels, {expected} bytes, but {found} "
            "follow; copy or download it again"
        )
    values = np.frombuffer(data, order, offset=header.end()).astype(np.float32)
    shape = (height, width, 3) if channels == 3 else (height, width)
    return values.reshape(shape)[::-1]


def write_pfm(path: Path | str, image: Float[np.ndarray, "H W *channels"]) -> None:
    """Write `(H, W)` or `(H, W, 3)` values as a float map, float32; negative values are kept.

    Raises
    ------
    ArgumentError
        If a value is NaN or infinite, or the shape is another.
    """
    image = checks.picture("image", image)
    kind = "PF" if image.ndim == 3 else "Pf"
    header = f"{kind}\n{image.shape[1]} {image.shape[0]}\n-1.0\n".encode()
    with atomic_write(path) as file:
        file.write(header + image[::-1].astype("<f4").tobytes())
