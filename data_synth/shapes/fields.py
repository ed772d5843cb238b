"""Height fields: surfaces z = h(x, y) over a square that faces the viewer."""

from collections.abc import Callable

import numpy as np

from data_synth.shapes.shape import Shape, assemble, grid_patch, normalised, require_resolution

Height = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""From x and y to the height h and its derivatives dh/dx and dh/dy, all of one shape."""


def height_field(name: str, height: Height, resolution: int = 128) -> Shape:
    """Build the surface z = h(x, y) over [-1, 1]^2; its normal is along (-dh/dx, -dh/dy, 1).

    Parameters
    ----------
    name : str
    height : callable
        From x, y, each (n, n), to h, dh/dx, dh/dy.
    resolution : int
        Faces along a side, at least 8.
    """
    require_resolution(resolution)
    side = np.linspace(-1.0, 1.0, resolution + 1)
    x, y = np.meshgrid(side, side)
    z, slope_x, slope_y = height(x, y)
    if not (np.isfinite(z).all() and np.isfinite(slope_x).all() and np.isfinite(slope_y).all()):
        raise ValueError(
            "height must return finite heights and slopes on [-1, 1]^2, got NaN or Inf: "
            "give a differentiable function"
        )
    normals = normalised(np.stack([-slope_x, -slope_y, np.ones_like(z)], axis=-1))
    uvs = (np.stack([x, y], axis=-1) + 1.0) / 2.0
    return assemble(name, grid_patch(np.stack([x, y, z], axis=-1), normals, uvs))


def ripples(resolution: int = 128, amplitude: float = 0.08, frequency: float = 12.0) -> Shape:
    """Build rings that run out from the centre, h = amplitude cos(frequency r) exp(-r^2).

    Parameters
    ----------
    resolution : int
    amplitude : float
        Height of the middle ring.
    frequency : float
        Radians per unit length.
    """

    def height(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        radius = np.hypot(x, y)
        fade = amplitude * np.exp(-(radius**2))
        # dh/dr / r, in which sin(f r) / r is a sinc, finite at the centre.
        slope = -fade * (
            frequency**2 * np.sinc(frequency * radius / np.pi) + 2.0 * np.cos(frequency * radius)
        )
        return fade * np.cos(frequency * radius), slope * x, slope * y

    return height_field("ripples", height, resolution)


def hills(resolution: int = 128, count: int = 24, rng: np.random.Generator | int = 0) -> Shape:
    """Build a relief of `count` Gaussian hills and hollows at random places.

    Parameters
    ----------
    resolution : int
    count : int
        At least 1.
    rng : numpy Generator or seed
    """
    if count < 1:
        raise ValueError(f"count must be at least 1, got {count}: ask for one hill or more")
    rng = np.random.default_rng(rng)
    centre = rng.uniform(-0.9, 0.9, (count, 2))
    width = rng.uniform(0.12, 0.35, count)
    peak = rng.uniform(-0.6, 1.0, count) * width

    def height(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        dx, dy = x[..., None] - centre[:, 0], y[..., None] - centre[:, 1]
        hill = peak * np.exp(-(dx**2 + dy**2) / (2.0 * width**2))
        slope = -hill / width**2
        return hill.sum(axis=-1), (slope * dx).sum(axis=-1), (slope * dy).sum(axis=-1)

    return height_field("hills", height, resolution)
