"""Reading a whole file, with one clear error."""

from pathlib import Path

from harmface.errors import FileError

MAX_BYTES = 2**32
"""Largest file read into memory: 4 GiB."""


def read_bytes(path: Path | str) -> bytes:
    """Return the bytes of a file.

    Raises
    ------
    FileError
        If it is missing, a folder, unreadable, empty or larger than 4 GiB.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise FileError(f"{path}: is a folder, a file is needed")
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise FileError(f"{path}: is {size} bytes long, more than the limit of {MAX_BYTES}")
        data = path.read_bytes()
    except FileNotFoundError:
        raise FileError(f"{path}: does not exist; check the name") from None
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror}") from None
    if not data:
        raise FileError(f"{path}: is empty; make or copy it again")
    return data
