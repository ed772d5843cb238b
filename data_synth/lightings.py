"""Sets of lights: the 64-light grid, the nine points, random single lights and mixtures.

Directions are unit vectors from the surface to the light in a right-handed frame with x to
the right of the image, y up and z towards the viewer. A light's weight is the irradiance that
it gives to a surface facing it; an ambient or area light is a dense set of directions whose
weights are radiance times solid angle.

References
----------
.. [GBK01] A. Georghiades, P. Belhumeur, D. Kriegman, "From Few to Many: Illumination Cone
   Models for Face Recognition under Variable Lighting and Pose", PAMI 23(6), 2001.
.. [LHK05] K.-C. Lee, J. Ho, D. Kriegman, "Acquiring Linear Subspaces for Face Recognition
   under Variable Lighting", PAMI 27(5), 2005.
"""

from dataclasses import dataclass

import numpy as np

# The positive azimuths; the grid is symmetric about the median plane. Degrees.
_YALE_MEDIAN = ((0, 0), (0, 20), (0, 45), (0, 90), (0, -20), (0, -35))
_YALE_SIDE = (
    *((5, 10), (5, -10), (10, 0), (10, -20), (15, 20), (20, 10), (20, -10), (20, -40)),
    *((25, 0), (35, 15), (35, 40), (35, 65), (35, -20), (50, 0), (50, -40), (60, 20)),
    *((60, -20), (70, 0), (70, 45), (70, -35), (85, 20), (85, -20), (95, 0), (110, 15)),
    *((110, 40), (110, 65), (110, -20), (120, 0), (130, 20)),
)

YALE_SUBSET_LIMITS = (12.0, 25.0, 50.0, 77.0)
"""Largest angle, in degrees, between light and viewing axis of the subsets 1 to 4."""

# The limits are nominal: the database counts A+035E+40 and A-035E+40, whose angle is 51.1
# degrees, in the third subset. No light lies between 52 and 60 degrees, nor within two degrees
# above another limit, so one margin for all gives the published 7, 12, 12, 14 and 19 lights.
_YALE_LIMIT_MARGIN = 2.0

# LHK05's universal configuration: polar angle from the viewing axis and azimuth, in degrees.
_NINE_POINTS = (
    *((0, 0), (68, -90), (74, 108), (80, 52), (85, -42), (85, -137), (85, 146), (85, -4)),
    (51, 67),
)


@dataclass(frozen=True)
class Lights:
    """Images lit from a common set of directions.

    Attributes
    ----------
    name : str
    directions : (J, 3) float64, unit
        From the surface to the light.
    weights : (F, J) float64, non-negative
        Irradiance at normal incidence of each direction, an image a row.
    labels : tuple of F str
        What each image's light is called.
    subset : (F,) int64 or None
        The published subset of each image, counted from 1, where the set has any.
    """

    name: str
    directions: np.ndarray
    weights: np.ndarray
    labels: tuple[str, ...]
    subset: np.ndarray | None = None

    def __post_init__(self) -> None:
        directions, weights = self.directions, self.weights
        if directions.ndim != 2 or directions.shape[1] != 3 or len(directions) == 0:
            raise ValueError(
                f"directions must have shape (J, 3) with J >= 1, got {directions.shape}: "
                "give one unit vector a row"
            )
        if not np.allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=0, atol=1e-6):
            raise ValueError("directions must be unit vectors: divide each by its norm")
        if weights.ndim != 2 or weights.shape[1] != len(directions):
            raise ValueError(
                f"weights must have shape (F, {len(directions)}), one column for each "
                f"direction, got {weights.shape}: give one row for each image"
            )
        if not (np.isfinite(weights).all() and (weights >= 0).all()):
            raise ValueError(
                "weights must be finite and non-negative, got NaN, Inf or a value below 0: "
                "light cannot be negative"
            )
        if len(self.labels) != len(weights):
            raise ValueError(
                f"labels must name each of the {len(weights)} images, got {len(self.labels)}"
            )
        if self.subset is not None and self.subset.shape != (len(weights),):
            raise ValueError(
                f"subset must have shape ({len(weights)},), one for each image, "
                f"got {self.subset.shape}"
            )


def yale64() -> Lights:
    """Return the 64 single lights of the Yale Face Database B, frontal pose [GBK01]_.

    A positive azimuth of the database stands to the right *of the subject*, which is the left
    of the image, so azimuth `a` and elevation `e` give `(-sin a cos e, sin e, cos a cos e)`.
    Labels are those of the database's file names, such as `A+035E-20`.

    Returns
    -------
    Lights
        64 images of one light of unit irradiance each, with their five subsets.

    Examples
    --------
    >>> lights = yale64()
    >>> [int((lights.subset == k).sum()) for k in (1, 2, 3, 4, 5)]
    [7, 12, 12, 14, 19]
    """
    mirrored = [(-azimuth, elevation) for azimuth, elevation in _YALE_SIDE]
    angles = [*_YALE_MEDIAN, *_YALE_SIDE, *mirrored]
    azimuth, elevation = np.radians(angles).T
    directions = np.stack(
        [
            -np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
            np.cos(azimuth) * np.cos(elevation),
        ],
        axis=1,
    )
    labels = tuple(f"A{azimuth:+04d}E{elevation:+03d}" for azimuth, elevation in angles)
    return Lights("yale64", directions, np.eye(64), labels, yale_subset(directions))


def yale_subset(directions: np.ndarray) -> np.ndarray:
    """Subset 1 to 5 of the Yale Face Database B to which each light direction belongs.

    Parameters
    ----------
    directions : (..., 3) float, unit

    Returns
    -------
    (...) int64
        By the angle from the viewing axis +z: up to 12, 25, 50 and 77 degrees and beyond,
        each limit with the database's own margin of two degrees.
    """
    angle = np.degrees(np.arccos(np.clip(directions[..., 2], -1.0, 1.0)))
    limits = np.array(YALE_SUBSET_LIMITS) + _YALE_LIMIT_MARGIN
    subset: np.ndarray = 1 + np.searchsorted(limits, angle)
    return subset


def nine_points() -> Lights:
    """Return the nine lights whose images span a subspace close to the harmonic one [LHK05]_.

    Published as polar angle from the axis through the nose and azimuth about it, in a frame
    with x along the horizon and y vertical; taken here in the frame of this module, azimuth
    from +x towards +y.
    """
    polar, azimuth = np.radians(_NINE_POINTS).T
    directions = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=1
    )
    labels = tuple(f"P{polar:02d}A{azimuth:+04d}" for polar, azimuth in _NINE_POINTS)
    return Lights("ninepoints", directions, np.eye(9), labels)


def uniform_directional(
    n: int, rng: np.random.Generator | int, *, max_polar: float = 180.0
) -> Lights:
    """Light `n` images by one unit light each, directions uniform on a cap about the viewing axis.

    Parameters
    ----------
    n : int
        Number of images, at least 1.
    rng : numpy Generator or seed
    max_polar : float
        Largest angle from +z, in degrees in (0, 180]; 90 lights from the front alone.
    """
    _require_count("n", n)
    if not 0 < max_polar <= 180:
        raise ValueError(
            f"max_polar must be in (0, 180] degrees, got {max_polar}: 180 is the whole sphere"
        )
    directions = _uniform_on_cap(n, np.random.default_rng(rng), max_polar)
    labels = tuple(f"directional {index}" for index in range(n))
    return Lights("directional", directions, np.eye(n), labels)


def mixed(n: int, rng: np.random.Generator | int, *, directions: int = 512) -> Lights:
    """Light `n` images, each by its own mixture of ambient, area and point lights.

    An image has an ambient light with a gradient, one to three area lights (round, or soft
    boxes with sides along the horizon) and up to two point lights, sharing its flux at random.
    Area and point lights stand within 110 degrees of the viewing axis. All images share one
    nearly uniform set of directions, turned at random; a point light is a single one of them.
    Each image is scaled so that its best lit normal receives an irradiance of 1, as under a
    single unit light.

    Parameters
    ----------
    n : int
        Number of images, at least 1.
    rng : numpy Generator or seed
    directions : int
        Number of shared directions, at least 64.

    Returns
    -------
    Lights
        `J = directions` directions; no image has a negative weight.
    """
    _require_count("n", n)
    if directions < 64:
        raise ValueError(
            f"directions must be at least 64 to resolve an area light, got {directions}"
        )
    rng = np.random.default_rng(rng)
    grid = _fibonacci_sphere(directions) @ _random_rotation(rng).T
    weights = np.stack([_mixture(grid, rng) for _ in range(n)])
    best_lit = (weights @ np.maximum(grid @ grid.T, 0.0)).max(axis=1, keepdims=True)
    labels = tuple(f"mixture {index}" for index in range(n))
    return Lights("mixed", grid, weights / best_lit, labels)


def _mixture(grid: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Weights (J,) of one image, their sum 1."""
    ambient = 1.0 + rng.uniform(0.0, 1.0) * (grid @ _uniform_on_cap(1, rng, 180.0)[0])
    area = sum(_area_light(grid, rng) for _ in range(rng.integers(1, 4)))
    points = np.zeros(len(grid))
    count = int(rng.integers(0, 3))
    for direction in _uniform_on_cap(count, rng, 110.0):
        points[np.argmax(grid @ direction)] += rng.uniform(0.2, 1.0)
    lights = np.stack([ambient, area, points] if count else [ambient, area])
    weights: np.ndarray = (rng.dirichlet(np.ones(len(lights))) / lights.sum(axis=1)) @ lights
    return weights


def _area_light(grid: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Radiance (J,) of a soft-edged disc or box, about 10 to 35 degrees in radius."""
    centre = _uniform_on_cap(1, rng, 110.0)[0]
    across = np.cross([0.0, 1.0, 0.0], centre)
    across /= np.linalg.norm(across)
    # Gnomonic coordinates of a lamp that faces the subject; behind the subject there is none.
    facing = grid @ centre
    in_front = facing > 0.2
    plane = np.stack([grid @ across, grid @ np.cross(centre, across)]) / np.where(
        in_front, facing, 1.0
    )
    size = np.tan(np.radians(rng.uniform(10.0, 35.0, 2)))
    if rng.random() < 0.5:
        distance = np.hypot(*plane) / size[0]
    else:
        distance = np.abs(plane / size[:, None]).max(axis=0)
    radiance: np.ndarray = rng.uniform(0.3, 1.0) * in_front * np.exp(-(distance**6))
    return radiance


def _uniform_on_cap(n: int, rng: np.random.Generator, max_polar: float) -> np.ndarray:
    z = rng.uniform(np.cos(np.radians(max_polar)), 1.0, n)
    azimuth = rng.uniform(0.0, 2.0 * np.pi, n)
    radius = np.sqrt(1.0 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1)


def _fibonacci_sphere(n: int) -> np.ndarray:
    """`n` nearly uniform directions: equal steps in z, the golden angle in azimuth."""
    z = 1.0 - (2.0 * np.arange(n) + 1.0) / n
    azimuth = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(n)
    radius = np.sqrt(1.0 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1)


def _random_rotation(rng: np.random.Generator) -> np.ndarray:
    """Draw a rotation uniform over SO(3): the Q of a Gaussian matrix, signs fixed."""
    q, r = np.linalg.qr(rng.standard_normal((3, 3)))
    q *= np.sign(np.diag(r))
    rotation: np.ndarray = q * np.linalg.det(q)
    return rotation


def _require_count(name: str, value: int) -> None:
    if value < 1:
        raise ValueError(f"{name} must be at least 1, got {value}: ask for one image or more")
