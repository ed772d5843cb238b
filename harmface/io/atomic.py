"""Output that is whole or not there."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from harmface.errors import FileError


@contextmanager
def atomic_write(path: Path | str) -> Iterator[IO[bytes]]:
    """Open a binary file that takes its name only when everything has been written.

    Parameters
    ----------
    path
        The file to make or replace; its folder must exist.

    Raises
    ------
    FileError
        If the folder does not exist or cannot be written to, or the disk is full.

    Examples
    --------
    >>> folder = tempfile.mkdtemp()
    >>> with atomic_write(Path(folder, "a")) as file:
    ...     _ = file.write(b"whole")
    >>> Path(folder, "a").read_bytes()
    b'whole'
    """
    path = Path(path)
    try:
        file = tempfile.NamedTemporaryFile(  # noqa: SIM115 - renamed or removed below
            dir=path.parent, prefix=f".{path.name}.", delete=False
        )
    except OSError as error:
        raise FileError(f"{path}: cannot be written: {error.strerror}") from None
    try:
        with file:
            yield file
        # A temporary file is private to its owner; the result gets the usual permissions.
        mask = os.umask(0)
        os.umask(mask)
        Path(file.name).chmod(0o666 & ~mask)
        Path(file.name).replace(path)
    except OSError as error:
        Path(file.name).unlink(missing_ok=True)
        raise FileError(f"{path}: cannot be written: {error.strerror}") from None
    except BaseException:
        Path(file.name).unlink(missing_ok=True)
        raise
