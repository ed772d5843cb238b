"""Which files are photographs of one object, in which order, and what the others are for."""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from harmface.errors import FileError

PHOTOGRAPH_SUFFIXES = (
    ".png",
    ".tif",
    ".tiff",
    ".pgm",
    ".ppm",
    ".tga",
    ".jpg",
    ".jpeg",
    ".bmp",
    ".webp",
)

LIGHT_FILES = (
    "lights.txt",
    "light_directions.txt",
    "lights.csv",
    "lights.npy",
    "light_directions.npy",
)

_MASK = re.compile(r"(.*[._ -])?mask", re.IGNORECASE)
_UNLIT = re.compile(r"(.*[._ -])?(ambient|dark)([._ -]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True)
class Sorted:
    """Files by what they are.

    Parameters
    ----------
    photographs
        In order.
    mask
        A mask among them, if there was one.
    notes
        What was done beside the obvious.
    """

    photographs: list[Path]
    mask: Path | None
    notes: tuple[str, ...]


def files_below(folder: Path) -> Iterator[Path]:
    """Yield the files below a folder that a person put there, in the order of their names.

    Symbolic links to folders are followed, but none back into a folder that is being looked
    through. What systems leave behind is passed over: hidden files and folders, `._` twins of
    files and `__MACOSX`.

    Raises
    ------
    FileError
        If a folder cannot be read.
    """
    yield from _below(folder, frozenset())


def _below(folder: Path, above: frozenset[str]) -> Iterator[Path]:
    real = os.path.realpath(folder)
    if real in above:
        return
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError as error:
        raise FileError(f"{folder}: cannot be read: {error.strerror}") from None
    for entry in entries:
        if entry.name.startswith(".") or entry.name == "__MACOSX":
            continue
        if entry.is_dir():
            yield from _below(folder / entry.name, above | {real})
        elif entry.is_file():
            yield folder / entry.name


def photographs_in(folder: Path) -> list[Path]:
    """Return all images in a folder, hidden files aside, by name.

    Raises
    ------
    FileError
        If there is none, or the folder cannot be read.
    """
    try:
        inside = list(folder.iterdir())
    except OSError as error:
        raise FileError(f"{folder}: cannot be read: {error.strerror}") from None
    files = sorted(
        path
        for path in inside
        if path.suffix.lower() in PHOTOGRAPH_SUFFIXES and not path.name.startswith(".")
    )
    if not files:
        raise FileError(f"{folder}: holds no photographs; give PNG, TIFF, PGM, TGA or JPEG files")
    return files


def light_file_of(folder: Path) -> Path | None:
    """Return the file of lights in a folder, or else in the one that it lies in, if there is one.

    Its name is one of `LIGHT_FILES`, or ends in `.lp`.

    Raises
    ------
    FileError
        If there are several that end in `.lp`, and none of the others.
    """
    for place in (folder, folder.absolute().parent):
        found = [place / name for name in LIGHT_FILES if (place / name).is_file()]
        found = found[:1] or [path for path in place.glob("*.lp") if path.is_file()]
        if len(found) > 1 and place == folder:
            raise FileError(f"{found[1]}: is a second file of lights; say which with --lights")
        if len(found) == 1:
            return found[0]
    return None


def sort_photographs(files: list[Path], mask: Path | None) -> Sorted:
    """Tell the photographs from what else lies among them, and put them in order.

    `mask.png`, `cat.mask.png` and `cat_mask.png` are the mask; `ambient` and `dark` in the same
    places mean a photograph without the light, which is left out. Files in the order of their
    names, as a folder or a shell gives them, are put in the order of their numbers: img2 before
    img10. Any other order is kept.

    Parameters
    ----------
    files
        Images.
    mask
        The mask, if it was named by itself; then none is looked for.

    Raises
    ------
    FileError
        If there is more than one mask, or no photograph.
    """
    notes = []
    masks = [path for path in files if _MASK.fullmatch(path.stem)]
    unlit = [path for path in files if _UNLIT.fullmatch(path.stem)]
    if mask is None and len(masks) > 1:
        raise FileError(
            f"{masks[1]}: is a second mask beside {masks[0].name}; say which with --mask"
        )
    if mask is not None:
        masks += [path for path in files if path.resolve() == mask.resolve()]
    if masks:
        notes.append(f"taken as {'the' if mask is None else 'a'} mask: {_names(masks)}")
    if unlit:
        notes.append(f"left out as taken without the light: {_names(unlit)}")
    photographs = [path for path in files if path not in masks and path not in unlit]
    if not photographs:
        raise FileError(f"{files[0]}: is no photograph by its name, nor is any other file given")
    by_name, by_number = sorted(photographs), sorted(photographs, key=_number_key)
    if photographs == by_name != by_number:
        photographs = by_number
        notes.append(f"photographs are taken in the order of their numbers: {_names(by_number)}")
    return Sorted(photographs, masks[0] if mask is None and masks else mask, tuple(notes))


def _number_key(path: Path) -> list[tuple[int, str]]:
    """Return a key that sorts runs of digits by their value."""
    parts = re.split(r"(\d+)", str(path))
    return [(int(part), part) if part.isdecimal() else (0, part) for part in parts]


def _names(files: list[Path]) -> str:
    """Return the names of files, those in the middle of many left out."""
    names = [path.name for path in files]
    return ", ".join(names if len(names) <= 4 else [*names[:3], "...", names[-1]])
