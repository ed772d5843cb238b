"""Folders of results."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from harmface.errors import FileError
from harmface.io.atomic import HIDDEN, claim, sweep


def prepare_folder(folder: Path, names: list[str]) -> None:
    """Make a folder, or accept one that holds nothing but files of these names.

    Hidden files of the package's own do not count; those that a killed process left are removed.

    Parameters
    ----------
    folder
        Made if missing.
    names
        Names of all files that may be in it.

    Raises
    ------
    FileError
        If the folder holds anything else, is a file, or cannot be made.
    """
    names_found = make_folder(folder)
    sweep(folder)
    foreign = [name for name in names_found if name not in names]
    if foreign:
        raise FileError(
            f"{folder}: holds other files ({foreign[0]}); give an empty or a new folder"
        )


@contextmanager
def output_folder(folder: Path, names: list[str]) -> Iterator[None]:
    """Hold a folder, see `prepare_folder`, against other processes while it is written to.

    Parameters
    ----------
    folder
        Made if missing.
    names
        Names of all files that may be in it.

    Yields
    ------
    None
        While the block runs, others are kept out.

    Raises
    ------
    FileError
        As `prepare_folder`, or if another process is writing there.
    """
    prepare_folder(folder, names)
    with claim(folder):
        yield


def make_folder(folder: Path) -> list[str]:
    """Make a folder if there is none; return the names in it, but for hidden files of our own.

    Raises
    ------
    FileError
        If it is a file, or cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return sorted(entry.name for entry in folder.iterdir() if not entry.name.startswith(HIDDEN))
    except OSError as error:
        raise FileError(f"{folder}: cannot be used as a folder: {error.strerror}") from None
