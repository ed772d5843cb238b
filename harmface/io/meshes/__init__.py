"""Meshes: PLY, OBJ, glTF and STL files to read, and PLY, GLB and OBJ to write."""

from harmface.io.meshes.reading import MESH_SUFFIXES, read_mesh
from harmface.io.meshes.textures import MAX_TEXELS
from harmface.io.meshes.writing import write_glb, write_obj, write_ply

__all__ = [
    "MAX_TEXELS",
    "MESH_SUFFIXES",
    "read_mesh",
    "write_glb",
    "write_obj",
    "write_ply",
]
