"""Materials of OBJ files (MTL)."""

import os
from dataclasses import dataclass, field, replace

from harmface.errors import FileError
from harmface.geometry import TextureImage
from harmface.io.files import MAX_TEXT, excerpt, is_number, read_bytes
from harmface.io.meshes.textures import Textures

# How many words follow an option of a map; those of scale, offset and turbulence are numbers,
# of which only the first must be there.
_OPTIONS = {"-blendu": 1, "-blendv": 1, "-bm": 1, "-boost": 1, "-cc": 1, "-clamp": 1}
_OPTIONS |= {"-imfchan": 1, "-mm": 2, "-texres": 1, "-type": 1}
_VECTORS = ("-s", "-o", "-t")


@dataclass(frozen=True)
class Material:
    """A diffuse material; those that look the same are equal.

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

    name: str = field(compare=False)
    color: tuple[float, ...] = (1.0, 1.0, 1.0)
    picture: str | None = None
    clamp: bool = False
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)

    def image(self, textures: Textures) -> TextureImage | None:
        """Return the texture, if there is one."""
        if self.picture is None:
            return None
        wrap = "clamp" if self.clamp else "repeat"
        return textures.named_in_mesh(self.picture, (wrap, wrap))


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
        textures.note(
            f"its material file {excerpt(library)} is not there; materials count as white"
        )
    found: dict[bytes, Material] = {}
    for file in files:
        name = None
        for line in read_bytes(file, MAX_TEXT).splitlines():
            words = line.split()
            try:
                match words[:1]:
                    case [b"newmtl"]:
                        name = b" ".join(words[1:])
                        found[name] = Material(name.decode("utf-8", "replace"))
                    case [b"Kd"] if name is not None:
                        found[name] = replace(found[name], color=_color(words[1:]))
                    case [b"map_Kd"] if name is not None:
                        text = os.fsdecode(line.strip()[len(b"map_Kd") :].strip())
                        found[name] = _mapped(found[name], text)
            except (IndexError, ValueError):
                shown = excerpt(line[:200].decode("utf-8", "replace"))
                raise FileError(f"{file}: cannot be read as MTL: {shown}") from None
    return found


def _color(words: list[bytes]) -> tuple[float, ...]:
    """Return Kd; one number is a grey."""
    color = tuple(float(word) for word in (words * 3 if len(words) == 1 else words[:3]))
    if len(color) != 3 or not all(0 <= value <= 1 for value in color):
        raise ValueError
    return color


def _mapped(material: Material, text: str) -> Material:
    """Return a material with the texture, and its options, of a map_Kd line."""
    words = text.split()
    place = 0
    while place < len(words) and words[place].startswith("-"):
        option, start = words[place].lower(), place + 1
        if option in _VECTORS:
            end = start + 1
            while end < min(len(words), start + 3) and is_number(words[end]):
                end += 1
            values = [float(word) for word in words[start:end]]
            if option == "-s":
                material = replace(material, scale=(values[0], values[1] if values[1:] else 1.0))
            elif option == "-o":
                material = replace(material, offset=(values[0], values[1] if values[1:] else 0.0))
        elif option in _OPTIONS:
            end = start + _OPTIONS[option]
            if option == "-clamp":
                material = replace(material, clamp=words[start] == "on")
        else:
            break
        place = end
    # Blanks within the name are kept as they are.
    picture = text.split(None, place)[place] if place else text
    if not picture:
        raise ValueError
    return replace(material, picture=picture)
