"""Precomputed transfer: how much of each harmonic of the light reaches each point of a surface.

Cast shadows and light from one part of the surface to another are in it, so that irradiance is
`L @ T` for any light, as it is for the harmonic images of a convex object.

References
----------
.. [R05] Ramamoorthi, Modeling Illumination Variation with Spherical Harmonics, 2005, 0.6.
.. [SKS02] Sloan, Kautz and Snyder, Precomputed Radiance Transfer for Real-Time Rendering in
   Dynamic, Low-Frequency Lighting Environments, SIGGRAPH 2002.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float

from harmface import checks
from harmface.conventions import degrees, luminance
from harmface.errors import ArgumentError
from harmface.geometry import Blocked, GBuffer, Mesh, blocked, visible
from harmface.light import hemisphere
from harmface.reflectance import lambda_normalization, lambert_per_coefficient
from harmface.rendering.reference import clamped_cosines
from harmface.sphere import real_harmonics, stratified_directions

if TYPE_CHECKING:
    from scipy.sparse import csr_array

SAMPLES = 8192
"""Directions over the sphere. Of the light in a hemispherical bowl, which hides half of the sky,
they tell the mean to 0.1 % and each point's to 0.35 % (one standard deviation)."""

PAIRS = 2**21
"""Pairs of direction and point treated at a time, half of which are rays: 100 MB of arrays."""

SETTLED = 1e-6
"""What a bounce may add, as a share of all, for there to be no more of them to count."""

MOST_BOUNCES = 1000
"""A bounce that still adds something here has lost less than 1 % of the light of the one before."""

Arrays = Mapping[str, np.ndarray]
Points = tuple[np.ndarray, np.ndarray]
Keep = Callable[[Callable[[Points], Arrays], Mapping[str, Points]], Iterable[Arrays]]
"""Returns what a function makes of the parts of a long job, known by their names, in their order:
anew, wherever, or from where it was kept."""


@dataclass(frozen=True, eq=False)
class Transfer:
    """Irradiance of points under each harmonic of distant light.

    Parameters
    ----------
    coefficients
        `T_lm`: irradiance under light whose radiance is `Y_lm`. Channels lead if light was
        reflected between parts of a coloured surface.
    standard_errors
        One standard deviation of the sampling of each coefficient's cast shadows; where bounces
        carry them on, at most that.
    back_share
        Share of the rays stopped by the surface that met its inner side, through a hole. That
        stops light and is taken as black.
    """

    coefficients: Float[np.ndarray, "*channels_K_pixels"]
    standard_errors: Float[np.ndarray, "*channels_K_pixels"]
    back_share: float


def transfer(
    mesh: Mesh,
    max_degree: int,
    *,
    view: GBuffer | None = None,
    bounces: int | Literal["all"] = 0,
    albedo: Float[np.ndarray, "*channels V"] | None = None,
    samples: int = SAMPLES,
    rng: np.random.Generator | int = 0,
    progress: Callable[[float], None] = lambda done: None,
    keep: Keep = lambda make, parts: map(make, parts.values()),
) -> Transfer:
    """Return the transfer of light to the vertices of a mesh, or to what a camera sees of it.

    Without bounces it is the integral of [R05]_ eq. 40-41 for a matte surface of albedo 1,
    `T_lm(x) = integral V(x, w) max(n . w, 0) Y_lm(w) dw`: what a convex surface would receive,
    `A_l Y_lm(n)`, less what is hidden. Only the latter is sampled, so that what sees the whole
    sky has no error at all; the estimate is unbiased. Each bounce adds what arrives by way of the
    surface, `T'(x) = 1/pi integral (1 - V) albedo(x') T(x') max(n . w, 0) dw` ([SKS02]_ section
    5), by the same rays: what a point does not see of the sky it sees of the surface, and energy
    is conserved.

    Parameters
    ----------
    mesh
        The surface. It is seen from its outer side only.
    max_degree
        Highest degree of the light.
    view
        Where to find the transfer; by default at the vertices.
    bounces
        How often light is reflected from the surface to itself, or "all".
    albedo
        Of the vertices, for the bounces; by default the luminance of the mesh's.
    samples
        Number of directions over the whole sphere, even. The same serve all points.
    rng
        Generator or seed.
    progress
        Told the fraction done.
    keep
        Asked for all parts by their names: a caller who stores them can go on after a stop, and one
        who has many processes can share them out.

    Returns
    -------
    Transfer
        At the vertices `(*channels, K, V)`, of a view `(*channels, K, H, W)`, zero in the
        background, in float64. Times albedo it is a basis as `harmonic_images` returns it.

    Raises
    ------
    ArgumentError
        If an argument is out of range, or light never gets out of the mesh again.
    """
    max_degree = checks.degree("max_degree", max_degree)
    if bounces != "all":
        bounces = checks.integer("bounces", bounces, 0)
    if checks.positive_integer("samples", samples) % 2:
        raise ArgumentError(f"samples must be even, as they are drawn in pairs, got {samples}")
    albedo = luminance(mesh.albedo) if albedo is None else checks.non_negative("albedo", albedo)
    if albedo.shape[-1:] != mesh.vertices.shape[:1]:
        raise ArgumentError(
            f"albedo must have a value for each of {len(mesh.vertices)} vertices, got shape "
            f"{albedo.shape}"
        )
    if bounces and albedo.max() > 1:
        raise ArgumentError(
            f"albedo must be at most 1, got {albedo.max():.4g}: with bounces, light would grow "
            "without end; divide it by the largest"
        )
    parts = _Parts(mesh, max_degree, stratified_directions(samples // 2, rng), bounces != 0, keep)
    points, normals = mesh.vertices, mesh.normals
    if view is not None:
        points, normals = view.position[view.mask], view.normals[view.mask]
    share = 0.5 if bounces and view is not None else 1.0
    found = parts.gather("points", points, normals, lambda done: progress(share * done))
    values = np.stack([found.direct, found.errors])
    stopped, backs = found.stopped, found.backs
    if bounces:
        at_vertices = found
        if view is not None:
            at_vertices = parts.gather(
                "vertices", mesh.vertices, mesh.normals, lambda done: progress((1 + done) / 2)
            )
            stopped, backs = stopped + at_vertices.stopped, backs + at_vertices.backs
        # Errors are carried on as if all had one sign, which bounds them.
        before = np.stack([at_vertices.direct, at_vertices.errors])
        arriving = _bounced(at_vertices, albedo, before, bounces)
        values = _with_channels(values, albedo) + _reflected(found, albedo, arriving)
    if view is not None:
        image = np.zeros((*values.shape[:-1], *view.mask.shape))
        image[..., view.mask] = values
        values = image
    return Transfer(values[0], values[1], backs / max(stopped, 1))


def visibility_coefficients(
    mesh: Mesh,
    max_degree: int,
    *,
    samples: int = SAMPLES,
    rng: np.random.Generator | int = 0,
) -> Float[np.ndarray, "K V"]:
    """Return the coefficients of what each vertex sees of the sky: 1 where it is open, else 0.

    Below the horizon of a vertex's normal nothing is open. Times a reflectance by
    `sphere.product`, they give the transfer of materials that are not known beforehand, to the
    degree of both.

    Parameters
    ----------
    mesh
        The surface.
    max_degree
        Highest degree.
    samples
        Number of directions over the whole sphere, even.
    rng
        Generator or seed.

    Returns
    -------
    numpy.ndarray
        Shape (K, V), K = (degree + 1)**2.

    Raises
    ------
    ArgumentError
        If an argument is out of range.
    """
    each = degrees(checks.degree("max_degree", max_degree))
    directions = stratified_directions(max(1, samples // 2), rng).reshape(-1, 3)
    weighted = real_harmonics(directions, max_degree) * (4 * np.pi / len(directions))
    # A half-space's own coefficients are known; only what else hides the sky is sampled.
    zonal = (
        hemisphere(np.array([0.0, 0.0, 1.0]), 1.0, max_degree)
        * lambda_normalization(max_degree)[each]
    )
    found = zonal[each * (each + 1), None] * real_harmonics(
        mesh.normals.astype(np.float64), max_degree
    )
    for some in _blocks(len(mesh.vertices), len(directions)):
        points, normals = mesh.vertices[some], mesh.normals[some]
        hidden = (directions @ normals.T > 0) & ~visible(mesh, points, normals, directions)
        found[:, some] -= weighted @ hidden
    return found


@dataclass(frozen=True, eq=False)
class _Gathered:
    """What rays from points have found.

    Parameters
    ----------
    direct, errors
        Transfer of the sky's light, and its standard errors, `(K, N)`.
    exchange
        Share of each vertex's radiosity in the irradiance of each point, `(N, V)`.
    stopped, backs
        Number of rays that met the surface, and of those its inner side.
    """

    direct: np.ndarray
    errors: np.ndarray
    exchange: "csr_array"
    stopped: int
    backs: int


@dataclass(frozen=True, eq=False)
class _Parts:
    """Gathers at any number of points, block by block."""

    mesh: Mesh
    degree: int
    pairs: Float[np.ndarray, "S 2 3"]
    bounces: bool
    keep: Keep

    def gather(
        self,
        name: str,
        points: Float[np.ndarray, "N 3"],
        normals: Float[np.ndarray, "N 3"],
        progress: Callable[[float], None],
    ) -> _Gathered:
        from scipy.sparse import csr_array, vstack

        blocks = _blocks(len(points), self.pairs.size // 3)
        make = partial(_block, self.mesh, self.degree, self.pairs, self.bounces)
        named = {f"{name} {some.start}": (points[some], normals[some]) for some in blocks}
        parts = []
        for some, part in zip(blocks, self.keep(make, named), strict=True):
            parts.append(part)
            progress(some.stop / len(points))
        direct = np.concatenate([part["direct"] for part in parts], axis=1)
        errors = np.concatenate([part["errors"] for part in parts], axis=1)
        stopped, backs = np.sum([part["counts"] for part in parts], axis=0)
        exchange = csr_array((0, 0))
        if self.bounces:
            shapes = [(len(part["indptr"]) - 1, len(self.mesh.vertices)) for part in parts]
            exchange = vstack(
                [
                    csr_array((part["data"], part["indices"], part["indptr"]), shape=shape)
                    for part, shape in zip(parts, shapes, strict=True)
                ],
                format="csr",
            )
        return _Gathered(direct, errors, exchange, int(stopped), int(backs))


def _block(
    mesh: Mesh, degree: int, pairs: Float[np.ndarray, "S 2 3"], bounces: bool, some: Points
) -> Arrays:
    """Return what rays from some points find; it depends on nothing else."""
    points, normals = some
    directions = pairs.reshape(-1, 3)
    solid_angle = 4 * np.pi / len(directions)
    hidden = clamped_cosines(normals, directions).astype(np.float32)
    arrays: dict[str, np.ndarray] = {"counts": np.zeros(2, int)}
    if bounces:
        stops = blocked(mesh, points, normals, directions)
        weights = hidden[stops.direction, stops.point] * np.float32(solid_angle / np.pi)
        held = np.zeros(hidden.shape, bool)
        held[stops.direction, stops.point] = True
        hidden *= held
        arrays = _exchange(mesh, len(points), stops, weights)
    else:
        hidden *= ~visible(mesh, points, normals, directions)
    basis = real_harmonics(directions, degree).astype(np.float32)
    open_sky = real_harmonics(normals.astype(np.float64), degree)
    open_sky *= lambert_per_coefficient(degree)[:, None]
    arrays["direct"] = open_sky - solid_angle * (basis @ hidden)
    # The sum over the pairs of the squared difference of the two.
    first, second = hidden[::2], hidden[1::2]
    spread = basis**2 @ hidden**2 - 2 * (basis[:, ::2] * basis[:, 1::2]) @ (first * second)
    arrays["errors"] = solid_angle * np.sqrt(np.maximum(spread, 0))
    return arrays


def _exchange(
    mesh: Mesh, n_points: int, stops: Blocked, weights: Float[np.ndarray, "P"]
) -> dict[str, np.ndarray]:
    """Return the sparse matrix that carries the radiosity of vertices to points, as arrays."""
    from scipy.sparse import coo_array

    front = stops.front
    rows, columns = np.repeat(stops.point[front], 3), mesh.faces[stops.face[front]].reshape(-1)
    each = weights[front, None] * stops.weights[front]
    shape = (n_points, len(mesh.vertices))
    matrix = coo_array((each.reshape(-1), (rows, columns)), shape=shape).tocsr()
    return {
        "data": matrix.data,
        "indices": matrix.indices,
        "indptr": matrix.indptr,
        "counts": np.array([len(front), np.count_nonzero(~front)]),
    }


def _with_channels(
    values: Float[np.ndarray, "2 K N"], albedo: Float[np.ndarray, "*channels V"]
) -> Float[np.ndarray, "2 *channels_K_N"]:
    """Return values that are the same in every channel of the albedo."""
    channels = albedo.shape[:-1]
    spread = values.reshape(len(values), *[1] * len(channels), *values.shape[1:])
    return np.broadcast_to(spread, (len(values), *channels, *values.shape[1:]))


def _reflected(
    found: _Gathered,
    albedo: Float[np.ndarray, "*channels V"],
    received: Float[np.ndarray, "2 *channels_K_V"],
) -> Float[np.ndarray, "2 *channels_K_N"]:
    """Return the irradiance from what the vertices reflect of their own."""
    radiosity = albedo[..., None, :] * received
    flat = radiosity.reshape(-1, radiosity.shape[-1])
    return (found.exchange @ flat.T).T.reshape(*radiosity.shape[:-1], -1)


def _bounced(
    found: _Gathered,
    albedo: Float[np.ndarray, "*channels V"],
    direct: Float[np.ndarray, "2 K V"],
    bounces: int | Literal["all"],
) -> Float[np.ndarray, "2 *channels_K_V"]:
    """Return what vertices receive before the last bounce, which brings it to where it counts."""
    added = _with_channels(direct, albedo)
    total = added
    for _ in range(MOST_BOUNCES if bounces == "all" else bounces - 1):
        added = _reflected(found, albedo, added)
        total = total + added
        if np.abs(added).max() <= SETTLED * np.abs(total).max():
            return total
    if bounces == "all":
        raise ArgumentError(
            f"bounces do not die out: the {MOST_BOUNCES}th still adds to the light in the mesh, "
            "which is closed and white; give a number of bounces, or albedo below 1"
        )
    return total


def _blocks(count: int, width: int) -> list[slice]:
    step = max(1, PAIRS // width)
    return [slice(first, min(first + step, count)) for first in range(0, count, step)]
