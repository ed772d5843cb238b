"""Folders of photographs of several people: the Extended Yale B layout, or a folder a person."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from harmface.conventions import luminance
from harmface.errors import ArgumentError, FileError
from harmface.io.files import read_bytes
from harmface.io.images import read_image
from harmface.recognition.nine_points import nearest_lights, nine_points

SUBSET_LIMITS = (12.5, 25.5, 52.0, 77.5)
"""Largest angle, in degrees, between light and viewing axis of the subsets 1 to 4 of the database;
beyond is subset 5. Its own list counts lights of 51.1 degrees in the third."""

# yaleB01_P00A+035E+40.pgm: person, pose, azimuth and elevation of the light.
_YALE_NAME = re.compile(r"(yaleB\d+)_P\d+A([+-]\d{3})E([+-]\d{2})\.(?:pgm|png|tiff?)")
_SUFFIXES = (".png", ".pgm", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp")


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


def find_photographs(folder: Path | str) -> list[Photograph]:
    """List the photographs below a folder, by subject and name.

    In the Extended Yale B layout (`yaleB01/yaleB01_P00A+035E+40.pgm`) names tell the light; its
    ambient and spoilt (`.bad`) photographs and other stray files are passed over. Any other
    folder is taken to hold a folder of photographs for each subject.

    Raises
    ------
    FileError
        If the folder is missing or holds photographs of fewer than two subjects.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise FileError(f"{folder}: is not a folder; give one of photographs")
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    found = [
        _yale_photograph(path, light)
        for path in files
        if (light := yale_light(path.name)) is not None
    ] or [
        Photograph(path, path.parent.name, None, 0)
        for path in files
        if path.suffix.lower() in _SUFFIXES and path.parent != folder
    ]
    if len({photograph.subject for photograph in found}) < 2:
        raise FileError(
            f"{folder}: holds photographs of fewer than two subjects; give SUBJECT/*.png, or "
            "yaleB01/yaleB01_P00A+035E+40.pgm and so on"
        )
    return found


def read_photographs(
    photographs: list[Photograph],
    *,
    srgb: bool = False,
    size: tuple[int, int] | None = None,
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
        Rows and columns to resize to, by area averages; all must be alike if not given.
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
        If a file cannot be read (and `bad` is not given), or has another size than the first.
    """
    import cv2

    kept: list[Photograph] = []
    images: list[np.ndarray] = []
    for photograph in photographs:
        try:
            image = read_image(photograph.path, srgb=srgb)
            image = luminance(image) if image.ndim == 3 else image
            if size is not None and image.shape != size:
                image = cv2.resize(image, size[::-1], interpolation=cv2.INTER_AREA)
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


def choose_gallery(photographs: list[Photograph], gallery: str) -> Bool[np.ndarray, "n"]:
    """Return which photographs make the gallery; all others are probes.

    Parameters
    ----------
    photographs
        All of them.
    gallery
        "ninepoints": of each subject those nearest to the nine points of light; "subset1": those
        under frontal light; "first:N": the first of each subject; else a text file of names.

    Raises
    ------
    ArgumentError
        If a subject is not in the gallery, or lights are needed and not known.
    FileError
        If the text file is missing or names other files.
    """
    chosen = np.zeros(len(photographs), bool)
    subjects = np.array([photograph.subject for photograph in photographs])
    if gallery in ("ninepoints", "subset1"):
        if any(photograph.light is None for photograph in photographs):
            raise ArgumentError(
                f"gallery {gallery} needs names that tell the light, as Extended Yale B has; "
                "use first:N or a list"
            )
        if gallery == "subset1":
            chosen = np.array([photograph.subset == 1 for photograph in photographs])
        else:
            chosen[_nine_points(photographs, subjects)] = True
    elif gallery.startswith("first:"):
        count = gallery.removeprefix("first:")
        if not count.isdigit() or int(count) < 1:
            raise ArgumentError(f"gallery first:N needs a whole number, got {gallery!r}")
        for subject in np.unique(subjects):
            chosen[np.flatnonzero(subjects == subject)[: int(count)]] = True
    else:
        chosen = _listed(photographs, Path(gallery))
    missing = sorted(set(subjects) - set(subjects[chosen]))
    if missing:
        raise ArgumentError(f"gallery {gallery} holds no photograph of {missing[0]}")
    return chosen


def _nine_points(photographs: list[Photograph], subjects: np.ndarray) -> np.ndarray:
    found = []
    for subject in np.unique(subjects):
        own = np.flatnonzero(subjects == subject)
        lights = np.array([photographs[i].light for i in own], dtype=np.float64)
        found.append(own[nearest_lights(lights, nine_points())])
    return np.concatenate(found)


def _listed(photographs: list[Photograph], path: Path) -> np.ndarray:
    try:
        lines = read_bytes(path).decode().splitlines()
    except UnicodeDecodeError:
        raise FileError(f"{path}: is not a text file of photographs' names") from None
    wanted = {line.strip() for line in lines if line.strip()}
    names = [photograph.path.name for photograph in photographs]
    unknown = sorted(wanted - set(names))
    if unknown:
        raise FileError(f"{path}: names {unknown[0]}, which is not among the photographs")
    return np.array([name in wanted for name in names])


def yale_light(name: str) -> tuple[float, float, float] | None:
    """Return the direction to the light that a file name of the Yale databases tells, or None.

    A positive azimuth of theirs lights the left of the image, a positive elevation comes from
    above.

    Examples
    --------
    >>> [round(x, 3) for x in yale_light("yaleB01_P00A+090E+00.pgm")]
    [-1.0, 0.0, 0.0]
    """
    match = _YALE_NAME.fullmatch(name)
    if not match:
        return None
    a, e = np.radians(float(match[2])), np.radians(float(match[3]))
    return float(-np.sin(a) * np.cos(e)), float(np.sin(e)), float(np.cos(a) * np.cos(e))


def _yale_photograph(path: Path, light: tuple[float, float, float]) -> Photograph:
    angle = np.degrees(np.arccos(np.clip(light[2], -1, 1)))
    subset = 1 + int(np.searchsorted(SUBSET_LIMITS, angle))
    return Photograph(path, path.name.split("_")[0], light, subset)
