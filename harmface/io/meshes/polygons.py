"""Triangles from polygons, strips and fans."""

import mapbox_earcut
import numpy as np
from jaxtyping import Bool, Float, Integer

from harmface.errors import FileError

MOST_CORNERS = 10_000
"""Most corners of a polygon that is not convex: cutting one takes up to seconds."""


def triangulate(
    vertices: Float[np.ndarray, "V 3"],
    corners: Integer[np.ndarray, "C"],
    counts: Integer[np.ndarray, "P"],
) -> tuple[Integer[np.ndarray, "T 3"], Integer[np.ndarray, "T"]]:
    """Cut polygons into triangles.

    Parameters
    ----------
    vertices
        Positions.
    corners
        Vertex indices of all polygons, one polygon after the other.
    counts
        How many corners each polygon has; those with fewer than three are left out.

    Returns
    -------
    triangles
        Indices into `corners`, in the order of the polygons.
    polygon
        The polygon of each triangle.
    """
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(vertices):
        raise FileError(
            f"a face names vertex {corners.max() + 1 if corners.min() >= 0 else corners.min()} "
            f"of {len(vertices)}"
        )
    starts = np.cumsum(counts) - counts
    triangles, polygon = [], []
    for count in np.unique(counts[counts >= 3]):
        chosen = np.flatnonzero(counts == count)
        places = starts[chosen][:, None] + np.arange(count)
        fan = np.stack(
            [np.zeros(count - 2, int), np.arange(1, count - 1), np.arange(2, count)], axis=1
        )
        if count == 3:
            convex = np.ones(len(chosen), bool)
        else:
            convex = np.concatenate(
                [
                    _convex(vertices[corners[some]])
                    for some in np.array_split(places, 1 + places.size // 2**20)
                ]
            )
        triangles.append(places[convex][:, fan].reshape(-1, 3))
        polygon.append(np.repeat(chosen[convex], count - 2))
        for index, place in zip(chosen[~convex], places[~convex], strict=True):
            cut = place[_cut(vertices[corners[place]])]
            triangles.append(cut)
            polygon.append(np.full(len(cut), index))
    if not triangles:
        return np.empty((0, 3), int), np.empty(0, int)
    whole, owner = np.concatenate(triangles), np.concatenate(polygon)
    order = np.argsort(owner, kind="stable")
    return whole[order], owner[order]


def strip(indices: Integer[np.ndarray, "N"]) -> Integer[np.ndarray, "T 3"]:
    """Return the triangles of a strip, every other one turned round."""
    faces = np.lib.stride_tricks.sliding_window_view(indices, 3).copy()
    faces[1::2] = faces[1::2, [1, 0, 2]]
    return faces


def fan(indices: Integer[np.ndarray, "N"]) -> Integer[np.ndarray, "T 3"]:
    """Return the triangles of a fan."""
    first = np.full(len(indices) - 2, indices[0])
    return np.stack([indices[1:-1], indices[2:], first], axis=1)


def _convex(points: Float[np.ndarray, "P C 3"]) -> Bool[np.ndarray, "P"]:
    """Return which polygons turn one way, and once round, at all their corners."""
    edges = np.roll(points, -1, axis=1) - points
    turns = np.cross(np.roll(edges, 1, axis=1), edges)
    normal = _newell(points)
    size = np.abs(turns).max(axis=(1, 2))
    inward = (
        np.einsum("pci,pi->pc", turns, normal)
        < -1e-9 * (size * np.linalg.norm(normal, axis=1))[:, None]
    )
    # A star turns one way at all its corners, but fans from its first corner overlap.
    fans = points[:, 1:] - points[:, :1]
    areas = np.einsum("pci,pi->pc", np.cross(fans[:, :-1], fans[:, 1:]), normal)
    folded = (areas < -1e-9 * np.abs(areas).max(axis=1, keepdims=True)).any(axis=1)
    return ~(inward.any(axis=1) | folded)


def _cut(points: Float[np.ndarray, "C 3"]) -> Integer[np.ndarray, "T 3"]:
    """Cut one polygon, looked at against its mean normal, by clipping ears."""
    if len(points) > MOST_CORNERS:
        raise FileError(
            f"a face that is not convex has {len(points)} corners, more than {MOST_CORNERS}; "
            "export the mesh with triangles"
        )
    normal = _newell(points[None])[0]
    # The plane whose axes are the two that the normal is least along; in the right order, what
    # runs counter-clockwise about the normal still does.
    last = int(np.abs(normal).argmax())
    axes = [(last + 1) % 3, (last + 2) % 3]
    if normal[last] < 0:
        axes.reverse()
    flat = np.ascontiguousarray((points - points[0])[:, axes])
    cut = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], np.uint32))
    return np.asarray(cut).reshape(-1, 3).astype(int)


def _newell(points: Float[np.ndarray, "P C 3"]) -> Float[np.ndarray, "P 3"]:
    """Return twice the area vectors of polygons (Newell's method)."""
    spokes = points - points[:, :1]
    return np.cross(spokes, np.roll(spokes, -1, axis=1)).sum(axis=1)
