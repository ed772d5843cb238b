"""Text files of light directions and intensities, as photometric stereo sets have them."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.files import read_bytes

UNEQUAL = 0.01
"""Relative spread of the directions' lengths from which they seem to mean something."""


@dataclass(frozen=True, eq=False)
class Lights:
    """One distant light for each image.

    Parameters
    ----------
    directions
        Unit vectors from the object to the light.
    intensities
        Of each light, if the file gave them.
    notes
        What to know of how the file was read.
    """

    directions: Float[np.ndarray, "F 3"]
    intensities: Float[np.ndarray, "F"] | None
    notes: tuple[str, ...] = ()


def read_lights(path: Path | str, count: int) -> Lights:
    """Read light directions: x y z a line, one line for each image in its order.

    Directions point from the object to the light, x right, y up, z towards the camera, and are
    brought to unit length: how strong a light is a fourth number of its line says. Numbers may be
    parted by commas; a comment starts with `#` or `%`; a first line of one number is the number
    of lines. A table of three (or four) rows and a column for each image is read as its transpose.

    Parameters
    ----------
    path
        The text file.
    count
        How many images there are.

    Raises
    ------
    FileError
        If the file is no such text, the number of lines is not `count`, a direction is zero, an
        intensity is not positive, or no light is in front of the object.
    """
    table = read_table(path)
    if table.shape[1] == count and table.shape[0] in (3, 4) and table.shape[1] not in (3, 4):
        table = table.T
    if len(table) != count or table.shape[1] not in (3, 4):
        raise FileError(
            f"{path}: holds {table.shape[0]} lines of {table.shape[1]} numbers, but {count} images "
            "need a line each: x y z, and the intensity if it is known"
        )
    lengths = np.linalg.norm(table[:, :3], axis=1)
    if not lengths.all():
        raise FileError(f"{path}: holds a direction of length zero; give x y z to every light")
    if (table[:, 2] <= 0).all():
        raise FileError(
            f"{path}: puts every light behind the object (z <= 0), but directions go from the "
            "object to the light, x right, y up, z towards the camera; negate z, or all three "
            "numbers if they go from the light to the object"
        )
    intensities = table[:, 3] if table.shape[1] == 4 else None
    if intensities is not None and not (intensities > 0).all():
        raise FileError(f"{path}: holds an intensity that is not positive; leave out that image")
    notes = []
    if np.ptp(lengths) > UNEQUAL * lengths.max():
        notes.append(
            f"{Path(path).name}: directions have lengths of {lengths.min():.3g} to "
            f"{lengths.max():.3g}, which are not used; give intensities as a fourth number"
        )
    return Lights(table[:, :3] / lengths[:, None], intensities, tuple(notes))


def read_table(path: Path | str) -> Float[np.ndarray, "rows columns"]:
    """Read a table of numbers: see `read_lights` for what its text may hold.

    Raises
    ------
    FileError
        If the file holds anything but numbers, lines of unlike length, or fewer or more lines
        than its first one promises.
    """
    text = read_bytes(path).decode("utf-8-sig", "replace")
    lines = [re.split(r"[#%]", line)[0].replace(",", " ").split() for line in text.splitlines()]
    lines = [line for line in lines if line]
    if len(lines) > 1 and len(lines[0]) == 1 < len(lines[1]):
        promised = lines.pop(0)[0]
        if promised != str(len(lines)):
            raise FileError(
                f"{path}: its first line promises {promised[:20]} lines, {len(lines)} follow"
            )
    try:
        return checks.finite("values", np.array(lines, dtype=float, ndmin=2))
    except (ArgumentError, ValueError) as error:
        raise FileError(f"{path}: is not a table of numbers ({error})") from None
