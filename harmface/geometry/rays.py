"""Ray casting against a mesh, by Embree."""

from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from jaxtyping import Bool, Float, Float32, Integer

from harmface.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class Hits:
    """Where rays first meet a mesh.

    Parameters
    ----------
    face
        Index of the face met; -1 where a ray meets nothing.
    u, v
        Barycentric coordinates: the point is `(1 - u - v) a + u b + v c`. Undefined on a miss.
    """

    face: Integer[np.ndarray, "N"]
    u: Float[np.ndarray, "N"]
    v: Float[np.ndarray, "N"]


class RayCaster:
    """A mesh in Embree's acceleration structure.

    Embree works in single precision, so the mesh is moved and scaled into the unit ball around
    the origin first: accuracy then does not depend on the unit or the place of the mesh.
    """

    def __init__(
        self, vertices: Float[np.ndarray, "V 3"], faces: Integer[np.ndarray, "F 3"]
    ) -> None:
        used = vertices[used_vertices(faces, len(vertices))].astype(np.float64)
        low, high = used.min(axis=0), used.max(axis=0)
        self._center = (low + high) / 2
        self.radius = float(np.linalg.norm(high - low) / 2)
        if self.radius == 0:
            raise ArgumentError("vertices must span a surface, got all faces at one point")
        self._scene = EmbreeScene(robust=True)
        TriangleMesh(self._scene, self.local(vertices), np.ascontiguousarray(faces, np.int32))

    def local(self, points: Float[np.ndarray, "N 3"]) -> Float32[np.ndarray, "N 3"]:
        """Return points of the mesh's coordinates in those that rays are cast in."""
        return np.ascontiguousarray((points - self._center) / self.radius, dtype=np.float32)

    def first_hits(
        self, origins: Float32[np.ndarray, "N 3"], directions: Float[np.ndarray, "N 3"]
    ) -> Hits:
        """Return where each ray first meets the mesh.

        Parameters
        ----------
        origins
            Starting points, made by `local`.
        directions
            Unit directions.
        """
        found = self._scene.run(origins, np.ascontiguousarray(directions, np.float32), output=True)
        return Hits(found["primID"], found["u"], found["v"])

    def occluded(
        self, origins: Float32[np.ndarray, "N 3"], directions: Float[np.ndarray, "N 3"]
    ) -> Bool[np.ndarray, "N"]:
        """Return whether each ray meets the mesh at any distance."""
        found = self._scene.run(
            origins,
            np.ascontiguousarray(directions, np.float32),
            query="OCCLUDED",
        )
        return np.asarray(found) != -1


def used_vertices(faces: Integer[np.ndarray, "F 3"], vertex_count: int) -> Bool[np.ndarray, "V"]:
    """Return which vertices a face uses."""
    used = np.zeros(vertex_count, dtype=bool)
    used[faces] = True
    return used
