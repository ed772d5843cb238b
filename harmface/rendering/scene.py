"""Scenes of lamps and surfaces near an object, and the light that reaches its points.

References
----------
.. [AKDS04] Annen, Kautz, Durand and Seidel, Spherical Harmonic Gradients for Mid-Range
   Illumination, EGSR 2004.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.conventions import harmonic_count
from harmface.errors import ArgumentError
from harmface.geometry.rays import RayCaster
from harmface.light import NearLight, PointLight, Probes, layout_named
from harmface.sphere import harmonic_gradients, real_harmonics

FACE_SIZE = 64
"""Side of a probe's cube map in pixels, as in [AKDS04]_ section 7."""

SAMPLES = 256
"""Points of each lamp, at least, that the reference casts rays to."""

PAIRS = 2**18
"""Directions treated at a time: 50 MB of harmonics at degree 4."""


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface that may shine, from its outer side, with one radiance.

    Parameters
    ----------
    vertices
        Positions.
    faces
        Triangles, counter-clockwise seen from outside.
    radiance
        One number a channel; zero for what only stands in the way.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Integer[np.ndarray, "F 3"]
    radiance: Float[np.ndarray, "channels"]


@dataclass(frozen=True, eq=False)
class Scene:
    """Lamps and surfaces round an object, which is itself no part of it.

    Parameters
    ----------
    lights
        Lamps, all with the same channels.
    surfaces
        Meshes that shine or stand in the way.

    Raises
    ------
    ArgumentError
        If there is nothing that shines, or channels differ.
    """

    lights: tuple[NearLight, ...]
    surfaces: tuple[Surface, ...] = ()

    def __post_init__(self) -> None:
        radiances = [light.radiance for light in self.lights]
        radiances += [surface.radiance for surface in self.surfaces]
        if not any(np.any(radiance) for radiance in radiances):
            raise ArgumentError("a scene must hold a light that is not dark")
        if len({radiance.shape for radiance in radiances}) > 1 or radiances[0].ndim != 1:
            raise ArgumentError(
                "all lights of a scene must have the same number of channels, got shapes "
                f"{sorted({radiance.shape for radiance in radiances})}"
            )

    @property
    def channels(self) -> int:
        """Number of colour channels."""
        return len(self.lights[0].radiance if self.lights else self.surfaces[0].radiance)

    @cached_property
    def solid(self) -> tuple[Surface, ...]:
        """Everything that a ray can meet: lamps but for points, and surfaces."""
        lamps = [
            Surface(*light.triangles(), light.radiance)
            for light in self.lights
            if not isinstance(light, PointLight)
        ]
        return (*lamps, *self.surfaces)

    @cached_property
    def cast(self) -> "_Cast | None":
        """All of it made ready for rays, if there is any."""
        return _Cast(self.solid) if self.solid else None


class _Cast:
    """Several surfaces as one mesh for rays."""

    def __init__(self, surfaces: tuple[Surface, ...]) -> None:
        counts = [len(each.vertices) for each in surfaces]
        starts = np.cumsum([0, *counts[:-1]])
        self.vertices = np.concatenate([each.vertices for each in surfaces])
        self.faces = np.concatenate([s.faces + n for s, n in zip(surfaces, starts, strict=True)])
        sizes = [len(each.faces) for each in surfaces]
        self.surface = np.repeat(np.arange(len(surfaces)), sizes)
        self.radiance = np.stack([each.radiance for each in surfaces])
        self.rays = RayCaster(self.vertices, self.faces)
        corners = self.vertices[self.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self.normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)

    def first(
        self, points: Float[np.ndarray, "N 3"], directions: Float[np.ndarray, "N 3"]
    ) -> tuple[Integer[np.ndarray, "N"], Float[np.ndarray, "N 3"]]:
        """Return the face that each ray meets, -1 for none, and the place."""
        hits = self.rays.first_hits(self.rays.local(points), directions)
        weights = np.stack([1 - hits.u - hits.v, hits.u, hits.v], axis=1)
        return hits.face, np.einsum("nc,nci->ni", weights, self.vertices[self.faces[hits.face]])


def probes(
    scene: Scene, points: Float[np.ndarray, "P 3"], max_degree: int, size: int = FACE_SIZE
) -> Probes:
    """Return light and its gradients at points of a scene.

    A single lamp is integrated in closed form, see `light.NearLight`; where several things may
    hide each other, `ray_cast_probes` looks. Point lights are added where nothing hides them.

    Parameters
    ----------
    scene
        The lamps and what stands between.
    points
        Where.
    max_degree
        Highest degree.
    size
        Side of the cube map's faces in pixels.

    Returns
    -------
    Probes
        Coefficients of radiance, shape (P, channels, K), and their gradients.

    Raises
    ------
    ArgumentError
        If a point is not finite, or lies in a lamp or its plane.
    """
    points = checks.finite("points", checks.vectors("points", points)).astype(np.float64)
    lamps = [light for light in scene.lights if not isinstance(light, PointLight)]
    if len(scene.solid) == 1 and lamps:
        found = lamps[0].probes(points, max_degree)
    elif scene.solid:
        for lamp in lamps:
            lamp.probes(points, 0)  # refuses points that lie in it
        found = ray_cast_probes(scene, points, max_degree, size)
    else:
        found = _dark(scene, points, max_degree)
    for light in scene.lights:
        if isinstance(light, PointLight):
            seen = _open(scene, points, light)
            each = light.probes(points, max_degree)
            found += Probes(
                points,
                each.coefficients * seen[:, None, None],
                each.gradients * seen[:, None, None, None],
            )
    return found


def ray_cast_probes(
    scene: Scene, points: Float[np.ndarray, "P 3"], max_degree: int, size: int = FACE_SIZE
) -> Probes:
    """Return light and its gradients at points from cube maps of what is seen there.

    With the distance `r`, the normal `n` and the radiance `L` of what is seen in each direction,
    the surface being fixed while the point moves ([AKDS04]_ eq. 11-13 put together),

        grad c = -integral L / r (grad Y + Y (n / (n . w) - 3 w)) dw.

    What hides what is taken not to change. The term `1 / (n . w)` has a finite integral over any
    surface, but a surface seen from its edge has few pixels and large values in them: below half
    the width of a pixel, `n . w` counts as that.

    Parameters
    ----------
    scene
        The lamps and what stands between; point lights, which no ray meets, are left out.
    points
        Where.
    max_degree
        Highest degree.
    size
        Side of the cube map's faces in pixels.

    Returns
    -------
    Probes
        Coefficients of radiance, shape (P, channels, K), and their gradients.

    Raises
    ------
    ArgumentError
        If a point is not finite.
    """
    points = checks.finite("points", checks.vectors("points", points)).astype(np.float64)
    size = checks.positive_integer("size", size)
    if scene.cast is None:
        return _dark(scene, points, max_degree)
    cube = layout_named("cube")
    directions = cube.directions(size).reshape(-1, 3)
    solid_angles = cube.solid_angles(size).reshape(-1)
    harmonics = real_harmonics(directions, max_degree)
    slopes = harmonic_gradients(directions, max_degree)
    found = _dark(scene, points, max_degree)
    for number, point in enumerate(points):
        face, place = scene.cast.first(np.broadcast_to(point, directions.shape), directions)
        normals = scene.cast.normals[face]
        cosines = np.einsum("ni,ni->n", normals, directions)
        lit = (face >= 0) & (cosines < 0)
        w, n = directions[lit], normals[lit]
        power = scene.cast.radiance[scene.cast.surface[face[lit]]] * solid_angles[lit, None]
        basis = harmonics[:, lit]
        found.coefficients[number] = power.T @ basis.T
        toward = n / np.minimum(cosines[lit], -1 / size)[:, None] - 3 * w
        change = slopes[:, lit] + basis[..., None] * toward
        distance = np.linalg.norm(place[lit] - point, axis=1)
        near = power / distance[:, None]
        found.gradients[number] = -np.tensordot(near.T, change, axes=(1, 1))
    return found


def sampled_light(
    scene: Scene,
    points: Float[np.ndarray, "P 3"],
    max_degree: int,
    samples: int = SAMPLES,
    progress: Callable[[float], None] = lambda done: None,
) -> Float[np.ndarray, "P channels K"]:
    """Return the light at points by brute force: rays to points spread over every lamp.

    The reference that probes are held against: `c = sum L Y V cos dA / r^2`, with the visibility
    `V` of each point of a lamp and no derivative of anything.

    Parameters
    ----------
    scene
        The lamps and what stands between.
    points
        Where.
    max_degree
        Highest degree.
    samples
        Points of each lamp, at least.
    progress
        Told the fraction done.

    Returns
    -------
    numpy.ndarray
        Coefficients of radiance, shape (P, channels, K).

    Raises
    ------
    ArgumentError
        If a point is not finite.
    """
    points = checks.finite("points", checks.vectors("points", points)).astype(np.float64)
    total = _dark(scene, points, max_degree).coefficients
    for number, surface in enumerate(scene.solid):
        if not surface.radiance.any():
            continue
        places, areas = _spread(surface, checks.positive_integer("samples", samples))
        step = max(1, PAIRS // len(places))
        for first in range(0, len(points), step):
            some = points[first : first + step]
            total[first : first + step] += _from_surface(
                scene, number, places, areas, some, max_degree
            )
            progress((number + min(first + step, len(points)) / len(points)) / len(scene.solid))
    for light in scene.lights:
        if isinstance(light, PointLight):
            seen = _open(scene, points, light)
            total += light.probes(points, max_degree).coefficients * seen[:, None, None]
    return total


def _from_surface(
    scene: Scene,
    number: int,
    places: Float[np.ndarray, "S 3"],
    areas: Float[np.ndarray, "S 3"],
    points: Float[np.ndarray, "P 3"],
    max_degree: int,
) -> Float[np.ndarray, "P channels K"]:
    """Return the light that one surface sends to points."""
    assert scene.cast is not None
    offsets = places - points[:, None]
    distance = np.linalg.norm(offsets, axis=-1)
    facing = -np.einsum("psi,si->ps", offsets, areas)
    p, s = np.nonzero(facing > 0)
    directions = offsets[p, s] / distance[p, s, None]
    face, _ = scene.cast.first(points[p], directions)
    seen = (face >= 0) & (scene.cast.surface[face] == number)
    p, s, directions = p[seen], s[seen], directions[seen]
    weights = facing[p, s] / distance[p, s] ** 3
    basis = real_harmonics(directions, max_degree) * weights
    sums = np.stack([np.bincount(p, each, minlength=len(points)) for each in basis], axis=1)
    return scene.solid[number].radiance[:, None] * sums[:, None]


def _spread(
    surface: Surface, samples: int
) -> tuple[Float[np.ndarray, "S 3"], Float[np.ndarray, "S 3"]]:
    """Return the middles of small triangles that a surface divides into, and their area vectors."""
    n = max(1, int(np.ceil(np.sqrt(samples / len(surface.faces)))))
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    lower = np.stack([i, j], -1)[i + j < n] + 1 / 3
    upper = np.stack([i, j], -1)[i + j < n - 1] + 2 / 3
    uv = np.concatenate([lower, upper]) / n
    corner, one, two = np.moveaxis(surface.vertices[surface.faces], 1, 0)
    one, two = one - corner, two - corner
    places = corner[:, None] + uv[:, :1] * one[:, None] + uv[:, 1:] * two[:, None]
    areas = np.repeat(np.cross(one, two) / 2 / len(uv), len(uv), axis=0)
    return places.reshape(-1, 3), areas


def _open(
    scene: Scene, points: Float[np.ndarray, "P 3"], light: PointLight
) -> Float[np.ndarray, "P"]:
    """Return 1 for points that see a point light, 0 for others."""
    if scene.cast is None:
        return np.ones(len(points))
    offsets = light.position - points
    distance = np.linalg.norm(offsets, axis=1)
    face, place = scene.cast.first(points, offsets / distance[:, None])
    nearer = np.linalg.norm(place - points, axis=1) < distance
    return (~((face >= 0) & nearer)).astype(float)


def _dark(scene: Scene, points: Float[np.ndarray, "P 3"], max_degree: int) -> Probes:
    shape = (len(points), scene.channels, harmonic_count(max_degree))
    return Probes(points, np.zeros(shape), np.zeros((*shape, 3)))
