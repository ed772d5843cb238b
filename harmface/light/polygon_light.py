"""A polygon that shines, seen from near by; `near_light` has the mathematics."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.errors import ArgumentError
from harmface.light.near_light import FLAT, NearLight, in_front, outline_integrals, spread

EDGE_NODES = 16
"""Gauss nodes of an edge: exact to rounding up to degree 16 for an edge of a quarter turn."""


@dataclass(frozen=True, eq=False)
class PolygonLight(NearLight):
    """A flat polygon that shines from one side.

    Parameters
    ----------
    vertices
        Three or more corners in one plane, counter-clockwise seen from where it shines to;
        edges do not cross.
    radiance
        The same everywhere and in all directions: one number or one a channel.

    Raises
    ------
    ArgumentError
        If the corners do not lie in one plane or span no area, or the radiance is negative.
    """

    vertices: Float[np.ndarray, "n 3"]
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        vertices = checks.finite("vertices", checks.vectors("vertices", self.vertices))
        if vertices.ndim != 2 or len(vertices) < 3:
            raise ArgumentError(f"vertices must be three or more points, got {vertices.shape}")
        object.__setattr__(self, "vertices", vertices.astype(np.float64))
        object.__setattr__(self, "radiance", checks.non_negative("radiance", self.radiance))
        area = self.area_vector
        size = np.ptp(vertices, axis=0).max()
        if np.linalg.norm(area) <= FLAT * size**2:
            raise ArgumentError("vertices must span an area, got points on a line")
        heights = (vertices - vertices.mean(axis=0)) @ (area / np.linalg.norm(area))
        if np.abs(heights).max() > 1e-6 * size:
            raise ArgumentError(
                f"vertices must lie in one plane, got {np.abs(heights).max() / size:.2g} of the "
                "polygon's size off it; cut it into triangles"
            )

    @property
    def area_vector(self) -> Float[np.ndarray, "3"]:
        """The normal on the shining side, as long as the area."""
        corners = self.vertices - self.vertices[0]
        return np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0) / 2

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        normal = self.area_vector / np.linalg.norm(self.area_vector)
        size = np.ptp(self.vertices, axis=0).max()
        front = in_front(points, self.vertices[0], normal, size, "polygon")
        corners = self.vertices - points[front, None]
        distances = np.linalg.norm(corners, axis=-1, keepdims=True)
        seen = corners / distances
        after, farther = np.roll(seen, -1, axis=1), np.roll(distances, -1, axis=1)
        # Across an edge of the region: outward, as corners run counter-clockwise.
        conormals = np.cross(seen, after)
        sines = np.linalg.norm(conormals, axis=-1, keepdims=True)
        conormals = np.divide(conormals, sines, out=np.zeros_like(conormals), where=sines > 0)
        angles = np.arctan2(sines, np.einsum("pei,pei->pe", seen, after)[..., None])
        nodes, weights = np.polynomial.legendre.leggauss(EDGE_NODES)
        nodes, weights = (nodes + 1) / 2, weights / 2
        # Between the ends both the direction and 1 / r go by sines of the angle; an edge that is
        # seen end-on has no conormal, and what stands for its directions does not matter.
        some = np.where(sines > 0, sines, 1)
        begin, end = np.sin((1 - nodes) * angles) / some, np.sin(nodes * angles) / some
        between = begin[..., None] * seen[:, :, None] + end[..., None] * after[:, :, None]
        between = np.where(sines[..., None] > 0, between, seen[:, :, None])
        between /= np.linalg.norm(between, axis=-1, keepdims=True)
        nearness = begin / distances + end / farther
        steps = conormals[:, :, None] * (angles * weights)[..., None]
        count = len(self.vertices) * EDGE_NODES
        flat = (len(corners), count)
        return spread(
            front,
            *outline_integrals(
                between.reshape(*flat, 3),
                steps.reshape(*flat, 3),
                nearness.reshape(flat),
                -normal,
                max_degree,
            ),
        )

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return its surface for ray casting.

        Returns
        -------
        tuple of numpy.ndarray
            Vertices, (V, 3), and the corners of each triangle, (F, 3), counter-clockwise from where
            it shines.
        """
        from mapbox_earcut import triangulate_float64

        across = np.linalg.svd(self.area_vector[None])[2][1:]
        if np.cross(*across) @ self.area_vector < 0:
            across = across[::-1]
        plane = np.ascontiguousarray((self.vertices - self.vertices[0]) @ across.T)
        faces = triangulate_float64(plane, np.array([len(plane)], np.uint32)).reshape(-1, 3)
        corners = plane[faces]
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        turned = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0] < 0
        return self.vertices, np.where(turned[:, None], faces[:, ::-1], faces).astype(np.int64)
