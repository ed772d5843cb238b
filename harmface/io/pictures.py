"""Pictures as files hold them: decoded by OpenImageIO, turned the right way up."""

import logging
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Num, UInt

from harmface.conventions import srgb_to_linear
from harmface.errors import FileError
from harmface.io.files import PARSE_ERRORS, check_regular, excerpt, read_bytes
from harmface.io.png import SIGNATURE, check_png, png_encoding, png_size

LOG = logging.getLogger(__name__)

FORMATS = ("png", "pnm", "tiff", "jpeg", "bmp", "webp", "targa")
"""Formats that are decoded, as OpenImageIO names them; pnm is PBM, PGM and PPM."""

NO_PICTURE = "its bytes are not PNG, TIFF, JPEG, PGM, PPM, BMP, WebP or TGA"

MAX_PIXELS = 2**26
"""Largest picture decoded unless another limit is asked for: 67 megapixels."""

_SET = 16
"""How many times as many pixels as one picture a set may have: about 5 GB of luminance."""

MAX_SCANS = 50
"""Most scans of a JPEG file; progressive ones have about ten, and each goes over all pixels."""

_AT_ONCE = 2**20
"""Codes looked up at once."""

# Width, height and largest code of a PGM or PPM file; a comment may stand in every gap.
_GAP = rb"(?:\s|#[^\n]*\n)+"
_PNM = re.compile(rb"P[2356]" + rb"".join([_GAP + rb"(\d{1,9})"] * 3) + rb"\s")
_JPEG = b"\xff\xd8"
# A marker in a JPEG file; a zero follows every 0xff byte that is data, and restarts are no parts.
_MARKER = re.compile(rb"\xff([^\x00\xff\xd0-\xd7])")


@dataclass(frozen=True, eq=False)
class Picture:
    """A decoded picture.

    Parameters
    ----------
    codes
        As stored: unsigned integers from 0 to the largest that their type holds, or real numbers.
    largest
        Largest code of the file if its codes were stretched to fill their type, as those of PGM
        are; None if they were not.
    notes
        What to know of how the file was read.
    srgb
        Whether the file says that it is encoded in sRGB, or linear; None if it says neither.
    opacity
        Share of each pixel that is covered, in [0, 1]; None if all are.
    """

    codes: Num[np.ndarray, "H W *channels"]
    largest: int | None
    notes: tuple[str, ...]
    srgb: bool | None = None
    opacity: Float[np.ndarray, "H W"] | None = None

    @property
    def bits(self) -> int:
        """Bits of a channel of a pixel."""
        return self.codes.dtype.itemsize * 8

    def linear(
        self, srgb: bool | None = None, *, unstated: bool = False
    ) -> Float[np.ndarray, "H W *channels"]:
        """Return linear values on black, float64.

        Parameters
        ----------
        srgb
            Whether the file is encoded in sRGB, whatever it says of itself; what it says is
            believed if not given.
        unstated
            Whether a file that does not say how it is encoded is encoded in sRGB.

        Returns
        -------
        numpy.ndarray
            Shape (H, W) or (H, W, 3); what is transparent is black.
        """
        found = next(known for known in (srgb, self.srgb, unstated) if known is not None)
        values = self.values(found)
        if self.opacity is None:
            return values
        return values * (self.opacity if values.ndim == 2 else self.opacity[..., None])

    def values(self, srgb: bool) -> Float[np.ndarray, "H W *channels"]:
        """Return values, float64: codes over the largest one, or real numbers as they are.

        Parameters
        ----------
        srgb
            Whether they are encoded in sRGB and should be made linear.

        Returns
        -------
        numpy.ndarray
            Shape (H, W) or (H, W, 3), without opacity.
        """
        if self.codes.dtype.kind == "f" or self.codes.dtype.itemsize > 2:
            real = self.codes.dtype.kind == "f"
            values = self.codes / (1.0 if real else np.iinfo(self.codes.dtype).max)
            values = values.astype(np.float64, copy=False)
            return srgb_to_linear(values) if srgb else values
        limit = np.iinfo(self.codes.dtype).max
        table = np.arange(limit + 1)
        if self.largest is None:
            meant = table / limit
        else:
            # Code k of m was stretched to k * limit / m, rounded down.
            meant = -(-table * self.largest // limit) / self.largest
        meant = srgb_to_linear(meant) if srgb else meant
        return _looked_up(meant, self.codes)


def read_picture(path: Path | str, max_pixels: int = MAX_PIXELS) -> Picture:
    """Decode a picture: PNG, PBM, PGM, PPM, TIFF, JPEG, BMP, WebP or, by its name, TGA.

    The orientation that the file names (EXIF) is applied.

    Parameters
    ----------
    path
        The file.
    max_pixels
        Largest picture decoded.

    Returns
    -------
    Picture
        Its codes, and its opacity beside them.

    Raises
    ------
    FileError
        If the file is missing, no such picture, damaged, larger than `max_pixels`, of several
        pages, or neither grey nor RGB.
    """
    path = Path(path)
    size = check_regular(path)
    said = _check_parts(path, max_pixels)
    with opened(path) as source:
        kind = source.format_name()
        # A TGA file has no signature, so that much else looks like one: only its name tells.
        if kind not in FORMATS or (kind == "targa") != (path.suffix.lower() == ".tga"):
            raise _unreadable(path, NO_PICTURE)
        spec = source.spec()
        check_size(path, spec.width, spec.height, max_pixels)
        _check_channels(path, spec)
        largest = None
        if kind == "pnm":
            largest = _largest_code(path, size)
        codes = pixels(path, source, 0, spec.nchannels, str(spec.format))
        if kind == "targa" and codes.shape[2] == 4 and not _alpha_bits(path):
            codes[..., 3] = np.iinfo(codes.dtype).max
        notes = _notes(path, source, spec)
        if kind != "jpeg" and source.seek_subimage(1, 0):
            raise FileError(f"{path}: holds several pages; save each as a file of its own")
        if kind == "jpeg" and spec.getattribute("Exif:ColorSpace") == 1:
            said = True
    turn = spec.getattribute("Orientation") or 1
    colours, opacity = _colours(path, codes, spec)
    LOG.info("read %s: %s of %d x %d pixels", path, kind, spec.width, spec.height)
    return Picture(
        oriented(colours, turn),
        largest,
        notes,
        said,
        None if opacity is None else oriented(opacity, turn),
    )


@contextmanager
def opened(path: Path) -> Iterator[Any]:
    """Open a file with OpenImageIO, and turn what it raises into one error."""
    # Slow to import, and only wanted here.
    import OpenImageIO

    try:
        asked = OpenImageIO.ImageSpec()
        asked.attribute("oiio:UnassociatedAlpha", 1)
        source = OpenImageIO.ImageInput.open(str(path), asked)
        if source is None:
            reason = _said(OpenImageIO)
            if "find a format reader" in reason:
                reason = NO_PICTURE
            raise _unreadable(path, reason)
        try:
            yield source
        finally:
            source.close()
    except FileError:
        raise
    except PARSE_ERRORS as error:
        raise _unreadable(path, excerpt(error)) from None


def _looked_up(
    table: Float[np.ndarray, "n"], codes: UInt[np.ndarray, "..."]
) -> Float[np.ndarray, "..."]:
    """Return `table[codes]`, a few rows at a time: numpy takes eight bytes for each index."""
    values = np.empty(codes.shape, table.dtype)
    step = max(1, _AT_ONCE // max(1, codes[0].size))
    for first in range(0, len(values), step):
        values[first : first + step] = table[codes[first : first + step]]
    return values


def check_size(path: Path | str, width: int, height: int, max_pixels: int) -> None:
    """Refuse a picture without pixels, or with more than a limit, before memory is taken."""
    if not (width > 0 and height > 0):
        raise FileError(f"{path}: its header names {width} x {height} pixels")
    if width * height > max_pixels:
        raise FileError(
            f"{path}: has {width} x {height} pixels, more pixels than the limit of {max_pixels}; "
            "make the image smaller, or raise max_pixels (--max-pixels)"
        )


def check_total(path: Path | str, count: int, shape: tuple[int, ...], max_pixels: int) -> None:
    """Refuse a set of pictures, of which `path` is the first, that are too many for memory."""
    if count * shape[0] * shape[1] > _SET * max_pixels:
        raise FileError(
            f"{path}: and {count - 1} more have {shape[1]} x {shape[0]} pixels each, more than "
            f"{_SET} times {max_pixels} together; make them smaller, or raise max_pixels "
            "(--max-pixels)"
        )


def pixels(path: Path, source: Any, first: int, end: int, dtype: str) -> np.ndarray:
    """Return channels `first` up to `end` of an open picture, (H, W, channels)."""
    found = source.read_image(source.current_subimage(), 0, first, end, dtype)
    if found is None:
        raise _unreadable(path, _said(source))
    return np.asarray(found)


def oriented(image: np.ndarray, orientation: int) -> np.ndarray:
    """Turn an image, (H, W, ...), the way that the orientation of EXIF and TIFF says.

    Examples
    --------
    >>> oriented(np.array([[1, 2, 3], [4, 5, 6]]), 6)
    array([[4, 1],
           [5, 2],
           [6, 3]])
    """
    if orientation in (2, 3, 7, 8):
        image = image[:, ::-1]
    if orientation in (3, 4, 6, 7):
        image = image[::-1]
    return image.swapaxes(0, 1) if orientation in (5, 6, 7, 8) else image


def _space(spec: Any) -> str:
    """Return what the channels of a JPEG or TIFF file mean, where it is not grey or RGB."""
    return str(spec.getattribute("jpeg:ColorSpace") or spec.getattribute("tiff:ColorSpace") or "")


def _check_channels(path: Path, spec: Any) -> None:
    """Refuse what is neither grey nor RGB, with or without opacity, before it is decoded."""
    if _space(spec).endswith("LAB"):
        # It would be decoded, but with another white.
        raise FileError(f"{path}: holds the colours {_space(spec)}; save it as grey or RGB")
    if spec.nchannels - (spec.alpha_channel >= 0) not in (1, 3):
        raise FileError(
            f"{path}: has the channels {excerpt(', '.join(spec.channelnames))}; save it as grey "
            "or RGB"
        )


def _colours(
    path: Path, codes: np.ndarray, spec: Any
) -> tuple[np.ndarray, Float[np.ndarray, "H W"] | None]:
    """Return grey codes as (H, W), or RGB, and the opacity of what is partly transparent."""
    alpha = spec.alpha_channel
    kept = [index for index in range(codes.shape[2]) if index != alpha]
    if codes.dtype.kind == "i":
        raise FileError(f"{path}: holds signed integers; convert it to PNG")
    if codes.dtype.kind == "f" and not np.isfinite(codes).all():
        raise FileError(f"{path}: holds NaN or infinite values; mend them")
    opacity = None
    if alpha >= 0:
        full = 1.0 if codes.dtype.kind == "f" else float(np.iinfo(codes.dtype).max)
        if (codes[..., alpha] != full).any():
            opacity = np.clip(codes[..., alpha] / full, 0.0, 1.0)
    return codes[..., 0] if len(kept) == 1 else codes[..., kept], opacity


def _notes(path: Path, source: Any, spec: Any) -> tuple[str, ...]:
    """Return what the decoder found odd."""
    notes = []
    said = _said(source)
    if "premature end of jpeg file" in said.lower():
        raise _unreadable(path, "it is cut off")
    if said:
        notes.append(f"{path.name}: is damaged but was read as far as it goes ({said})")
    if _space(spec) in ("CMYK", "YCCK"):
        notes.append(f"{path.name}: holds CMYK, turned to RGB without a colour profile")
    return tuple(notes)


def _check_parts(path: Path, max_pixels: int) -> bool | None:
    """Refuse PNG and JPEG files that are not to be opened: opening decodes, or speaks on stderr.

    Returns what a PNG file says of its encoding, see `png_encoding`.
    """
    with path.open("rb") as file:
        start = file.read(len(SIGNATURE))
    if start.startswith(_JPEG):
        _check_scans(path, read_bytes(path))
    if start != SIGNATURE:
        return None
    data = read_bytes(path)
    try:
        check_size(path, *png_size(data), max_pixels)
        check_png(data)
        return png_encoding(data)
    except FileError:
        raise
    except (ValueError, zlib.error) as error:
        raise _unreadable(path, excerpt(error)) from None


def _check_scans(path: Path, data: bytes) -> None:
    """Refuse a JPEG file that would be decoded over and over."""
    scans, place = 0, len(_JPEG)
    while (marker := _MARKER.search(data, place)) and marker[1] != b"\xd9":
        scans += marker[1] == b"\xda"
        start = marker.end()
        # A segment may hold a JPEG file of its own, a thumbnail; its length leads over it.
        place = start + max(2, int.from_bytes(data[start : start + 2], "big"))
    if scans > MAX_SCANS:
        raise FileError(f"{path}: has {scans} scans, more than the limit of {MAX_SCANS}")


def _alpha_bits(path: Path) -> int:
    """Return how many bits of a pixel a TGA file calls alpha: programs leave the fourth byte 0."""
    with path.open("rb") as file:
        return file.read(18)[17] & 15


def _largest_code(path: Path, size: int) -> int | None:
    with path.open("rb") as file:
        header = _PNM.match(file.read(min(size, 4096)))
    largest = int(header[3]) if header else 0
    return largest if 0 < largest < 65535 else None


def _said(source: Any) -> str:
    """Return the last complaint of OpenImageIO, which may repeat bytes that are no text."""
    try:
        return excerpt(source.geterror())
    except UnicodeDecodeError:
        return "its header is damaged"


def _unreadable(path: Path, reason: str) -> FileError:
    return FileError(f"{path}: cannot be read as an image ({reason}); copy or convert it again")
