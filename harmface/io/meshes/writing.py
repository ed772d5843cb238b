"""Meshes to PLY, GLB and OBJ files, by way of trimesh."""

from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float
from PIL import Image

from harmface.conventions import linear_to_srgb
from harmface.errors import ArgumentError
from harmface.geometry import Mesh
from harmface.io.atomic import atomic_write


def write_ply(path: Path | str, mesh: Mesh) -> None:
    """Write a mesh as binary PLY, linear albedo as 8-bit vertex colours.

    Parameters
    ----------
    path
        The file to make or replace.
    mesh
        What to write; positions and normals are stored in single precision.
    """
    with atomic_write(path) as file:
        file.write(trimesh.exchange.ply.export_ply(_painted(mesh), vertex_normal=True))


def write_glb(path: Path | str, mesh: Mesh) -> None:
    """Write a mesh as GLB, linear albedo as 8-bit vertex colours, which glTF says are linear.

    Parameters
    ----------
    path
        The file to make or replace.
    mesh
        What to write; positions and normals are stored in single precision.
    """
    scene = trimesh.Scene(_painted(mesh))
    data = trimesh.exchange.gltf.export_glb(scene, include_normals=True)
    with atomic_write(path) as file:
        file.write(data)


def write_obj(
    path: Path | str,
    mesh: Mesh,
    texture: Float[np.ndarray, "H W"] | Float[np.ndarray, "H W 3"],
    uv: Float[np.ndarray, "V 2"],
) -> None:
    """Write a mesh as OBJ, with an MTL file and a PNG texture of the same name beside it.

    Parameters
    ----------
    path
        The file to make or replace, `.obj`.
    mesh
        What to write; its own albedo is not: the texture holds it.
    texture
        Linear albedo in [0, 1], stored in 8 bits as sRGB, as readers of OBJ take it.
    uv
        Texture coordinates of each vertex, v upwards.

    Raises
    ------
    ArgumentError
        If there are no texture coordinates for some vertex.
    FileError
        If a file cannot be written.
    """
    path = Path(path)
    if len(uv) != len(mesh.vertices):
        raise ArgumentError(f"uv must be given for {len(mesh.vertices)} vertices, got {len(uv)}")
    encoded = linear_to_srgb(np.clip(texture, 0, 1))
    picture = Image.fromarray(np.round(encoded * 255).astype(np.uint8))
    material = trimesh.visual.material.SimpleMaterial(
        image=picture, name=path.stem, diffuse=(255, 255, 255)
    )
    visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, visual=visual, process=False)
    surface.vertex_normals = mesh.normals
    text, others = trimesh.exchange.obj.export_obj(
        surface,
        include_normals=True,
        return_texture=True,
        mtl_name=f"{path.stem}.mtl",
        header=None,
    )
    # The mesh comes last: where it is, its texture is too.
    for name, data in [*others.items(), (path.name, text.encode())]:
        with atomic_write(path.with_name(name)) as file:
            file.write(data)


def _painted(mesh: Mesh) -> trimesh.Trimesh:
    """Return a mesh as trimesh has it, with vertex colours."""
    return trimesh.Trimesh(
        vertices=mesh.vertices,
        faces=mesh.faces,
        vertex_normals=mesh.normals,
        vertex_colors=np.round(mesh.albedo * 255).astype(np.uint8),
        process=False,
    )
