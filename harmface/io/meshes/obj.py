"""Wavefront OBJ files."""

import os
from array import array
from dataclasses import dataclass, field
from io import BytesIO

import numpy as np
from jaxtyping import Float, Integer

from harmface.errors import FileError
from harmface.io.files import excerpt
from harmface.io.meshes.mtl import Material, read_materials
from harmface.io.meshes.part import Part, unit_colors
from harmface.io.meshes.polygons import triangulate
from harmface.io.meshes.textures import Textures

_WHITE = (1.0, 1.0, 1.0)


@dataclass
class _Statements:
    """What the lines of a file say, one number after the other."""

    positions: array = field(default_factory=lambda: array("d"))
    colors: array = field(default_factory=lambda: array("d"))
    coordinates: array = field(default_factory=lambda: array("d"))
    normals: array = field(default_factory=lambda: array("d"))
    corners: array = field(default_factory=lambda: array("q"))
    """Three indices for each corner: of position, texture coordinate, normal; -1 for none."""
    counts: array = field(default_factory=lambda: array("q"))
    """Corners of each face."""
    materials: array = field(default_factory=lambda: array("q"))
    """Number of each face's material."""
    names: dict[bytes, int] = field(default_factory=dict)
    libraries: list[str] = field(default_factory=list)
    colored: bool = False


def read_obj(data: bytes, textures: Textures) -> list[Part]:
    """Return the surfaces of an OBJ file: of each material one with and one without coordinates."""
    said = _statements(data)
    positions = np.array(said.positions).reshape(-1, 3)
    coordinates = np.array(said.coordinates).reshape(-1, 2)
    normals = np.array(said.normals).reshape(-1, 3)
    corners = np.array(said.corners, dtype=np.int64).reshape(-1, 3)
    for column, (name, array_) in enumerate(
        [("vertex", positions), ("texture coordinate", coordinates), ("normal", normals)]
    ):
        top = corners[:, column].max(initial=-1)
        if top >= len(array_):
            raise FileError(f"a face names {name} {top + 1} of {len(array_)}")
    if not np.isfinite(positions).all():
        raise FileError("vertices must be finite, got NaN or Inf")
    triangles, face = triangulate(positions, corners[:, 0], np.array(said.counts, dtype=np.int64))
    colors = _colors(said, textures)
    named = _materials(said, textures)
    # Programs write a material for each face of a figure; those that look alike are one.
    looks = {material: number for number, material in enumerate(dict.fromkeys(named))}
    materials = list(looks)
    look = np.array([looks[material] for material in named])
    pictured = (corners[triangles, 1] >= 0).all(axis=1)
    of_face = 2 * look[np.array(said.materials, dtype=np.int64)][face] + pictured
    order = np.argsort(of_face, kind="stable")
    ends = np.searchsorted(of_face[order], np.arange(2 * len(materials)), side="right")
    parts, tinted = [], []
    for number, chosen in enumerate(np.split(order, ends[:-1])):
        if not len(chosen):
            continue
        material = materials[number // 2]
        rows, faces = _distinct(corners[triangles[chosen].reshape(-1)])
        vertex, coordinate, normal = rows.T
        part = Part(positions[vertex], faces.reshape(-1, 3), factor=np.array(material.color))
        if (normal >= 0).any():
            part.normals = normals[normal]
            part.normals[normal < 0] = np.nan
        if colors is not None:
            part.colors = colors[vertex]
        if number % 2:
            part.uv = coordinates[coordinate] * material.scale + material.offset
            part.image = material.image(textures)
            if part.image is not None:
                # MTL would have both multiplied, but most programs write some grey beside a
                # texture that is the whole colour.
                part.factor = np.ones(3)
                tinted += [material] if material.color != (1, 1, 1) else []
        elif material.picture is not None:
            textures.leave_out(material.picture)
        parts.append(part)
    if tinted:
        shown = " ".join(f"{value:.3g}" for value in tinted[0].color)
        textures.note(f"its textures are taken alone, without the colour beside them (Kd {shown})")
    return parts


def _statements(data: bytes) -> _Statements:
    said = _Statements()
    current = said.names.setdefault(b"", 0)
    # A list of all lines would take several times the memory of the file.
    for number, line in enumerate(BytesIO(_joined_lines(data))):
        words = line.split()
        if not words:
            continue
        try:
            match words[0]:
                case b"v":
                    said.positions.extend((float(words[1]), float(words[2]), float(words[3])))
                    # A fourth number is a weight, six have a colour, seven an opacity, too.
                    if len(words) >= 7:
                        said.colored = True
                        said.colors.extend(map(float, words[4:7]))
                    else:
                        said.colors.extend(_WHITE)
                case b"vt":
                    up = float(words[2]) if len(words) > 2 else 0.0
                    said.coordinates.extend((float(words[1]), up))
                case b"vn":
                    said.normals.extend((float(words[1]), float(words[2]), float(words[3])))
                case b"f":
                    _face(said, words[1:])
                    said.materials.append(current)
                case b"usemtl":
                    name = b" ".join(words[1:])
                    current = said.names.setdefault(name, len(said.names))
                case b"mtllib":
                    said.libraries.append(os.fsdecode(line.strip()[len(b"mtllib") :].strip()))
        except (IndexError, ValueError, OverflowError):
            shown = excerpt(line[:200].decode("utf-8", "replace"))
            raise FileError(f"line {number + 1} cannot be read: {shown}") from None
    return said


def _joined_lines(data: bytes) -> bytes:
    """Return a text with newlines alone at the ends of its lines, continued ones in one."""
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return data.replace(b"\\\n", b" ")


def _face(said: _Statements, words: list[bytes]) -> None:
    """Note a face's corners; negative numbers count back from the last so far."""
    limits = (len(said.positions) // 3, len(said.coordinates) // 2, len(said.normals) // 3)
    for word in words:
        parts = word.split(b"/")
        if not parts[0] or len(parts) > 3:
            raise ValueError
        for place, limit in enumerate(limits):
            text = parts[place] if place < len(parts) else b""
            index = int(text) if text else 0
            if text and (index == 0 or index < -limit):
                raise ValueError
            said.corners.append(index - 1 if index >= 0 else limit + index)
    said.counts.append(len(words))


def _distinct(
    corners: Integer[np.ndarray, "C 3"],
) -> tuple[Integer[np.ndarray, "N 3"], Integer[np.ndarray, "C"]]:
    """Return the distinct corners, in order, and which of them each corner is."""
    sizes = [int(n) for n in corners.max(axis=0) + 2]
    if sizes[0] * sizes[1] * sizes[2] < 2**62:
        # One number for each corner sorts much faster than a row of three.
        keys = (corners[:, 0] * sizes[1] + corners[:, 1] + 1) * sizes[2] + corners[:, 2] + 1
        _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
        return corners[first], inverse
    rows, inverse = np.unique(corners, axis=0, return_inverse=True)
    return rows, inverse.reshape(-1)


def _colors(said: _Statements, textures: Textures) -> Float[np.ndarray, "V 3"] | None:
    if not said.colored:
        return None
    colors, bytes_ = unit_colors(np.array(said.colors).reshape(-1, 3), "vertex colours")
    if bytes_:
        textures.note("its vertex colours exceed 1 and are taken to run from 0 to 255")
    return colors


def _materials(said: _Statements, textures: Textures) -> list[Material]:
    """Return the materials in the order of their numbers; unknown ones are white."""
    white = Material("")
    if not textures.wanted:
        return [white] * len(said.names)
    known: dict[bytes, Material] = {}
    for library in said.libraries:
        known = {**read_materials(library, textures), **known}
    unknown = [name for name in said.names if name and name not in known]
    if unknown:
        shown = excerpt(unknown[0].decode("utf-8", "replace"))
        textures.note(f"{len(unknown)} materials ({shown}) are not defined and count as white")
    return [known.get(name, white) for name in said.names]
