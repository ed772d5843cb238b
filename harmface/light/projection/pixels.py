"""Projection pixel by pixel, for any layout: harmonics at the centres times solid angles."""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from harmface.conventions import harmonic_count
from harmface.light.layouts import FACES, Cube, Layout
from harmface.light.layouts.cube import FACE_ROTATIONS
from harmface.sphere import real_harmonics, rotate

BLOCK = 2**18
"""Numbers handled at a time, in the table and in the map's float64 copy: 2 MB."""

MAX_CACHED = 2**22
"""Largest table kept for the next map of the same size, in numbers: 32 MB."""

_UNTURNED_FACE = FACES.index("-z")


def project_pixels(
    radiance: Float[np.ndarray, "*channels_pixels"], form: Layout, max_degree: int
) -> Float[np.ndarray, "*channels K"]:
    """Return a map's coefficients in its layout's frame, see `project_map`."""
    if not isinstance(form, Cube):
        return _sums(radiance, form, max_degree)
    # Each face is projected as if it were -z, from one table, and its coefficients turned.
    of_faces = _sums(radiance, form, max_degree)
    return np.einsum("...fj,fjk->...k", of_faces, _face_turns(max_degree))


def _sums(
    radiance: Float[np.ndarray, "*leading H W"], form: Layout, max_degree: int
) -> Float[np.ndarray, "*leading K"]:
    """Return the sum of radiance times the table over the last two axes, in float64."""
    height, width = radiance.shape[-2:]
    total = np.zeros((*radiance.shape[:-2], harmonic_count(max_degree)))
    step = max(1, BLOCK // ((total.size // total.shape[-1] + total.shape[-1]) * width))
    for rows, table in _tables(form, height, max_degree, step):
        block = radiance[..., rows, :].astype(np.float64, order="C")
        total += block.reshape(*block.shape[:-2], -1) @ table.T
    return total


def _tables(
    form: Layout, height: int, max_degree: int, step: int
) -> Iterator[tuple[slice, Float[np.ndarray, "K pixels"]]]:
    """Yield blocks of rows and their tables, from the cache where all of the map's fits."""
    cached = height**2 * harmonic_count(max_degree) <= MAX_CACHED
    for first in range(0, height, step):
        rows = slice(first, min(first + step, height))
        if cached:
            whole = _whole_table(form, height, max_degree)
            yield rows, whole[:, rows.start * height : rows.stop * height]
        else:
            yield rows, _table(form, height, max_degree, rows)


@lru_cache(maxsize=1)
def _whole_table(form: Layout, height: int, max_degree: int) -> Float[np.ndarray, "K pixels"]:
    return _table(form, height, max_degree, slice(0, height))


def _table(
    form: Layout, height: int, max_degree: int, rows: slice
) -> Float[np.ndarray, "K pixels"]:
    directions = form.directions(height, rows)
    solid_angles = form.solid_angles(height, rows)
    if isinstance(form, Cube):
        directions, solid_angles = directions[_UNTURNED_FACE], solid_angles[_UNTURNED_FACE]
    return real_harmonics(directions.reshape(-1, 3), max_degree) * solid_angles.ravel()


@lru_cache(maxsize=8)
def _face_turns(max_degree: int) -> Float[np.ndarray, "6 K K"]:
    """Return, for each face, the coefficients of each harmonic turned from -z onto it."""
    identity = np.eye(harmonic_count(max_degree))
    return np.stack([rotate(identity, rotation) for rotation in FACE_ROTATIONS])
