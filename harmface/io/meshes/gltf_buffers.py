"""The numbers and bytes that the JSON of a glTF file points to."""

import base64
import binascii
from typing import Any
from urllib.parse import unquote

import numpy as np
from jaxtyping import Float, Integer

from harmface.errors import FileError
from harmface.io.files import excerpt, read_bytes
from harmface.io.meshes.textures import Textures

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def objects(tree: dict[str, Any], name: str) -> dict[str, Any]:
    """Return the object of a name; empty if there is none."""
    found = tree.get(name, {})
    if not isinstance(found, dict):
        raise FileError(f"is a broken glTF file: {name} is no object")
    return found


def items(tree: dict[str, Any], name: str) -> list[Any]:
    """Return the list of a name; empty if there is none."""
    found = tree.get(name, [])
    if not isinstance(found, list):
        raise FileError(f"is a broken glTF file: {name} is no list")
    return found


def item(tree: dict[str, Any], name: str, index: Any) -> dict[str, Any]:
    """Return an object of a list."""
    found = items(tree, name)
    if not isinstance(index, int) or not 0 <= index < len(found):
        raise FileError(f"is a broken glTF file: {name} has no {excerpt(index)}")
    if not isinstance(found[index], dict):
        raise FileError(f"is a broken glTF file: {name} {index} is no object")
    return found[index]


def whole(value: Any, name: str) -> int:
    """Return a whole number that is not negative."""
    if not isinstance(value, int) or value < 0:
        raise FileError(f"is a broken glTF file: {name} is {excerpt(value)}")
    return value


class Buffers:
    """Accessors and buffer views, checked against what there is before memory is taken."""

    def __init__(self, tree: dict[str, Any], binary: bytes, textures: Textures) -> None:
        self._tree = tree
        self._binary = binary
        self._textures = textures
        self._read: dict[int, bytes] = {}
        quantized = "KHR_mesh_quantization" in items(tree, "extensionsUsed")
        # Without it, whole numbers stand for fractions even where the file forgets to say so.
        self._normalized = not quantized

    @property
    def size(self) -> int:
        """Bytes in files of their own that have been read."""
        return sum(map(len, self._read.values()))

    def view(self, index: Any) -> bytes:
        """Return the bytes of a buffer view."""
        view = item(self._tree, "bufferViews", index)
        if "EXT_meshopt_compression" in objects(view, "extensions"):
            raise FileError("is compressed by EXT_meshopt_compression; export it without")
        data = self._buffer(view["buffer"])
        start = whole(view.get("byteOffset", 0), "byteOffset")
        length = whole(view["byteLength"], "byteLength")
        if start + length > len(data):
            raise FileError(f"ends within buffer view {index}; export it again")
        return data[start : start + length]

    def resource(self, uri: str) -> bytes:
        """Return the bytes that a URI holds, or of the file that it names."""
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except binascii.Error as error:
                raise FileError(f"holds data that are no base64: {excerpt(error)}") from None
        if "://" in uri:
            raise FileError(f"names {excerpt(uri)}; save it beside the file")
        return read_bytes(self._textures.mesh.parent / unquote(uri))

    def stored(self, index: Any) -> bool:
        """Return whether an accessor has numbers of its own; it is all zeros otherwise."""
        return not {"bufferView", "sparse"}.isdisjoint(item(self._tree, "accessors", index))

    def vectors(
        self, index: Any, size: int | None, *, normalized: bool = False
    ) -> Float[np.ndarray, "N C"]:
        """Return an accessor's vectors, float64.

        Parameters
        ----------
        index
            Of the accessor.
        size
            Components that it must have; any if None.
        normalized
            Whether whole numbers stand for fractions in any case.
        """
        accessor = item(self._tree, "accessors", index)
        values = self._values(accessor)
        if size is not None and values.shape[1] != size:
            raise FileError(f"is a broken glTF file: accessor {index} is no VEC{size}")
        found = values.astype(np.float64)
        if values.dtype.kind == "f" or not (normalized or accessor.get("normalized") is True):
            return found
        return np.maximum(found / np.iinfo(values.dtype).max, -1)

    def coordinates(self, index: Any) -> Float[np.ndarray, "N 2"]:
        """Return texture coordinates as the file has them."""
        return self.vectors(index, 2, normalized=self._normalized)

    def indices(self, index: Any) -> Integer[np.ndarray, "N"]:
        """Return an accessor of vertex indices."""
        values = self._values(item(self._tree, "accessors", index))
        if values.dtype.kind == "f" or values.shape[1] != 1:
            raise FileError(f"is a broken glTF file: accessor {index} holds no indices")
        return values[:, 0].astype(np.int64)

    def _buffer(self, index: Any) -> bytes:
        buffer = item(self._tree, "buffers", index)
        if "uri" not in buffer:
            return self._binary
        if index not in self._read:
            self._read[index] = self.resource(str(buffer["uri"]))
        return self._read[index]

    def _values(self, accessor: dict[str, Any]) -> np.ndarray:
        """Return numbers as they are stored, (count, components)."""
        count = whole(accessor["count"], "count")
        if accessor.get("type") not in _SIZES:
            raise FileError(f"is a broken glTF file: an accessor is {accessor.get('type')!r:.40}")
        shape = (count, _SIZES[accessor["type"]])
        if "bufferView" in accessor:
            values = self._strided(accessor, shape, accessor["componentType"])
        else:
            if count > len(self._binary) + self.size:
                raise FileError(f"promises {count} elements that it does not have")
            values = np.zeros(shape, _TYPES[accessor["componentType"]])
        if "sparse" in accessor:
            sparse = objects(accessor, "sparse")
            changed = whole(sparse["count"], "count")
            where, what = objects(sparse, "indices"), objects(sparse, "values")
            places = self._strided(where, (changed, 1), where["componentType"])[:, 0]
            values = values.copy()
            values[places] = self._strided(what, (changed, shape[1]), accessor["componentType"])
        return values

    def _strided(self, entry: dict[str, Any], shape: tuple[int, int], kind: Any) -> np.ndarray:
        dtype = np.dtype(_TYPES[kind])
        data = self.view(entry["bufferView"])
        view = item(self._tree, "bufferViews", entry["bufferView"])
        row = shape[1] * dtype.itemsize
        stride = whole(view.get("byteStride", row), "byteStride") or row
        start = whole(entry.get("byteOffset", 0), "byteOffset")
        if shape[0] and (stride < row or start + stride * (shape[0] - 1) + row > len(data)):
            raise FileError(f"promises {shape[0]} elements in {len(data)} bytes; export it again")
        return (
            np.ndarray(shape, dtype, data, start, (stride, dtype.itemsize))
            if shape[0]
            else (np.empty(shape, dtype))
        )
