"""Reading a whole file, with one clear error."""

import stat
import struct
import tokenize
import zipfile
import zlib
from pathlib import Path, PureWindowsPath

from harmface.errors import FileError

MAX_BYTES = 2**32
"""Largest file read into memory: 4 GiB."""

MAX_TEXT = 2**24
"""Longest text read: 16 MiB. A parser takes some ten times as much for what it makes of it."""

MAX_ECHO = 200
"""Most characters of a file that a message repeats."""

# What parsers raise when bytes are not what their format says. A lack of memory is none of it:
# sizes are checked before memory is taken.
PARSE_ERRORS = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    BufferError,
    EOFError,
    LookupError,
    NameError,
    OSError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
    struct.error,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)


def check_regular(path: Path | str, most: int = MAX_BYTES) -> int:
    """Return the size of a regular file, in bytes, without opening it.

    A pipe or a device could make its reader wait for ever, or never end.

    Parameters
    ----------
    path
        The file, or a symbolic link to it.
    most
        Largest size in bytes.

    Raises
    ------
    FileError
        If it is missing, a folder, a pipe or device, empty or larger than `most`.
    """
    try:
        found = Path(path).stat()
    except FileNotFoundError:
        raise FileError(f"{path}: does not exist; check the name") from None
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError:
        raise FileError(f"{str(path)!r}: is no name that a file can have") from None
    if stat.S_ISDIR(found.st_mode):
        raise FileError(f"{path}: is a folder, a file is needed")
    if not stat.S_ISREG(found.st_mode):
        raise FileError(f"{path}: is a pipe or a device, a regular file is needed")
    if found.st_size > most:
        raise FileError(f"{path}: is {found.st_size} bytes long, more than the limit of {most}")
    if found.st_size == 0:
        raise FileError(f"{path}: is empty; make or copy it again")
    return found.st_size


def read_bytes(path: Path | str, most: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file.

    Parameters
    ----------
    path
        The file.
    most
        Largest size in bytes.

    Raises
    ------
    FileError
        If it is missing, a folder, a pipe or device, unreadable, empty or larger than `most`.
    """
    check_regular(path, most)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise FileError(f"{path}: cannot be read: {error.strerror}") from None


def excerpt(said: object) -> str:
    """Return the first line of a text or an error, at most 200 characters of it.

    Examples
    --------
    >>> excerpt(ValueError("one" + chr(10) + "two"))
    'one'
    >>> excerpt(EOFError())
    'EOFError'
    """
    line = next((line for line in str(said).splitlines() if line.strip()), "")
    line = line or (type(said).__name__ if isinstance(said, BaseException) else "")
    return line if len(line) <= MAX_ECHO else f"{line[:MAX_ECHO]}..."


def is_number(word: str) -> bool:
    """Return whether this is a real number as Python writes it.

    Examples
    --------
    >>> is_number("1e-3"), is_number("1,5")
    (True, False)
    """
    try:
        float(word)
    except ValueError:
        return False
    return True


def is_file_name(name: object) -> bool:
    """Return whether this can be the name of a file, without a folder, on any system.

    Examples
    --------
    >>> is_file_name("001.png"), is_file_name("../001.png"), is_file_name("C:001.png")
    (True, False, False)
    """
    return (
        isinstance(name, str)
        and PureWindowsPath(name).name == name not in ("", "..")
        and "\0" not in name
        and len(name.encode("utf-8", "surrogatepass")) <= 255
    )
