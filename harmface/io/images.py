"""Photographs and rendered images: PNG, PGM, PPM, TIFF, TGA and JPEG, 8 or 16 bits."""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Float
from PIL import Image, UnidentifiedImageError

from harmface import checks
from harmface.conventions import linear_to_srgb, srgb_to_linear
from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes
from harmface.io.opencv import quiet_opencv

FORMATS = ("PNG", "PPM", "TIFF", "JPEG", "BMP")
"""Formats that their first bytes tell, as Pillow names them; PPM includes PGM."""

MAX_PIXELS = 2**27
"""Largest image decoded: 134 megapixels."""


def read_image(path: Path | str, *, srgb: bool = False) -> Float[np.ndarray, "H W *channels"]:
    """Read an image as values in [0, 1], float64.

    Parameters
    ----------
    path
        A PNG, PGM, PPM, TIFF, TGA, JPEG or BMP file of 8 or 16 bits, grey or RGB.
    srgb
        Whether values are encoded in sRGB and should be made linear; they are taken as linear
        otherwise.

    Returns
    -------
    numpy.ndarray
        Shape (H, W) for grey, (H, W, 3) for RGB.

    Raises
    ------
    FileError
        If the file is missing, no such image, broken, too large, partly transparent or of
        several pages.
    """
    path = Path(path)
    data = read_bytes(path)
    picture = _validated(path, data)
    pixels = _targa(picture, data) if picture.format == "TGA" else _by_opencv(data)
    if pixels is None or pixels.dtype not in (np.uint8, np.uint16):
        raise FileError(f"{path}: is not an image of 8 or 16 bits a channel; convert it to PNG")
    limit = np.iinfo(pixels.dtype).max
    if pixels.ndim == 3:
        if pixels.shape[-1] == 4 and (pixels[..., 3] != limit).any():
            raise FileError(f"{path}: is partly transparent; flatten it onto a background")
        pixels = pixels[..., 2::-1]
    values = pixels / limit
    return srgb_to_linear(values) if srgb else values


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
        On NaN, another number of bits, or another shape.
    FileError
        If the name does not end in `.png` or the file cannot be written.
    """
    import cv2

    path = Path(path)
    if path.suffix.lower() != ".png":
        raise FileError(f"{path}: images are written as PNG; give a name that ends in .png")
    image = checks.finite("image", image)
    if image.ndim not in (2, 3) or image.shape[2:] not in ((), (3,)):
        raise ArgumentError(f"image must have shape (H, W) or (H, W, 3), got {image.shape}")
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


def _by_opencv(data: bytes) -> np.ndarray | None:
    """Return codes as OpenCV has them: blue, green, red; None if it cannot decode them."""
    # OpenCV is slow to import and only wanted here: Pillow cannot decode RGB of 16 bits.
    import cv2

    with quiet_opencv():
        return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)


def _targa(picture: Image.Image, data: bytes) -> np.ndarray:
    """Return the codes of a TGA file as OpenCV would, which cannot read it."""
    alpha_bits = data[17] & 15
    if picture.mode in ("1", "L", "LA") and not (picture.mode == "LA" and alpha_bits):
        return np.asarray(picture.convert("L"))
    # Files of 32 bits a pixel often leave the fourth byte empty, and say that it is no alpha.
    codes = np.asarray(picture.convert("RGBA" if alpha_bits else "RGB"))
    return codes[..., [2, 1, 0, 3][: codes.shape[-1]]]


def _validated(path: Path, data: bytes) -> Image.Image:
    """Decode with Pillow, which raises on any damage where OpenCV would guess on."""
    too_large = FileError(
        f"{path}: has more pixels than the limit of {MAX_PIXELS}; make the image smaller"
    )
    try:
        with warnings.catch_warnings():
            # Pillow only warns of tags that lie, and of sizes that are below its own cap.
            warnings.simplefilter("error", UserWarning)
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            # A TGA file has no signature, so only its name tells.
            formats = ("TGA",) if path.suffix.lower() == ".tga" else FORMATS
            picture = Image.open(BytesIO(data), formats=formats)
            if picture.width * picture.height > MAX_PIXELS:
                raise too_large
            if picture.format == "TIFF" and getattr(picture, "n_frames", 1) > 1:
                raise FileError(f"{path}: holds several pages; save each as a file of its own")
            picture.load()
            return picture
    except Image.DecompressionBombError:
        raise too_large from None
    except FileError:
        raise
    except (
        EOFError,
        LookupError,
        OSError,
        OverflowError,
        SyntaxError,
        TypeError,
        UserWarning,
        ValueError,
    ) as error:
        reason = (str(error).splitlines() or [""])[0]
        if isinstance(error, UnidentifiedImageError):
            reason = "its bytes are of no image format"
        raise FileError(
            f"{path}: cannot be read as an image ({reason}); "
            f"give one of {', '.join(FORMATS)} or TGA, undamaged"
        ) from None
