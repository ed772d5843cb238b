"""Arrays of real numbers from MATLAB files of versions 5 to 7.

scipy reads these files too, and more of them, but ends the whole program on some damaged ones.
"""

import math
import struct
import zlib
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface.errors import FileError
from harmface.io.files import PARSE_ERRORS, excerpt, read_bytes

# Types of data elements, as the specification (MATLAB MAT-File Format) numbers them.
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8"}
_MATRIX, _COMPRESSED = 14, 15
_NUMERIC_CLASSES = range(6, 14)
_COMPLEX = 0x800
_HEADER = 128
_START = 512
"""Bytes of a variable that hold its name, unless that is longer than MATLAB has them."""


def read_matlab(path: Path | str, name: str, most: int) -> Float[np.ndarray, "..."]:
    """Return an array of real numbers of a MATLAB file, float64.

    Parameters
    ----------
    path
        The `.mat` file, of version 5, 6 or 7.
    name
        The variable; others are passed over.
    most
        Largest number of values.

    Raises
    ------
    FileError
        If the file is missing, broken, of another version, or holds no such array.
    """
    data = read_bytes(path)
    order = {b"IM": "<", b"MI": ">"}.get(data[126:_HEADER])
    if order is None or data[:19] == b"MATLAB 7.3 MAT-file":
        raise FileError(f"{path}: is no MATLAB file of version 5 to 7; save it with -v7")
    try:
        place = _HEADER
        while place < len(data):
            kind, size = struct.unpack_from(f"{order}II", data, place)
            body = data[place + 8 : place + 8 + size]
            if kind == _COMPRESSED and _name(_inflated(body, _START), order) == name:
                body = _inflated(body, 8 * most + _START)
                return _values(body[8:], order, most)
            if kind == _MATRIX and _name(bytes(8) + body[:_START], order) == name:
                return _values(body, order, most)
            place += 8 + size
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: its MATLAB array {name} is broken ({excerpt(error)})") from None
    raise FileError(f"{path}: holds no MATLAB array {name}")


def _inflated(body: bytes, most: int) -> bytes:
    return zlib.decompressobj().decompress(body, most)


def _name(start: bytes, order: str) -> str:
    """Return the name of a variable, from its first bytes after eight of its tag."""
    place = 8
    for _ in "flags", "shape":
        _, _, place = _element(start, place, order)
    return _element(start, place, order)[1].decode("latin-1")


def _values(body: bytes, order: str, most: int) -> np.ndarray:
    """Return the values of a variable."""
    _, flags, place = _element(body, 0, order)
    _, dimensions, place = _element(body, place, order)
    _, _, place = _element(body, place, order)
    (flag,) = struct.unpack_from(f"{order}I", flags)
    shape = tuple(int(side) for side in np.frombuffer(dimensions, f"{order}i4"))
    if flag & 0xFF not in _NUMERIC_CLASSES or flag & _COMPLEX:
        raise ValueError("it holds no real numbers")
    if min(shape) < 0 or math.prod(shape) > most:
        raise ValueError(f"its shape is {shape}, {most} values at most are read")
    kind, stored, _ = _element(body, place, order)
    with np.errstate(invalid="ignore"):  # numpy remarks on some NaN.
        values = np.frombuffer(stored, order + _NUMBERS[kind]).astype(np.float64)
    return values.reshape(shape, order="F")


def _element(body: bytes, place: int, order: str) -> tuple[int, bytes, int]:
    """Return type and bytes of a data element, and where the next one starts."""
    kind, size = struct.unpack_from(f"{order}II", body, place)
    if kind >> 16:
        # Up to four bytes are stored in the tag itself.
        kind, size = kind & 0xFFFF, kind >> 16
        return kind, body[place + 4 : place + 4 + min(size, 4)], place + 8
    return kind, body[place + 8 : place + 8 + size], place + 8 + -(-size // 8) * 8
