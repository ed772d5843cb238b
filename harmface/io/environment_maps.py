"""Environment maps from files and to files."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from harmface.conventions import map_frame
from harmface.errors import ArgumentError, FileError, FileWarning
from harmface.io.exr import read_exr, write_exr
from harmface.io.pfm import read_pfm, write_pfm
from harmface.io.pictures import MAX_PIXELS, read_picture
from harmface.io.radiance_hdr import read_radiance_hdr, write_radiance_hdr
from harmface.light import EnvironmentMap
from harmface.light.cube_arrangements import (
    arrangement_of,
    faces_from_image,
    faces_from_opengl,
    image_from_faces,
    opengl_order_of_cross,
)
from harmface.light.layouts import Layout, RH01Probe, layout_named

_READERS = {".hdr": read_radiance_hdr, ".pic": read_radiance_hdr, ".pfm": read_pfm}
_WRITERS = {".hdr": write_radiance_hdr, ".pfm": write_pfm, ".exr": write_exr}


@dataclass(frozen=True)
class _Reading:
    """How the pixels of a map's file are read, see `read_environment_map`."""

    srgb: bool | None
    part: str | None
    max_pixels: int


def read_environment_map(
    path: Path | str | Sequence[Path | str],
    layout: str = "latlong",
    *,
    frame: str | None = None,
    srgb: bool | None = None,
    part: str | None = None,
    max_pixels: int = MAX_PIXELS,
) -> EnvironmentMap:
    """Read an environment map.

    Parameters
    ----------
    path
        A `.hdr`, `.pfm` or `.exr` file, or a picture that `read_image` reads. For a cube one
        image in a cross or strip, told by its ratio of sides, or six files in the order
        +x -x +y -y +z -z.
    layout
        "latlong", "angular", "mirror-ball" or "cube".
    frame
        Where the map's maker says its pixels look, see `conventions.MAP_FRAMES`; by default as
        our layouts. Angular maps are read as by the program behind the published tables, see
        `file_layout`, unless their frame is "figure-3" or "debevec".
    srgb
        Whether a picture that `read_image` reads is encoded in sRGB, whatever it says of itself.
        If not given, what it says is believed; one that says nothing is taken as linear, with a
        warning at 8 bits.
    part
        Which part, layer or view of an OpenEXR file to read, see `read_exr`.
    max_pixels
        Largest picture read.

    Returns
    -------
    EnvironmentMap
        Linear radiance, channels first.

    Raises
    ------
    FileError
        If the file is missing, broken, too large, holds negative or NaN radiance, or does not
        look like a map of this layout; the message says why.
    ArgumentError
        If there is no such layout or frame.

    Warns
    -----
    FileWarning
        If a picture of 8 bits is taken as linear, or the file holds several parts.
    """
    how = _Reading(srgb, part, max_pixels)
    form = file_layout(layout, frame)
    matrix = map_frame(layout, frame)
    name = str(path if isinstance(path, Path | str) else path[0])
    try:
        if layout == "cube":
            image = _read_cube(path, how, frame)
        elif isinstance(path, Path | str):
            image = _read_pixels(path, how)
        else:
            raise ArgumentError(f"a {layout} map is one file, got {len(path)}")
        environment = EnvironmentMap.from_image(image, form, matrix)
    except ArgumentError as error:
        raise FileError(f"{name}: {error}") from None
    _check_corners(name, environment)
    return environment


def file_layout(layout: str, frame: str | None = None) -> Layout:
    """Return where the pixels of a map file look.

    An angular map without another frame is taken, and made, as RH01's program takes one, each
    pixel at its upper left corner: the published tables were computed by that program.

    Parameters
    ----------
    layout
        "latlong", "angular", "mirror-ball" or "cube".
    frame
        Whose convention the file follows, see `conventions.MAP_FRAMES`.

    Returns
    -------
    Layout
        Of the file's pixels.
    """
    if layout == "angular" and frame in (None, "rh01"):
        return RH01Probe()
    return layout_named(layout)


def write_environment_map(
    path: Path | str,
    image: Float[np.ndarray, "..."],
    *,
    arrangement: str = "vertical-strip",
) -> None:
    """Write a map's image, channels last; the ending of the name says in which format.

    Parameters
    ----------
    path
        A name that ends in `.hdr`, `.pfm` or `.exr`.
    image
        `(H, W)` or `(H, W, 3)` linear values, or a cube's faces `(6, N, N)` or `(6, N, N, 3)`.
    arrangement
        How a cube's faces are laid out, see `light.ARRANGEMENTS`.

    Raises
    ------
    FileError
        If the ending is another or the file cannot be written.
    """
    write = _WRITERS.get(Path(path).suffix.lower())
    if write is None:
        raise FileError(f"{path}: the name must end in {', '.join(_WRITERS)}")
    is_cube = image.shape[0] == 6 and image.ndim >= 3 and image.shape[1] == image.shape[2]
    write(path, image_from_faces(image, arrangement) if is_cube else image)


def _read_pixels(path: Path | str, how: _Reading) -> Float[np.ndarray, "H W *channels"]:
    suffix = Path(path).suffix.lower()
    if how.part is not None and suffix != ".exr":
        raise ArgumentError(f"part was asked for, but {path} has none; only .exr files do")
    if how.srgb and suffix in (*_READERS, ".exr"):
        raise ArgumentError(f"srgb was asked for, but {path} holds linear values")
    if suffix == ".exr":
        return read_exr(path, part=how.part, max_pixels=how.max_pixels)
    if suffix in _READERS:
        return _READERS[suffix](path, max_pixels=how.max_pixels)
    picture = read_picture(path, how.max_pixels)
    notes = picture.notes
    if how.srgb is None and picture.srgb is None and picture.bits == 8:
        notes += (
            f"{path}: holds 8 bits, which are taken as linear; if it looks right on a screen they "
            "are sRGB: say srgb=True (--srgb, or --srgb-environment)",
        )
    for note in notes:
        warnings.warn(note, FileWarning, stacklevel=2)
    return picture.linear(how.srgb)


def _read_cube(
    path: Path | str | Sequence[Path | str], how: _Reading, frame: str | None
) -> Float[np.ndarray, "6 N N *channels"]:
    """Read six faces from six files, or from a cross or strip, and turn them our way."""
    opengl = frame in ("opengl", "three.js")
    if isinstance(path, Path | str):
        image = _read_pixels(path, how)
        faces = faces_from_image(image)
        if opengl and arrangement_of(image.shape).endswith("cross"):
            faces = opengl_order_of_cross(faces)
    else:
        faces = _read_faces(path, how)
    return faces_from_opengl(faces) if opengl else faces


def _read_faces(paths: Sequence[Path | str], how: _Reading) -> Float[np.ndarray, "6 N N *channels"]:
    if len(paths) != 6:
        raise ArgumentError(f"a cube is one cross or strip or six faces, got {len(paths)} files")
    faces = [_read_pixels(path, how) for path in paths]
    for path, face in zip(paths, faces, strict=True):
        if face.shape != faces[0].shape:
            raise FileError(
                f"{path}: a cube's faces have one size, but this has shape {face.shape} and "
                f"{paths[0]} {faces[0].shape}"
            )
    return np.stack(faces)


def _check_corners(name: str, environment: EnvironmentMap) -> None:
    """Refuse a square image whose corners, which a disc leaves empty, are as bright as the rest."""
    outside = environment.solid_angles == 0
    if not outside.any():
        return
    corners = environment.radiance[..., outside].mean()
    inside = environment.radiance[..., ~outside].mean()
    if corners > inside / 2:
        raise FileError(
            f"{name}: is no {environment.layout.name} map: the corners outside its disc are not "
            f"dark (mean {corners:.3g}, {inside:.3g} inside); it may be one face of a cube"
        )
