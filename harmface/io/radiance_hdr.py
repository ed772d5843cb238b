"""Radiance pictures (`.hdr`, `.pic`): three bytes a pixel that share the exponent of a fourth.

No library reads them whole: those at hand (OpenCV, OpenImageIO, imageio) leave out exposures,
colour spaces, orientations or old run lengths, or refuse files that Radiance itself makes.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes
from harmface.io.pictures import MAX_PIXELS, check_size
from harmface.io.primaries import in_rec709
from harmface.io.radiance_codes import decode_scanlines
from harmface.io.radiance_header import read_header

_AT_ONCE = 2**17
"""Pixels decoded at once."""

LARGEST = 2.0**126
"""Values from here on are refused: the format ends at 2**127."""


def read_radiance_hdr(
    path: Path | str, *, max_pixels: int = MAX_PIXELS
) -> Float[np.ndarray, "H W 3"]:
    """Return linear RGB radiance of a Radiance picture, float32, in Rec. 709.

    Values are divided by EXPOSURE and COLORCORR; XYZ and other PRIMARIES are converted; all eight
    orders of pixels and all three codings are read.

    Parameters
    ----------
    path
        The file.
    max_pixels
        Largest picture read.

    Raises
    ------
    FileError
        If the file is missing, is no such picture, is cut off, or larger than `max_pixels`.

    Warns
    -----
    FileWarning
        If it holds colours beyond Rec. 709.
    """
    data = read_bytes(path)
    header = read_header(path, data)
    check_size(path, header.length, header.scanlines, max_pixels)
    try:
        codes = decode_scanlines(data, header.start, header.scanlines, header.length)
    except (EOFError, ValueError) as error:
        raise FileError(f"{path}: is damaged ({error}); copy or download it again") from None
    if header.by_columns:
        codes = codes.swapaxes(0, 1)
    codes = codes[:: -1 if header.upwards else 1, :: -1 if header.leftwards else 1]
    # Three bytes are 256ths of a power of two; exponent 0 means black.
    powers = np.ldexp(np.float32(1), np.arange(256) - 136)
    powers[0] = 0
    image = np.empty((*codes.shape[:2], 3), np.float32)
    # Some rows and one channel at once stay in the processor's cache, which is seven times faster.
    step = max(1, _AT_ONCE // codes.shape[1])
    for first in range(0, len(codes), step):
        some = codes[first : first + step]
        factors = powers[some[..., 3]]
        for channel in range(3):
            np.multiply(some[..., channel], factors, out=image[first : first + step, :, channel])
    if (header.exposure != 1).any():
        image /= header.exposure
    return image if header.matrix is None else in_rec709(path, image, header.matrix)


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
    image = checks.picture("image", checks.non_negative("image", image))
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
