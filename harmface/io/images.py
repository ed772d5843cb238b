"""Photographs and rendered images, as values in [0, 1]."""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt

from harmface import checks
from harmface.conventions import linear_to_srgb
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.atomic import atomic_write
from harmface.io.pictures import MAX_PIXELS, read_picture
from harmface.io.png import MAX_SIDE, with_encoding

JPEG_QUALITY = 95
"""Of Pillow: beyond it files grow fast and codes hardly change."""

_JPEG_SUFFIXES = (".jpg", ".jpeg")

# EXIF: the folder of the camera's facts, and the tag in it that is 1 for sRGB.
_EXIF_FOLDER, _COLOR_SPACE = 0x8769, 0xA001


def read_image(
    path: Path | str, *, srgb: bool = False, max_pixels: int = MAX_PIXELS
) -> Float[np.ndarray, "H W *channels"]:
    """Read an image as linear values in [0, 1], turned as the file says (EXIF orientation).

    What a file says of its encoding is believed: the chunks sRGB, gAMA and iCCP of PNG, the colour
    space in the EXIF data of JPEG. What is transparent is laid on black, in linear light.

    Parameters
    ----------
    path
        A PNG, PGM, PPM, TIFF, JPEG, BMP, WebP or TGA file, grey or RGB, of 8, 16 or 32 bits; or a
        TIFF file of real numbers, which may lie outside [0, 1] and are returned as they are.
    srgb
        Whether files that do not say how they are encoded are encoded in sRGB; they are taken as
        linear otherwise.
    max_pixels
        Largest picture decoded.

    Returns
    -------
    numpy.ndarray
        Shape (H, W) for grey, (H, W, 3) for RGB; float64.

    Raises
    ------
    FileError
        If the file is missing, no such image, broken, too large or of several pages.

    Warns
    -----
    FileWarning
        If a JPEG or TIFF file holds CMYK, or a JPEG file is damaged but could be decoded.
    """
    picture = read_picture(path, max_pixels)
    for note in picture.notes:
        warnings.warn(note, FileWarning, stacklevel=2)
    return picture.linear(unstated=srgb)


def write_image(
    path: Path | str,
    image: Float[np.ndarray, "H W *channels"],
    *,
    bits: int = 16,
    srgb: bool = False,
    opacity: Float[np.ndarray, "H W"] | None = None,
) -> None:
    """Write linear values as PNG or JPEG, which says how it is encoded; they are clipped to [0, 1].

    Parameters
    ----------
    path
        The file to make or replace; the ending says the format: `.png`, or `.jpg` or `.jpeg`.
    image
        Linear values, (H, W) or (H, W, 3).
    bits
        8 or 16 bits a channel; JPEG has 8.
    srgb
        Whether to encode in sRGB, as JPEG always is; values are stored linearly otherwise.
    opacity
        Share of each pixel that is covered, in [0, 1], of an image on black: colours are divided
        by it and it becomes the alpha channel of a PNG file, so that `read_image` gives `image`
        again. JPEG has none.

    Raises
    ------
    ArgumentError
        On NaN, integers, whose scale is not known, another number of bits, another shape, or
        bits, opacity or linear values that JPEG cannot hold.
    FileError
        If the name has another ending or the file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".png", *_JPEG_SUFFIXES):
        raise FileError(
            f"{path}: images are written as PNG or JPEG; give a name that ends in .png or .jpg"
        )
    image = checks.picture("image", checks.intensities("image", image))
    if max(image.shape) > MAX_SIDE:
        raise ArgumentError(
            f"image must have at most {MAX_SIDE} rows and columns as PNG, got {image.shape}"
        )
    if bits not in (8, 16):
        raise ArgumentError(f"bits must be 8 or 16, got {bits}")
    if suffix in _JPEG_SUFFIXES and (bits != 8 or not srgb or opacity is not None):
        raise ArgumentError(
            "bits must be 8 and srgb true for JPEG, which has no opacity; write linear values, 16 "
            "bits or opacity as PNG"
        )
    if opacity is not None:
        checks.intensities("opacity", opacity)
        if opacity.shape != image.shape[:2] or not ((opacity >= 0) & (opacity <= 1)).all():
            raise ArgumentError(
                f"opacity must lie in [0, 1] for each of {image.shape[:2]} pixels, got "
                f"shape {opacity.shape}"
            )
        covered = np.where(opacity > 0, opacity, 1)
        image = image / (covered if image.ndim == 2 else covered[..., None])
    values = np.clip(image, 0, 1)
    values = linear_to_srgb(values) if srgb else values
    dtype = np.uint8 if bits == 8 else np.uint16
    codes = np.round(values * (2**bits - 1)).astype(dtype)
    if suffix in _JPEG_SUFFIXES:
        encoded = _jpeg(codes)
    else:
        alpha = None if opacity is None else np.round(opacity * (2**bits - 1)).astype(dtype)
        encoded = with_encoding(_png(path, codes, alpha), srgb)
    with atomic_write(path) as file:
        file.write(encoded)


def _png(
    path: Path, codes: UInt[np.ndarray, "H W *channels"], alpha: UInt[np.ndarray, "H W"] | None
) -> bytes:
    """Return codes as a PNG file."""
    import cv2

    if alpha is not None:
        colours = codes if codes.ndim == 3 else np.repeat(codes[..., None], 3, axis=-1)
        codes = np.dstack([colours[..., ::-1], alpha])
    elif codes.ndim == 3:
        codes = codes[..., ::-1]
    done, encoded = cv2.imencode(".png", codes)
    if not done:
        raise FileError(f"{path}: could not be encoded as PNG")
    return bytes(encoded)


def _jpeg(codes: UInt[np.ndarray, "H W *channels"]) -> bytes:
    """Return codes as a JPEG file whose EXIF data say sRGB, its colours not subsampled."""
    from PIL import Image

    exif = Image.Exif()
    exif.get_ifd(_EXIF_FOLDER)[_COLOR_SPACE] = 1
    buffer = BytesIO()
    Image.fromarray(codes).save(
        buffer, format="JPEG", quality=JPEG_QUALITY, subsampling=0, exif=exif
    )
    return buffer.getvalue()
