"""OpenEXR pictures (`.exr`), through OpenImageIO."""

import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.atomic import atomic_write
from harmface.io.files import check_regular, excerpt
from harmface.io.pictures import MAX_PIXELS, check_size, opened, pixels
from harmface.io.primaries import REC709, in_rec709, luminance_weights, to_rec709

MAX_CHANNELS = 128
"""Most channels of a part; renderers write some dozens."""

MAX_PARTS = 256
"""Most parts that are looked through."""

_RGB, _GREY, _CHROMA = ("R", "G", "B"), ("Y",), ("RY", "Y", "BY")


def read_exr(
    path: Path | str, *, part: str | None = None, max_pixels: int = MAX_PIXELS
) -> Float[np.ndarray, "H W *channels"]:
    """Return linear RGB in Rec. 709, or luminance alone, of an OpenEXR picture, float32.

    The picture is the display window: what the data window leaves of it is black, and what lies
    outside of it is cut off. Other chromaticities, XYZ among them, and luminance with chroma
    (Y, RY, BY) are converted.

    Parameters
    ----------
    path
        The file.
    part
        Which of several pictures in the file to read: the name of a part, or its number from 0,
        or a layer or view, as `right` of `right.R`; by default the first that has no such prefix.
    max_pixels
        Largest picture read.

    Raises
    ------
    FileError
        If the file is missing, broken, larger than `max_pixels`, deep, has other channels, too
        many, or some of fewer pixels (subsampled chroma), or no such part.

    Warns
    -----
    FileWarning
        If the file holds other pictures too and `part` was not given, or colours beyond Rec. 709.
    """
    path = Path(path)
    check_regular(path)
    with opened(path) as source:
        if source.format_name() != "openexr":
            raise FileError(f"{path}: is not an OpenEXR picture (its first bytes are of another)")
        pictures = _pictures(path, source)
        name, layer, index = _chosen(path, pictures, part)
        source.seek_subimage(index, 0)
        spec = source.spec()
        check_size(path, spec.width, spec.height, max_pixels)
        check_size(path, spec.full_width, spec.full_height, max_pixels)
        image = _read(path, source, spec, layer)
    if part is None and len(pictures) > 1:
        others = excerpt(", ".join(repr(each) for each, _, _ in pictures if each != name))
        warnings.warn(
            f"{path}: holds several pictures, of which {name!r} was read; ask for another by part "
            f"(--part): {others}",
            FileWarning,
            stacklevel=2,
        )
    return image


def write_exr(path: Path | str, image: Float[np.ndarray, "H W *channels"]) -> None:
    """Write `(H, W)` or `(H, W, 3)` values as an OpenEXR picture, float32, ZIP-compressed.

    Raises
    ------
    ArgumentError
        If a value is NaN or infinite, or the shape is another.
    FileError
        If the file cannot be written.
    """
    import OpenImageIO

    image = checks.picture("image", image)
    codes = np.ascontiguousarray(np.atleast_3d(image), dtype=np.float32)
    rows, columns, channels = codes.shape
    spec = OpenImageIO.ImageSpec(columns, rows, channels, "float")
    spec.channelnames = _RGB if image.ndim == 3 else _GREY
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", "")  # Else it is the time of day.
    # The library writes to names only.
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder, "image.exr")
        target: Any = OpenImageIO.ImageOutput.create(str(whole))
        written = target.open(str(whole), spec) and target.write_image(codes)
        if not (target.close() and written):
            raise FileError(f"{path}: could not be encoded ({excerpt(target.geterror())})")
        data = whole.read_bytes()
    with atomic_write(path) as file:
        file.write(data)


def _pictures(path: Path, source: Any) -> list[tuple[str, str, int]]:
    """Return name, layer of channels and part of every picture of a file."""
    found = []
    names: list[str] = []
    index = 0
    while source.seek_subimage(index, 0):
        spec = source.spec()
        if spec.deep:
            raise FileError(
                f"{path}: is a deep picture, with several samples a pixel; flatten it first"
            )
        if index == MAX_PARTS or spec.nchannels > MAX_CHANNELS:
            raise FileError(
                f"{path}: has {index + 1} parts and {spec.nchannels} channels; {MAX_PARTS} and "
                f"{MAX_CHANNELS} at most are read"
            )
        names += spec.channelnames
        views = spec.getattribute("multiView")
        own = str(views[0] if views else spec.getattribute("oiio:subimagename") or index)
        layers = dict.fromkeys(name.rpartition(".")[0] for name in spec.channelnames)
        found += [
            (layer or own, layer, index)
            for layer in layers
            if any(_places(spec, layer, wanted) for wanted in (_RGB, _GREY))
        ]
        index += 1
    if not found:
        raise FileError(f"{path}: has no channels R, G, B or Y, but {excerpt(', '.join(names))}")
    return found


def _chosen(
    path: Path, pictures: list[tuple[str, str, int]], part: str | None
) -> tuple[str, str, int]:
    """Return the picture that was asked for, or the first; one without a layer if there is."""
    if part is None:
        return min(pictures, key=lambda picture: picture[1] != "")
    for picture in pictures:
        if part == picture[0] or (part == str(picture[2]) and not picture[1]):
            return picture
    names = ", ".join(repr(name) for name, _, _ in pictures)
    raise FileError(f"{path}: has no part {part!r}, but {excerpt(names)}")


def _places(spec: Any, layer: str, wanted: tuple[str, ...]) -> list[int]:
    """Return where the channels of a layer are, or nothing if one is missing."""
    names = {name: place for place, name in enumerate(spec.channelnames)}
    places = [names.get(f"{layer}.{name}" if layer else name) for name in wanted]
    return [place for place in places if place is not None] if None not in places else []


def _read(path: Path, source: Any, spec: Any, layer: str) -> Float[np.ndarray, "H W *channels"]:
    """Return a layer in its display window, in Rec. 709."""
    wanted = next(each for each in (_RGB, _CHROMA, _GREY) if _places(spec, layer, each))
    places = _places(spec, layer, wanted)
    low, high = min(places), max(places) + 1
    stored = pixels(path, source, low, high, "float")[..., [place - low for place in places]]
    image = _in_window(path, stored, spec)
    if wanted == _GREY:
        return image[..., 0]
    chromaticities = spec.getattribute("chromaticities")
    try:
        if wanted == _CHROMA:
            image = _from_chroma(image, luminance_weights(chromaticities or REC709))
        matrix = to_rec709(chromaticities or REC709)
    except ArgumentError as error:
        raise FileError(f"{path}: {excerpt(error)}") from None
    return image if matrix is None else in_rec709(path, image, matrix)


def _in_window(path: Path, stored: np.ndarray, spec: Any) -> np.ndarray:
    """Return the display window, black where the data window has nothing."""
    display = (spec.full_y, spec.full_x, spec.full_height, spec.full_width)
    if display == (spec.y, spec.x, spec.height, spec.width):
        return stored
    image = np.zeros((spec.full_height, spec.full_width, stored.shape[2]), np.float32)
    down, right = spec.y - spec.full_y, spec.x - spec.full_x
    target = image[max(down, 0) :, max(right, 0) :]
    source = stored[max(-down, 0) :, max(-right, 0) :]
    rows, columns = np.minimum(target.shape, source.shape)[:2]
    if rows == 0 or columns == 0:
        raise FileError(f"{path}: its data window lies outside of its display window")
    target[:rows, :columns] = source[:rows, :columns]
    return image


def _from_chroma(image: np.ndarray, weights: Float[np.ndarray, "3"]) -> np.ndarray:
    """Return red, green, blue of (R - Y) / Y, Y, (B - Y) / Y."""
    luminance = image[..., 1]
    red, blue = (image[..., 0] + 1) * luminance, (image[..., 2] + 1) * luminance
    green = (luminance - weights[0] * red - weights[2] * blue) / weights[1]
    return np.stack([red, green, blue], axis=-1).astype(np.float32)
