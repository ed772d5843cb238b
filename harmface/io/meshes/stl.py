"""STL files, binary and as text."""

import re
from array import array

import numpy as np

from harmface.errors import FileError
from harmface.io.meshes.part import Part

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
_NUMBER = rb"\s+([-+.\deEnafiNAFI]{1,40})"
_VERTEX = re.compile(rb"^[ \t]*vertex" + _NUMBER * 3, re.MULTILINE | re.IGNORECASE)


def read_stl(data: bytes) -> Part:
    """Return the triangles of an STL file, each with three vertices of its own."""
    count = int.from_bytes(data[80:_HEADER], "little")
    size = _HEADER + count * _RECORD.itemsize
    # Programs write "solid" into binary files, too, and others append to them.
    text = data[:5].lower() == b"solid" and size != len(data)
    if text:
        numbers = array("d")
        for found in _VERTEX.finditer(data):
            numbers.extend(map(float, found.groups()))
        if len(numbers) % 9:
            raise FileError(f"has {len(numbers) // 3} vertices, which make no whole triangles")
        corners = np.array(numbers)
    elif size > len(data):
        raise FileError(f"promises {count} triangles in {len(data)} bytes; export it again")
    else:
        corners = np.frombuffer(data, _RECORD, count, _HEADER)["corners"].astype(np.float64)
    vertices = corners.reshape(-1, 3)
    return Part(vertices, np.arange(len(vertices)).reshape(-1, 3))
