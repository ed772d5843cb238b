"""Folders of photographs of several people: the Extended Yale B layout, or a folder a person."""

import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path, PurePath

import numpy as np
from jaxtyping import Bool, Float

from harmface.conventions import luminance
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.images import read_image
from harmface.io.photo_folders import PHOTOGRAPH_SUFFIXES, files_below
from harmface.io.pictures import MAX_PIXELS, check_total

SUBSET_LIMITS = (12.5, 25.5, 52.0, 77.5)
"""Largest angle, in degrees, between light and viewing axis of the subsets 1 to 4 of the database;
beyond is subset 5. Its own list counts lights of 51.1 degrees in the third."""

# yaleB01_P00A+035E+40.pgm: person, pose, azimuth and elevation of the light.
_YALE_NAME = re.compile(r"(yaleB\d+)_P(\d+)A([+-]\d{3})E([+-]\d{2})")
_FRONTAL = "00"


@dataclass(frozen=True)
class Photograph:
    """One photograph of a set.

    Parameters
    ----------
    path
        Its file.
    subject
        Who it shows.
    light
        Direction to the light, if the file's name tells it.
    subset
        1 to 5 by the angle of the light from the viewing axis; 0 if that is not known.
    """

    path: Path
    subject: str
    light: tuple[float, float, float] | None
    subset: int


def find_photographs(
    folder: Path | str, *, sessions: bool = False, unlabelled: bool = False
) -> list[Photograph]:
    """List the photographs below a folder, by subject and name.

    In the Extended Yale B layout (`yaleB01/yaleB01_P00A+035E+40.pgm`) names tell the light; its
    ambient and spoilt (`.bad`) photographs and other stray files are passed over. Any other
    folder is taken to hold a folder of photographs for each subject. Hidden files and what
    systems leave behind are passed over, links to folders are followed.

    Parameters
    ----------
    folder
        Where they are.
    sessions
        Whether a subject's folder holds others, such as one for each session, whose photographs
        are the subject's; otherwise the folder in which a photograph lies is the subject.
    unlabelled
        Whether photographs may lie in the folder itself, too; then their subject is "", and there
        need not be two.

    Returns
    -------
    list of Photograph
        Sorted by subject and name.

    Raises
    ------
    FileError
        If the folder is missing, cannot be read, holds photographs of fewer than two subjects, or
        several folders of one.

    Warns
    -----
    FileWarning
        If photographs of the Yale database are left out because the head is turned.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise FileError(f"{folder}: is not a folder; give one of photographs")
    files = sorted(files_below(folder))
    found = _yale_photographs(folder, files)
    by_name = bool(found)
    found = found or [
        Photograph(path, inside[0 if sessions else -1] if inside else "", None, 0)
        for path in files
        if path.suffix.lower() in PHOTOGRAPH_SUFFIXES
        and ((inside := path.relative_to(folder).parts[:-1]) or unlabelled)
    ]
    if unlabelled:
        if not found:
            raise FileError(f"{folder}: holds no photographs; give PNG, TIFF, PGM or JPEG files")
        return found
    if by_name or not sessions:
        _check_folders(found)
    if len({photograph.subject for photograph in found}) < 2:
        raise FileError(
            f"{folder}: holds photographs of fewer than two subjects; give SUBJECT/*.png, or "
            "yaleB01/yaleB01_P00A+035E+40.pgm and so on"
        )
    return found


def _check_folders(found: list[Photograph]) -> None:
    """Refuse two folders of one name: they may be of two people, or of one."""
    folders: dict[str, Path] = {}
    for photograph in found:
        place = photograph.path.parent
        if folders.setdefault(photograph.subject, place) != place:
            raise FileError(
                f"{place}: is the second folder of subject {photograph.subject!r}, after "
                f"{folders[photograph.subject]}; rename or merge it, or say sessions "
                "(--sessions) if the folders around them are the subjects"
            )


def read_photographs(
    photographs: list[Photograph],
    *,
    srgb: bool = False,
    size: tuple[int, int] | None = None,
    max_pixels: int = MAX_PIXELS,
    bad: Callable[[FileError], None] | None = None,
) -> tuple[list[Photograph], Float[np.ndarray, "n H W"]]:
    """Read photographs as one stack of luminance in [0, 1], float32.

    Parameters
    ----------
    photographs
        What to read.
    srgb
        Whether values are encoded in sRGB and should be made linear.
    size
        Rows and columns to resize to, by area averages; all must be alike if not given. Their
        ratio of sides must be one, and if it is not that of `size`, the middle is cut out.
    max_pixels
        Largest photograph read; as they are kept, all together may have 16 times as many pixels.
    bad
        Told of every file that cannot be read, which is then left out; without it the first such
        file ends the reading.

    Returns
    -------
    tuple
        The photographs that were read, and their pixels.

    Raises
    ------
    FileError
        If a file cannot be read (and `bad` is not given), or has another size than the first, or
        another ratio of sides.

    Warns
    -----
    FileWarning
        If photographs have another ratio of sides than `size`.
    """
    kept: list[Photograph] = []
    images: list[np.ndarray] = []
    stored: tuple[int, int] | None = None
    for photograph in photographs:
        try:
            image = read_image(photograph.path, srgb=srgb, max_pixels=max_pixels)
            image = luminance(image) if image.ndim == 3 else image
            if stored is None:
                stored = (image.shape[0], image.shape[1])
                if size is not None and not _alike(stored, size):
                    warnings.warn(
                        f"{photograph.path}: has {stored[0]} x {stored[1]} pixels, of which the "
                        f"middle is cut out for another ratio of sides, {size[0]} x {size[1]}",
                        FileWarning,
                        stacklevel=2,
                    )
            if size is not None:
                image = resized(photograph.path, image, size, stored)
            check_total(photograph.path, len(photographs), image.shape, max_pixels)
            if images and image.shape != images[0].shape:
                raise FileError(
                    f"{photograph.path}: has {image.shape[0]} x {image.shape[1]} pixels, others "
                    f"{images[0].shape[0]} x {images[0].shape[1]}; ask for a common size"
                )
            if np.ptp(image) == 0:
                raise FileError(f"{photograph.path}: has one value everywhere; it shows nothing")
        except FileError as error:
            if bad is None:
                raise
            bad(error)
            continue
        kept.append(photograph)
        images.append(image.astype(np.float32))
    if not images:
        raise ArgumentError("photographs must hold at least one that can be read")
    return kept, np.stack(images)


def resized(
    path: Path, image: Float[np.ndarray, "H W"], size: tuple[int, int], like: tuple[int, int]
) -> Float[np.ndarray, "h w"]:
    """Resize a photograph by area averages, as others were; it is cut but never stretched.

    Parameters
    ----------
    path
        Named in errors.
    image
        The photograph.
    size
        Rows and columns to resize to.
    like
        Rows and columns that the others had: the ratio must be the same, to a pixel.

    Raises
    ------
    FileError
        If the ratio of sides is another.
    """
    import cv2

    if image.shape == size:
        return image
    if not _alike(image.shape, like):
        raise FileError(
            f"{path}: has {image.shape[0]} x {image.shape[1]} pixels, another ratio of sides than "
            f"others, {like[0]} x {like[1]}; crop it as they are"
        )
    if not _alike(image.shape, size):
        rows, columns = image.shape
        scale = min(rows / size[0], columns / size[1])
        high, wide = round(size[0] * scale), round(size[1] * scale)
        top, left = (rows - high) // 2, (columns - wide) // 2
        image = image[top : top + high, left : left + wide]
    return cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA)


def read_probe(
    path: Path,
    mask: Bool[np.ndarray, "H W"],
    *,
    like: tuple[int, int] | None = None,
    srgb: bool = False,
    max_pixels: int = MAX_PIXELS,
) -> Float[np.ndarray, "H W"]:
    """Read a photograph as luminance, to be compared with a gallery.

    Parameters
    ----------
    path
        Its file.
    mask
        Pixels that are compared, of the size that it must have.
    like
        Rows and columns that the gallery's photographs had before they were resized, if they were:
        it is resized as they were.
    srgb
        Whether values are encoded in sRGB and should be made linear.
    max_pixels
        Largest photograph read.

    Raises
    ------
    FileError
        If it cannot be read, has another size, or shows nothing on the mask.
    """
    image = read_image(path, srgb=srgb, max_pixels=max_pixels)
    image = luminance(image) if image.ndim == 3 else image
    if like is not None:
        image = resized(path, image, (mask.shape[0], mask.shape[1]), like)
    if image.shape != mask.shape:
        raise FileError(
            f"{path}: has {image.shape[0]} x {image.shape[1]} pixels, the gallery has "
            f"{mask.shape[0]} x {mask.shape[1]}; resize it, or enroll with its --size"
        )
    if not image[mask].any():
        raise FileError(f"{path}: is all black where faces are; give a photograph with light in it")
    if np.ptp(image[mask]) == 0:
        raise FileError(f"{path}: has one value everywhere that faces are; it shows nothing")
    return image


def _alike(shape: tuple[int, ...], size: tuple[int, int]) -> bool:
    """Return whether a picture has the ratio of sides of a size, to a pixel of it."""
    rows, columns = size
    return (
        abs(columns - rows * shape[1] / shape[0]) <= 1
        or abs(rows - columns * shape[0] / shape[1]) <= 1
    )


def yale_light(name: str) -> tuple[float, float, float] | None:
    """Return the direction to the light that a file name of the Yale databases tells, or None.

    A positive azimuth of theirs lights the left of the image, a positive elevation comes from
    above.

    Examples
    --------
    >>> [round(x, 3) for x in yale_light("yaleB01_P00A+090E+00.pgm")]
    [-1.0, 0.0, 0.0]
    """
    match = _yale_match(name)
    if not match:
        return None
    a, e = np.radians(float(match[3])), np.radians(float(match[4]))
    return float(-np.sin(a) * np.cos(e)), float(np.sin(e)), float(np.cos(a) * np.cos(e))


def _yale_match(name: str) -> re.Match[str] | None:
    path = PurePath(name)
    known = path.suffix.lower() in PHOTOGRAPH_SUFFIXES
    return _YALE_NAME.fullmatch(path.stem) if known else None


def _yale_photographs(folder: Path, files: list[Path]) -> list[Photograph]:
    """Return those of one pose: frontal, or else the only one that there is."""
    matches = [(path, match) for path in files if (match := _yale_match(path.name))]
    poses = sorted({match[2] for _, match in matches})
    pose = _FRONTAL if _FRONTAL in poses else next(iter(poses), None)
    if len(poses) > 1 and pose != _FRONTAL:
        raise FileError(
            f"{folder}: holds the poses P{', P'.join(poses)} but not P{_FRONTAL}; give one of them"
        )
    kept = [(path, match) for path, match in matches if match[2] == pose]
    if len(kept) < len(matches):
        warnings.warn(
            f"{folder}: {len(matches) - len(kept)} photographs of other poses than P{pose} are "
            "left out",
            FileWarning,
            stacklevel=3,
        )
    found = []
    for path, match in kept:
        light = yale_light(path.name)
        assert light is not None
        angle = np.degrees(np.arccos(np.clip(light[2], -1, 1)))
        subset = 1 + int(np.searchsorted(SUBSET_LIMITS, angle))
        found.append(Photograph(path, match[1], light, subset))
    return found
