"""Output that is whole or not there, and that two processes do not write at once.

A file is written under a hidden temporary name beside its own and renamed when it is complete. A
command that works for long claims its output first: a hidden lock file says so to others. Both
kinds of hidden file are locked as long as the process that made them lives, so that what a killed
process left is told from what is in use, and removed by the next command.
"""

import contextlib
import logging
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import IO

from harmface.errors import FileError

try:
    import fcntl
except ImportError:  # Windows has no such locks: there nobody is kept out.
    fcntl = None  # type: ignore[assignment]

LOG = logging.getLogger(__name__)

HIDDEN = ".harmface-"
"""How the names of all files begin that are no output."""


@contextmanager
def atomic_write(path: Path | str) -> Iterator[IO[bytes]]:
    """Open a binary file that takes its name only when everything is written and on the disk.

    Parameters
    ----------
    path
        The file to make or replace; its folder must exist. Of a symbolic link, what it points to
        is replaced.

    Yields
    ------
    file
        Open for writing in binary.

    Raises
    ------
    FileError
        If the folder does not exist or cannot be written to, the disk is full, or `path` is a
        folder, a device or a pipe.

    Examples
    --------
    >>> import tempfile
    >>> folder = tempfile.mkdtemp()
    >>> with atomic_write(Path(folder, "a")) as file:
    ...     _ = file.write(b"whole")
    >>> Path(folder, "a").read_bytes()
    b'whole'
    """
    with _naming(path):
        target = check_output(path)
        descriptor = None
        while descriptor is None:
            temporary = target.with_name(f"{HIDDEN}{secrets.token_hex(8)}.partial")
            descriptor = _locked(temporary)
    try:
        with _naming(path):
            with open(descriptor, "wb") as file:  # noqa: PTH123 - a descriptor has no path
                yield file
                file.flush()
                os.fsync(descriptor)
            temporary.replace(target)
            _sync_folder(target.parent)
        LOG.info("wrote %s", path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def check_output(path: Path | str) -> Path:
    """Return the file that a path means, if a file can be made there or be replaced.

    Raises
    ------
    FileError
        If it is a folder, a device or a pipe.
    """
    with _naming(path):
        target = Path(os.path.realpath(path))
        try:
            mode = target.stat().st_mode
        except FileNotFoundError:
            return target
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a device or a pipe"
        raise FileError(f"{path}: is {kind}; give the name of a file")
    return target


@contextmanager
def claim(path: Path | str) -> Iterator[None]:
    """Keep other processes of this package from the same output, and remove what dead ones left.

    Parameters
    ----------
    path
        A file to be written, whose folder exists, or a folder that exists.

    Yields
    ------
    None
        While the block runs, others are kept out.

    Raises
    ------
    FileError
        If another process works on this output, or the folder cannot be written to.
    """
    target = Path(path)
    with _naming(path):
        if target.is_dir():
            folder, lock = target, target / f"{HIDDEN}folder.lock"
        else:
            target = Path(os.path.realpath(path))
            folder = target.parent
            # A name of its own may be as long as names can be.
            lock = folder / f"{HIDDEN}{sha256(os.fsencode(target.name)).hexdigest()[:16]}.lock"
        descriptor = _locked(lock)
    if descriptor is None:
        raise FileError(
            f"{path}: another process is writing there; wait for it, or give another name"
        )
    try:
        with _naming(path):
            sweep(folder)
        yield
    finally:
        # Removed while it is locked: whoever opened it in between finds that it has gone.
        lock.unlink(missing_ok=True)
        os.close(descriptor)


def _locked(path: Path) -> int | None:
    """Make and lock a file; None if a living process holds it."""
    flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    while True:
        # The system itself gives a file made this way the usual permissions.
        descriptor = os.open(path, flags, 0o666)
        if not _lock(descriptor):
            os.close(descriptor)
            return None
        with contextlib.suppress(FileNotFoundError):
            # It may have been removed between the two steps.
            if os.path.samestat(os.fstat(descriptor), path.stat()):
                return descriptor
        os.close(descriptor)


def _lock(descriptor: int) -> bool:
    """Return whether a file could be locked for this process, until it is closed."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True  # Some network file systems offer no locks: there nobody is kept out.
    return True


def sweep(folder: Path) -> None:
    """Remove the temporary files that processes left which live no more."""
    for path in folder.glob(f"{HIDDEN}*.partial"):
        # It may be another user's, or be gone by now.
        with contextlib.suppress(OSError):
            descriptor = os.open(path, os.O_RDWR)
            try:
                if _lock(descriptor):
                    path.unlink()
            finally:
                os.close(descriptor)


def _sync_folder(folder: Path) -> None:
    """Put a new name on the disk, where the system can do that."""
    if hasattr(os, "O_DIRECTORY"):
        with contextlib.suppress(OSError):
            descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)


@contextmanager
def _naming(path: Path | str) -> Iterator[None]:
    """Turn an error of the system into one that names the output."""
    if "\0" in str(path):
        raise FileError(f"{str(path)!r}: cannot be written: no name holds a NUL")
    try:
        yield
    except OSError as error:
        raise FileError(f"{path}: cannot be written: {error.strerror}") from None
