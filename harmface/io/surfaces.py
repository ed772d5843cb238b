"""A folder that holds a surface: normals, albedo, depth, and a mesh."""

from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from harmface.geometry import Mesh, pixel_coordinates
from harmface.io.atomic import atomic_write
from harmface.io.images import write_image
from harmface.io.meshes import write_glb, write_obj, write_ply
from harmface.stereo import StereoResult

MESH_FILES = {
    "ply": ("mesh.ply",),
    "obj": ("mesh.obj", "mesh.mtl", "mesh.png"),
    "glb": ("mesh.glb",),
}

_ARRAYS = ("normals.npy", "albedo.npy", "depth.npy", "confidence.npy")


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
    found: StereoResult,
    depth: Float[np.ndarray, "H W"],
    mesh: Mesh,
    mesh_mask: Bool[np.ndarray, "H W"],
    mesh_format: str = "ply",
) -> None:
    """Write what photometric stereo found.

    Parameters
    ----------
    folder
        Must exist.
    found
        Normals, albedo and confidence.
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
