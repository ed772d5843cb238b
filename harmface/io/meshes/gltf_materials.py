"""The base colour of the materials of a glTF file."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float

from harmface.errors import FileError
from harmface.geometry import TextureImage
from harmface.io.meshes.gltf_buffers import Buffers, item, objects, whole
from harmface.io.meshes.textures import Textures

_WRAPS = {10497: "repeat", 33071: "clamp", 33648: "mirror"}


@dataclass
class Material:
    """The base colour of a material.

    Parameters
    ----------
    factor
        Linear RGB.
    image
        Its texture.
    coordinates
        Which set of texture coordinates it takes.
    turn, offset
        What is done to these first, v downwards: `turn @ uv + offset`.
    """

    factor: Float[np.ndarray, "3"] = field(default_factory=lambda: np.ones(3))
    image: TextureImage | None = None
    coordinates: int = 0
    turn: Float[np.ndarray, "2 2"] = field(default_factory=lambda: np.eye(2))
    offset: Float[np.ndarray, "2"] = field(default_factory=lambda: np.zeros(2))


class Materials:
    """The materials of a file; of those that are used, once each, textures are decoded."""

    def __init__(self, tree: dict[str, Any], buffers: Buffers, textures: Textures) -> None:
        self._tree = tree
        self._buffers = buffers
        self._textures = textures
        self._made: dict[int, Material] = {}

    def get(self, index: Any) -> Material:
        """Return a material; white if there is none."""
        if index is None:
            return Material()
        if not isinstance(index, int) or index not in self._made:
            self._made[index] = self._material(item(self._tree, "materials", index))
        return self._made[index]

    def _material(self, entry: dict[str, Any]) -> Material:
        model = objects(entry, "pbrMetallicRoughness")
        factor, texture = model.get("baseColorFactor"), objects(model, "baseColorTexture")
        older = objects(objects(entry, "extensions"), "KHR_materials_pbrSpecularGlossiness")
        if not model and older:
            factor, texture = older.get("diffuseFactor"), objects(older, "diffuseTexture")
        material = Material()
        if factor is not None:
            material.factor = np.array(factor, dtype=np.float64)[:3]
            if (
                material.factor.shape != (3,)
                or not ((material.factor >= 0) & (material.factor <= 1)).all()
            ):
                raise FileError("is a broken glTF file: a base colour is not RGBA in [0, 1]")
        if texture and self._textures.wanted:
            material.image = self._image(item(self._tree, "textures", texture.get("index")))
        material.coordinates = whole(texture.get("texCoord", 0), "texCoord")
        transform = objects(objects(texture, "extensions"), "KHR_texture_transform")
        if transform:
            _transform(material, transform)
        return material

    def _image(self, texture: dict[str, Any]) -> TextureImage:
        webp = objects(objects(texture, "extensions"), "EXT_texture_webp")
        source = webp.get("source", texture.get("source"))
        if source is None:
            others = ", ".join(objects(texture, "extensions")) or "nothing"
            raise FileError(
                f"has a texture that only {others[:100]} tells; export it with PNG or JPEG, or "
                "give another (--texture)"
            )
        sampler = item(self._tree, "samplers", texture["sampler"]) if "sampler" in texture else {}
        wraps = (sampler.get("wrapS", 10497), sampler.get("wrapT", 10497))
        if not all(isinstance(each, int) and each in _WRAPS for each in wraps):
            raise FileError("is a broken glTF file: a sampler wraps in no known way")
        wrap = (_WRAPS[wraps[0]], _WRAPS[wraps[1]])
        image = item(self._tree, "images", source)
        if "bufferView" in image:
            data = self._buffers.view(image["bufferView"])
            return self._textures.embedded(data, f"image {source}", wrap)
        uri = str(image["uri"])
        if uri.startswith("data:"):
            return self._textures.embedded(self._buffers.resource(uri), f"image {source}", wrap)
        if "://" in uri:
            raise FileError(f"names {uri[:100]}; save it beside the file")
        return self._textures.named_in_mesh(uri, wrap, deep_srgb=True)


def _transform(material: Material, transform: dict[str, Any]) -> None:
    """Apply KHR_texture_transform: scale, then rotate, then offset."""
    scale = np.array(transform.get("scale", [1, 1]), dtype=np.float64).reshape(2)
    angle = float(transform.get("rotation", 0))
    cosine, sine = np.cos(angle), np.sin(angle)
    material.turn = np.array([[cosine, sine], [-sine, cosine]]) * scale
    material.offset = np.array(transform.get("offset", [0, 0]), dtype=np.float64).reshape(2)
    material.coordinates = whole(transform.get("texCoord", material.coordinates), "texCoord")
