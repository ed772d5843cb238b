"""Quadrature rules on the sphere whose panels follow the features of an environment."""

import numpy as np


def panels(breaks: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Put a Gauss-Legendre rule on every interval between consecutive breaks.

    Parameters
    ----------
    breaks : (B,) float
        In any order; equal ones count once.
    nodes : int
        In each interval.

    Returns
    -------
    positions, weights : ((B - 1) nodes,) float64
    """
    points, weights = np.polynomial.legendre.leggauss(nodes)
    breaks = np.unique(breaks)
    half = np.diff(breaks)[:, None] / 2
    middle = breaks[:-1, None] + half
    return (middle + half * points).ravel(), (half * weights).ravel()


def sphere_rule(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Integrate smooth functions: Gauss-Legendre in z by twice as many equal azimuths.

    Exact for harmonics up to degree `2 nodes - 1`.
    """
    z, weights = np.polynomial.legendre.leggauss(nodes)
    azimuth = np.pi * np.arange(2 * nodes) / nodes
    across = np.sqrt(1.0 - z**2)
    directions = np.stack(
        [
            np.outer(across, np.cos(azimuth)),
            np.outer(across, np.sin(azimuth)),
            np.repeat(z[:, None], 2 * nodes, axis=1),
        ],
        axis=-1,
    )
    return directions.reshape(-1, 3), np.repeat(weights * np.pi / nodes, 2 * nodes)


def sky_rule(
    pole: np.ndarray, rings: tuple[float, ...], nodes: int
) -> tuple[np.ndarray, np.ndarray]:
    """Integrate functions with rings around a pole and a jump at the horizon y = 0.

    Polar coordinates about the pole, say the sun; each circle is cut where it crosses the
    horizon. The cut moves as a square root where a circle only just touches the horizon, and a
    change of variable with a vanishing derivative there makes it smooth.

    Parameters
    ----------
    pole : (3,) float, unit
        Above the horizon.
    rings : tuple of float
        Angles from the pole, in radians, across which the function is not smooth.
    nodes : int
        In each interval of the angle, and in each arc of a circle.
    """
    altitude = np.arcsin(np.clip(pole[1], -1.0, 1.0))
    up = np.array([0.0, 1.0, 0.0]) - pole[1] * pole
    # At the zenith any horizontal direction serves.
    up = up / np.linalg.norm(up) if np.linalg.norm(up) > 1e-12 else np.array([0.0, 0.0, 1.0])
    side = np.cross(pole, up)

    breaks = np.unique([0.0, *rings, altitude, np.pi - altitude, np.pi])
    fraction, weights = panels(np.array([0.0, 1.0]), nodes)
    start, length = breaks[:-1, None], np.diff(breaks)[:, None]
    angle = (start + length * fraction**2 * (3.0 - 2.0 * fraction)).ravel()
    weight = (length * weights * 6.0 * fraction * (1.0 - fraction)).ravel() * np.sin(angle)

    # Above the horizon where cos(azimuth) > -tan(altitude) / tan(angle).
    crossing = np.arccos(
        np.clip(-np.sin(altitude) * np.cos(angle) / (np.cos(altitude) * np.sin(angle)), -1.0, 1.0)
    )
    points, weights = np.polynomial.legendre.leggauss(nodes)
    above, below = crossing[:, None], np.pi - crossing[:, None]
    azimuth = np.concatenate([above * points, np.pi + below * points], axis=1)
    weight = weight[:, None] * np.concatenate([above * weights, below * weights], axis=1)
    directions = np.cos(angle)[:, None, None] * pole + np.sin(angle)[:, None, None] * (
        np.cos(azimuth)[..., None] * up + np.sin(azimuth)[..., None] * side
    )
    kept = weight > 0
    return directions[kept], weight[kept]


def wall_rule(
    s_breaks: np.ndarray, t_breaks: np.ndarray, distance: float, nodes: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integrate over the solid angle of a wall, a plane rectangle at a distance from the origin.

    Returns
    -------
    s, t : (J,) float64
        Nodes on the wall.
    solid_angles : (J,) float64
        Weights times `distance / r^3`, r from the origin.
    """
    s, s_weights = panels(s_breaks, nodes)
    t, t_weights = panels(t_breaks, nodes)
    s, t = (grid.ravel() for grid in np.meshgrid(s, t, indexing="ij"))
    radius = np.sqrt(s**2 + t**2 + distance**2)
    return s, t, np.outer(s_weights, t_weights).ravel() * distance / radius**3
