"""Frames of a film, from a folder, files or a video."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Bool, Float

from harmface.errors import FileError
from harmface.io.captures import read_mask
from harmface.io.files import check_regular
from harmface.io.images import read_image
from harmface.io.photo_folders import photographs_in, sort_photographs
from harmface.io.pictures import MAX_PIXELS, check_total
from harmface.moving import silhouettes

VIDEO_SUFFIXES = (".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm")

MOST_FRAMES = 2000
"""Most frames read of a video: more than a minute."""

BLACK = 0.01
"""Part of the film's median brightness below which a frame is black."""

BLURRED = 0.2
"""Part of the median sharpness, the variance of the Laplacian, below which a frame is blurred."""


@dataclass(frozen=True, eq=False)
class Frames:
    """A film as it was read.

    Parameters
    ----------
    grey
        Linear brightness, the mean of the colour channels.
    masks
        The object in each frame.
    kept
        Which of all frames these are.
    names
        Of all frames.
    notes
        What was done beside the obvious.
    """

    grey: Float[np.ndarray, "F H W"]
    masks: Bool[np.ndarray, "F H W"]
    kept: Bool[np.ndarray, "n"]
    names: tuple[str, ...]
    notes: tuple[str, ...]


def read_film(
    sources: list[Path],
    *,
    masks: Path | None = None,
    srgb: bool = False,
    max_pixels: int = MAX_PIXELS,
    report: Callable[[float], None] = lambda done: None,
) -> Frames:
    """Read the frames of a film, and masks of the object in them.

    Black and blurred frames are left out. Masks are those in `masks`, or in a folder `masks`
    beside the frames, with the frames' names; else they are found (`silhouettes`).

    Parameters
    ----------
    sources
        One folder, one video, or files in their order.
    masks
        Folder of masks.
    srgb
        Whether frames that do not say how they are encoded are sRGB; a video's always are.
    max_pixels
        Largest frame; all together may have 16 times as many pixels.
    report
        Told the fraction done.

    Returns
    -------
    Frames
        In the order of the film.

    Raises
    ------
    FileError
        If a file cannot be read, sizes differ, a mask is missing, or too few frames are left.
    """
    video = len(sources) == 1 and sources[0].suffix.lower() in VIDEO_SUFFIXES
    if video:
        colour, names = _video(sources[0], max_pixels, report)
    else:
        files = photographs_in(sources[0]) if sources[0].is_dir() else sources
        files = sort_photographs(files, None).photographs
        colour, names = _pictures(files, srgb, max_pixels, report)
    folder = masks
    if folder is None and not video and (Path(files[0]).parent / "masks").is_dir():
        folder = Path(files[0]).parent / "masks"
    grey = colour.mean(axis=-1) if colour.ndim == 4 else colour
    kept, notes = _usable(grey, names)
    chosen = [name for name, good in zip(names, kept, strict=True) if good]
    if folder is None:
        found = silhouettes(colour[kept])
        notes.append(
            f"no masks were given: the object is what stands out of the background, "
            f"{found.mean():.0%} of the frames; --mask says better"
        )
    else:
        found = _masks(folder, chosen, grey.shape[1:])
    return Frames(grey[kept], found, kept, tuple(names), tuple(notes))


def _pictures(
    files: list[Path], srgb: bool, max_pixels: int, report: Callable[[float], None]
) -> tuple[np.ndarray, list[str]]:
    frames: list[np.ndarray] = []
    for number, path in enumerate(files):
        image = read_image(path, srgb=srgb, max_pixels=max_pixels).astype(np.float32)
        if frames and image.shape != frames[0].shape:
            raise FileError(
                f"{path}: has {_size(image)}, {files[0].name} has {_size(frames[0])}; frames of "
                "a film must be alike"
            )
        check_total(path, len(files), image.shape[:2], max_pixels)
        frames.append(image)
        report((number + 1) / len(files))
    return np.stack(frames), [path.name for path in files]


def _size(image: np.ndarray) -> str:
    channels = image.shape[2] if image.ndim == 3 else 1
    return f"{image.shape[0]} x {image.shape[1]} pixels of {channels} channels"


def _video(
    path: Path, max_pixels: int, report: Callable[[float], None]
) -> tuple[np.ndarray, list[str]]:
    check_regular(path)
    # The decoder would print what it thinks of a damaged file.
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    source = cv2.VideoCapture(str(path))
    frames: list[np.ndarray] = []
    try:
        while len(frames) <= MOST_FRAMES:
            there, image = source.read()
            if not there:
                break
            check_total(path, len(frames) + 1, image.shape[:2], max_pixels)
            encoded = image[..., ::-1].astype(np.float32) / 255
            low = encoded <= 0.04045
            frames.append(np.where(low, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4))
            report(len(frames) / MOST_FRAMES)
    finally:
        source.release()
    if not frames:
        raise FileError(f"{path}: OpenCV cannot open this video; give its frames as pictures")
    if len(frames) > MOST_FRAMES:
        raise FileError(f"{path}: has more than {MOST_FRAMES} frames; cut it")
    return np.stack(frames), [f"{path.name}:{number + 1}" for number in range(len(frames))]


def _usable(grey: np.ndarray, names: list[str]) -> tuple[np.ndarray, list[str]]:
    """Return which frames are neither black nor blurred, and what to say of the others."""
    bright = grey.mean(axis=(1, 2))
    lit = bright > BLACK * np.median(bright)
    sharp = np.array([cv2.Laplacian(each, cv2.CV_32F).var() for each in grey.astype(np.float32)])
    sharp = np.divide(sharp, bright**2, out=np.zeros_like(sharp), where=lit)
    focused = sharp > BLURRED * np.median(sharp[lit]) if lit.any() else lit
    notes = []
    for word, bad in (("black", ~lit), ("blurred", lit & ~focused)):
        if bad.any():
            left = [name for name, one in zip(names, bad, strict=True) if one]
            notes.append(f"left out as {word}: {', '.join(left[:5])}" + (", ..." * (len(left) > 5)))
    return lit & focused, notes


def _masks(folder: Path, names: list[str], shape: tuple[int, ...]) -> np.ndarray:
    found = []
    for name in names:
        mask = read_mask(folder / name)
        if mask.shape != shape:
            raise FileError(
                f"{folder / name}: has {mask.shape[0]} x {mask.shape[1]} pixels, the frames have "
                f"{shape[0]} x {shape[1]}"
            )
        found.append(mask)
    return np.stack(found)
