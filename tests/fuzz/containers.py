"""Formats that protect or pack what they hold, taken apart and put together again.

Damage to the whole mostly meets a check sum; damage to a part, under a new one, gets behind it.
"""

import hashlib
import io
import struct
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Container:
    """How to take a file apart, into the parts that are worth damaging, and what undoes it."""

    parts: Callable[[bytes], list[bytes]]
    whole: Callable[[list[bytes]], bytes]


def png_parts(data: bytes) -> list[bytes]:
    """Return type and content of each chunk; the picture's own unpacked."""
    parts, place = [], 8
    while place + 8 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, place)
        content = data[place + 8 : place + 8 + length]
        parts.append(kind + (zlib.decompress(content) if kind == b"IDAT" else content))
        place += 12 + length
    return parts


def png_whole(parts: list[bytes]) -> bytes:
    whole = b"\x89PNG\r\n\x1a\n"
    for part in parts:
        kind, content = part[:4].ljust(4, b"a"), part[4:]
        content = zlib.compress(content) if kind == b"IDAT" else content
        whole += struct.pack(">I", len(content)) + kind + content
        whole += struct.pack(">I", zlib.crc32(kind + content))
    return whole


def npz_parts(data: bytes) -> list[bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return [name.encode() + b"\0" + archive.read(name) for name in archive.namelist()]


def npz_whole(parts: list[bytes]) -> bytes:
    """Return an archive that ends with a valid digest, as the package writes it."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for part in parts:
            name, _, content = part.partition(b"\0")
            archive.writestr(name[:100].decode("latin-1") or "x", content)
    body = buffer.getvalue()[:-2]
    comment = b"harmface sha256 " + hashlib.sha256(body).hexdigest().encode()
    return body + len(comment).to_bytes(2, "little") + comment


def glb_parts(data: bytes) -> list[bytes]:
    parts, place = [], 12
    while place + 8 <= len(data):
        length = int.from_bytes(data[place : place + 4], "little")
        parts.append(data[place + 8 : place + 8 + length])
        place += 8 + length
    return parts


def glb_whole(parts: list[bytes]) -> bytes:
    chunks = b""
    for part, kind, blank in zip(parts, (b"JSON", b"BIN\0"), (b" ", b"\0"), strict=False):
        padded = part + blank * (-len(part) % 4)
        chunks += struct.pack("<I4s", len(padded), kind) + padded
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def mat_parts(data: bytes) -> list[bytes]:
    """Return the header and each element of a MATLAB 5 file, unpacked."""
    parts, place = [data[:128]], 128
    while place + 8 <= len(data):
        kind, length = struct.unpack_from("<II", data, place)
        content = data[place + 8 : place + 8 + length]
        packed = kind == 15
        parts.append(zlib.decompress(content) if packed else data[place : place + 8 + length])
        place += 8 + length
    return parts


def mat_whole(parts: list[bytes]) -> bytes:
    packed = [zlib.compress(part) for part in parts[1:]]
    return parts[0] + b"".join(struct.pack("<II", 15, len(part)) + part for part in packed)


PNG = Container(png_parts, png_whole)
NPZ = Container(npz_parts, npz_whole)
GLB = Container(glb_parts, glb_whole)
MAT = Container(mat_parts, mat_whole)
