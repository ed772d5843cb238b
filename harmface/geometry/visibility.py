"""Which directions see the sky from points on a surface: cast shadows."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.mesh import Mesh

OFFSET = 1e-4
"""How far rays start off the surface, as a fraction of the mesh's radius: well beyond the single
precision of Embree. On a smooth surface of 8,000 vertices, where normals between the vertices are
not those of the facets, no point then hides more than a part in 20,000 of its own sky; ten times
nearer it is a part in 2,000."""

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
    starts = _starts(mesh, points, normals)
    directions = directions.astype(np.float32)
    lit = np.zeros((len(directions), len(points)), dtype=bool)
    for some in _some_of(len(directions), len(points)):
        j, i = _before(normals, directions[some])
        j += some.start
        lit[j, i] = ~mesh.rays.occluded(starts[i], directions[j])
    return lit


@dataclass(frozen=True, eq=False)
class Blocked:
    """Which surface stands before points in which directions; each array has one entry a pair.

    Parameters
    ----------
    direction, point
        Indices of the direction and the point.
    face
        Index of the face that is met first.
    weights
        Barycentric weights of that face's three vertices.
    front
        Whether the face is met on its outer side.
    """

    direction: Integer[np.ndarray, "P"]
    point: Integer[np.ndarray, "P"]
    face: Integer[np.ndarray, "P"]
    weights: Float[np.ndarray, "P 3"]
    front: Bool[np.ndarray, "P"]


def blocked(
    mesh: Mesh,
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    directions: Float[np.ndarray, "J 3"],
) -> Blocked:
    """Return what stands in the way of light that `visible` finds to be in a cast shadow.

    Parameters
    ----------
    mesh
        What casts the shadows.
    points
        Points on the mesh, in its coordinates.
    normals
        Unit normals there.
    directions
        Unit directions to the light, not so many that all pairs would fill the memory.

    Returns
    -------
    Blocked
        The pairs of a direction and a point before it between which a face is met.
    """
    starts = _starts(mesh, points, normals)
    directions = directions.astype(np.float32)
    j, i = _before(normals, directions)
    hits = mesh.rays.first_hits(starts[i], directions[j])
    met = hits.face >= 0
    j, i, face, u, v = j[met], i[met], hits.face[met], hits.u[met], hits.v[met]
    front = np.einsum("pi,pi->p", mesh.face_normals[face], directions[j]) < 0
    return Blocked(j, i, face, np.stack([1 - u - v, u, v], axis=1), front)


def _starts(
    mesh: Mesh, points: Float[np.ndarray, "N 3"], normals: Float[np.ndarray, "N 3"]
) -> Float[np.ndarray, "N 3"]:
    """Return where rays start: off the surface, which they would meet again otherwise."""
    return mesh.rays.local(points + OFFSET * mesh.rays.radius * normals)


def _before(
    normals: Float[np.ndarray, "N 3"], directions: Float[np.ndarray, "J 3"]
) -> tuple[Integer[np.ndarray, "P"], Integer[np.ndarray, "P"]]:
    """Return the pairs of direction and point where the direction is before the surface."""
    direction, point = np.nonzero(directions @ normals.astype(np.float32).T > 0)
    return direction, point


def _some_of(count: int, width: int) -> list[slice]:
    step = max(1, CHUNK // max(1, width))
    return [slice(first, min(first + step, count)) for first in range(0, count, step)]
