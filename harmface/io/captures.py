"""Photographs of one still object under changing light, with what is known of them."""

import zlib
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.conventions import luminance
from harmface.errors import ArgumentError, FileError
from harmface.io.files import read_bytes
from harmface.io.images import read_image
from harmface.io.photo_sets import yale_light

_SUFFIXES = (".png", ".tif", ".tiff", ".pgm", ".jpg", ".jpeg", ".bmp")


@dataclass(frozen=True, eq=False)
class Capture:
    """Photographs and what came with them.

    Parameters
    ----------
    names
        File of each photograph.
    images
        Linear luminance; divided by the lights' intensities where these are known.
    mask
        The object, if a mask came with it.
    lights
        Unit direction to the light of each photograph, if known.
    truth
        True unit normals, if known; zero in the background.
    """

    names: tuple[str, ...]
    images: Float[np.ndarray, "F H W"]
    mask: Bool[np.ndarray, "H W"] | None
    lights: Float[np.ndarray, "F 3"] | None
    truth: Float[np.ndarray, "H W 3"] | None


def read_capture(paths: list[Path], *, srgb: bool = False) -> Capture:
    """Read photographs given as files, or as one folder.

    A folder with `filenames.txt` is in the DiLiGenT layout: `light_directions.txt`,
    `light_intensities.txt`, `mask.png` and `Normal_gt.mat` are read where they are. Names of the
    Extended Yale B database tell their lights. Of any other folder all photographs are read, and
    `mask.png` as the mask.

    Parameters
    ----------
    paths
        Photographs, or one folder of them.
    srgb
        Whether values are encoded in sRGB and should be made linear.

    Raises
    ------
    FileError
        If a file is missing or broken, sizes differ, or counts disagree.
    """
    folder = paths[0] if len(paths) == 1 and paths[0].is_dir() else None
    if folder is None:
        return _capture(paths, None, srgb)
    if (folder / "filenames.txt").exists():
        return _diligent(folder, srgb)
    files = sorted(
        path
        for path in folder.iterdir()
        if path.suffix.lower() in _SUFFIXES and path.name != "mask.png"
    )
    files = [path for path in files if "_Ambient" not in path.name]
    if not files:
        raise FileError(f"{folder}: holds no photographs; give PNG, TIFF, PGM or JPEG files")
    mask = folder / "mask.png"
    return _capture(files, mask if mask.exists() else None, srgb)


def read_mask(path: Path | str) -> Bool[np.ndarray, "H W"]:
    """Read a mask: True where an image is at least half white."""
    image = read_image(path)
    return np.asarray((image.mean(axis=-1) if image.ndim == 3 else image) >= 0.5)


def read_lights(path: Path | str, count: int) -> Float[np.ndarray, "F 3"]:
    """Read light directions: a text file of three numbers a line, one line for each image.

    Raises
    ------
    FileError
        If the file is no such text, the number of lines is not `count`, or a direction is zero.
    """
    table = _table(Path(path))
    if table.shape != (count, 3):
        raise FileError(
            f"{path}: holds {table.shape[0]} lines of {table.shape[1]} numbers, but {count} images "
            "need a line of three each"
        )
    lengths = np.linalg.norm(table, axis=1, keepdims=True)
    if not lengths.all():
        raise FileError(f"{path}: holds a direction of length zero")
    return table / lengths


def _capture(files: list[Path], mask: Path | None, srgb: bool) -> Capture:
    images = _images(files, srgb)
    named = [yale_light(path.name) for path in files]
    known = [light for light in named if light is not None]
    lights = np.array(known) if len(known) == len(files) else None
    grey = [luminance(image) if image.ndim == 3 else image for image in images]
    return Capture(
        tuple(path.name for path in files),
        np.stack(grey),
        None if mask is None else read_mask(mask),
        lights,
        None,
    )


def _images(files: list[Path], srgb: bool) -> list[np.ndarray]:
    images = [read_image(path, srgb=srgb) for path in files]
    for path, image in zip(files, images, strict=True):
        if image.shape[:2] != images[0].shape[:2]:
            raise FileError(
                f"{path}: has {image.shape[0]} x {image.shape[1]} pixels, {files[0].name} has "
                f"{images[0].shape[0]} x {images[0].shape[1]}; photographs must be of one size"
            )
    return images


def _diligent(folder: Path, srgb: bool) -> Capture:
    listed = read_bytes(folder / "filenames.txt").decode("utf-8", "replace").split()
    if not listed or any(Path(name).name != name for name in listed):
        raise FileError(f"{folder / 'filenames.txt'}: must list plain file names")
    images = _images([folder / name for name in listed], srgb)
    lights = intensities = None
    if (folder / "light_directions.txt").exists():
        lights = read_lights(folder / "light_directions.txt", len(listed))
    if (folder / "light_intensities.txt").exists():
        intensities = _table(folder / "light_intensities.txt")
        if len(intensities) != len(listed) or not (intensities > 0).all():
            raise FileError(
                f"{folder / 'light_intensities.txt'}: must hold a positive line for each image"
            )
    grey = []
    for number, image in enumerate(images):
        channels = image if image.ndim == 3 else image[..., None]
        scale = 1.0 if intensities is None else intensities[number]
        grey.append((channels / scale).mean(axis=-1))
    mask, truth = folder / "mask.png", folder / "Normal_gt.mat"
    return Capture(
        tuple(listed),
        np.stack(grey),
        read_mask(mask) if mask.exists() else None,
        lights,
        _matlab_normals(truth) if truth.exists() else None,
    )


def _table(path: Path) -> Float[np.ndarray, "rows columns"]:
    text = read_bytes(path).decode("utf-8", "replace")
    try:
        rows = [[float(number) for number in line.split()] for line in text.splitlines() if line]
        return checks.finite("values", np.array([row for row in rows if row], float, ndmin=2))
    except (ArgumentError, ValueError) as error:
        raise FileError(f"{path}: is not a table of numbers ({error})") from None


def _matlab_normals(path: Path) -> Float[np.ndarray, "H W 3"]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    data = read_bytes(path)
    try:
        normals = np.asarray(loadmat(BytesIO(data))["Normal_gt"], dtype=np.float64)
    except (
        KeyError,
        MatReadError,
        NotImplementedError,
        OSError,
        TypeError,
        ValueError,
        zlib.error,
    ) as error:
        raise FileError(f"{path}: holds no MATLAB array Normal_gt ({error})") from None
    if normals.ndim != 3 or normals.shape[2] != 3:
        raise FileError(f"{path}: Normal_gt must be H x W x 3, got {normals.shape}")
    return normals
