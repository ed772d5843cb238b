"""Albedo from pictures: finer than a colour at each vertex."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Integer, Num

from harmface import checks
from harmface.conventions import srgb_to_linear
from harmface.errors import ArgumentError
from harmface.summaries import summary

WRAPS = ("repeat", "mirror", "clamp")


@dataclass(frozen=True, eq=False)
class TextureImage:
    """A picture to be looked up at texture coordinates.

    Parameters
    ----------
    pixels
        RGB, row 0 at the top: 8 or 16 bits, or floating point in [0, 1]. They are kept as they
        are, as a linear copy of a large picture would take four times its memory.
    srgb
        Whether they are encoded in sRGB.
    wrap
        What lies left and right, and above and below, of the picture: "repeat", "mirror" or
        "clamp" (its edge).

    Raises
    ------
    ArgumentError
        If the pixels have another shape, type or range, or a wrap is unknown.
    """

    pixels: Num[np.ndarray, "H W 3"]
    srgb: bool = False
    wrap: tuple[str, str] = ("repeat", "repeat")

    __repr__ = summary

    def __post_init__(self) -> None:
        pixels = self.pixels
        if pixels.ndim != 3 or pixels.shape[2] != 3 or 0 in pixels.shape:
            raise ArgumentError(f"texture must have shape (H, W, 3), got {pixels.shape}")
        if pixels.dtype not in (np.uint8, np.uint16):
            checks.non_negative("texture", pixels)
            if pixels.dtype.kind != "f" or pixels.max() > 1:
                raise ArgumentError(
                    "texture must be of 8 or 16 bits or lie in [0, 1], got "
                    f"{pixels.dtype} up to {pixels.max():.4g}"
                )
        if not set(self.wrap) <= set(WRAPS):
            raise ArgumentError(f"wrap must be of {', '.join(WRAPS)}, got {self.wrap}")

    def sample(
        self, uv: Float[np.ndarray, "N 2"], footprint: Float[np.ndarray, "N"] | None = None
    ) -> Float[np.ndarray, "N 3"]:
        """Return linear RGB at texture coordinates, bilinearly, from means of blocks.

        Parameters
        ----------
        uv
            u runs from 0 at the left edge of the picture to 1 at its right edge, v from the
            bottom to the top.
        footprint
            How many pixels of the picture a sample stands for, along a side: blocks of the
            nearest power of two are averaged. One if not given.

        Returns
        -------
        numpy.ndarray
            Linear RGB in [0, 1], shape (N, 3), float64.
        """
        if footprint is None:
            return self._bilinear(0, uv)
        last = max(self.pixels.shape[:2]).bit_length() - 1
        with np.errstate(divide="ignore"):
            level = np.clip(np.round(np.log2(footprint)), 0, last).astype(int)
        found = np.empty((len(uv), 3))
        for each in np.unique(level):
            chosen = level == each
            found[chosen] = self._bilinear(int(each), uv[chosen])
        return found

    def _bilinear(self, level: int, uv: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "N 3"]:
        blocks = self
        for _ in range(level):
            blocks = blocks._halved
        rows, columns = self.pixels.shape[:2]
        across = _wrapped(uv[:, 0], self.wrap[0]) * columns / 2**level - 0.5
        down = _wrapped(1 - uv[:, 1], self.wrap[1]) * rows / 2**level - 0.5
        left, right, x = _neighbours(across, blocks.pixels.shape[1], self.wrap[0])
        upper, lower, y = _neighbours(down, blocks.pixels.shape[0], self.wrap[1])
        above = (1 - x) * blocks._linear(upper, left) + x * blocks._linear(upper, right)
        below = (1 - x) * blocks._linear(lower, left) + x * blocks._linear(lower, right)
        return (1 - y) * above + y * below

    def _linear(
        self, row: Integer[np.ndarray, "..."], column: Integer[np.ndarray, "..."]
    ) -> Float[np.ndarray, "... 3"]:
        codes = self.pixels[row, column]
        if codes.dtype.kind == "f":
            return srgb_to_linear(codes) if self.srgb else codes
        return self._table[codes]

    @cached_property
    def _table(self) -> Float[np.ndarray, "codes"]:
        """Linear value of every code of 8 or 16 bits."""
        values = np.linspace(0, 1, np.iinfo(self.pixels.dtype).max + 1)
        return srgb_to_linear(values) if self.srgb else values

    @cached_property
    def _halved(self) -> "TextureImage":
        """Linear means of blocks of 2 x 2 pixels; an odd last row or column is repeated."""
        rows, columns = self.pixels.shape[:2]
        total = np.zeros(((rows + 1) // 2, (columns + 1) // 2, 3), np.float32)
        for i in (0, 1):
            row = np.minimum(np.arange(i, rows + i, 2), rows - 1)
            for j in (0, 1):
                column = np.minimum(np.arange(j, columns + j, 2), columns - 1)
                # Some rows at a time, as a picture in double precision may not fit into memory.
                for some in np.array_split(np.arange(len(row)), 1 + rows * columns // 2**20):
                    total[some] += self._linear(row[some][:, None], column)
        return TextureImage(np.clip(total / 4, 0, 1), False, self.wrap)


@dataclass(frozen=True, eq=False)
class Texture:
    """Where on a mesh which picture lies.

    Parameters
    ----------
    images
        The pictures.
    image
        Index into `images` of each face; -1 for a face without one.
    uv
        Texture coordinates of each vertex, v upwards.
    tint
        Linear RGB of each vertex by which the picture is multiplied.

    Raises
    ------
    ArgumentError
        If an index has no image, or a value is NaN or out of range.
    """

    images: tuple[TextureImage, ...]
    image: Integer[np.ndarray, "F"]
    uv: Float[np.ndarray, "V 2"]
    tint: Float[np.ndarray, "V 3"]

    __repr__ = summary

    def __post_init__(self) -> None:
        checks.finite("uv", self.uv)
        checks.non_negative("tint", self.tint)
        if self.tint.max(initial=0) > 1:
            raise ArgumentError(f"tint must lie in [0, 1], got {self.tint.max():.4g}")
        if len(self.image) and not -1 <= self.image.min() <= self.image.max() < len(self.images):
            raise ArgumentError(f"image must index {len(self.images)} images, or be -1")

    def sample(
        self,
        corners: Integer[np.ndarray, "N 3"],
        image: Integer[np.ndarray, "N"],
        weights: Float[np.ndarray, "N 3"],
        footprint: Float[np.ndarray, "N"] | None = None,
    ) -> Float[np.ndarray, "N 3"]:
        """Return linear albedo at points of faces; undefined where `image` is -1.

        Parameters
        ----------
        corners
            Vertex indices of each point's face.
        image
            The image there.
        weights
            Barycentric coordinates of the points.
        footprint
            Side of the area that each point stands for, in units of the unit square of texture
            coordinates; none if not given.

        Returns
        -------
        numpy.ndarray
            Linear RGB in [0, 1], shape (N, 3).
        """
        uv = np.einsum("nc,nci->ni", weights, self.uv[corners])
        found = np.einsum("nc,nci->ni", weights, self.tint[corners])
        for index in np.unique(image[image >= 0]):
            chosen = image == index
            picture = self.images[index]
            rows, columns = picture.pixels.shape[:2]
            pixels = None if footprint is None else footprint[chosen] * np.sqrt(rows * columns)
            found[chosen] *= picture.sample(uv[chosen], pixels)
        return found


def _wrapped(coordinate: Float[np.ndarray, "N"], wrap: str) -> Float[np.ndarray, "N"]:
    """Return coordinates in [0, 1]."""
    if wrap == "clamp":
        return np.clip(coordinate, 0, 1)
    if wrap == "mirror":
        return 1 - np.abs(1 - np.mod(coordinate, 2))
    return np.mod(coordinate, 1)


def _neighbours(
    place: Float[np.ndarray, "N"], count: int, wrap: str
) -> tuple[Integer[np.ndarray, "N"], Integer[np.ndarray, "N"], Float[np.ndarray, "N 1"]]:
    """Return the two texels about a place, and the weight of the second."""
    first = np.floor(place).astype(int)
    share = (place - first)[:, None]
    if wrap == "repeat":
        return first % count, (first + 1) % count, share
    return np.clip(first, 0, count - 1), np.clip(first + 1, 0, count - 1), share
