"""What an environment is, and how it becomes quadrature nodes or a lat-long map."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Rule = tuple[np.ndarray, np.ndarray]
"""Directions (J, 3) and solid angles (J,), which add up to 4 pi."""

# Coarse maps are averages of one with at least so many rows, whose samples lie a third of a
# degree apart: nothing here is smaller than the sun's disc of half a degree, so nothing slips
# between them.
_LEAST_HEIGHT = 256
# A pixel is sampled on a Fibonacci lattice (step, points), which holds as many different rows
# and columns as points: an edge along the pixel's side is placed as well as a slanted one.
_LATTICE = (3, 5)
_FINEST = 10_000
# A pixel gets more points while it may be wrong by this share of the mean pixel's flux.
_PIXEL_TOLERANCE = 0.025
_CHUNK = 1 << 16


@dataclass(frozen=True)
class Environment:
    """Distant light: radiance as a function of the direction it comes from.

    Attributes
    ----------
    name : str
    radiance : callable
        From unit directions (..., 3) to linear RGB radiance (..., 3), non-negative. The frame
        has x right, y up and z towards the viewer; the light is seen from the origin.
    rule : callable
        From the number of nodes along a panel to a quadrature rule whose panels end where this
        environment's features do, so that it converges fast in spite of them.
    nodes : int
        Nodes along a panel that bring harmonic coefficients of low degree to 1e-5.
    """

    name: str
    radiance: Callable[[np.ndarray], np.ndarray]
    rule: Callable[[int], Rule]
    nodes: int


def quadrature(environment: Environment, refinement: int = 1) -> Rule:
    """Return the rule that integrates this environment.

    A harmonic coefficient is `sum_j radiance(d_j) Y(d_j) w_j`. To degree 2 its error is below
    1e-5 of the norm of all of them; a refinement of 2 tells how far below.

    Parameters
    ----------
    environment : Environment
    refinement : int
        Factor on the nodes along a panel, at least 1.

    Returns
    -------
    directions : (J, 3) float64, unit
    solid_angles : (J,) float64, positive
        Steradians; they add up to 4 pi.
    """
    if refinement < 1:
        raise ValueError(f"refinement must be at least 1, got {refinement}: 1 is accurate to 1e-5")
    return environment.rule(environment.nodes * refinement)


def latlong_directions(height: int) -> np.ndarray:
    """Return the directions (H, 2H, 3) of the pixel centres of a lat-long map.

    OpenEXR's layout: the top row looks to +y, the centre column to +z and the left quarter to +x.
    """
    _require_height(height)
    row, column = np.mgrid[0:height, 0 : 2 * height] + 0.5
    return _directions(np.pi * row / height, np.pi * column / height)


def rasterise(environment: Environment, height: int) -> np.ndarray:
    """Rasterise to a lat-long map whose pixels are averages over their solid angle.

    Pixels that an edge may cross are sampled more finely, until the whole map is accurate to
    about 1e-5 of its flux. A pixel keeps the flux, not the place, of what is smaller than
    itself: a map moves a small lamp by up to half a pixel.

    Parameters
    ----------
    environment : Environment
    height : int
        Rows H, at least 4; there are twice as many columns.

    Returns
    -------
    (H, 2H, 3) float64
        Linear RGB radiance in OpenEXR's lat-long layout.
    """
    _require_height(height)
    finer = -(-_LEAST_HEIGHT // height)
    image = _rasterise(environment, finer * height)
    solid_angle = _solid_angles(finer * height)[:, None, None]
    blocks = (image * solid_angle).reshape(height, finer, 2 * height, finer, 3).sum(axis=(1, 3))
    averages: np.ndarray = blocks / _solid_angles(height)[:, None, None]
    return averages


def _rasterise(environment: Environment, height: int) -> np.ndarray:
    solid_angle = np.repeat(_solid_angles(height), 2 * height)[:, None]
    pixels = np.arange(len(solid_angle))
    lattice = _LATTICE
    image = _sample(environment, height, pixels, lattice)
    tolerance = _PIXEL_TOLERANCE * (image * solid_angle).mean(axis=0)
    # A linear gradient is sampled exactly; what bends may be an edge, which N points place to
    # about N^(-3/4) of the pixel: four times as well from one lattice to the next used.
    doubt = _bend(image.reshape(height, 2 * height, 3)).reshape(-1, 3) / lattice[1] ** 0.75
    while lattice[1] < _FINEST:
        pixels = pixels[(doubt * solid_angle[pixels] > tolerance).any(axis=1)]
        if not len(pixels):
            break
        for _ in range(4):
            lattice = _next(lattice)
        finer = _sample(environment, height, pixels, lattice)
        doubt = np.abs(finer - image[pixels]) / 4.0
        image[pixels] = finer
    return image.reshape(height, 2 * height, 3)


def _solid_angles(height: int) -> np.ndarray:
    """Solid angle (H,) of a pixel in each row of a lat-long map."""
    edges = np.pi * np.arange(height + 1) / height
    return np.pi / height * -np.diff(np.cos(edges))


def _next(lattice: tuple[int, int]) -> tuple[int, int]:
    """Step along the Fibonacci numbers."""
    return lattice[1], sum(lattice)


def _sample(
    environment: Environment, height: int, pixels: np.ndarray, lattice: tuple[int, int]
) -> np.ndarray:
    """Mean radiance (P, 3) over a lattice of points, uniform in solid angle, in each pixel."""
    step, points = lattice
    down = (np.arange(points) + 0.5) / points
    right = (np.arange(points) * step % points + 0.5) / points
    parts = []
    for chunk in np.array_split(pixels, 1 + len(pixels) * points // _CHUNK):
        row, column = np.divmod(chunk[:, None], 2 * height)
        top, bottom = np.cos(np.pi * row / height), np.cos(np.pi * (row + 1) / height)
        polar = np.arccos(top + (bottom - top) * down)
        turn = np.pi * (column + right) / height
        parts.append(environment.radiance(_directions(polar, turn)).mean(axis=1))
    return np.concatenate(parts)


def _directions(polar: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Directions at a polar angle from +y and a turn from the left edge of the map."""
    # The left edge looks to -z; turning right leads to +x at the first quarter.
    across = np.sin(polar)
    return np.stack([across * np.sin(turn), np.cos(polar), -across * np.cos(turn)], axis=-1)


def _bend(image: np.ndarray) -> np.ndarray:
    """Sum of the absolute second differences along rows, around the seam, and columns."""
    bend: np.ndarray = np.abs(np.roll(image, 1, axis=1) + np.roll(image, -1, axis=1) - 2.0 * image)
    tall = np.pad(image, ((1, 1), (0, 0), (0, 0)), mode="edge")
    bend += np.abs(tall[2:] + tall[:-2] - 2.0 * image)
    return bend


def _require_height(height: int) -> None:
    if height < 4:
        raise ValueError(f"height must be at least 4 rows, got {height}: 256 is a usual value")
