"""Folders of results."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from harmface.errors import FileError
from harmface.io.atomic import HIDDEN, atomic_write, claim, sweep

MANIFEST, REQUEST = "manifest.json", "request.json"
"""What a finished job says of all that it made, and what one that is under way was asked for."""


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


@contextmanager
def job_folder(folder: Path, request: Mapping[str, Any]) -> Iterator[None]:
    """Hold a folder in which a job makes many files, or goes on where it was stopped.

    Parameters
    ----------
    folder
        Made if missing.
    request
        All that the files depend on: anything JSON can hold.

    Yields
    ------
    None
        While the block runs, others are kept out. It has to end with the manifest.

    Raises
    ------
    FileError
        If the folder holds anything but files of the same request, is a file, or cannot be made.
    """
    make_folder(folder)
    with claim(folder):
        entries = make_folder(folder)
        started = next((name for name in (MANIFEST, REQUEST) if name in entries), None)
        if started is None:
            if entries:
                raise FileError(
                    f"{folder}: holds other files ({entries[0]}); give an empty or a new folder"
                )
            write_json(folder / REQUEST, {"request": request})
        elif _request_of(folder / started) != request:
            raise FileError(
                f"{folder}: holds other results; give a new folder, or the options they were made "
                "with"
            )
        yield
        (folder / REQUEST).unlink(missing_ok=True)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write anything that JSON can hold, whole or not at all."""
    with atomic_write(path) as file:
        file.write(json.dumps(content, indent=1).encode() + b"\n")


def _request_of(path: Path) -> Any:
    try:
        return json.loads(path.read_text())["request"]
    except (KeyError, RecursionError, TypeError, ValueError):
        return None
