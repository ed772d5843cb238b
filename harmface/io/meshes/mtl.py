"""Materials of OBJ files (MTL)."""

import os
import warnings
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from harmface.errors import FileError, FileWarning
from harmface.geometry import TextureImage
from harmface.io.files import MAX_TEXT, excerpt, read_bytes
from harmface.io.meshes.textures import Textures

# How many words follow an option of a map; those of scale, offset and turbulence are numbers,
# of which only the first must be there.
_OPTIONS = {"-blendu": 1, "-blendv": 1, "-bm": 1, "-boost": 1, "-cc": 1, "-clamp": 1}
_OPTIONS |= {"-imfchan": 1, "-mm": 2, "-texres": 1, "-type": 1}
_VECTORS = ("-s", "-o", "-t")


@dataclass
class Material:
    """A diffuse material.

    Parameters
    ----------
    name
        As `usemtl` has it.
    color
        Kd; white if it is not given. A texture stands in its place.
    picture
        File name of map_Kd.
    clamp
        Whether the picture does not repeat.
    scale, offset
        By which texture coordinates are multiplied, and what is added then.
    """

    name: str
    color: Float[np.ndarray, "3"] = field(default_factory=lambda: np.ones(3))
    picture: str | None = None
    clamp: bool = False
    scale: Float[np.ndarray, "2"] = field(default_factory=lambda: np.ones(2))
    offset: Float[np.ndarray, "2"] = field(default_factory=lambda: np.zeros(2))

    def image(self, textures: Textures) -> TextureImage | None:
        """Return the texture, if there is one."""
        if self.picture is None:
            return None
        wrap = "clamp" if self.clamp else "repeat"
        return textures.beside(self.picture, (wrap, wrap))


def read_materials(library: str, textures: Textures) -> dict[bytes, Material]:
    """Return the materials of the files that one `mtllib` line names, by their names.

    A library that is missing is told; its materials count as white.
    """
    try:
        files = [textures.find(library)]
    except FileError:
        try:
            # Several files may stand in a line, and one may have blanks in its name.
            files = [textures.find(name) for name in library.split()]
        except FileError:
            files = []
    if not files:
        text = f"its material file {excerpt(library)} is not there; materials count as white"
        warnings.warn(f"{textures.mesh.name}: {text}", FileWarning, stacklevel=5)
    found: dict[bytes, Material] = {}
    for file in files:
        current: Material | None = None
        for line in read_bytes(file, MAX_TEXT).splitlines():
            words = line.split()
            try:
                match words[:1], current:
                    case [b"newmtl"], _:
                        name = b" ".join(words[1:])
                        current = found.setdefault(name, Material(name.decode("utf-8", "replace")))
                    case [b"Kd"], Material() as material:
                        material.color = _color(words[1:])
                    case [b"map_Kd"], Material() as material:
                        _map(material, os.fsdecode(line.strip()[len(b"map_Kd") :].strip()))
            except (IndexError, ValueError):
                shown = excerpt(line[:200].decode("utf-8", "replace"))
                raise FileError(f"{file}: cannot be read as MTL: {shown}") from None
    return found


def _color(words: list[bytes]) -> Float[np.ndarray, "3"]:
    """Return Kd; one number is a grey."""
    color = np.array([float(word) for word in (words[:3] if len(words) >= 3 else words[:1] * 3)])
    if color.shape != (3,) or not ((color >= 0) & (color <= 1)).all():
        raise ValueError
    return color


def _map(material: Material, text: str) -> None:
    words = text.split()
    place = 0
    while place < len(words) and words[place].startswith("-"):
        option, start = words[place].lower(), place + 1
        if option in _VECTORS:
            end = start + 1
            while end < min(len(words), start + 3) and _is_number(words[end]):
                end += 1
            values = [float(word) for word in words[start:end]]
            if option == "-s":
                material.scale = np.array([values[0], values[1] if len(values) > 1 else 1.0])
            elif option == "-o":
                material.offset = np.array([values[0], values[1] if len(values) > 1 else 0.0])
        elif option in _OPTIONS:
            end = start + _OPTIONS[option]
            if option == "-clamp":
                material.clamp = words[start] == "on"
        else:
            break
        place = end
    # Blanks within the name are kept as they are.
    material.picture = text.split(None, place)[place] if place else text
    if not material.picture:
        raise ValueError


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
