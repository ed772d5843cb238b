"""Which directions see the sky from points on a surface: cast shadows."""

import numpy as np
from jaxtyping import Bool, Float

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.mesh import Mesh

OFFSET = 1e-3
"""How far rays start off the surface, as a fraction of the mesh's radius: beyond the single
precision of Embree, and below any relief that a shadow could be told by."""

CHUNK = 2**20
"""Rays cast at a time: 40 MB of arrays."""


def visible(
    mesh: Mesh,
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    directions: Float[np.ndarray, "J 3"],
) -> Bool[np.ndarray, "J N"]:
    """Return whether the light from each direction reaches each point of the surface.

    A direction behind the surface (attached shadow) or blocked by the mesh (cast shadow) does
    not. Interreflection plays no part.

    Parameters
    ----------
    mesh
        What casts the shadows.
    points
        Points on the mesh, in its coordinates.
    normals
        Unit normals there.
    directions
        Unit directions to the light.

    Returns
    -------
    numpy.ndarray
        Shape (J, N), bool.

    Raises
    ------
    ArgumentError
        If shapes do not agree, or normals or directions are no unit vectors.
    """
    points = checks.finite("points", points)
    normals = checks.unit_vectors("normals", normals)
    directions = checks.unit_vectors("directions", directions)
    if points.shape != normals.shape:
        raise ArgumentError(f"normals must match points {points.shape}, got {normals.shape}")
    starts = mesh.rays.local(points + OFFSET * mesh.rays.radius * normals)
    directions = directions.astype(np.float32)
    normals = normals.astype(np.float32)
    lit = np.zeros((len(directions), len(points)), dtype=bool)
    step = max(1, CHUNK // max(1, len(points)))
    for first in range(0, len(directions), step):
        some = directions[first : first + step]
        j, i = np.nonzero(some @ normals.T > 0)
        lit[first + j, i] = ~mesh.rays.occluded(starts[i], some[j])
    return lit
