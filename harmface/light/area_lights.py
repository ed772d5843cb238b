"""Lights near by: polygons, discs, spheres and points, with the gradients of their coefficients.

A light of constant radiance `L` seen in the region `R` of directions has the coefficients
`c_k = L integral_R Y_k`. As `Y_lm` is `-1 / (l (l + 1))` times its own Laplacian, for l > 0

    c_lm = -L / (l (l + 1)) integral over the outline of (grad Y_lm . n) ds,

`n` being the outward normal of the outline on the sphere; for l = 0 the function
`-log(1 + u . w)`, whose Laplacian is 1 (`u` any direction that R is not opposite to), takes the
place of `Y`. When the point moves by `d`, an outline point at distance `r` moves by `-d . n / r`
along `n`, and only there the integral changes (Reynolds' transport theorem):

    grad c_k = -L integral over the outline of Y_k n / r ds.

Along a straight edge `n` is constant and `Y_k` a trigonometric polynomial of the angle, which a
Gauss rule integrates to rounding; round the rim of a disc a uniform rule converges as fast.

References
----------
.. [AKDS04] Annen, Kautz, Durand and Seidel, Spherical Harmonic Gradients for Mid-Range
   Illumination, EGSR 2004.
.. [WR18] Wang and Ramamoorthi, Analytic Spherical Harmonic Coefficients for Polygonal Area
   Lights, SIGGRAPH 2018.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer
from numpy.polynomial.legendre import legvander

from harmface import checks
from harmface.conventions import degrees, harmonic_count
from harmface.errors import ArgumentError
from harmface.light.analytic import zonal_cap
from harmface.light.distant_light import DistantLight
from harmface.light.probes import Probes
from harmface.sphere import derivative_matrices, harmonic_gradients, real_harmonics

EDGE_NODES = 16
"""Gauss nodes of an edge: exact to rounding up to degree 16 for an edge of a quarter turn."""

RIM_NODES = 128
"""Nodes round a disc: to rounding farther than 0.3 radii from the rim, 1e-6 at a tenth."""

FLAT = 1e-9
"""Share of a flat light's size below which a distance from its plane is a rounding of 0."""

CHUNK = 2**18
"""Directions treated at a time: 50 MB of harmonics at degree 4."""


class NearLight(ABC):
    """A light that is not far away: what arrives differs from point to point."""

    radiance: Float[np.ndarray, "*channels"]

    @abstractmethod
    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        """Return coefficients and gradients of the light with radiance 1, nothing in its way.

        They have the shapes (P, K) and (P, K, 3), and are zero where the light does not shine. It
        refuses points that lie in the light, or in the plane of a flat one.
        """

    @abstractmethod
    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return its surface for ray casting, counter-clockwise seen from where it shines to."""

    def probes(self, points: Float[np.ndarray, "P 3"], max_degree: int) -> Probes:
        """Return the light's coefficients and their gradients at points that nothing shadows.

        Parameters
        ----------
        points
            Where.
        max_degree
            Highest degree.

        Returns
        -------
        Probes
            Coefficients of radiance, `(P, *channels, K)`, and their gradients.

        Raises
        ------
        ArgumentError
            If a point is not finite, lies in the light, or in the plane of a flat one.
        """
        points = checks.finite("points", checks.vectors("points", points)).astype(np.float64)
        count = harmonic_count(max_degree)
        coefficients, gradients = np.empty((len(points), count)), np.empty((len(points), count, 3))
        step = max(1, CHUNK // RIM_NODES)
        for first in range(0, len(points), step):
            some = slice(first, first + step)
            coefficients[some], gradients[some] = self._unit(points[some], max_degree)
        channels = [1] * self.radiance.ndim
        return Probes(
            points,
            self.radiance[..., None] * coefficients.reshape(len(points), *channels, count),
            self.radiance[..., None, None] * gradients.reshape(len(points), *channels, count, 3),
        )

    def as_distant_light(self, point: Float[np.ndarray, "3"]) -> DistantLight:
        """Return one directional light with the same light vector as at a point.

        It stands for the light around there as far as that is much farther than its size.

        Parameters
        ----------
        point
            Place, in the light's unit of length.

        Returns
        -------
        DistantLight
            One direction with its irradiance in each channel.

        Raises
        ------
        ArgumentError
            If the point is not finite, lies in the light or its plane, or receives nothing of it.
        """
        # The harmonics of degree 1 are y, z and x times their constant, that of degree 0 by sqrt 3.
        first = self.probes(np.asarray(point, float)[None], 1).coefficients[0][..., [3, 1, 2]]
        vectors = first * np.sqrt(4 * np.pi / 3)
        lengths = np.linalg.norm(vectors, axis=-1)
        brightest = vectors.reshape(-1, 3)[lengths.argmax()]
        if lengths.max() == 0:
            raise ArgumentError("point receives nothing of the light: it is behind it, or dark")
        return DistantLight(brightest[None] / lengths.max(), lengths[..., None])


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
        front = _in_front(points, self.vertices[0], normal, size, "polygon")
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
        return _spread(
            front,
            *_outline_integrals(
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


@dataclass(frozen=True, eq=False)
class DiscLight(NearLight):
    """A flat round lamp that shines from one side.

    Parameters
    ----------
    center
        Middle of the disc.
    normal
        Unit vector to where it shines.
    radius
        Above 0.
    radiance
        The same everywhere and in all directions: one number or one a channel.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """

    center: Float[np.ndarray, "3"]
    normal: Float[np.ndarray, "3"]
    radius: float
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", _place("center", self.center))
        normal = checks.unit_vectors("normal", self.normal)
        if normal.shape != (3,):
            raise ArgumentError(f"normal must have shape (3,), got {normal.shape}")
        object.__setattr__(self, "normal", normal.astype(np.float64))
        _check_radius(self.radius)
        object.__setattr__(self, "radiance", checks.non_negative("radiance", self.radiance))

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        front = _in_front(points, self.center, self.normal, 2 * self.radius, "disc")
        rim, tangents = self._rim(RIM_NODES)
        seen = rim - points[front, None]
        distances = np.linalg.norm(seen, axis=-1, keepdims=True)
        seen /= distances
        steps = np.cross(seen, tangents / distances) * (2 * np.pi / RIM_NODES)
        return _spread(
            front, *_outline_integrals(seen, steps, 1 / distances[..., 0], -self.normal, max_degree)
        )

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return its surface for ray casting.

        Returns
        -------
        tuple of numpy.ndarray
            Vertices, (V, 3), and the corners of each triangle, (F, 3), counter-clockwise from where
            it shines.
        """
        rim, _ = self._rim(RIM_NODES)
        around = np.arange(RIM_NODES)
        faces = np.stack([np.full(RIM_NODES, RIM_NODES), around, np.roll(around, -1)], axis=1)
        return np.concatenate([rim, self.center[None]]), faces

    def _rim(self, count: int) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
        """Return points round the rim, and the derivatives by the angle."""
        along = np.cross(self.normal, np.eye(3)[np.abs(self.normal).argmin()])
        along /= np.linalg.norm(along)
        across = np.cross(self.normal, along)
        angle = 2 * np.pi * np.arange(count)[:, None] / count
        cosine, sine = self.radius * np.cos(angle), self.radius * np.sin(angle)
        return self.center + cosine * along + sine * across, cosine * across - sine * along


@dataclass(frozen=True, eq=False)
class SphereLight(NearLight):
    """A ball that shines: seen from anywhere it is a cone of constant radiance.

    Parameters
    ----------
    center
        Middle of the ball.
    radius
        Above 0.
    radiance
        The same everywhere and in all directions: one number or one a channel.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """

    center: Float[np.ndarray, "3"]
    radius: float
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", _place("center", self.center))
        _check_radius(self.radius)
        object.__setattr__(self, "radiance", checks.non_negative("radiance", self.radiance))

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        # With `sin(angle) = radius / distance` only the edge of the cone changes with distance.
        offsets = self.center - points
        distances = np.linalg.norm(offsets, axis=-1)
        inside = np.count_nonzero(distances <= self.radius)
        if inside:
            raise ArgumentError(f"points must lie outside the sphere light, got {inside} inside")
        angles = np.arcsin(self.radius / distances)
        degree = np.arange(max_degree + 1)
        scale = 2 * np.pi * np.sqrt((2 * degree + 1) / (4 * np.pi))
        edge = legvander(np.cos(angles), max_degree) * scale
        slopes = -edge * (self.radius**2 / (distances**3 * np.cos(angles)))[:, None]
        return _about_axis(offsets, distances, zonal_cap(angles, max_degree), slopes)

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return its surface for ray casting, of the same area.

        Returns
        -------
        tuple of numpy.ndarray
            Vertices, (V, 3), and the corners of each triangle, (F, 3), counter-clockwise from where
            it shines.
        """
        from trimesh.creation import icosphere

        ball = icosphere(subdivisions=3)
        grown = self.radius * np.sqrt(4 * np.pi / ball.area)
        return self.center + grown * np.asarray(ball.vertices), np.asarray(ball.faces, np.int64)


@dataclass(frozen=True, eq=False)
class PointLight(NearLight):
    """A lamp without a size.

    Parameters
    ----------
    position
        Where it stands.
    radiance
        Its intensity: irradiance on a surface that faces it at distance 1; one number or one a
        channel.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """

    position: Float[np.ndarray, "3"]
    radiance: Float[np.ndarray, "*channels"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", _place("position", self.position))
        object.__setattr__(self, "radiance", checks.non_negative("intensity", self.radiance))

    def _unit(
        self, points: Float[np.ndarray, "P 3"], max_degree: int
    ) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
        offsets = self.position - points
        distances = np.linalg.norm(offsets, axis=-1)
        if not distances.all():
            raise ArgumentError("points must not lie where the point light is")
        zonal = np.sqrt((2 * np.arange(max_degree + 1) + 1) / (4 * np.pi))
        return _about_axis(
            offsets,
            distances,
            zonal / distances[:, None] ** 2,
            -2 * zonal / distances[:, None] ** 3,
        )

    def triangles(self) -> tuple[Float[np.ndarray, "V 3"], Integer[np.ndarray, "F 3"]]:
        """Return nothing: no ray meets it.

        Returns
        -------
        tuple of numpy.ndarray
            No vertices, (0, 3), and no triangles, (0, 3).
        """
        return np.zeros((0, 3)), np.zeros((0, 3), np.int64)


def _about_axis(
    offsets: Float[np.ndarray, "P 3"],
    distances: Float[np.ndarray, "P"],
    zonal: Float[np.ndarray, "P L"],
    slopes: Float[np.ndarray, "P L"],
) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
    """Return coefficients and gradients of light that is round about the direction to its centre.

    Both turn with the direction `u`, whose derivative by the point is `-(1 - u u^T) / distance`,
    and change with the distance, whose derivative is `-u`.
    """
    max_degree = zonal.shape[1] - 1
    each = degrees(max_degree)
    axes = offsets / distances[:, None]
    scale = np.sqrt(4 * np.pi / (2 * each + 1))
    harmonics = real_harmonics(axes, max_degree).T * scale
    turning = np.moveaxis(harmonic_gradients(axes, max_degree), 0, 1) * scale[:, None]
    gradients = -(slopes[:, each] * harmonics)[..., None] * axes[:, None]
    gradients -= zonal[:, each, None] * turning / distances[:, None, None]
    return zonal[:, each] * harmonics, gradients


def _outline_integrals(
    directions: Float[np.ndarray, "P J 3"],
    steps: Float[np.ndarray, "P J 3"],
    nearness: Float[np.ndarray, "P J"],
    axis: Float[np.ndarray, "3"],
    max_degree: int,
) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
    """Return coefficients and gradients of a region of radiance 1 from its outline.

    Parameters
    ----------
    directions
        Unit vectors to the outline's nodes.
    steps
        Outward normals of the outline on the sphere there, times the arc each node stands for.
    nearness
        One over the distance of the nodes.
    axis
        A direction that no part of the region is opposite to.
    max_degree
        Highest degree.
    """
    degree = degrees(max_degree)
    harmonics = np.moveaxis(real_harmonics(directions, max_degree), 0, 1)
    crossing = harmonics @ steps
    # The gradient of Y_k is a sum over harmonics of the degree below, see `derivative_matrices`.
    coefficients = -np.einsum("ikj,pji->pk", derivative_matrices(max_degree), crossing)
    coefficients[:, 1:] /= (degree * (degree + 1))[1:]
    solid_angles = -((steps @ axis) / (1 + directions @ axis)).sum(axis=1)
    coefficients[:, 0] = solid_angles / np.sqrt(4 * np.pi)
    return coefficients, -(harmonics * nearness[:, None]) @ steps


def _in_front(
    points: Float[np.ndarray, "P 3"],
    within: Float[np.ndarray, "3"],
    normal: Float[np.ndarray, "3"],
    size: float,
    name: str,
) -> np.ndarray:
    """Return which points are on the shining side of a flat light; none may lie in its plane."""
    heights = (points - within) @ normal
    flat = np.count_nonzero(np.abs(heights) <= FLAT * size)
    if flat:
        raise ArgumentError(
            f"points must not lie in the plane of the {name} light, got {flat} that do; move the "
            "light"
        )
    return np.asarray(heights > 0)


def _spread(
    front: np.ndarray, coefficients: np.ndarray, gradients: np.ndarray
) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
    """Return values for all points: zero behind the light."""
    everywhere = [np.zeros((len(front), *values.shape[1:])) for values in (coefficients, gradients)]
    everywhere[0][front], everywhere[1][front] = coefficients, gradients
    return everywhere[0], everywhere[1]


def _place(name: str, point: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    point = checks.finite(name, point)
    if point.shape != (3,):
        raise ArgumentError(f"{name} must have shape (3,), got {point.shape}")
    return point.astype(np.float64)


def _check_radius(radius: float) -> None:
    if not (np.isfinite(radius) and radius > 0):
        raise ArgumentError(f"radius must be above 0, got {radius}")
