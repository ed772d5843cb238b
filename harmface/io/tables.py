"""Tables of numbers in text, as spreadsheets, cameras and other programs write them."""

import io
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.files import PARSE_ERRORS, excerpt, is_number, read_bytes

MAX_TABLE = 2**20
"""Longest table read: 1 MiB, some ten thousand lines."""

_LONGEST_HEADER = 10_000
"""Bytes of an NPY header that numpy reads."""

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
_NPY_HEADERS = {
    1: np.lib.format.read_array_header_1_0,
    2: np.lib.format.read_array_header_2_0,
}


@dataclass(frozen=True, eq=False)
class Table:
    """A table of numbers.

    Parameters
    ----------
    numbers
        All of them finite.
    columns
        Their names in lower case, if the first line had names.
    rows
        What each row starts with, if that is no number: the name of a file.
    """

    numbers: Float[np.ndarray, "rows columns"]
    columns: tuple[str, ...] | None = None
    rows: tuple[str, ...] | None = None


def read_table(path: Path | str) -> Table:
    """Read a table of numbers from a text file, or an array from a `.npy` file.

    Numbers are parted by blanks, commas or semicolons, and may have a decimal comma where no comma
    parts them; a comment starts with `#` or `%`. A first line of one number is the number of
    lines (as in RTI's `.lp` files), one of words names the columns; each line may start with the
    name of a file.

    Raises
    ------
    FileError
        If the file holds anything else, lines of unlike length, or fewer or more lines than its
        first one promises.
    """
    data = read_bytes(path, MAX_TABLE)
    if data.startswith(np.lib.format.MAGIC_PREFIX):
        return Table(_array(path, data))
    lines = _words(data.decode("utf-8-sig", "replace"))
    if len(lines) > 1 and len(lines[0]) == 1 < len(lines[1]):
        promised = lines.pop(0)[0]
        if promised != str(len(lines)):
            raise FileError(
                f"{path}: its first line promises {promised[:20]} lines, {len(lines)} follow"
            )
    columns = None
    if len(lines) > 1 and not any(map(is_number, lines[0])) and any(map(is_number, lines[1])):
        columns = tuple(word.lower() for word in lines.pop(0))
    rows = None
    if lines and all(_names_a_row(line) for line in lines):
        # A name may have blanks; the numbers of all lines are as many as those of the first.
        count = next(n for n, word in enumerate(reversed(lines[0])) if not is_number(word))
        rows = tuple(" ".join(line[: len(line) - count]) for line in lines)
        lines = [line[len(line) - count :] for line in lines]
        if columns is not None:
            columns = columns[len(columns) - count :]
    try:
        numbers = np.array(lines, dtype=float, ndmin=2)
        return Table(checks.finite("values", numbers), columns, rows)
    except (ArgumentError, ValueError) as error:
        raise FileError(f"{path}: is not a table of numbers ({excerpt(error)})") from None


def npy_array(data: bytes) -> np.ndarray:
    """Return the array that the bytes of an NPY file hold: real numbers, and no more than they are.

    Raises
    ------
    ValueError
        Or another of `PARSE_ERRORS`, if they hold no such array.
    """
    file = io.BytesIO(data)
    shape, fortran, dtype = npy_header(file)
    if dtype.kind not in "fiub" or math.prod(shape) * dtype.itemsize != len(data) - file.tell():
        raise ValueError("it does not hold the array that its header promises")
    array = np.frombuffer(data, dtype, offset=file.tell())
    return array.reshape(shape, order="F" if fortran else "C")


def npy_header(file: Any) -> tuple[tuple[int, ...], bool, np.dtype]:
    """Return shape, whether columns come first, and dtype, as an open NPY file begins with them."""
    major, _ = np.lib.format.read_magic(file)
    if major not in _NPY_HEADERS:
        raise ValueError(f"its NPY version is {major}")
    place = file.tell()
    length = int.from_bytes(file.read(2 if major == 1 else 4), "little")
    if b"\\" in file.read(min(length, _LONGEST_HEADER)):
        raise ValueError("its header has a backslash")  # of which Python would warn
    file.seek(place)
    try:
        shape, fortran, dtype = _NPY_HEADERS[major](file)
    except MemoryError:
        # Python's parser says so of what is nested deeply, whatever memory there is.
        raise ValueError("its header is nested deeply") from None
    if min(shape, default=0) < 0:
        raise ValueError(f"its shape is {shape}")
    return shape, fortran, dtype


def _array(path: Path | str, data: bytes) -> Float[np.ndarray, "rows columns"]:
    try:
        found = checks.finite("values", npy_array(data).astype(np.float64))
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: holds no array of real numbers ({excerpt(error)})") from None
    if found.ndim != 2:
        raise FileError(f"{path}: must hold rows and columns, got the shape {found.shape}")
    return found


def _words(text: str) -> list[list[str]]:
    """Return the words of every line that has some."""
    lines = [re.split(r"[#%]", line)[0].strip() for line in text.splitlines()]
    lines = [line for line in lines if line]
    apart = [re.split(r"[;\s]+" if ";" in line else r"\s+", line) for line in lines]
    words = [word for line in apart for word in line]
    decimal = (
        any("," in word for word in words)
        and all(len(line) > 1 for line in apart[-1:])
        and all("." not in word or not is_number(word) for word in words)
        and all("," not in word or _DECIMAL_COMMA.fullmatch(word) for word in words)
    )
    if decimal:
        return [[word.replace(",", ".") for word in line if word] for line in apart]
    return [[word for word in re.split(r"[;,\s]+", line) if word] for line in lines]


def _names_a_row(line: list[str]) -> bool:
    return len(line) > 1 and not is_number(line[0]) and is_number(line[-1])
