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
from harmface.io.files import MAX_TEXT, PARSE_ERRORS, excerpt, read_bytes
from harmface.io.tables import npy_header

# NPZ is a zip archive, and a zip archive may end with a comment, whose length stands in the two
# bytes before it: the digest of everything in front of these goes there, where numpy ignores it.
_COMMENT = b"harmface sha256 "
_DIGEST_LENGTH = len(_COMMENT) + 64
_HEADER = "header"
MAX_BYTES = 2**30
"""Most bytes of all arrays of a file, unless their file has a sixteenth of that: 1 GiB."""

_PACKED = 16
"""How many bytes a byte of a large file may stand for; those of photographs stand for two."""

_MAX_MEMBERS = 1000
"""Most arrays of a file; ours have about ten."""


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

    Parameters
    ----------
    path
        A file of `write_npz`.
    kind
        What it must hold.
    version
        Version of that kind that it must be.

    Returns
    -------
    tuple
        Arrays by name, and attributes by name.

    Raises
    ------
    FileError
        If the file is missing, of another kind or version, or any byte of it has changed, or if
        its arrays take more memory than 1 GiB and sixteen times the file.
    """
    path = Path(path)
    data = read_bytes(path)
    comment = data[-_DIGEST_LENGTH:]
    if not comment.startswith(_COMMENT):
        raise FileError(f"{path}: is not a harmface {kind} file, or is cut off; make it again")
    body = memoryview(data)[: -_DIGEST_LENGTH - 2]
    length = data[-_DIGEST_LENGTH - 2 : -_DIGEST_LENGTH]
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
    except PARSE_ERRORS as error:
        # The digest only shows that the bytes are those written, not who wrote them.
        raise FileError(f"{path}: is not a harmface {kind} file ({excerpt(error)})") from None
    if found != (kind, version):
        raise FileError(
            f"{path}: holds {excerpt(found[0])} version {excerpt(found[1])}, but {kind} version "
            f"{version} is needed; make it again with this version of harmface"
        )
    return arrays, attributes


def _check_sizes(data: bytes) -> None:
    """Refuse arrays that are too large, or that ask for other memory than their bytes fill."""
    remaining = max(MAX_BYTES, _PACKED * len(data))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
        if len(members) > _MAX_MEMBERS:
            raise ValueError(f"it has {len(members)} arrays, {_MAX_MEMBERS} at most are read")
        for member in members:
            remaining -= member.file_size
            if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise ValueError(f"{member.filename} is compressed in another way than by deflate")
            if remaining < 0:
                raise ValueError(f"its arrays take more than {MAX_BYTES} bytes")
            with archive.open(member) as file:
                shape, _, dtype = npy_header(file)
                if member.filename == f"{_HEADER}.npy" and member.file_size > MAX_TEXT:
                    raise ValueError("its header is too long")
                if math.prod(shape) * dtype.itemsize != member.file_size - file.tell():
                    raise ValueError(f"{member.filename} does not hold the array it claims")
