"""Folders of results."""

from pathlib import Path

from harmface.errors import FileError


def prepare_folder(folder: Path, names: list[str]) -> None:
    """Make a folder, or accept one that holds nothing but files of these names.

    Raises
    ------
    FileError
        If the folder holds anything else, is a file, or cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        foreign = sorted({entry.name for entry in folder.iterdir()} - set(names))
    except OSError as error:
        raise FileError(f"{folder}: cannot be used as a folder: {error.strerror}") from None
    if foreign:
        raise FileError(
            f"{folder}: holds other files ({foreign[0]}); give an empty or a new folder"
        )
