"""Surfaces of glTF 2.0 files, binary (GLB) and as text."""

import json
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from harmface.errors import FileError
from harmface.io.files import MAX_TEXT, excerpt
from harmface.io.meshes.gltf_buffers import Buffers, item, items, objects
from harmface.io.meshes.gltf_materials import Material, Materials
from harmface.io.meshes.part import Part
from harmface.io.meshes.polygons import fan, strip
from harmface.io.meshes.textures import Textures

_KNOWN = ("KHR_mesh_quantization", "KHR_texture_transform", "EXT_texture_webp")
_HARMLESS = ("KHR_materials_", "KHR_lights_", "KHR_xmp", "EXT_lights_")
"""Extensions that change neither shape nor base colour."""

_TRIANGLES = {4: lambda indices: indices.reshape(-1, 3), 5: strip, 6: fan}

_LEAST_LIMIT = 2**20
"""Vertices, and triangles, that any file may make by placing its meshes several times."""


def read_gltf(data: bytes, textures: Textures) -> list[Part]:
    """Return the surfaces of the file's scene, each in its place."""
    tree, binary = _tree(data, textures)
    if not str(objects(tree, "asset").get("version", "")).startswith("2."):
        raise FileError("is no glTF of version 2; export it as such")
    for name in items(tree, "extensionsRequired"):
        if name not in _KNOWN and not str(name).startswith(_HARMLESS):
            raise FileError(
                f"needs the extension {excerpt(name)}, which is not read; export it without "
                "(uncompressed)"
            )
    buffers = Buffers(tree, binary, textures)
    materials = Materials(tree, buffers, textures)
    budget = max(len(data) + buffers.size, _LEAST_LIMIT)
    parts = []
    for node, place in _placed(tree):
        for primitive in items(item(tree, "meshes", node["mesh"]), "primitives"):
            if primitive.get("mode", 4) not in _TRIANGLES:
                continue  # points and lines
            part = _part(primitive, buffers, materials, textures)
            budget -= max(len(part.vertices), len(part.faces))
            if budget < 0:
                raise FileError("places its meshes so often that they would not fit into memory")
            _move(part, place)
            parts.append(part)
    _tell(tree, textures)
    return parts


def _tree(data: bytes, textures: Textures) -> tuple[dict[str, Any], bytes]:
    """Return the JSON of a file, and the binary chunk of a GLB."""
    binary = b""
    if textures.mesh.suffix.lower() == ".glb" or data[:4] == b"glTF":
        if data[:4] != b"glTF" or len(data) < 20:
            raise FileError("is not a GLB file, or is cut off; export it again")
        version, _, length, kind = struct.unpack_from("<IIII", data, 4)
        if version != 2 or kind != 0x4E4F534A or 20 + length > len(data):
            raise FileError("is not a GLB file of version 2, or is cut off; export it again")
        text = data[20 : 20 + length]
        rest = data[20 + length :]
        if len(rest) >= 8:
            size, kind = struct.unpack_from("<II", rest)
            if kind == 0x004E4942:
                if 8 + size > len(rest):
                    raise FileError("is a GLB file that is cut off; export it again")
                binary = rest[8 : 8 + size]
    else:
        text = data
    if len(text) > MAX_TEXT:
        raise FileError(f"has {len(text)} bytes of JSON, more than the limit of {MAX_TEXT}")
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise FileError(f"is a broken or no glTF file: {excerpt(error)}") from None
    if not isinstance(tree, dict):
        raise FileError("is a broken glTF file: its JSON is no object")
    return tree, binary


def _placed(tree: dict[str, Any]) -> Iterator[tuple[dict[str, Any], Float[np.ndarray, "4 4"]]]:
    """Yield every node of the scene that has a mesh, and where its coordinates lie."""
    if items(tree, "scenes"):
        roots = items(item(tree, "scenes", tree.get("scene", 0)), "nodes")
    else:
        indices = range(len(items(tree, "nodes")))
        below = {
            child for index in indices for child in items(item(tree, "nodes", index), "children")
        }
        roots = [index for index in indices if index not in below]
    waiting = [(index, np.eye(4)) for index in reversed(roots)]
    seen: set[int] = set()
    while waiting:
        index, place = waiting.pop()
        node = item(tree, "nodes", index)
        if index in seen:
            raise FileError(f"is a broken glTF file: node {index} is in several places")
        seen.add(index)
        place = place @ _matrix(node)
        waiting += [(child, place) for child in reversed(items(node, "children"))]
        if "mesh" in node:
            yield node, place


def _matrix(node: dict[str, Any]) -> Float[np.ndarray, "4 4"]:
    if "matrix" in node:
        matrix = np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    else:
        turn = Rotation.from_quat(np.array(node.get("rotation", [0, 0, 0, 1]), dtype=np.float64))
        scale = np.array(node.get("scale", [1, 1, 1]), dtype=np.float64)
        matrix = np.eye(4)
        matrix[:3, :3] = turn.as_matrix() * scale.reshape(3)
        matrix[:3, 3] = np.array(node.get("translation", [0, 0, 0]), dtype=np.float64)
    return matrix


def _part(
    primitive: dict[str, Any], buffers: Buffers, materials: Materials, textures: Textures
) -> Part:
    attributes = objects(primitive, "attributes")
    if not buffers.stored(attributes["POSITION"]):
        named = ", ".join(objects(primitive, "extensions")) or "unknown means"
        raise FileError(f"has positions compressed by {excerpt(named)}; export it without")
    vertices = buffers.vectors(attributes["POSITION"], 3)
    if "indices" in primitive:
        indices = buffers.indices(primitive["indices"])
    else:
        indices = np.arange(len(vertices))
    mode = primitive.get("mode", 4)
    faces = _TRIANGLES[mode](indices) if len(indices) >= 3 else np.empty((0, 3), np.int64)
    part = Part(vertices, faces)
    if "NORMAL" in attributes:
        part.normals = _as_many(buffers.vectors(attributes["NORMAL"], 3), vertices)
    if "COLOR_0" in attributes:
        colors = buffers.vectors(attributes["COLOR_0"], None, normalized=True)[:, :3]
        part.colors = np.clip(_as_many(colors, vertices), 0, 1)
    material = materials.get(primitive.get("material"))
    part.factor = material.factor
    set_ = f"TEXCOORD_{material.coordinates}"
    if set_ not in attributes and material.image is None:
        set_ = "TEXCOORD_0"
    if set_ in attributes:
        uv = _as_many(buffers.coordinates(attributes[set_]), vertices)
        part.uv = _turned(uv, material)
        part.image = material.image
    elif material.image is not None:
        textures.leave_out(f"that of material {primitive['material']}")
    return part


def _as_many(
    values: Float[np.ndarray, "N C"], vertices: Float[np.ndarray, "V 3"]
) -> Float[np.ndarray, "V C"]:
    if len(values) != len(vertices):
        raise FileError(f"is a broken glTF file: {len(values)} values for {len(vertices)} vertices")
    return values


def _turned(uv: Float[np.ndarray, "V 2"], material: Material) -> Float[np.ndarray, "V 2"]:
    """Return texture coordinates as the material has them turned, and v upwards."""
    # glTF counts v downwards from the top of the picture.
    return (uv @ material.turn.T + material.offset) * [1, -1] + [0, 1]


def _move(part: Part, place: Float[np.ndarray, "4 4"]) -> None:
    linear = place[:3, :3]
    part.vertices = part.vertices @ linear.T + place[:3, 3]
    if np.linalg.det(linear) < 0:
        part.faces = part.faces[:, ::-1]
    if part.normals is not None:
        # The inverse transpose times the determinant, which exists for flat places, too.
        cofactors = np.stack(
            [
                np.cross(linear[1], linear[2]),
                np.cross(linear[2], linear[0]),
                np.cross(linear[0], linear[1]),
            ]
        )
        sign = -1 if np.linalg.det(linear) < 0 else 1
        part.normals = sign * part.normals @ cofactors.T


def _tell(tree: dict[str, Any], textures: Textures) -> None:
    """Say what of the file is ignored."""
    ignored = []
    if any("skin" in node for node in items(tree, "nodes")):
        ignored.append("skins (it is shown in the pose it is stored in)")
    primitives = [p for mesh in items(tree, "meshes") for p in items(mesh, "primitives")]
    if any("targets" in primitive for primitive in primitives):
        ignored.append("morph targets")
    if any(
        material.get("alphaMode", "OPAQUE") != "OPAQUE" for material in items(tree, "materials")
    ):
        ignored.append("transparency")
    if ignored:
        textures.note(f"{', '.join(ignored)} left out")
