"""Photographs of one still object under changing light, with what is known of them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from harmface.conventions import luminance
from harmface.errors import FileError
from harmface.io.clipping import Clipping
from harmface.io.files import MAX_TEXT, excerpt, is_file_name, read_bytes
from harmface.io.hot_pixels import without_hot_pixels
from harmface.io.light_files import Lights, read_lights
from harmface.io.matlab import read_matlab
from harmface.io.photo_folders import Sorted, light_file_of, photographs_in, sort_photographs
from harmface.io.photo_sets import yale_light
from harmface.io.pictures import MAX_PIXELS, check_total, read_picture
from harmface.io.tables import read_table
from harmface.summaries import summary

CHANNELS = ("red", "green", "blue")


@dataclass(frozen=True, eq=False)
class Capture:
    """Photographs and what came with them.

    Parameters
    ----------
    names
        File of each photograph.
    images
        Linear luminance, float32; divided by the lights' intensities where these are known.
    saturated
        Which observations are clipped in any channel: at the largest value that the file could
        hold, or at a common one below it, see `clipping.Clipping`.
    mask
        The object, if a mask came with it.
    lights
        Unit direction to the light of each photograph, if known.
    distances
        How far the lights are, in the unit of their file, if positions were asked for.
    strengths
        Of the lights in the images: 1 of each where these were divided by known intensities.
    truth
        True unit normals, if known; zero in the background.
    notes
        What to know of how the files were read.
    """

    names: tuple[str, ...]
    images: Float[np.ndarray, "F H W"]
    saturated: Bool[np.ndarray, "F H W"]
    mask: Bool[np.ndarray, "H W"] | None
    lights: Float[np.ndarray, "F 3"] | None
    distances: Float[np.ndarray, "F"] | None
    strengths: Float[np.ndarray, "F"] | None
    truth: Float[np.ndarray, "H W 3"] | None
    notes: tuple[str, ...]

    __repr__ = summary


def read_capture(
    paths: list[Path],
    *,
    srgb: bool | None = None,
    mask: Path | None = None,
    lights: Path | None = None,
    positions: bool = False,
    coloured: bool = False,
    aside: Path | None = None,
    max_pixels: int = MAX_PIXELS,
    report: Callable[[float], None] = lambda done: None,
) -> Capture:
    """Read photographs given as files, or as one folder.

    A folder with `filenames.txt` is in the DiLiGenT layout: `light_directions.txt`,
    `light_intensities.txt` (a number or one for each channel), `mask.png` and `Normal_gt.mat` are
    read where they are. Of any other folder all photographs are read, the lights, see
    `light_file_of`, and the mask, see `sort_photographs`. Names of the Extended Yale B database
    tell their lights.

    Parameters
    ----------
    paths
        Photographs, or one folder of them.
    srgb
        Whether the photographs are encoded in sRGB, whatever their files say. If not given, what
        a file says is believed, and one that says nothing is linear.
    mask
        The mask's file; found among the photographs if not given.
    lights
        The lights' file, see `read_lights`; found in the folder, or the one that it lies in, if
        not given.
    positions
        Whether the lights' file holds positions of lamps, not directions.
    coloured
        Whether lamps of three colours shone at once: each channel of a photograph, red, green and
        blue in this order, counts as a photograph under a lamp of its own, with a light of its own.
    aside
        A file among the photographs that is neither one of them nor the object's mask.
    max_pixels
        Largest photograph read; all together may have 16 times as many pixels.
    report
        Told the fraction of the photographs that have been read.

    Returns
    -------
    Capture
        Photographs, mask, lights and truth, as far as there are such.

    Raises
    ------
    FileError
        If a file is missing or broken, sizes differ, or counts disagree.
    """
    folder = paths[0] if len(paths) == 1 and paths[0].is_dir() else None
    if folder is not None and (folder / "filenames.txt").exists():
        found = Sorted(_listed(folder), mask or _existing(folder, "mask.png"), ())
    else:
        inside = paths if folder is None else photographs_in(folder)
        if aside is not None:
            inside = [path for path in inside if path.resolve() != aside.resolve()]
        found = sort_photographs(inside, mask)
    files = found.photographs
    names = [path.name for path in files]
    if coloured:
        names = [f"{name} {channel}" for name in names for channel in CHANNELS]
    known, light_notes = _lights(files, len(names), folder, lights, positions)
    intensities = _intensities(folder, known, len(names))
    images, saturated, notes = _stack(files, intensities, srgb, coloured, max_pixels, report)
    mask_image = None
    if found.mask is not None:
        mask_image = read_mask(found.mask)
        if mask_image.shape != images.shape[1:]:
            raise _other_size(found.mask, mask_image, files[0], images[0])
    truth = None if folder is None else _existing(folder, "Normal_gt.mat")
    return Capture(
        tuple(names),
        images,
        saturated,
        mask_image,
        None if known is None else known.directions,
        known.distances if known is not None and positions else None,
        None if intensities is None else np.ones(len(names)),
        None if truth is None else _matlab_normals(truth, images.shape[1:]),
        (*found.notes, *light_notes, *notes),
    )


def read_mask(path: Path | str) -> Bool[np.ndarray, "H W"]:
    """Read a mask: True where an image is at least half as bright as at its brightest.

    Parameters
    ----------
    path
        A picture that `read_image` reads; what it says of its encoding does not matter.

    Returns
    -------
    numpy.ndarray
        Shape (H, W), bool.

    Raises
    ------
    FileError
        If the file is no image, or black everywhere.
    """
    # Encoding moves no edge between black and white, and half grey is half of the codes.
    picture = read_picture(path)
    image = picture.values(False)
    grey = image.mean(axis=-1) if image.ndim == 3 else image
    if not grey.any():
        raise FileError(f"{path}: is an empty mask, black everywhere; paint the object white")
    return np.asarray(grey >= grey.max() / 2)


def _existing(folder: Path, *names: str) -> Path | None:
    """Return the first of the files that exists."""
    return next((folder / name for name in names if (folder / name).exists()), None)


def _listed(folder: Path) -> list[Path]:
    path = folder / "filenames.txt"
    lines = read_bytes(path, MAX_TEXT).decode("utf-8", "replace").splitlines()
    names = [line.strip() for line in lines if line.strip()]
    bad = next((name for name in names if not is_file_name(name)), None)
    if not names or bad is not None:
        raise FileError(
            f"{path}: must list plain file names, a line each, got {excerpt(repr(bad))}"
        )
    return [folder / name for name in names]


def _lights(
    files: list[Path], count: int, folder: Path | None, given: Path | None, positions: bool
) -> tuple[Lights | None, tuple[str, ...]]:
    """Return the lights of photographs, and what to know of how they were found."""
    # A file that names photographs does not name their channels.
    names = [path.name for path in files] if count == len(files) else []
    path = given or (None if folder is None else light_file_of(folder))
    if path is None:
        if positions:
            raise FileError(f"{files[0].parent}: holds no file of lamps' positions; give --lights")
        known = _named_lights(files) if count == len(files) else None
        return known, () if known is None else known.notes
    if given is not None or path.parent == folder:
        known = read_lights(path, count, names, positions=positions)
        return known, known.notes
    # What lies one folder up may belong to other photographs.
    try:
        known = read_lights(path, count, names, positions=positions)
    except FileError as error:
        if positions:
            raise
        return _named_lights(files), (f"lights beside the folder are not used: {error}",)
    return known, (f"the lights are those of {path}", *known.notes)


def _named_lights(files: list[Path]) -> Lights | None:
    """Return the lights that names of the Extended Yale B database tell."""
    directions = [light for path in files if (light := yale_light(path.name)) is not None]
    return (
        Lights(np.array(directions), np.ones(len(files)), None)
        if len(directions) == len(files)
        else None
    )


def _intensities(
    folder: Path | None, lights: Lights | None, count: int
) -> Float[np.ndarray, "F channels"] | None:
    """Return the intensity of each light, one for all channels or one for each."""
    if lights is not None and lights.intensities is not None:
        return lights.intensities[:, None]
    path = None if folder is None else _existing(folder, "light_intensities.txt")
    if path is None:
        return None
    table = read_table(path).numbers
    if len(table) != count or table.shape[1] not in (1, 3) or not (table > 0).all():
        raise FileError(
            f"{path}: must hold one positive number, or three, for each of the {count} images"
        )
    return table


def _stack(
    files: list[Path],
    intensities: Float[np.ndarray, "F channels"] | None,
    srgb: bool | None,
    coloured: bool,
    max_pixels: int,
    report: Callable[[float], None],
) -> tuple[Float[np.ndarray, "F H W"], Bool[np.ndarray, "F H W"], list[str]]:
    """Return the photographs in one channel, which observations are saturated, and notes."""
    first = read_picture(files[0], max_pixels).codes
    count = len(files) * (len(CHANNELS) if coloured else 1)
    check_total(files[0], count, first.shape, max_pixels)
    stack = np.empty((count, *first.shape[:2]), np.float32)
    saturated = np.empty(stack.shape, bool)
    marks = np.empty(stack.shape, np.uint8)
    clipping = Clipping()
    notes: list[str] = []
    full: float | None = None
    guessed = False
    number = 0
    for path in files:
        picture = read_picture(path, max_pixels)
        image, codes = picture.linear(srgb), picture.codes
        if image.shape[:2] != stack.shape[1:]:
            raise _other_size(path, image, files[0], stack[0])
        full = None if codes.dtype.kind == "f" else float(np.iinfo(codes.dtype).max)
        if coloured and image.shape[2:] != (len(CHANNELS),):
            raise FileError(f"{path}: is grey, but lamps of three colours need colour photographs")
        parts = [(image, codes)]
        if coloured:
            parts = [(image[..., c], codes[..., c]) for c in range(len(CHANNELS))]
        for values, part in parts:
            at_full = part == full
            if 0 < at_full.mean() < 1 and (at_full | (part == 0)).all():
                raise FileError(
                    f"{path}: is black and white only; if it is a mask, give it as --mask"
                )
            saturated[number] = at_full if part.ndim == 2 else at_full.any(axis=-1)
            marks[number] = clipping.add(part)
            intensity = None if intensities is None else intensities[number]
            stack[number] = _one_channel(values, intensity)
            number += 1
        notes += picture.notes
        guessed |= picture.srgb is None and path.suffix.lower() in (".jpg", ".jpeg")
        report(number / count)
    levels = clipping.levels(full)
    found = [f"{level:g}" for level in levels if level is not None]
    if found:
        for number in range(count):
            saturated[number] |= clipping.clipped(number, marks[number], levels)
        notes.append(
            f"the photographs are clipped at {' and '.join(dict.fromkeys(found))}"
            + ("" if full is None else f", below the largest code of their files, {full:g}")
            + f": {saturated.mean():.1%} of the observations are taken as saturated"
        )
    stack, hot = without_hot_pixels(stack)
    if hot:
        notes.append(
            f"{hot} hot pixels, each far brighter than its neighbours in one photograph alone, "
            "have the median of these"
        )
    if guessed and srgb is None:
        notes.append(
            "JPEG files are hardly ever linear; if these come from a camera, say --gamma srgb"
        )
    return stack, saturated, notes


def _one_channel(
    image: Float[np.ndarray, "H W *channels"], intensity: Float[np.ndarray, "channels"] | None
) -> Float[np.ndarray, "H W"]:
    """Return luminance over intensity; the mean of the channels if each has its intensity."""
    if intensity is None or len(intensity) == 1:
        grey = luminance(image) if image.ndim == 3 else image
        return grey if intensity is None else grey / intensity
    return (image[..., None] / intensity if image.ndim == 2 else image / intensity).mean(axis=-1)


def _other_size(path: Path, image: np.ndarray, first: Path, like: np.ndarray) -> FileError:
    return FileError(
        f"{path}: has {image.shape[0]} x {image.shape[1]} pixels, {first.name} has "
        f"{like.shape[0]} x {like.shape[1]}; photographs and mask must be of one size"
    )


def _matlab_normals(path: Path, shape: tuple[int, ...]) -> Float[np.ndarray, "H W 3"]:
    normals = read_matlab(path, "Normal_gt", 3 * math.prod(shape))
    if normals.shape != (*shape, 3) or not np.isfinite(normals).all():
        raise FileError(
            f"{path}: Normal_gt must hold finite numbers, {shape[0]} x {shape[1]} x 3 as the "
            f"photographs are, got {normals.shape}"
        )
    return normals
