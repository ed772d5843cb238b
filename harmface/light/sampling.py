"""Looking a map up in any direction, and drawing it anew in another layout."""

import math
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from harmface import checks
from harmface.light.environment_map import EnvironmentMap
from harmface.light.layouts import Layout, layout_named


def sample(
    environment: EnvironmentMap, directions: Float[np.ndarray, "*points 3"]
) -> Float[np.ndarray, "..."]:
    """Return the radiance that a map shows in given directions, linear between pixel centres.

    There are no seams: beyond a map's edge lie the pixels that look there.

    Parameters
    ----------
    environment
        The map.
    directions
        Unit directions in the world.

    Returns
    -------
    numpy.ndarray
        `(*channels, *points)`, in the map's precision.

    Raises
    ------
    ArgumentError
        If a direction is not of unit length.
    """
    directions = checks.unit_vectors("directions", directions).astype(np.float64)
    border = _with_border(environment)
    *face, rows, columns = environment.layout.positions_of(
        directions @ environment.frame, environment.height
    )
    face = [number.astype(np.intp) for number in face]
    # The first pixel's centre, at position 0.5, has index 1 inside the border.
    row, down = _split(rows + 0.5)
    column, across = _split(columns + 0.5)
    seen = np.zeros((*environment.channels, *directions.shape[:-1]), border.dtype)
    for next_row, row_weight in ((0, 1 - down), (1, down)):
        for next_column, column_weight in ((0, 1 - across), (1, across)):
            weight = (row_weight * column_weight).astype(border.dtype)
            index: tuple[Any, ...] = (..., *face, row + next_row, column + next_column)
            seen += weight * border[index]
    return seen


def resample(environment: EnvironmentMap, layout: str | Layout, height: int) -> EnvironmentMap:
    """Return a map drawn anew in a layout, in our own frame, without aliasing.

    Each new pixel is the mean over its solid angle of as many lookups as pixels of the old map fit
    into it. The old map's frame, and so any rotation, is taken up in the pixels.

    Parameters
    ----------
    environment
        The map.
    layout
        The new layout or its name.
    height
        The new height, of a face for a cube.

    Returns
    -------
    EnvironmentMap
        With the same channels and precision.

    Raises
    ------
    ArgumentError
        If there is no such layout or the height is below 1.
    """
    layout = layout_named(layout)
    height = checks.positive_integer("height", height)
    solid_angles = layout.solid_angles(height)
    shows = solid_angles > 0
    ratio = np.sqrt(np.count_nonzero(environment.solid_angles) / np.count_nonzero(shows))
    splits = max(1, math.ceil(ratio - 1e-9))
    seen = sample(environment, layout.directions(height * splits))
    seen *= layout.solid_angles(height * splits).astype(seen.dtype)
    *leading, rows, columns = seen.shape
    parts = seen.reshape(*leading, rows // splits, splits, columns // splits, splits)
    power = parts.sum(axis=(-3, -1), dtype=np.float64)
    power[..., shows] /= solid_angles[shows]
    return EnvironmentMap(power.astype(seen.dtype), layout)


def _with_border(environment: EnvironmentMap) -> Float[np.ndarray, "*channels_pixels"]:
    """Return the map with one pixel more on every side, taken from where those look.

    Pixels that show nothing, around a disc, are filled likewise.
    """
    layout, height = environment.layout, environment.height
    *first, rows, columns = environment.pixels
    faces = [np.arange(count, dtype=float).reshape(-1, 1, 1) for count in first]
    down, across = np.arange(-1, rows + 1)[:, None] + 0.5, np.arange(-1, columns + 1) + 0.5
    near: tuple[Any, ...] = layout.pixels_near(*faces, down, across, height=height)
    return environment.radiance[(..., *near)]


def _split(
    position: Float[np.ndarray, "*points"],
) -> tuple[Int[np.ndarray, "*points"], Float[np.ndarray, "*points"]]:
    """Return whole parts as indices, and the fractions."""
    whole = np.floor(position)
    return whole.astype(np.intp), position - whole
