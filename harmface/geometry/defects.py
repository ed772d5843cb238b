"""What is wrong with a mesh as the surface of a solid: holes, and faces without an area."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Integer

from harmface.geometry.mesh import Mesh

SAME = 1e-7
"""Distance of vertices at one place, in radii of the mesh: the rounding of single precision."""


@dataclass(frozen=True)
class Defects:
    """Counts of what a closed surface would not have.

    Parameters
    ----------
    open_edges
        Edges of one face only, which bound holes; vertices at one place count as one.
    degenerate_faces
        Faces without an area.
    inward_faces
        Faces whose front is turned away from all three of their vertices' normals.
    """

    open_edges: int
    degenerate_faces: int
    inward_faces: int


def mesh_defects(mesh: Mesh) -> Defects:
    """Return counts of the defects of a mesh.

    Parameters
    ----------
    mesh
        The surface.

    Returns
    -------
    Defects
        Numbers of open edges, of degenerate faces, and of faces against their normals.

    Examples
    --------
    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2]])
    >>> from harmface.geometry import vertex_normals
    >>> normals = vertex_normals(corner, faces)
    >>> mesh_defects(Mesh(corner, faces, normals, np.full((4, 3), 0.5)))
    Defects(open_edges=3, degenerate_faces=0, inward_faces=0)
    """
    degenerate = ~mesh.face_normals.any(axis=1)
    places = _places(mesh)[mesh.faces[~degenerate]]
    edges = np.sort(np.stack([places, np.roll(places, -1, axis=1)], axis=-1), axis=-1)
    _, counts = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
    facing = np.einsum("fi,fci->fc", mesh.face_normals, mesh.normals[mesh.faces])
    return Defects(
        int(np.count_nonzero(counts == 1)),
        int(np.count_nonzero(degenerate)),
        int(np.count_nonzero((facing < 0).all(axis=1))),
    )


def _places(mesh: Mesh) -> Integer[np.ndarray, "V"]:
    """Return a number for each vertex, the same for all at one place but for rounding."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    count = len(mesh.vertices)
    pairs = KDTree(mesh.vertices).query_pairs(SAME * mesh.rays.radius, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), bool), tuple(pairs.T)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])
