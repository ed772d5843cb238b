"""The pictures that a mesh file names or holds."""

import warnings
from io import BytesIO
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from jaxtyping import Num
from PIL import Image

from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.geometry import TextureImage
from harmface.io.exr import read_exr
from harmface.io.files import PARSE_ERRORS, excerpt, read_bytes
from harmface.io.opencv import quiet_opencv

MAX_PIXELS = 2**27
"""Most pixels of all textures of a mesh: 134 megapixels, some 400 MB of 8 bits."""

FORMATS = ("PNG", "JPEG", "WEBP", "TIFF", "BMP", "TGA", "PPM")


class Textures:
    """Decodes the textures of one mesh, each once.

    Parameters
    ----------
    mesh
        The mesh file, beside which its textures are looked for.
    linear
        Whether 8-bit pictures are linear; they are taken as sRGB otherwise.
    wanted
        Whether the mesh's own textures are; nothing is opened otherwise.
    """

    def __init__(self, mesh: Path, *, linear: bool, wanted: bool) -> None:
        self.mesh = mesh
        self.wanted = wanted
        self._linear = linear
        self._decoded: dict[Path | str, Num[np.ndarray, "H W 3"]] = {}
        self._left = MAX_PIXELS

    def beside(self, name: str, wrap: tuple[str, str] = ("repeat", "repeat")) -> TextureImage:
        """Return the texture that the mesh file names.

        Raises
        ------
        FileError
            If it is neither where the name says nor beside the mesh, or is broken.
        """
        return self.from_file(self.find(name), wrap)

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

    def from_file(self, path: Path, wrap: tuple[str, str] = ("repeat", "repeat")) -> TextureImage:
        """Return the texture in a file."""
        if path not in self._decoded:
            if path.suffix.lower() == ".exr":
                self._decoded[path] = _coloured(read_exr(path))
            else:
                self._decoded[path] = self._decode(read_bytes(path), path)
            self._tell(path.name, self._decoded[path])
        return self._image(path, wrap, srgb=False)

    def embedded(
        self, data: bytes, name: str, wrap: tuple[str, str] = ("repeat", "repeat")
    ) -> TextureImage:
        """Return the texture in bytes of a glTF file, where 16 bits are sRGB as well."""
        if name not in self._decoded:
            self._decoded[name] = self._decode(data, name)
            self._tell(name, self._decoded[name])
        return self._image(name, wrap, srgb=True)

    def _image(self, name: Path | str, wrap: tuple[str, str], srgb: bool) -> TextureImage:
        codes = self._decoded[name]
        encoded = codes.dtype == np.uint8 or (srgb and codes.dtype == np.uint16)
        try:
            return TextureImage(codes, encoded and not self._linear, wrap)
        except ArgumentError as error:
            raise FileError(f"{name}: {error}") from None

    def _tell(self, name: str, codes: Num[np.ndarray, "H W 3"]) -> None:
        if codes.dtype == np.uint8 and not self._linear:
            warnings.warn(
                f"{self.mesh.name}: its texture {excerpt(name)} has 8 bits and is taken as sRGB; "
                "if it is linear, say so (--texture-linear)",
                FileWarning,
                stacklevel=2,
            )

    def _decode(self, data: bytes, name: Path | str) -> Num[np.ndarray, "H W 3"]:
        """Return RGB codes of 8 or 16 bits, or floating point, without alpha."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", UserWarning)
                warnings.simplefilter("ignore", Image.DecompressionBombWarning)
                picture = Image.open(BytesIO(data), formats=FORMATS)
                self._left -= picture.width * picture.height
                if self._left < 0:
                    raise FileError(
                        f"its textures have more pixels than the limit of {MAX_PIXELS}; make "
                        "them smaller"
                    )
                picture.load()
                codes = _codes(picture, data)
        except FileError:
            raise
        except (*PARSE_ERRORS, UserWarning, Image.DecompressionBombError) as error:
            raise FileError(f"{name}: cannot be read as an image: {excerpt(error)}") from None
        return _coloured(codes)


def _coloured(codes: Num[np.ndarray, "H W *channels"]) -> Num[np.ndarray, "H W 3"]:
    return np.repeat(codes[..., None], 3, axis=2) if codes.ndim == 2 else codes


def _codes(picture: Image.Image, data: bytes) -> Num[np.ndarray, "H W *channels"]:
    """Return grey or RGB codes of a decoded picture, in full depth."""
    if picture.mode.startswith("I;16"):
        return np.asarray(picture).astype(np.uint16)
    if picture.mode == "F":
        return np.asarray(picture)
    if picture.format == "PNG" and data[24] == 16:
        # Pillow has decoded it, and found it sound, but only keeps 8 bits of RGB. OpenCV, slow to
        # import, keeps all.
        import cv2

        with quiet_opencv():
            codes = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        if codes is None or codes.dtype != np.uint16 or codes.ndim != 3:
            raise ValueError("its 16 bits cannot be decoded")
        return np.ascontiguousarray(codes[..., 2::-1])
    if picture.mode == "I":
        raise ValueError("it has 32 bits; save it with 16")
    return np.asarray(picture.convert("RGB"))
