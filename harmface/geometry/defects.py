"""What is wrong with a mesh as the surface of a solid: holes, and faces without an area."""

from dataclasses import dataclass

import numpy as np

from harmface.geometry.mesh import Mesh
from harmface.geometry.two_sided import same_places


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
    places = same_places(mesh.vertices)[mesh.faces[~degenerate]]
    edges = np.sort(np.stack([places, np.roll(places, -1, axis=1)], axis=-1), axis=-1)
    _, counts = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
    facing = np.einsum("fi,fci->fc", mesh.face_normals, mesh.normals[mesh.faces])
    return Defects(
        int(np.count_nonzero(counts == 1)),
        int(np.count_nonzero(degenerate)),
        int(np.count_nonzero((facing < 0).all(axis=1))),
    )
