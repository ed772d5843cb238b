"""OpenEXR pictures (`.exr`), through the optional package OpenEXR."""

import contextlib
import io
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes

MAX_PIXELS = 2**27
"""Largest picture read: 134 megapixels."""


def read_exr(path: Path | str) -> Float[np.ndarray, "H W *channels"]:
    """Return the channels R, G and B, or Y alone, of an OpenEXR picture, float32.

    Raises
    ------
    FileError
        If the package OpenEXR is missing, or the file is missing, broken, larger than 134
        megapixels, or has other channels.
    """
    library = _library(path)
    read_bytes(path)  # Names a missing or empty file; the library's own words are obscure.
    shape = _size(library, path)
    with _reading(path), library.File(str(path), separate_channels=True) as file:
        channels = {name: channel.pixels for name, channel in file.channels().items()}
    names = [name for name in "RGB" if name in channels]
    names = names if len(names) == 3 else [name for name in "Y" if name in channels]
    if not names:
        raise FileError(f"{path}: has no channels R, G, B or Y, but {', '.join(channels)}")
    if any(np.shape(channels[name]) != shape for name in names):
        raise FileError(f"{path}: has channels of several sizes; convert it to .hdr")
    image = np.stack([channels[name] for name in names], axis=-1).astype(np.float32)
    return image if len(names) == 3 else image[..., 0]


def write_exr(path: Path | str, image: Float[np.ndarray, "H W *channels"]) -> None:
    """Write `(H, W)` or `(H, W, 3)` values as an OpenEXR picture, float32, ZIP-compressed.

    Raises
    ------
    ArgumentError
        If a value is NaN or infinite, or the shape is another.
    FileError
        If the package OpenEXR is missing or the file cannot be written.
    """
    library = _library(path)
    image = checks.finite("image", image)
    if image.ndim not in (2, 3) or image.shape[2:] not in ((), (3,)) or image.size == 0:
        raise ArgumentError(f"image must have shape (H, W) or (H, W, 3), got {image.shape}")
    pixels = np.ascontiguousarray(image, dtype=np.float32)
    header = {"compression": library.ZIP_COMPRESSION, "type": library.scanlineimage}
    # The library writes to names only.
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder, "image.exr")
        with library.File(header, {"RGB" if image.ndim == 3 else "Y": pixels}) as file:
            file.write(str(whole))
        data = whole.read_bytes()
    with atomic_write(path) as file:
        file.write(data)


def _library(path: Path | str) -> ModuleType:
    try:
        import OpenEXR
    except ImportError:
        raise FileError(
            f"{path}: .exr files need the package OpenEXR; install it with "
            "pip install 'harmface[exr]', or convert the file to .hdr"
        ) from None
    library: ModuleType = OpenEXR
    return library


def _size(library: ModuleType, path: Path | str) -> tuple[int, int]:
    """Return height and width as the header has them, before memory is taken for pixels."""
    with _reading(path), library.File(str(path), header_only=True) as file:
        low, high = (np.asarray(corner, dtype=int) for corner in file.header()["dataWindow"])
    width, height = (int(size) for size in high - low + 1)
    if min(width, height) < 1 or width * height > MAX_PIXELS:
        raise FileError(
            f"{path}: its header names {width} x {height} pixels, outside 1 to {MAX_PIXELS}"
        )
    return height, width


@contextlib.contextmanager
def _reading(path: Path | str) -> Iterator[None]:
    """Turn what the library prints and raises into one error; what it prints says more."""
    said = ""
    with contextlib.redirect_stdout(io.StringIO()) as printed, _silent_stderr():
        try:
            yield
        except (KeyError, OverflowError, RuntimeError, TypeError, ValueError) as error:
            said = str(error) or type(error).__name__
    said = printed.getvalue() or said
    if said:
        raise FileError(
            f"{path}: is not a whole OpenEXR picture ({said.splitlines()[0]}); "
            "copy or convert it again"
        )


@contextlib.contextmanager
def _silent_stderr() -> Iterator[None]:
    """Keep C++ from printing details of what is raised or printed by Python anyway."""
    sys.stderr.flush()
    saved = os.dup(2)
    try:
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
