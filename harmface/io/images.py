"""Photographs and rendered images, as values in [0, 1]."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import linear_to_srgb
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.atomic import atomic_write
from harmface.io.pictures import MAX_PIXELS, read_picture
from harmface.io.png import MAX_SIDE


def read_image(
    path: Path | str, *, srgb: bool = False, max_pixels: int = MAX_PIXELS
) -> Float[np.ndarray, "H W *channels"]:
    """Read an image as values in [0, 1], float64, turned as the file says (EXIF orientation).

    Parameters
    ----------
    path
        A PNG, PGM, PPM, TIFF, JPEG, BMP, WebP or TGA file, grey or RGB, of 8, 16 or 32 bits; or a
        TIFF file of real numbers, which may lie outside [0, 1] and are returned as they are.
    srgb
        Whether values are encoded in sRGB and should be made linear; they are taken as linear
        otherwise.
    max_pixels
        Largest picture decoded.

    Returns
    -------
    numpy.ndarray
        Shape (H, W) for grey, (H, W, 3) for RGB.

    Raises
    ------
    FileError
        If the file is missing, no such image, broken, too large, partly transparent or of
        several pages.

    Warns
    -----
    FileWarning
        If a JPEG or TIFF file holds CMYK, or a JPEG file is damaged but could be decoded.
    """
    picture = read_picture(path, max_pixels)
    for note in picture.notes:
        warnings.warn(note, FileWarning, stacklevel=2)
    return picture.values(srgb)


def write_image(
    path: Path | str,
    image: Float[np.ndarray, "H W *channels"],
    *,
    bits: int = 16,
    srgb: bool = False,
) -> None:
    """Write linear values as PNG; values outside [0, 1] are clipped.

    Parameters
    ----------
    path
        The file to make or replace; it must end in `.png`.
    image
        Linear values, (H, W) or (H, W, 3).
    bits
        8 or 16 bits a channel.
    srgb
        Whether to encode in sRGB; values are stored linearly otherwise.

    Raises
    ------
    ArgumentError
        On NaN, integers, whose scale is not known, another number of bits, or another shape.
    FileError
        If the name does not end in `.png` or the file cannot be written.
    """
    import cv2

    path = Path(path)
    if path.suffix.lower() != ".png":
        raise FileError(f"{path}: images are written as PNG; give a name that ends in .png")
    image = checks.picture("image", checks.intensities("image", image))
    if max(image.shape) > MAX_SIDE:
        raise ArgumentError(
            f"image must have at most {MAX_SIDE} rows and columns as PNG, got {image.shape}"
        )
    if bits not in (8, 16):
        raise ArgumentError(f"bits must be 8 or 16, got {bits}")
    values = np.clip(image, 0, 1)
    values = linear_to_srgb(values) if srgb else values
    codes = np.round(values * (2**bits - 1)).astype(np.uint8 if bits == 8 else np.uint16)
    done, encoded = cv2.imencode(".png", codes[..., ::-1] if codes.ndim == 3 else codes)
    if not done:
        raise FileError(f"{path}: could not be encoded as PNG")
    with atomic_write(path) as file:
        file.write(encoded.tobytes())
