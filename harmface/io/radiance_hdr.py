"""Radiance pictures (`.hdr`): four bytes a pixel, run-length coded, read and written by OpenCV.

The header is read here first: it says how much memory the picture takes, and OpenCV leaves out
what it may say of exposure and colour space.
"""

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes
from harmface.io.opencv import quiet_opencv

MAX_PIXELS = 2**27
"""Largest picture read: 134 megapixels, 1.6 GB as float32 in three channels."""

MAX_HEADER = 2**16
"""Longest header looked through."""

LARGEST = 2.0**126
"""Values from here on are refused: the format ends at 2**127."""


def read_radiance_hdr(path: Path | str) -> Float[np.ndarray, "H W 3"]:
    """Return linear RGB radiance of a Radiance picture, float32, divided by its EXPOSURE.

    Raises
    ------
    FileError
        If the file is missing, is no such picture, is cut off, in XYZ, stored sideways or upside
        down, or larger than 134 megapixels.
    """
    data = read_bytes(path)
    exposure = _check_header(path, data)
    import cv2

    with quiet_opencv(), _decoding(path):
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        if pixels is None:
            raise FileError(f"{path}: is cut off or damaged; copy or download it again")
        cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB, dst=pixels)
    if exposure != 1:
        pixels /= exposure
    return pixels


def write_radiance_hdr(path: Path | str, image: Float[np.ndarray, "H W *channels"]) -> None:
    """Write linear radiance as a Radiance picture; it keeps about two and a half digits.

    Parameters
    ----------
    path
        The file to make or replace.
    image
        `(H, W)` or `(H, W, 3)`, not negative.

    Raises
    ------
    ArgumentError
        If a value is negative, NaN or too large for the format, or the shape is another.
    """
    image = checks.non_negative("image", image)
    if image.ndim not in (2, 3) or image.shape[2:] not in ((), (3,)) or image.size == 0:
        raise ArgumentError(f"image must have shape (H, W) or (H, W, 3), got {image.shape}")
    if image.max() >= LARGEST:
        raise ArgumentError(
            f"image must stay below 2**126 to be stored as .hdr, got {image.max():.4g}; scale it"
        )
    import cv2

    bgr = np.repeat(image[..., None], 3, axis=-1) if image.ndim == 2 else image[..., ::-1]
    # Three bytes share the exponent of the largest. OpenCV cuts off what they cannot hold, which
    # loses 0.3 % of the light: half a step more and it rounds.
    peak = bgr.max(axis=-1, keepdims=True)
    half_step = np.where(peak > 0, np.ldexp(1.0, np.frexp(peak)[1] - 9), 0)
    done, encoded = cv2.imencode(".hdr", (bgr + half_step).astype(np.float32))
    if not done:
        raise FileError(f"{path}: could not be encoded as a Radiance picture")
    with atomic_write(path) as file:
        file.write(encoded.tobytes())


@contextmanager
def _decoding(path: Path | str) -> Iterator[None]:
    import cv2

    try:
        yield
    except cv2.error as error:
        raise FileError(f"{path}: is damaged ({error.err}); copy or download it again") from None


def _check_header(path: Path | str, data: bytes) -> float:
    """Refuse a header that lies or that OpenCV would misread; return the product of exposures."""
    head, blank, rest = data[:MAX_HEADER].partition(b"\n\n")
    if not re.match(rb"#\?(RADIANCE|RGBE)\n", head + b"\n") or not blank:
        raise FileError(f"{path}: is not a Radiance picture (its header is not one)")
    lines = head.split(b"\n")[1:]
    variables = [line.partition(b"=")[::2] for line in lines if not line.startswith(b"#")]
    formats = [value.strip() for name, value in variables if name == b"FORMAT"]
    if formats != [b"32-bit_rle_rgbe"]:
        found = b", ".join(formats).decode("latin-1") or "no format"
        raise FileError(f"{path}: holds {found}; a picture in 32-bit_rle_rgbe is needed")
    size = re.match(rb"-Y (\d{1,9}) \+X (\d{1,9})\n", rest)
    if not size:
        line = rest[:40].partition(b"\n")[0].decode("latin-1")
        raise FileError(
            f"{path}: its size line reads {line!r}; rows from the top (-Y height +X width) needed"
        )
    height, width = int(size[1]), int(size[2])
    if not 0 < height * width <= MAX_PIXELS:
        raise FileError(
            f"{path}: its header names {width} x {height} pixels, outside 1 to {MAX_PIXELS}"
        )
    # A run codes at most 127 pixels of one of four bytes by two; a row starts with four.
    shortest = height * min(4 * width, 4 + 8 * math.ceil(width / 127))
    payload = len(data) - len(head) - len(blank) - size.end()
    if payload < shortest:
        raise FileError(
            f"{path}: is cut off: {width} x {height} pixels take {shortest} bytes or more, "
            f"{payload} are there"
        )
    return _exposure(path, [value for name, value in variables if name == b"EXPOSURE"])


def _exposure(path: Path | str, values: list[bytes]) -> float:
    try:
        exposure = math.prod(float(value) for value in values)
    except ValueError:
        exposure = math.nan
    if not (math.isfinite(exposure) and exposure > 0):
        raise FileError(f"{path}: its EXPOSURE is not a positive number")
    return exposure
