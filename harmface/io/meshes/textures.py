"""The pictures that a mesh file names or holds."""

import tempfile
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from jaxtyping import Num

from harmface.errors import ArgumentError, FileError
from harmface.geometry import TextureImage
from harmface.io.exr import read_exr
from harmface.io.files import excerpt
from harmface.io.pictures import read_picture

MAX_TEXELS = 2**27
"""Most pixels of all textures of a mesh, unless another limit is asked for: 134 megapixels, some
400 MB at 8 bits."""

_REPEAT = ("repeat", "repeat")


class Textures:
    """Decodes the textures of one mesh, each once, and gathers what there is to say of the mesh.

    Parameters
    ----------
    mesh
        The mesh file, beside which its textures are looked for.
    linear
        Whether 8-bit pictures are linear; they are taken as sRGB otherwise.
    wanted
        Whether the mesh's own textures are; nothing is opened otherwise.
    max_pixels
        Most pixels of all of them.
    """

    def __init__(self, mesh: Path, *, linear: bool, wanted: bool, max_pixels: int) -> None:
        self.mesh = mesh
        self.wanted = wanted
        self.notes: list[str] = []
        self._left_out: dict[str, None] = {}
        self._linear = linear
        self._decoded: dict[Path | str, Num[np.ndarray, "H W 3"]] = {}
        self._told: set[Path | str] = set()
        self._remaining = max_pixels

    def note(self, text: str) -> None:
        """Remember what was assumed or left out."""
        self.notes.append(f"{self.mesh.name}: {text}")

    def leave_out(self, name: str) -> None:
        """Remember a texture that its faces have no coordinates for."""
        self._left_out[name] = None

    def said(self) -> list[str]:
        """Return all that there is to say of the mesh."""
        if not self._left_out:
            return self.notes
        names = excerpt(", ".join(self._left_out))
        text = f"textures are left out where faces have no coordinates for them: {names}"
        return [*self.notes, f"{self.mesh.name}: {text}"]

    def named_in_mesh(
        self, name: str, wrap: tuple[str, str] = _REPEAT, *, deep_srgb: bool = False
    ) -> TextureImage:
        """Return the texture in a file that the mesh file names.

        Parameters
        ----------
        name
            As the mesh file has it.
        wrap
            What lies beyond its edges.
        deep_srgb
            Whether 16 bits are sRGB as well, as in glTF.

        Raises
        ------
        FileError
            If it is neither where the name says nor beside the mesh, or is broken.
        """
        return self.from_file(self.find(name), wrap, deep_srgb=deep_srgb)

    def find(self, name: str) -> Path:
        """Return where a file named in a mesh file is: as named, or else beside the mesh."""
        given = Path(name.replace("\\", "/"))
        for place in (self.mesh.parent / given, self.mesh.parent / unquote(given.name)):
            try:
                if place.exists():
                    return place
            except (OSError, ValueError):
                continue
        raise FileError(
            f"its texture {excerpt(name)} is not there; put it beside the mesh, or give another "
            "(--texture)"
        )

    def from_file(
        self, path: Path, wrap: tuple[str, str] = _REPEAT, *, deep_srgb: bool = False
    ) -> TextureImage:
        """Return the texture in a file."""
        if path not in self._decoded:
            self._decoded[path] = self._decode(path)
        return self._image(path, path.name, wrap, deep_srgb)

    def embedded(self, data: bytes, name: str, wrap: tuple[str, str] = _REPEAT) -> TextureImage:
        """Return the texture in bytes of a glTF file."""
        if name not in self._decoded:
            # The decoder wants a file.
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder, name)
                path.write_bytes(data)
                try:
                    self._decoded[name] = self._decode(path)
                except FileError as error:
                    raise FileError(str(error).replace(str(path), name)) from None
        return self._image(name, name, wrap, deep_srgb=True)

    def _image(
        self, key: Path | str, name: str, wrap: tuple[str, str], deep_srgb: bool
    ) -> TextureImage:
        codes = self._decoded[key]
        srgb = not self._linear and (
            codes.dtype == np.uint8 or (deep_srgb and codes.dtype == np.uint16)
        )
        if srgb and key not in self._told:
            self._told.add(key)
            self.note(
                f"its texture {excerpt(name)} has {8 * codes.itemsize} bits and is taken as sRGB; "
                "if it is linear, say so (--texture-linear)"
            )
        try:
            return TextureImage(codes, srgb, wrap)
        except ArgumentError as error:
            raise FileError(f"{key}: {error}") from None

    def _decode(self, path: Path) -> Num[np.ndarray, "H W 3"]:
        """Return RGB codes of 8 or 16 bits, or floating point, without opacity."""
        try:
            if path.suffix.lower() == ".exr":
                codes = _coloured(read_exr(path, max_pixels=self._remaining))
            else:
                picture = read_picture(path, self._remaining)
                self.notes += picture.notes
                deep = picture.codes.dtype.itemsize > 2 and picture.codes.dtype.kind != "f"
                codes = _coloured(picture.values(srgb=False) if deep else picture.codes)
        except FileError as error:
            said = str(error).replace("max_pixels", "max_texels")
            raise FileError(said.replace("--max-pixels", "--max-texels")) from None
        self._remaining -= codes.shape[0] * codes.shape[1]
        return codes


def _coloured(codes: Num[np.ndarray, "H W *channels"]) -> Num[np.ndarray, "H W 3"]:
    return np.repeat(codes[..., None], 3, axis=2) if codes.ndim == 2 else codes
