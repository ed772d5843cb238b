"""Measured isotropic reflectance in the format of the MERL database.

Three 32-bit whole numbers, 90, 90 and 180, and then red, green and blue tables of doubles, little
endian, over the angles of `reflectance.Tabulated`.

References
----------
.. [MPBM03] Matusik, Pfister, Brand and McMillan, A Data-Driven Reflectance Model, SIGGRAPH 2003.
"""

from pathlib import Path

import numpy as np

from harmface.errors import FileError
from harmface.io.files import check_regular, read_bytes
from harmface.reflectance import Tabulated

SHAPE = (90, 90, 180)
SCALES = (1 / 1500, 1.15 / 1500, 1.66 / 1500)
"""Of red, green and blue, as the database's own reader has them."""

SIZE = 12 + 3 * 8 * SHAPE[0] * SHAPE[1] * SHAPE[2]


def read_merl(path: Path | str) -> Tabulated:
    """Read a measured material.

    Entries below zero mark what was not measured; they are masked, and `Tabulated.missing` counts
    them.

    Parameters
    ----------
    path
        A file of the MERL format, 34,992,012 bytes.

    Returns
    -------
    Tabulated
        In three channels, red, green and blue, float64.

    Raises
    ------
    FileError
        If the file has another size or other dimensions, holds a value that is not finite, or
        nothing that was measured.
    """
    size = check_regular(path)
    if size != SIZE:
        raise FileError(
            f"{path}: is {size} bytes long, a MERL table of 90 x 90 x 180 in colour has {SIZE}"
        )
    data = read_bytes(path, SIZE)
    dimensions = tuple(int(n) for n in np.frombuffer(data, "<i4", 3))
    if dimensions != SHAPE:
        raise FileError(f"{path}: says {dimensions} in its header, a MERL table has {SHAPE}")
    raw = np.frombuffer(data, "<f8", offset=12).reshape(3, *SHAPE)
    if not np.isfinite(raw).all():
        bad = int((~np.isfinite(raw)).sum())
        raise FileError(f"{path}: holds NaN or infinity in {bad} of {raw.size} values")
    measured = np.asarray((raw >= 0).all(axis=0))
    if not measured.any():
        raise FileError(f"{path}: holds no measurement, only the marks of missing ones")
    return Tabulated(np.maximum(raw, 0) * np.reshape(SCALES, (3, 1, 1, 1)), measured)
