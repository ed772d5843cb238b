"""PLY files, binary and as text."""

import re
from array import array
from dataclasses import dataclass, field
from io import BytesIO
from urllib.parse import unquote

import numpy as np
from jaxtyping import Float, Integer

from harmface.errors import FileError
from harmface.io.files import excerpt
from harmface.io.meshes.part import Part, unit_colors
from harmface.io.meshes.polygons import triangulate
from harmface.io.meshes.textures import Textures

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "int64": "i8", "uint64": "u8", "float16": "f2",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip

_FORMATS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "="}

_MAX_HEADER = 2**20
_MAX_PROPERTIES = 1000

_COLORS = [
    (f"{before}{red}", f"{before}{green}", f"{before}{blue}")
    for before in ("", "diffuse_", "vertex_")
    for red, green, blue in (("red", "green", "blue"), ("r", "g", "b"))
]
_COORDINATES = [("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t")]
_CORNERS = ("vertex_indices", "vertex_index")


@dataclass
class _Property:
    name: str
    type: str
    count_type: str | None = None


@dataclass
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)


@dataclass
class _Rows:
    """The values of an element: an array for each property, and counts for each list.

    Values of a list follow one another, row by row.
    """

    values: dict[str, np.ndarray]
    counts: dict[str, np.ndarray]
    types: dict[str, np.dtype]

    def columns(self, names: tuple[str, ...]) -> Float[np.ndarray, "N C"] | None:
        """Return single numbers as columns, if all of them are there."""
        if not all(name in self.values and name not in self.counts for name in names):
            return None
        return np.stack([self.values[name].astype(np.float64) for name in names], axis=1)


def read_ply(data: bytes, textures: Textures) -> Part:
    """Return the surface of a PLY file."""
    elements, order, pictures, start = _header(data)
    rows = _body(data, start, elements, order)
    if "vertex" not in rows or "face" not in rows:
        return Part(np.empty((0, 3)), np.empty((0, 3), int))
    vertex, face = rows["vertex"], rows["face"]
    vertices = vertex.columns(("x", "y", "z"))
    name = next((name for name in _CORNERS if name in face.counts), None)
    if vertices is None or name is None:
        raise FileError("has no positions x, y, z, or no vertex_indices")
    if not np.isfinite(vertices).all():
        raise FileError("vertices must be finite, got NaN or Inf")
    corners, counts = face.values[name].astype(np.int64), face.counts[name]
    triangles, polygon = triangulate(vertices, corners, counts)
    part = Part(vertices, corners[triangles], vertex.columns(("nx", "ny", "nz")))
    part.colors = _colors(vertex, textures)
    of_face = None if part.colors is not None else _colors(face, textures)
    part.uv = next((uv for uv in map(vertex.columns, _COORDINATES) if uv is not None), None)
    wedges = _wedges(face, counts)
    if of_face is not None or wedges is not None:
        # Neighbours differ in what they say of a vertex, so each face gets vertices of its own.
        shared = part.faces.reshape(-1)
        part.vertices = vertices[shared]
        part.faces = np.arange(len(shared)).reshape(-1, 3)
        part.normals = None if part.normals is None else part.normals[shared]
        if of_face is not None:
            part.colors = np.repeat(of_face[polygon], 3, axis=0)
        elif part.colors is not None:
            part.colors = part.colors[shared]
        if wedges is not None:
            part.uv = wedges[triangles.reshape(-1)]
        elif part.uv is not None:
            part.uv = part.uv[shared]
    if pictures and textures.wanted and part.uv is None:
        textures.leave_out(", ".join(pictures))
    elif pictures and textures.wanted:
        if len(pictures) > 1:
            raise FileError(
                f"has {len(pictures)} textures; PLY files with one are read: export it as OBJ "
                "or GLB"
            )
        part.image = textures.named_in_mesh(pictures[0])
    return part


def _header(data: bytes) -> tuple[list[_Element], str, list[str], int]:
    """Return elements, byte order, names of textures, and where the body starts."""
    match = re.compile(
        rb"ply[ \t]*\r?\n.*?^[ \t]*end_header[ \t]*(\r?\n|\r|\Z)", re.S | re.M
    ).match(data[:_MAX_HEADER])
    if match is None:
        raise FileError("cannot be read as PLY: its header does not end, or is none")
    elements: list[_Element] = []
    order, pictures = "", []
    for line in match[0].decode("latin-1").splitlines()[1:]:
        words = line.split()
        match words:
            case ["format", kind, _] if kind in _FORMATS:
                order = _FORMATS[kind]
            case ["element", name, count] if count.isdecimal() and len(count) < 20:
                elements.append(_Element(name, int(count)))
            case ["property", "list", count_type, kind, name] if elements:
                elements[-1].properties.append(_Property(name, _type(kind), _type(count_type)))
            case ["property", kind, name] if elements:
                elements[-1].properties.append(_Property(name, _type(kind)))
            case ["comment", word, *_] if word.lower() == "texturefile":
                pictures.append(unquote(line.split(None, 2)[2]))
            case ["end_header"] | ["comment", *_] | ["obj_info", *_] | []:
                pass
            case _:
                raise FileError(f"cannot be read as PLY: its header says {excerpt(line)}")
    if not order:
        raise FileError("cannot be read as PLY: its header names no format that is known")
    if sum(len(element.properties) for element in elements) > _MAX_PROPERTIES:
        raise FileError(f"has more properties than the limit of {_MAX_PROPERTIES}")
    return elements, order, pictures, match.end()


def _type(name: str) -> str:
    if name not in _TYPES:
        raise FileError(f"cannot be read as PLY: its header names a type {excerpt(name)}")
    return _TYPES[name]


def _body(data: bytes, start: int, elements: list[_Element], order: str) -> dict[str, _Rows]:
    """Return the rows of the vertices and the faces."""
    if order == "=":
        # As text, all numbers are alike: read them as if they were stored in double precision.
        numbers = array("d")
        try:
            for line in BytesIO(data[start:].replace(b"\r", b"\n")):
                numbers.extend(map(float, line.split()))
        except ValueError:
            raise FileError(
                f"cannot be read as PLY: {excerpt(line[:200].decode('latin-1'))}"
            ) from None
        data, start = numbers.tobytes(), 0
    found: dict[str, _Rows] = {}
    for element in elements:
        columns = [
            (
                each.name,
                _dtype(order, each.type),
                _dtype(order, each.count_type) if each.count_type else None,
            )
            for each in element.properties
        ]
        least = sum((count or kind).itemsize for _, kind, count in columns)
        if least * element.count > len(data) - start or (not least and element.count):
            raise FileError(
                f"promises {element.count} elements in {len(data)} bytes; export it again"
            )
        if len({name for name, _, _ in columns}) < len(columns):
            raise FileError(f"names a property of {excerpt(element.name)} twice")
        values, counts, start = _rows(data, start, element.count, columns)
        if element.name in ("vertex", "face") and element.count:
            types = {each.name: np.dtype(each.type) for each in element.properties}
            found[element.name] = _Rows(values, counts, types)
    return found


def _dtype(order: str, kind: str) -> np.dtype:
    return np.dtype("f8" if order == "=" else order + kind)


def _rows(
    data: bytes, start: int, count: int, columns: list[tuple[str, np.dtype, np.dtype | None]]
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], int]:
    """Read rows that may hold lists; all at once where every row is as long as the first."""
    if not count or not columns:
        return {}, {}, start
    lists = [name for name, _, length in columns if length is not None]
    lengths = _lengths(data, start, columns)
    row = np.dtype(
        [
            (f"{name} {part}", kind, size)
            for name, value, length in columns
            for part, kind, size in (
                [("values", value, ())]
                if length is None
                else [("count", length, ()), ("values", value, (lengths[name],))]
            )
        ]
    )
    if start + count * row.itemsize <= len(data):
        table = np.frombuffer(data, row, count, start)
        if all((table[f"{name} count"] == lengths[name]).all() for name in lists):
            values = {name: table[f"{name} values"].reshape(-1) for name, _, _ in columns}
            counts = {name: np.full(count, lengths[name]) for name in lists}
            return values, counts, start + count * row.itemsize
    pieces: dict[str, bytearray] = {name: bytearray() for name, _, _ in columns}
    numbers: dict[str, array] = {name: array("q") for name in lists}
    for _ in range(count):
        for name, value, length in columns:
            size = value.itemsize
            if length is not None:
                number = _number(data, start, length)
                start += length.itemsize
                numbers[name].append(number)
                size *= number
            if start + size > len(data):
                raise FileError("ends within its elements; export it again")
            pieces[name] += data[start : start + size]
            start += size
    values = {name: np.frombuffer(pieces[name], value) for name, value, _ in columns}
    return values, {name: np.array(each, dtype=np.int64) for name, each in numbers.items()}, start


def _lengths(
    data: bytes, start: int, columns: list[tuple[str, np.dtype, np.dtype | None]]
) -> dict[str, int]:
    """Return the lengths of the lists in the first row."""
    found: dict[str, int] = {}
    for name, value, length in columns:
        if length is not None:
            found[name] = _number(data, start, length)
            start += length.itemsize + (found[name] - 1) * value.itemsize
        start += value.itemsize
    return found


def _number(data: bytes, start: int, kind: np.dtype) -> int:
    """Return how many values a list has."""
    if start + kind.itemsize > len(data):
        raise FileError("ends within its elements; export it again")
    number = np.frombuffer(data, kind, 1, start)[0]
    if not 0 <= number <= len(data) or number != int(number):
        raise FileError(f"has a list of {number} values; export it again")
    return int(number)


def _colors(rows: _Rows, textures: Textures) -> Float[np.ndarray, "N 3"] | None:
    """Return colours in [0, 1], whatever type they are stored in."""
    for names in _COLORS:
        colors = rows.columns(names)
        if colors is None:
            continue
        kind = rows.types[names[0]]
        if kind in (np.uint8, np.uint16):
            return colors / np.iinfo(kind).max
        found, bytes_ = unit_colors(colors, "colours")
        if bytes_:
            textures.note("its colours exceed 1 and are taken to run from 0 to 255")
        return found
    return None


def _wedges(face: _Rows, counts: Integer[np.ndarray, "P"]) -> Float[np.ndarray, "C 2"] | None:
    """Return texture coordinates that are given for each corner of each face."""
    if "texcoord" not in face.counts:
        return None
    if not np.array_equal(face.counts["texcoord"], 2 * counts):
        raise FileError("has faces whose texture coordinates are not two for each corner")
    return face.values["texcoord"].astype(np.float64).reshape(-1, 2)
