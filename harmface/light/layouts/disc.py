"""Solid angles of square pixels in maps that fill a disc."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from harmface.light.layouts.layout import ALL

NODES = 8
"""Gauss-Legendre nodes on a pixel's edge: the integrands below are smooth over the whole disc, and
eight nodes integrate them to rounding even on the coarsest grid that cuts the disc."""


def disc_solid_angles(
    lines: Float[np.ndarray, "lines"],
    cap: Callable[[Float[np.ndarray, "..."]], Float[np.ndarray, "..."]],
    rows: slice = ALL,
) -> Float[np.ndarray, "rows columns"]:
    """Return the solid angle of every pixel of a square that circumscribes a map's disc.

    The disc of radius 1 shows direction `theta` from +z at radius `r`, all azimuths alike. With
    `cap(r**2) = (1 - cos theta) / r**2`, Stokes' theorem turns a pixel's solid angle, the integral
    of `sin theta dtheta dphi` over its part inside the disc, into the integral of
    `(1 - cos theta) dphi = cap (u dv - v du)` along that part's outline: four straight edges, each
    shared by two pixels, and the arcs of the rim, where `1 - cos theta = 2`. Shared edges cancel in
    sums, so the total is 4 pi to rounding.

    Parameters
    ----------
    lines
        Where the pixels' edges are, across as down, from -1 to 1.
    cap
        The function above, smooth in `r**2`.
    rows
        Which rows are wanted.

    Returns
    -------
    solid_angles
        In steradians; zero for pixels outside the disc.
    """
    some = range(len(lines) - 1)[rows]
    near = lines[some.start : some.stop + 1]
    horizontal, vertical = _edge_integrals(near, lines, cap), _edge_integrals(lines, near, cap)
    solid_angles = np.diff(horizontal, axis=0) + np.diff(vertical, axis=0).T

    # The rim's arcs: cut it at every grid line, across and down, and give each arc to its pixel.
    points = lines + 1j * np.sqrt(1 - lines**2)
    crossings = np.concatenate([points, points.conj(), 1j * points, 1j * points.conj()])
    angles = np.sort(np.angle(crossings))
    middle = (angles[1:] + angles[:-1]) / 2
    column = np.searchsorted(lines[1:-1], np.cos(middle))
    row = np.searchsorted(lines[1:-1], np.sin(middle)) - some.start
    here = (row >= 0) & (row < len(some))
    np.add.at(solid_angles, (row[here], column[here]), 2 * np.diff(angles)[here])
    # Rounding may leave less than nothing where a pixel has no part in the disc.
    return np.maximum(solid_angles, 0)


def _edge_integrals(
    lines: Float[np.ndarray, "lines"],
    ends: Float[np.ndarray, "ends"],
    cap: Callable[[Float[np.ndarray, "..."]], Float[np.ndarray, "..."]],
) -> Float[np.ndarray, "lines edges"]:
    """Return `t * integral of cap(t**2 + s**2) ds` on each line `t` from one end to the next."""
    half_chord = np.sqrt(1 - lines**2)[:, None]
    first = np.clip(ends[:-1], -half_chord, half_chord)
    last = np.clip(ends[1:], -half_chord, half_chord)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    total = np.zeros_like(first)
    for node, weight in zip(nodes, weights, strict=True):
        s = (first + last) / 2 + node * (last - first) / 2
        total += weight * cap(lines[:, None] ** 2 + s**2)
    return lines[:, None] * total * (last - first) / 2
