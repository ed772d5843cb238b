"""What a PNG file says of its encoding, and whether it is whole.

libpng, below OpenImageIO, writes to stderr of a file that is not whole.
"""

import math
import struct
import zlib
from collections.abc import Iterator

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"

MAX_SIDE = 1_000_000
"""Most rows or columns that libpng takes."""

_GAMMA_UNIT = 100_000
_SRGB_GAMMA = 45_455
"""The gAMA chunk of sRGB: 1 / 2.2, which stands for its curve where there is no sRGB chunk."""

# Channels and bits of each colour type (PNG specification, table 11.1).
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
_BITS = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
# First row and column of the passes of an interlaced picture, and the steps between them.
_PASSES = (
    *((0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4)),
    *((2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)),
)


def png_size(data: bytes) -> tuple[int, int]:
    """Return width and height as the header of a PNG file has them.

    Raises
    ------
    ValueError
        If it has no such header.
    """
    if len(data) < 33 or data[8:16] != b"\0\0\0\x0dIHDR":
        raise ValueError("its header is damaged")
    width, height = struct.unpack_from(">II", data, 16)
    return width, height


def png_encoding(data: bytes) -> bool | None:
    """Return whether a whole PNG file says that it is sRGB-encoded, or linear; None if neither.

    Of the chunks that may say so the first of sRGB, iCCP (by the profile's name) and gAMA counts,
    as the PNG specification ranks them. A gAMA of neither 1 nor 1 / 2.2 is no statement.

    Parameters
    ----------
    data
        The file, see `check_png`.

    Returns
    -------
    bool or None
        True for sRGB, False for linear.
    """
    said: dict[bytes, memoryview] = {}
    for name, body in _chunks(data):
        if name == b"IDAT":
            break
        said.setdefault(name, body)
    if b"sRGB" in said or bytes(said.get(b"iCCP", b"")).startswith(b"sRGB"):
        return True
    gamma = int.from_bytes(said.get(b"gAMA", b""), "big")
    if b"iCCP" in said:
        return None
    return {_GAMMA_UNIT: False, _SRGB_GAMMA: True}.get(gamma)


def with_encoding(data: bytes, srgb: bool) -> bytes:
    """Return a PNG file that says how its values are encoded.

    Parameters
    ----------
    data
        The file, without such a statement.
    srgb
        Whether they are sRGB-encoded; linear otherwise.

    Returns
    -------
    bytes
        The file with chunks sRGB and gAMA, or gAMA alone, behind its header.
    """
    parts = [(b"sRGB", b"\0")] if srgb else []
    parts.append((b"gAMA", struct.pack(">I", _SRGB_GAMMA if srgb else _GAMMA_UNIT)))
    chunks = b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in parts
    )
    header_end = len(SIGNATURE) + 25
    return data[:header_end] + chunks + data[header_end:]


def check_png(data: bytes) -> None:
    """Refuse a PNG file whose parts, checksums or pixels are not whole.

    Raises
    ------
    ValueError
        If something is wrong with it.
    """
    width, height = png_size(data)
    bits, colour, compression, filters, interlaced = data[24:29]
    sound = max(width, height) <= MAX_SIDE and bits in _BITS.get(colour, ())
    if not sound or compression or filters or interlaced > 1:
        raise ValueError("its header is damaged")
    names: list[bytes] = []
    coded: list[memoryview] = []
    for name, body in _chunks(data):
        known = name in (b"IHDR", b"PLTE", b"IDAT", b"IEND") or name[:1].islower()
        if not (known and name.isalpha() and name.isascii() and name[2:3].isupper()):
            raise ValueError("a part of it has an unknown name")
        if name == b"PLTE" and (len(body) % 3 or not 0 < len(body) <= 768):
            raise ValueError("its palette is damaged")
        if name == b"IDAT":
            if coded and names[-1] != b"IDAT":
                raise ValueError("its pixels are scattered")
            coded.append(body)
        names.append(name)
    before = names[: names.index(b"IDAT")] if coded else []
    if not coded or names.count(b"IHDR") > 1 or (colour == 3 and b"PLTE" not in before):
        raise ValueError("it lacks a part")
    if names.count(b"PLTE") > (b"PLTE" in before):
        raise ValueError("its palette is damaged")
    pixel = bits * _CHANNELS[colour]
    passes = _PASSES if interlaced else ((0, 0, 1, 1),)
    shapes = [
        (-(-(height - top) // down), 1 + math.ceil(-(-(width - left) // right) * pixel / 8))
        for top, left, down, right in passes
        if height > top and width > left
    ]
    _check_pixels(coded, shapes)


def _chunks(data: bytes) -> Iterator[tuple[bytes, memoryview]]:
    """Yield name and contents of every part, after its checksum."""
    place, name = len(SIGNATURE), b""
    while name != b"IEND":
        name = data[place + 4 : place + 8]
        end = place + 8 + int.from_bytes(data[place : place + 4], "big")
        if end + 4 > len(data):
            raise ValueError("it is cut off")
        checksum = int.from_bytes(data[end : end + 4], "big")
        if zlib.crc32(memoryview(data)[place + 4 : end]) != checksum:
            raise ValueError("a checksum in it is wrong")
        yield name, memoryview(data)[place + 8 : end]
        place = end + 4


def _check_pixels(coded: list[memoryview], shapes: list[tuple[int, int]]) -> None:
    """Refuse rows that are missing, or whose first byte names no filter."""
    size = sum(rows * length for rows, length in shapes)
    inflate = zlib.decompressobj()
    rows = bytearray()
    for part in coded:
        rows += inflate.decompress(part, max(1, size + 1 - len(rows)))
    if len(rows) != size or not inflate.eof:
        raise ValueError("its pixels are not as many as its header says")
    place = 0
    for count, length in shapes:
        filters = np.frombuffer(rows, np.uint8, count * length, place).reshape(count, length)[:, 0]
        if (filters > 4).any():
            raise ValueError("its pixels are damaged")
        place += count * length
