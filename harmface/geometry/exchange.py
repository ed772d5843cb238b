"""Meshes of trimesh and pyvista, to and from ours, without loss of what both can hold."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, Integer

if TYPE_CHECKING:
    from harmface.geometry.mesh import Mesh

Parts = tuple[
    Float[np.ndarray, "V 3"],
    Integer[np.ndarray, "F 3"],
    Float[np.ndarray, "V 3"] | None,
    Float[np.ndarray, "V 3"] | None,
]
"""Vertices, faces, and unit normals and albedo of the vertices where there are any."""

ALBEDO, NORMALS = "albedo", "Normals"
"""Names of the arrays that carry them, in double precision, through other libraries."""

UNIT = 1e-6
"""How far from 1 the length of a unit vector in single precision may be."""


def parts_of_trimesh(mesh: Any) -> Parts:
    """Return the parts of a `trimesh.Trimesh`.

    Albedo is its vertex attribute "albedo" where `trimesh_of` made it, or else its vertex colours,
    which are taken as linear.
    """
    kept = mesh.vertex_attributes
    albedo = kept.get(ALBEDO)
    if albedo is None and mesh.visual.kind == "vertex":
        albedo = np.asarray(mesh.visual.vertex_colors)[:, :3] / 255.0
    normals = _unit(np.array(kept.get(NORMALS, mesh.vertex_normals), np.float64))
    return np.array(mesh.vertices, np.float64), np.array(mesh.faces, np.int64), normals, albedo


def trimesh_of(mesh: "Mesh") -> Any:
    """Return a `trimesh.Trimesh` of a mesh's vertices; none are merged or left out."""
    import trimesh

    made = trimesh.Trimesh(
        mesh.vertices,
        mesh.faces,
        vertex_normals=mesh.normals,
        vertex_colors=_codes(mesh.albedo),
        process=False,
    )
    # Colours have 8 bits there, and normals may be computed anew: both go along as they are.
    made.vertex_attributes[ALBEDO] = mesh.albedo
    made.vertex_attributes[NORMALS] = mesh.normals
    return made


def parts_of_pyvista(mesh: Any) -> Parts:
    """Return the parts of a `pyvista.PolyData`.

    Albedo is its point array "albedo", linear in [0, 1], or else "RGB" of 8 bits; other cells
    than triangles are cut into such.
    """
    if not mesh.is_all_triangles:
        mesh = mesh.triangulate()
    triangles = np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
    # VTK's `long long` is another type to numpy than the integer of as many bits.
    faces = np.empty(triangles.shape, np.int64)
    faces[:] = triangles
    arrays = mesh.point_data
    albedo = None
    if ALBEDO in arrays:
        albedo = np.array(arrays[ALBEDO], np.float64)
    elif "RGB" in arrays:
        albedo = np.array(arrays["RGB"])[:, :3] / 255.0
    normals = _unit(np.array(arrays[NORMALS], np.float64)) if NORMALS in arrays else None
    return np.array(mesh.points, np.float64), faces, normals, albedo


def pyvista_of(mesh: "Mesh") -> Any:
    """Return a `pyvista.PolyData` with point arrays "Normals" and "albedo"."""
    import pyvista

    count = np.full((len(mesh.faces), 1), 3)
    made = pyvista.PolyData(mesh.vertices, np.hstack([count, mesh.faces]).reshape(-1))
    made.point_data[NORMALS] = mesh.normals
    made.point_data[ALBEDO] = mesh.albedo
    return made


def _unit(vectors: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "V 3"] | None:
    """Return vectors at unit length, as they are if they have it; None if one has no direction."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    if not lengths.size or lengths.min() == 0:
        return None
    return vectors if np.abs(lengths - 1).max() < UNIT else vectors / lengths


def _codes(albedo: Float[np.ndarray, "V 3"]) -> np.ndarray:
    return np.round(255 * albedo).astype(np.uint8)
