"""A folder that holds a surface: normals, albedo, depth, and a mesh."""

from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import FileError
from harmface.geometry import Mesh, pixel_coordinates
from harmface.io.atomic import atomic_write
from harmface.io.files import PARSE_ERRORS, excerpt, read_bytes
from harmface.io.images import write_image
from harmface.io.meshes import read_mesh, write_glb, write_obj, write_ply
from harmface.io.tables import npy_array

MESH_FILES = {
    "ply": ("mesh.ply",),
    "obj": ("mesh.obj", "mesh.mtl", "mesh.png"),
    "glb": ("mesh.glb",),
}

_ARRAYS = ("normals.npy", "albedo.npy", "depth.npy", "confidence.npy")


@runtime_checkable
class PixelSurface(Protocol):
    """A surface over the pixels of a picture: `StereoResult`, `FilmSurface`."""

    @property
    def normals(self) -> Float[np.ndarray, "H W 3"]:
        """Unit normals; zero outside the mask."""

    @property
    def albedo(self) -> Float[np.ndarray, "H W"]:
        """Albedo."""

    @property
    def confidence(self) -> Float[np.ndarray, "H W"]:
        """How far to trust each pixel, in (0, 1]."""

    @property
    def mask(self) -> Bool[np.ndarray, "H W"]:
        """The pixels."""


def surface_files(mesh_format: str) -> list[str]:
    """Return the names of all files that `write_surface` makes.

    Parameters
    ----------
    mesh_format
        A key of `MESH_FILES`.

    Returns
    -------
    list of str
        Names of files.
    """
    return [*_ARRAYS, "mask.png", *MESH_FILES[mesh_format]]


def write_surface(
    folder: Path,
    found: PixelSurface,
    depth: Float[np.ndarray, "H W"],
    mesh: Mesh,
    mesh_mask: Bool[np.ndarray, "H W"],
    mesh_format: str = "ply",
) -> None:
    """Write a surface that photographs told.

    Parameters
    ----------
    folder
        Must exist.
    found
        Normals, albedo and confidence, such as a `StereoResult`.
    depth
        Of the same size.
    mesh, mesh_mask
        Made by `depth_to_mesh` over this mask.
    mesh_format
        "ply" or "glb", with albedo as vertex colours, or "obj", with albedo as texture.
    """
    arrays = (found.normals, found.albedo, depth, found.confidence)
    for name, array in zip(_ARRAYS, arrays, strict=True):
        buffer = BytesIO()
        np.save(buffer, array, allow_pickle=False)
        with atomic_write(folder / name) as file:
            file.write(buffer.getvalue())
    write_image(folder / "mask.png", found.mask.astype(float), bits=8)
    if mesh_format == "obj":
        texture = found.albedo / max(found.albedo.max(), 1.0)
        write_obj(folder / "mesh.obj", mesh, texture, pixel_coordinates(mesh_mask))
    else:
        {"ply": write_ply, "glb": write_glb}[mesh_format](folder / f"mesh.{mesh_format}", mesh)


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface from photographs, as `write_surface` wrote it.

    Parameters
    ----------
    mesh
        Its vertices are the pixels that have a depth; its normals are those found, not those of
        its faces, which show less.
    confidence
        Of every vertex, in (0, 1].
    """

    mesh: Mesh
    confidence: Float[np.ndarray, "V"]


def read_surface(folder: Path | str) -> Surface:
    """Read a folder that `harmface stereo` made.

    Parameters
    ----------
    folder
        The folder.

    Returns
    -------
    Surface
        The mesh with the normals that were found, and how far to trust them.

    Raises
    ------
    FileError
        If a file is missing or damaged, or they do not belong together.
    """
    folder = Path(folder)
    missing = [name for name in _ARRAYS if not (folder / name).is_file()]
    found = [files[0] for files in MESH_FILES.values() if (folder / files[0]).is_file()]
    if missing or not found:
        raise FileError(
            f"{folder}: is not a folder that `harmface stereo` wrote: "
            f"{missing[0] if missing else 'a mesh'} is missing"
        )
    normals, depth, confidence = (
        _read_array(folder / name) for name in ("normals.npy", "depth.npy", "confidence.npy")
    )
    mesh = read_mesh(folder / found[0])
    seen = depth != 0
    fits = normals.shape == (*depth.shape, 3) and confidence.shape == depth.shape
    if depth.ndim != 2 or not fits or seen.sum() != len(mesh.vertices):
        raise FileError(
            f"{folder}: its files do not belong together: {found[0]} has "
            f"{len(mesh.vertices)} vertices, depth.npy has shape {depth.shape} with "
            f"{seen.sum()} pixels of the surface; run `harmface stereo` again"
        )
    try:
        mesh = replace(mesh, normals=normals[seen])
        return Surface(mesh, checks.non_negative("confidence", confidence[seen]))
    except ValueError as error:
        raise FileError(f"{folder}: holds no surface of use ({excerpt(error)})") from None


def _read_array(path: Path) -> np.ndarray:
    try:
        return checks.finite("values", npy_array(read_bytes(path)))
    except FileError:
        raise
    except PARSE_ERRORS as error:
        raise FileError(f"{path}: holds no array of real numbers ({excerpt(error)})") from None
