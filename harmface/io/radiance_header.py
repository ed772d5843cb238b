"""The header of a Radiance picture: what its four bytes a pixel mean, and in which order."""

import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface.errors import ArgumentError, FileError
from harmface.io.files import excerpt
from harmface.io.primaries import REC709, XYZ, to_rec709

MAX_HEADER = 2**16
"""Longest header looked through."""

_RGBE, _XYZE = "32-bit_rle_rgbe", "32-bit_rle_xyze"
_BLANK = re.compile(rb"\n\s*?\r?\n")
_SIZE = re.compile(rb"\s*([-+])([XY])\s+(\d{1,9})\s+([-+])([XY])\s+(\d{1,9})[ \t]*\r?\n")


@dataclass(frozen=True, eq=False)
class Header:
    """What comes before the pixels.

    Parameters
    ----------
    scanlines, length
        How many scanlines there are, and pixels in each.
    by_columns
        Whether scanlines are columns of the picture.
    upwards, leftwards
        Whether the bottom row comes first, and the right column.
    exposure
        What the values of each channel have been multiplied by.
    matrix
        Turns the values to red, green, blue of Rec. 709; None if they are that.
    start
        Where the pixels start in the file.
    """

    scanlines: int
    length: int
    by_columns: bool
    upwards: bool
    leftwards: bool
    exposure: Float[np.ndarray, "3"]
    matrix: Float[np.ndarray, "3 3"] | None
    start: int


def read_header(path: Path | str, data: bytes) -> Header:
    """Read the header of a Radiance picture, as Radiance itself does and somewhat more freely.

    Lines may end in CR LF, have blanks about their values, and start with the name of any program;
    FORMAT may be missing. Several EXPOSURE and COLORCORR lines multiply; 0, which some programs
    write for "unknown", counts as none.

    Parameters
    ----------
    path
        Named in errors.
    data
        The file.

    Raises
    ------
    FileError
        If this is no such header.
    """
    head = data[:MAX_HEADER]
    blank = _BLANK.search(head)
    size = _SIZE.match(head, blank.end()) if blank else None
    lines = head[: blank.start() if blank else 0].decode("latin-1").split("\n")
    # Lines that start with a tab tell of the pictures that this one was made from.
    variables = [
        (name.strip(), value.strip())
        for name, equals, value in (line.partition("=") for line in lines)
        if equals and not name.startswith(("#", "\t"))
    ]
    formats = [value for name, value in variables if name == "FORMAT"]
    if not blank or not (formats or lines[0].startswith("#?")):
        raise FileError(f"{path}: is not a Radiance picture (its header is not one)")
    if set(formats) - {_RGBE, _XYZE} or len(set(formats)) > 1:
        raise FileError(
            f"{path}: holds {excerpt(', '.join(formats))}; {_RGBE} or {_XYZE} is needed"
        )
    if not size or size[2] == size[5]:
        line = head[blank.end() :][:40].partition(b"\n")[0].decode("latin-1")
        raise FileError(f"{path}: its size line reads {line!r}; -Y height +X width is needed")
    signs = {size[2]: size[1], size[5]: size[4]}
    return Header(
        scanlines=int(size[3]),
        length=int(size[6]),
        by_columns=size[2] == b"X",
        upwards=signs[b"Y"] == b"+",
        leftwards=signs[b"X"] == b"-",
        exposure=_exposure(path, variables),
        matrix=_matrix(path, variables, formats),
        start=size.end(),
    )


def _exposure(path: Path | str, variables: list[tuple[str, str]]) -> Float[np.ndarray, "3"]:
    """Return the product of all exposures and corrections of colour."""
    found = np.ones(3)
    with np.errstate(over="ignore"):  # as it is refused below
        for name, value in variables:
            if name == "EXPOSURE":
                found *= _numbers(path, name, value, 1)
            elif name == "COLORCORR":
                found *= _numbers(path, name, value, 3)
        # Values are of single precision.
        single = found.astype(np.float32)
    if not (np.isfinite(single) & (single > 0)).all():
        raise FileError(f"{path}: its EXPOSURE and COLORCORR multiply to {found.tolist()}")
    return single


def _numbers(path: Path | str, name: str, value: str, count: int) -> Float[np.ndarray, "n"]:
    """Return positive numbers; zeros count as ones."""
    try:
        numbers = np.array([float(word) for word in value.split()])
    except ValueError:
        numbers = np.full(count, math.nan)
    if len(numbers) != count or not (np.isfinite(numbers) & (numbers >= 0)).all():
        words = "a positive number" if count == 1 else f"{count} positive numbers"
        raise FileError(f"{path}: its {name} is not {words}, but {excerpt(repr(value))}")
    return np.where(numbers == 0, 1, numbers)


def _matrix(
    path: Path | str, variables: list[tuple[str, str]], formats: list[str]
) -> Float[np.ndarray, "3 3"] | None:
    """Return what turns colours to Rec. 709."""
    stated = [value for name, value in variables if name == "PRIMARIES"]
    chromaticities: tuple[float, ...] = REC709
    if _XYZE in formats:
        chromaticities = XYZ
    elif stated:
        try:
            chromaticities = tuple(float(word) for word in stated[-1].split())
        except ValueError:
            chromaticities = ()
    if not any(chromaticities) and len(chromaticities) == 8:
        return None  # Programs write zeros for "unknown" here too.
    if len(chromaticities) != 8:
        raise FileError(
            f"{path}: its PRIMARIES are not eight numbers, but {excerpt(repr(stated[-1]))}"
        )
    try:
        return to_rec709(chromaticities)
    except ArgumentError as error:
        raise FileError(f"{path}: its PRIMARIES are of no use: {error}") from None
