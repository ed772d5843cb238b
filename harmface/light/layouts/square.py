"""Positions in square maps that show a disc: u to the right, v up, both in [-1, 1]."""

import numpy as np
from jaxtyping import Float, Int

from harmface.errors import ArgumentError


def square_height(what: str, shape: tuple[int, ...]) -> int:
    """Return the height of a square map, or refuse it by name."""
    if len(shape) != 2 or shape[0] != shape[1] or shape[0] == 0:
        raise ArgumentError(f"{what} is square, got pixel axes of shape {shape}")
    return shape[0]


def plane_position(
    position: tuple[Float[np.ndarray, "..."], ...], height: int, offset: float = 0.0
) -> tuple[Float[np.ndarray, "..."], Float[np.ndarray, "..."]]:
    """Return `(u, v)` of rows and columns, `offset` pixels nearer to the upper left corner."""
    rows, columns = np.broadcast_arrays(*position)
    return 2 * (columns - offset) / height - 1, 1 - 2 * (rows - offset) / height


def disc_position(
    x: Float[np.ndarray, "..."],
    y: Float[np.ndarray, "..."],
    radius: Float[np.ndarray, "..."],
    height: int,
    offset: float = 0.0,
) -> tuple[Float[np.ndarray, "..."], Float[np.ndarray, "..."]]:
    """Return rows and columns at a radius of the disc, towards (x, y); +x where these vanish."""
    azimuth = np.arctan2(y, x)
    u, v = radius * np.cos(azimuth), radius * np.sin(azimuth)
    return height * (1 - v) / 2 + offset, height * (1 + u) / 2 + offset


def pixels_inside(
    position: tuple[Float[np.ndarray, "..."], ...], height: int, offset: float = 0.0
) -> tuple[Int[np.ndarray, "..."], Int[np.ndarray, "..."]]:
    """Return the indices of the pixels at positions, or of the nearest with its centre inside.

    All of the rim is the one direction -z, so pixels just inside it show about the same.
    """
    u, v = plane_position(position, height, offset)
    # A pixel's diagonal is 2 sqrt(2) / height long: half of it inwards is enough.
    radius = np.hypot(u, v)
    shrink = np.where(radius < 1, 1, (1 - 1.5 / height) / np.maximum(radius, 1))
    rows = height * (1 - v * shrink) / 2 + offset
    columns = height * (1 + u * shrink) / 2 + offset
    return (
        np.clip(rows.astype(np.intp), 0, height - 1),
        np.clip(columns.astype(np.intp), 0, height - 1),
    )
