"""What lights near by have in common: coefficients from an outline, and their gradients.

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

import numpy as np
from jaxtyping import Float, Integer

from harmface import checks
from harmface.conventions import degrees, harmonic_count
from harmface.errors import ArgumentError
from harmface.light.distant_light import DistantLight
from harmface.light.probes import Probes
from harmface.sphere import derivative_matrices, harmonic_gradients, real_harmonics

FLAT = 1e-9
"""Share of a flat light's size below which a distance from its plane is a rounding of 0."""

CHUNK = 2**18
"""Directions treated at a time: 50 MB of harmonics at degree 4."""

NODES = 128
"""Most nodes that a light's outline has."""


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
        step = max(1, CHUNK // NODES)
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


def about_axis(
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


def outline_integrals(
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


def in_front(
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


def spread(
    front: np.ndarray, coefficients: np.ndarray, gradients: np.ndarray
) -> tuple[Float[np.ndarray, "P K"], Float[np.ndarray, "P K 3"]]:
    """Return values for all points: zero behind the light."""
    everywhere = [np.zeros((len(front), *values.shape[1:])) for values in (coefficients, gradients)]
    everywhere[0][front], everywhere[1][front] = coefficients, gradients
    return everywhere[0], everywhere[1]


def checked_place(name: str, point: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Return a point in double precision; it must be finite."""
    point = checks.finite(name, point)
    if point.shape != (3,):
        raise ArgumentError(f"{name} must have shape (3,), got {point.shape}")
    return point.astype(np.float64)


def check_radius(radius: float) -> None:
    """Refuse a radius that is not above 0."""
    if not (np.isfinite(radius) and radius > 0):
        raise ArgumentError(f"radius must be above 0, got {radius}")
