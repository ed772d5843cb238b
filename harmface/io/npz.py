"""Versioned NPZ files that detect any changed byte, and never unpickle."""

import hashlib
import io
import json
import math
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from harmface.errors import FileError
from harmface.io.atomic import atomic_write
from harmface.io.files import read_bytes

# NPZ is a zip archive, and a zip archive may end with a comment, whose length stands in the two
# bytes before it: the digest of everything in front of these goes there, where numpy ignores it.
_COMMENT = b"harmface sha256 "
_DIGEST_LENGTH = len(_COMMENT) + 64
_HEADER = "header"
_HEADER_READERS = {
    1: np.lib.format.read_array_header_1_0,
    2: np.lib.format.read_array_header_2_0,
}
_DEFLATE = 1040
"""No deflated byte holds more than 1032 others; a few belong to the stream itself."""


def write_npz(
    path: Path | str,
    kind: str,
    version: int,
    arrays: Mapping[str, np.ndarray],
    attributes: Mapping[str, Any] | None = None,
) -> None:
    """Write arrays and JSON attributes as one NPZ file with a digest.

    Parameters
    ----------
    path
        The file to make or replace.
    kind
        What the file holds, such as "gallery".
    version
        Version of that kind's layout.
    arrays
        Arrays by name; none of dtype object.
    attributes
        Anything that JSON can hold.
    """
    header = json.dumps({"kind": kind, "version": version, "attributes": dict(attributes or {})})
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **{_HEADER: np.array(header)}, **dict(arrays))
    body = buffer.getvalue()[:-2]
    digest = hashlib.sha256(body).hexdigest().encode()
    with atomic_write(path) as file:
        file.write(body + _DIGEST_LENGTH.to_bytes(2, "little") + _COMMENT + digest)


def read_npz(
    path: Path | str, kind: str, version: int
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Return the arrays and attributes of a file that `write_npz` made.

    Raises
    ------
    FileError
        If the file is missing, of another kind or version, or any byte of it has changed.
    """
    path = Path(path)
    data = read_bytes(path)
    comment = data[-_DIGEST_LENGTH:]
    if not comment.startswith(_COMMENT):
        raise FileError(f"{path}: is not a harmface {kind} file, or is cut off; make it again")
    body, length = data[: -_DIGEST_LENGTH - 2], data[-_DIGEST_LENGTH - 2 : -_DIGEST_LENGTH]
    digest = hashlib.sha256(body).hexdigest().encode()
    if comment[len(_COMMENT) :] != digest or int.from_bytes(length, "little") != _DIGEST_LENGTH:
        raise FileError(f"{path}: is damaged (its digest does not match); make it again")
    try:
        _check_sizes(data)
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            header = json.loads(str(archive[_HEADER]))
            arrays = {name: archive[name] for name in archive.files if name != _HEADER}
        found = header["kind"], header["version"]
        attributes = dict(header["attributes"])
    except (KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        # The digest only shows that the bytes are those written, not who wrote them.
        raise FileError(f"{path}: is not a harmface {kind} file ({error})") from None
    if found != (kind, version):
        raise FileError(
            f"{path}: holds {found[0]} version {found[1]}, but {kind} version {version} is "
            "needed; make it again with this version of harmface"
        )
    return arrays, attributes


def _check_sizes(data: bytes) -> None:
    """Refuse arrays whose headers ask for other memory than their bytes fill."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for member in archive.infolist():
            if member.file_size > _DEFLATE * member.compress_size:
                raise ValueError(f"{member.filename} claims more bytes than it can hold")
            with archive.open(member) as file:
                major, _ = np.lib.format.read_magic(file)
                if major not in _HEADER_READERS:
                    raise ValueError(f"{member.filename} has NPY version {major}")
                shape, _, dtype = _HEADER_READERS[major](file)
                if math.prod(shape) * dtype.itemsize != member.file_size - file.tell():
                    raise ValueError(f"{member.filename} does not hold the array it claims")
