"""Meshes with fewer vertices, for what has to be small."""

import numpy as np
from scipy.spatial import cKDTree

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry import Mesh


def decimated(mesh: Mesh, vertices: int) -> Mesh:
    """Return a mesh with about so many vertices, by VTK's quadric edge collapse.

    Normals and albedo are those of the nearest old vertex, so that shading keeps what the shape
    loses.

    Parameters
    ----------
    mesh
        What to simplify; returned as it is if it has no more vertices than that. A texture is
        left out: its colours at the vertices stay.
    vertices
        How many vertices to keep, at least 4; a few more may stay.

    Returns
    -------
    Mesh
        The same surface in fewer triangles.

    Raises
    ------
    ArgumentError
        If `vertices` is below 4, or nothing of the surface would be left.

    Examples
    --------
    >>> from data_synth.shapes import sphere
    >>> ball = sphere(64)
    >>> fine = Mesh(ball.vertices, ball.faces, ball.normals, ball.albedo)
    >>> len(decimated(fine, 1000).vertices) < 1100
    True
    """
    import pyvista as pv  # takes a second to load

    vertices = checks.integer("vertices", vertices, 4)
    if len(mesh.vertices) <= vertices:
        return mesh
    surface = pv.PolyData.from_regular_faces(mesh.vertices, mesh.faces).clean()
    small = surface.decimate(max(0.0, 1 - vertices / surface.n_points))
    if not small.n_cells:
        raise ArgumentError(f"vertices must leave something of the mesh, got {vertices}")
    places = np.array(small.points, dtype=mesh.vertices.dtype)
    nearest = cKDTree(mesh.vertices).query(places)[1]
    return Mesh(
        places,
        np.array(small.regular_faces, dtype=np.int32),
        mesh.normals[nearest],
        mesh.albedo[nearest],
    )
