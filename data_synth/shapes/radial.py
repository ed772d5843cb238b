"""Shapes that are a radius in every direction: sphere, ellipsoid, superquadric, bumpy sphere."""

import numpy as np

from data_synth.shapes.shape import (
    Shape,
    assemble,
    full_turn,
    grid_patch,
    normalised,
    require_positive,
    require_resolution,
)


def sphere(resolution: int = 64, radius: float = 1.0) -> Shape:
    """Build a sphere about the origin, its poles on the y axis.

    Parameters
    ----------
    resolution : int
        Rows of faces from pole to pole, at least 8; twice as many go around.
    radius : float
    """
    require_positive("radius", radius)
    directions, uvs = _directions(resolution)
    return assemble("sphere", grid_patch(radius * directions, directions, uvs))


def ellipsoid(
    resolution: int = 64, semi_axes: tuple[float, float, float] = (0.7, 1.0, 0.85)
) -> Shape:
    """Build an ellipsoid with its axes along x, y and z; the normal is p / semi_axes^2."""
    require_positive("semi_axes", *semi_axes)
    directions, uvs = _directions(resolution)
    points = directions * np.array(semi_axes)
    return assemble(
        "ellipsoid", grid_patch(points, normalised(directions / np.array(semi_axes)), uvs)
    )


def superquadric(
    resolution: int = 64,
    exponents: tuple[float, float] = (0.4, 0.4),
    semi_axes: tuple[float, float, float] = (0.75, 0.75, 0.75),
) -> Shape:
    """Build Barr's superquadric, `(|x/a|^(2/e2) + |z/c|^(2/e2))^(e2/e1) + |y/b|^(2/e1) = 1`.

    Parameters
    ----------
    resolution : int
    exponents : (e1, e2)
        Of the profile along y and of the section across it, each in [0.1, 1.9]: 1 is an
        ellipsoid, below it a rounded box, above it pinched towards an octahedron.
    semi_axes : (a, b, c)
    """
    require_positive("semi_axes", *semi_axes)
    if not all(0.1 <= exponent <= 1.9 for exponent in exponents):
        raise ValueError(
            f"exponents must be in [0.1, 1.9], got {exponents}: beyond, edges and points are "
            "too sharp to have normals"
        )
    profile, section = exponents
    directions, uvs = _directions(resolution)
    size = np.abs(directions)
    across = size[..., 0] ** (2 / section) + size[..., 2] ** (2 / section)
    inside = across ** (section / profile) + size[..., 1] ** (2 / profile)
    scale = inside[..., None] ** (-profile / 2)
    # Across vanishes at the poles only, where the gradient is along y.
    steepness = np.where(across > 0, across, 1.0) ** (section / profile - 1)
    gradient = np.sign(directions) * np.stack(
        [
            steepness * size[..., 0] ** (2 / section - 1),
            size[..., 1] ** (2 / profile - 1),
            steepness * size[..., 2] ** (2 / section - 1),
        ],
        axis=-1,
    )
    patch = grid_patch(
        directions * scale * np.array(semi_axes), normalised(gradient / np.array(semi_axes)), uvs
    )
    return assemble("superquadric", patch)


def bumpy_sphere(
    resolution: int = 96,
    amplitude: float = 0.09,
    waves: int = 12,
    rng: np.random.Generator | int = 0,
) -> Shape:
    """Build a sphere whose radius is modulated by random plane waves.

    The radius is `r(d) = 1 + h sum_k cos(f_k . d + phase_k)` with
    `h = amplitude sqrt(2 / waves)`; the normal is along `d - grad_S r / r`, grad_S the exact
    gradient on the sphere.

    Parameters
    ----------
    resolution : int
    amplitude : float
        Standard deviation of the radius; positive and below `1 / sqrt(2 waves)`, which keeps
        the radius above zero.
    waves : int
        Number of waves, at least 1.
    rng : numpy Generator or seed
    """
    if waves < 1:
        raise ValueError(f"waves must be at least 1, got {waves}: use sphere() for none")
    limit = 1.0 / np.sqrt(2.0 * waves)
    if not 0 < amplitude < limit:
        raise ValueError(
            f"amplitude must be above 0 and below 1 / sqrt(2 waves) = {limit:.3g}, "
            f"got {amplitude}: beyond, the radius may vanish"
        )
    rng = np.random.default_rng(rng)
    frequency = normalised(rng.standard_normal((waves, 3))) * rng.uniform(3.0, 9.0, (waves, 1))
    phase = rng.uniform(0.0, 2.0 * np.pi, waves)
    height = amplitude * np.sqrt(2.0 / waves)
    directions, uvs = _directions(resolution)
    angle = directions @ frequency.T + phase
    radius = 1.0 + height * np.cos(angle).sum(axis=-1, keepdims=True)
    gradient = -height * np.sin(angle) @ frequency
    gradient -= (gradient * directions).sum(axis=-1, keepdims=True) * directions
    normals = normalised(directions - gradient / radius)
    return assemble("bumpy_sphere", grid_patch(radius * directions, normals, uvs))


def _directions(resolution: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions (rows, columns, 3) from -y to +y, around from +z by +x, and their uvs."""
    require_resolution(resolution)
    latitude = np.pi * (np.arange(resolution + 1) / resolution - 0.5)
    out, up = np.cos(latitude), np.sin(latitude)
    out[[0, -1]] = 0.0  # cos(pi / 2) is not zero in floating point; the poles are
    sine, cosine = full_turn(2 * resolution)
    directions = np.stack(
        [
            np.outer(out, sine),
            np.broadcast_to(up[:, None], (len(up), len(sine))),
            np.outer(out, cosine),
        ],
        axis=-1,
    )
    u, v = np.meshgrid(np.linspace(0, 1, 2 * resolution + 1), np.linspace(0, 1, resolution + 1))
    # A pole belongs to one triangle a column: its u is in the triangle's middle.
    half_step = 0.25 / resolution
    u[0] = np.minimum(u[0] + half_step, 1.0)
    u[-1] = np.maximum(u[-1] - half_step, 0.0)
    return directions, np.stack([u, v], axis=-1)
