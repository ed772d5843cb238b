"""A triangle mesh with unit vertex normals and linear RGB albedo, per vertex or from pictures."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.errors import ArgumentError
from harmface.geometry.exchange import (
    parts_of_pyvista,
    parts_of_trimesh,
    pyvista_of,
    trimesh_of,
)
from harmface.geometry.rays import RayCaster, used_vertices
from harmface.geometry.texture import Texture
from harmface.geometry.two_sided import one_side, same_places
from harmface.summaries import summary


@dataclass(frozen=True, eq=False)
class Mesh:
    """A surface to render: the frame is x right, y up, z towards the viewer.

    Parameters
    ----------
    vertices
        Positions, any unit of length.
    faces
        Vertex indices of each triangle, counter-clockwise seen from outside.
    normals
        Outward unit normals of the vertices; `vertex_normals` computes them.
    albedo
        Linear RGB in [0, 1] of each vertex, textures included.
    texture
        Albedo between the vertices, if pictures tell more than `albedo`; `gbuffer` looks it up
        at every pixel.

    Raises
    ------
    ArgumentError
        If there is no face, an index has no vertex, or a value is NaN, not of unit length
        or out of range.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Integer[np.ndarray, "F 3"]
    normals: Float[np.ndarray, "V 3"]
    albedo: Float[np.ndarray, "V 3"]
    texture: Texture | None = None

    __repr__ = summary

    def __post_init__(self) -> None:
        checked = {
            "vertices": checks.finite("vertices", checks.vectors("vertices", self.vertices)),
            "normals": checks.unit_vectors("normals", self.normals),
            "albedo": checks.non_negative("albedo", self.albedo),
        }
        for name, array in checked.items():
            if array.shape != (len(checked["vertices"]), 3):
                raise ArgumentError(
                    f"{name} must have shape (V, 3) for all V vertices, got {array.shape}"
                )
        checked["faces"] = checked_faces(self.faces, len(checked["vertices"]))
        for name, array in checked.items():
            object.__setattr__(self, name, array)
        if self.albedo.max() > 1:
            raise ArgumentError(
                f"albedo must lie in [0, 1], got {self.albedo.max():.4g}; "
                "divide 8-bit colours by 255"
            )
        if self.texture is not None:
            given = (len(self.texture.uv), len(self.texture.tint), len(self.texture.image))
            needed = (len(self.vertices), len(self.vertices), len(self.faces))
            if given != needed:
                raise ArgumentError(
                    f"texture must have uv, tint and image for {needed} vertices, vertices and "
                    f"faces, got {given}"
                )

    def __getstate__(self) -> dict[str, Any]:
        # What is made on first use is made anew where it goes: rays cannot be pickled.
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def rays(self) -> RayCaster:
        """The mesh made ready for ray casting, built on first use."""
        return RayCaster(self.vertices, self.faces)

    @cached_property
    def face_normals(self) -> Float[np.ndarray, "F 3"]:
        """Unit normals of the faces, whatever those of their vertices; zero without an area."""
        corners = self.vertices[self.faces].astype(np.float64, copy=False)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)

    @property
    def bounds(self) -> Float[np.ndarray, "2 3"]:
        """Least and greatest coordinates of the vertices that faces use."""
        used = self.vertices[used_vertices(self.faces, len(self.vertices))]
        return np.stack([used.min(axis=0), used.max(axis=0)])

    def rotated(self, rotation: Float[np.ndarray, "3 3"]) -> "Mesh":
        """Return the mesh turned about the origin: `R v` for every vertex and normal.

        Parameters
        ----------
        rotation
            Rotation matrix, shape (3, 3).

        Returns
        -------
        Mesh
            With the same faces, albedo and texture.

        Raises
        ------
        ArgumentError
            If `rotation` is no rotation matrix.
        """
        rotation = checks.rotation("rotation", rotation)
        return replace(self, vertices=self.vertices @ rotation.T, normals=self.normals @ rotation.T)

    def flipped(self) -> "Mesh":
        """Return the mesh turned inside out: normals point the other way, faces run round it.

        Returns
        -------
        Mesh
            With the same vertices, albedo and texture.
        """
        return replace(self, faces=self.faces[:, ::-1], normals=-self.normals)

    @classmethod
    def from_trimesh(cls, mesh: Any) -> "Mesh":
        """Make a mesh from a `trimesh.Trimesh`.

        Parameters
        ----------
        mesh
            Triangles, y up, facing +z. Vertex colours are taken as linear; without them, and with
            a texture, albedo is 1.

        Returns
        -------
        Mesh
            With the same vertices and faces in the same order, float64.

        Examples
        --------
        >>> import trimesh
        >>> Mesh.from_trimesh(trimesh.creation.box()).faces.shape
        (12, 3)
        """
        return cls._from_parts(*parts_of_trimesh(mesh))

    def to_trimesh(self) -> Any:
        """Return the mesh as a `trimesh.Trimesh`.

        Returns
        -------
        trimesh.Trimesh
            `from_trimesh` gives the same mesh back, less its texture.
        """
        return trimesh_of(self)

    @classmethod
    def from_pyvista(cls, mesh: Any) -> "Mesh":
        """Make a mesh from a `pyvista.PolyData`.

        Parameters
        ----------
        mesh
            A surface, y up, facing +z; polygons are cut into triangles. Albedo is its point array
            "albedo", linear in [0, 1], or "RGB" of 8 bits, or else 1.

        Returns
        -------
        Mesh
            With the same points in the same order, float64.

        Examples
        --------
        >>> import pyvista
        >>> Mesh.from_pyvista(pyvista.Plane(i_resolution=2, j_resolution=3)).faces.shape
        (12, 3)
        """
        return cls._from_parts(*parts_of_pyvista(mesh))

    def to_pyvista(self) -> Any:
        """Return the mesh as a `pyvista.PolyData`.

        Returns
        -------
        pyvista.PolyData
            `from_pyvista` gives the same mesh back, less its texture.
        """
        return pyvista_of(self)

    @classmethod
    def _from_parts(
        cls,
        vertices: Float[np.ndarray, "V 3"],
        faces: Integer[np.ndarray, "F 3"],
        normals: Float[np.ndarray, "V 3"] | None,
        albedo: Float[np.ndarray, "V 3"] | None,
    ) -> "Mesh":
        """Make a mesh, with normals computed and albedo 1 where there are none."""
        normals = vertex_normals(vertices, faces) if normals is None else normals
        albedo = np.ones_like(vertices) if albedo is None else np.asarray(albedo, np.float64)
        return cls(vertices, faces, normals, albedo)


def checked_faces(
    faces: Integer[np.ndarray, "F 3"], vertex_count: int
) -> Integer[np.ndarray, "F 3"]:
    """Return `faces` if there is at least one and each index names a vertex."""
    faces = checks.array_of("faces", faces)
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise ArgumentError(f"faces must have shape (F, 3), got {faces.shape}")
    if len(faces) == 0:
        raise ArgumentError("faces must hold at least one triangle, got none")
    return checks.indices("faces", faces, vertex_count)


def vertex_normals(
    vertices: Float[np.ndarray, "V 3"],
    faces: Integer[np.ndarray, "F 3"],
    position: Integer[np.ndarray, "V"] | None = None,
) -> Float[np.ndarray, "V 3"]:
    """Return unit vertex normals: face normals averaged with the corner angles as weights.

    Vertices at the same position share their normal, so that neither a texture seam nor a
    format without shared vertices (STL) breaks a smooth surface into facets. Corner angles
    make the result independent of how a surface is cut into triangles (Thurmer and Wuthrich,
    Computing Vertex Normals from Polygonal Facets, 1998). Of a face that comes twice, once each
    way round, one counts (`one_side`). A vertex without a face that has an area, or whose faces
    cancel each other to rounding, gets (0, 0, 1).

    Parameters
    ----------
    vertices
        Positions, any unit.
    faces
        Counter-clockwise triangles.
    position
        As `same_places` returns it for the vertices; found if not given.

    Returns
    -------
    numpy.ndarray
        Outward unit normals, shape (V, 3), in the precision of `vertices`.

    Raises
    ------
    ArgumentError
        If there is no face, an index has no vertex, or a position is not finite.
    """
    vertices = checks.finite("vertices", checks.vectors("vertices", vertices))
    faces = checked_faces(faces, len(vertices))
    position = same_places(vertices) if position is None else position
    faces, _ = one_side(vertices, faces, position)
    corners = vertices[faces]
    edges = np.roll(corners, -1, axis=1) - corners
    normal = np.cross(edges[:, 0], edges[:, 1])
    lengths = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.divide(normal, lengths, out=np.zeros_like(normal), where=lengths > 0)
    back = np.roll(-edges, 1, axis=1)
    # |a x b| and a . b share the factor |a||b|, so the angle needs neither length.
    angle = np.arctan2(
        np.linalg.norm(np.cross(edges, back), axis=-1), np.einsum("fci,fci->fc", edges, back)
    )
    weighted = (angle[..., None] * normal[:, None]).reshape(-1, 3)
    place = position[faces].reshape(-1)
    sums = np.stack(
        [np.bincount(place, weighted[:, i], minlength=position.max() + 1) for i in range(3)],
        axis=-1,
    )
    lengths = np.linalg.norm(sums, axis=-1, keepdims=True)
    total = np.bincount(place, angle.reshape(-1), minlength=len(sums))
    # Each term is off by some units in its last place, so a sum of that size says nothing.
    lost = lengths[:, 0] <= 8 * np.finfo(vertices.dtype).eps * total
    sums[lost], lengths[lost] = (0.0, 0.0, 1.0), 1.0
    return (sums / lengths)[position].astype(vertices.dtype)
